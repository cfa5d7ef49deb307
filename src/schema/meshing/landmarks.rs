//! Landmarks of the skin that are given before a head is meshed.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::anatomy::GivenLandmarks;
use mechanics::mesh::{Frame, Vector};

/// The largest distance of a head from the origin of its scan.
const FARTHEST_MM: f64 = 1e5;
/// The largest distance of mid-plane landmarks from it, in mm.
const ASIDE_MM: f64 = 10.0;

/// Landmarks of the skin on its mid-plane, in mm, in the `frame` of the document, upwards: they bound the parts of the skin,
/// `skin_regions` of the case, and cells around lips and nose are as fine as around segments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SkinLandmarksDocument {
    /// The foremost point of the chin.
    pub pogonion: Triple,
    /// The fold between chin and lower lip.
    pub sublabiale: Triple,
    /// Where the upper lip meets the nose.
    pub subnasale: Triple,
    /// The tip of the nose. If absent, as under a bandage, there is no part `nose`, and cheeks end at the subnasale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub pronasale: Option<Triple>,
}

impl SkinLandmarksDocument {
    /// The landmarks in the frame of the meshed body; errors are added to `faults`.
    pub(super) fn to_given(
        self,
        at: &Pointer,
        frame: Frame,
        mirrored: bool,
        faults: &mut Faults,
    ) -> Option<GivenLandmarks> {
        if frame == Frame::Unspecified {
            let detail = "the input states no frame, so that superior and anterior are not known";
            faults.add(at, ErrorCode::FrameConflict, detail);
            return None;
        }
        let SkinLandmarksDocument { pogonion, sublabiale, subnasale, pronasale } = self;
        let named = [("pogonion", pogonion), ("sublabiale", sublabiale), ("subnasale", subnasale)];
        let named: Vec<_> =
            named.into_iter().chain(pronasale.map(|tip| ("pronasale", tip))).collect();
        let middle = named.iter().map(|(_, place)| place.0[0]).sum::<f64>() / named.len() as f64;
        let mut below: Option<(&str, f64)> = None;
        let mut sound = true;
        for (name, Triple([x, y, z])) in &named {
            let at = at.key(name);
            for (axis, value) in [x, y, z].into_iter().enumerate() {
                let range = -FARTHEST_MM..=FARTHEST_MM;
                sound &= faults.check_range(&at.index(axis), *value, range, "mm");
            }
            let detail = match below {
                Some((lower, height)) if *z <= height => {
                    format!("`{name}` is not above `{lower}`: {z} mm is not above {height} mm")
                }
                _ if (x - middle).abs() > ASIDE_MM => format!(
                    "landmarks have to be on the mid-plane of the face: {x} mm is over {ASIDE_MM} mm from their mean at {middle:.1} mm"
                ),
                _ => {
                    below = Some((*name, *z));
                    continue;
                }
            };
            faults.add(&at, ErrorCode::OutOfRange, detail);
            sound = false;
        }
        let sign = if mirrored { -1.0 } else { 1.0 };
        let place = |Triple([x, y, z]): Triple| Vector::new(sign * x, sign * y, z);
        sound.then(|| GivenLandmarks {
            pogonion: place(pogonion),
            sublabiale: place(sublabiale),
            subnasale: place(subnasale),
            pronasale: pronasale.map(place),
        })
    }
}
