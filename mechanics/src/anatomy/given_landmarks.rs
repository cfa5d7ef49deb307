//! Landmarks of the skin that somebody has picked, as where a bandage covers the profile.

use crate::landmarks::profile::ProfilePoint;
use crate::landmarks::{FaceAxes, MidPlane, ProfileLandmarks};
use crate::mesh::{Vector, VolumeMesh, Warning};
use crate::meshing::{RegionShape, SizeRegion};

/// A landmark farther from all nodes of the skin lies on something else, in mm.
const FAR: f64 = 10.0;
/// Lips reach about so far from their middle, in mm: half a mouth and its corners.
const LIPS: f64 = 30.0;
/// A nose reaches about so far from its tip, in mm.
const NOSE: f64 = 20.0;

/// Landmarks of the skin on its mid-plane, in mm; the tip of the nose where it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenLandmarks {
    pub pogonion: Vector,
    pub sublabiale: Vector,
    pub subnasale: Vector,
    pub pronasale: Option<Vector>,
}

impl GivenLandmarks {
    pub(super) fn named(&self) -> impl Iterator<Item = (&'static str, Vector)> + use<> {
        let GivenLandmarks { pogonion, sublabiale, subnasale, pronasale } = *self;
        let named = [("pogonion", pogonion), ("sublabiale", sublabiale), ("subnasale", subnasale)];
        named.into_iter().chain(pronasale.map(|tip| ("pronasale", tip)))
    }

    /// The sagittal plane through their middle, and what they are on it.
    pub(super) fn on_mid_plane(&self, axes: FaceAxes) -> (MidPlane, ProfileLandmarks) {
        let aside: Vec<f64> = self.named().map(|(_, at)| at.dot(&axes.lateral())).collect();
        let plane = MidPlane { axes, offset: aside.iter().sum::<f64>() / aside.len() as f64 };
        let point = |at: &Vector| {
            let [_, height, advance] = plane.coordinates(at);
            ProfilePoint { height, advance }
        };
        let landmarks = ProfileLandmarks {
            pogonion: point(&self.pogonion),
            sublabiale: point(&self.sublabiale),
            subnasale: point(&self.subnasale),
            pronasale: self.pronasale.as_ref().map(point),
            shallow_fold: None,
        };
        (plane, landmarks)
    }

    /// Balls about lips and nose in which cells are `finest`.
    pub(super) fn fine(&self, finest: f64) -> impl Iterator<Item = SizeRegion> + use<> {
        let lips = ((self.sublabiale + self.subnasale) / 2.0, LIPS);
        let balls = [lips].into_iter().chain(self.pronasale.map(|tip| (tip, NOSE)));
        balls.map(move |(centre, radius)| SizeRegion {
            shape: RegionShape::Ball { centre, radius },
            size: finest,
        })
    }

    /// A warning for each that lies far from the skin of a mesh.
    pub(super) fn far_from(&self, mesh: &VolumeMesh, skin: &[u32]) -> Vec<Warning> {
        let distance = |at: Vector| {
            let nodes = skin.iter().map(|&node| (mesh.nodes[node as usize] - at).norm());
            nodes.fold(f64::INFINITY, f64::min)
        };
        let far = self.named().map(|(name, at)| (name, distance(at))).filter(|(_, mm)| *mm > FAR);
        far.map(|(name, mm)| {
            let detail = format!(
                "landmark {name:?} lies {mm:.0} mm from the skin of the mesh: is it in mm, in the frame of the document?"
            );
            Warning::new("landmark-far", detail).with("distance_mm", mm)
        })
        .collect()
    }
}
