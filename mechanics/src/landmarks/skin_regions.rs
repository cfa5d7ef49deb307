//! Parts of the face, bounded by landmarks of the profile: lips, chin, nose, cheeks.
//!
//! | region | heights | to either side of the mid-plane |
//! | --- | --- | --- |
//! | `nose` | subnasale to 30 mm above the pronasale | 20 mm |
//! | `lips` | sublabiale to subnasale | 27 mm |
//! | `chin` | as far below the pogonion as the sublabiale is above it, up to the sublabiale | 27 mm |
//! | `cheeks` | pogonion to 20 mm above the pronasale | 27 mm (beside the nose 20 mm) to 65 mm |
//!
//! Without a pronasale there is no nose, and cheeks end at the subnasale.
//!
//! Only skin that is at most 30 mm, for the cheeks 60 mm, behind the subnasale counts. The widths are those of an adult:
//! half of a mouth of 54 mm, of a nose of 40 mm.

use std::collections::BTreeMap;

use super::mid_plane::MidPlane;
use super::profile::ProfileLandmarks;
use crate::mesh::Vector;

const HALF_MOUTH: f64 = 27.0;
const HALF_NOSE: f64 = 20.0;
const HALF_FACE: f64 = 65.0;
const NOSE_HEIGHT: f64 = 30.0;
const CHEEK_HEIGHT: f64 = 20.0;
const FRONT: f64 = 30.0;
const CHEEK_FRONT: f64 = 60.0;

/// The nodes of each part of the face, ascending; each node is in one at most. Parts without a node are left out.
pub fn skin_regions(
    nodes: &[Vector],
    skin: &[u32],
    plane: &MidPlane,
    landmarks: &ProfileLandmarks,
) -> BTreeMap<String, Vec<u32>> {
    let mut regions: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for &node in skin {
        let place = plane.coordinates(&nodes[node as usize]);
        if let Some(region) = region_of(place, landmarks) {
            regions.entry(region.to_owned()).or_default().push(node);
        }
    }
    regions.values_mut().for_each(|nodes| nodes.sort_unstable());
    regions
}

fn region_of([lateral, height, advance]: [f64; 3], at: &ProfileLandmarks) -> Option<&'static str> {
    let aside = lateral.abs();
    let behind = at.subnasale.advance - advance;
    let lowest = 2.0 * at.pogonion.height - at.sublabiale.height;
    if behind <= FRONT && aside <= HALF_MOUTH {
        if (lowest..at.sublabiale.height).contains(&height) {
            return Some("chin");
        }
        if (at.sublabiale.height..=at.subnasale.height).contains(&height) {
            return Some("lips");
        }
        let above_nose = at.pronasale.map(|tip| tip.height + NOSE_HEIGHT);
        let is_nose = |above: f64| (at.subnasale.height..=above).contains(&height);
        if aside <= HALF_NOSE && above_nose.is_some_and(is_nose) {
            return Some("nose");
        }
    }
    let beside = if height > at.subnasale.height { HALF_NOSE } else { HALF_MOUTH };
    let above_cheeks = at.pronasale.map_or(at.subnasale.height, |tip| tip.height + CHEEK_HEIGHT);
    let is_cheek = (beside..=HALF_FACE).contains(&aside)
        && behind <= CHEEK_FRONT
        && (at.pogonion.height..=above_cheeks).contains(&height);
    is_cheek.then_some("cheeks")
}
