//! Map of airways: which air around a body given by its surfaces is that of an airway, on a grid of some millimetres.

use rayon::prelude::*;

use super::compartments::{Division, airways};
use super::flood::place;
use crate::mesh::Vector;

/// Voxels along the diagonal of a body.
const VOXELS: f64 = 110.0;
/// Openings of the skin narrower than this lead into an airway, in mm and in voxels, whichever is more.
const OPENING: f64 = 10.0;
const OPENING_VOXELS: f64 = 3.0;

/// The air nearest to each voxel.
#[derive(Clone, Debug)]
pub(super) struct AirwayMap {
    low: Vector,
    spacing: f64,
    size: [usize; 3],
    airway: Vec<bool>,
}

impl AirwayMap {
    /// Of a body in a box; `faces` are those where it was cut, so that beyond them nothing is known.
    pub(super) fn new(
        bounds: (Vector, Vector),
        faces: [[bool; 2]; 3],
        is_body: impl Fn(&Vector) -> bool + Sync,
    ) -> AirwayMap {
        let spacing = ((bounds.1 - bounds.0).norm() / VOXELS).max(f64::MIN_POSITIVE);
        let opening = OPENING.max(OPENING_VOXELS * spacing);
        let margin = |cut: bool| if cut { -0.5 * spacing } else { opening };
        let low = Vector::from_fn(|axis, _| bounds.0[axis] - margin(faces[axis][0]));
        let high = Vector::from_fn(|axis, _| bounds.1[axis] + margin(faces[axis][1]));
        let size: [usize; 3] = std::array::from_fn(|axis| {
            ((high[axis] - low[axis]) / spacing).max(0.0).floor() as usize + 1
        });
        let centre =
            |voxel: usize| low + Vector::from(place(voxel, size).map(|n| n as f64)) * spacing;
        let voxels = 0..size.iter().product();
        let body: Vec<bool> = voxels.into_par_iter().map(|voxel| is_body(&centre(voxel))).collect();
        let division = Division {
            size,
            spacing: [spacing; 3],
            skin: 0.0,
            bone: 0.0,
            airway_opening: opening,
            bone_gap: 0.0,
        };
        AirwayMap { low, spacing, size, airway: airways(&body, &division) }
    }

    pub(super) fn is_airway(&self, point: &Vector) -> bool {
        let place = (point - self.low) / self.spacing;
        let index: [usize; 3] = std::array::from_fn(|axis| {
            ((place[axis] + 0.5).max(0.0) as usize).min(self.size[axis] - 1)
        });
        self.airway[(index[2] * self.size[1] + index[1]) * self.size[0] + index[0]]
    }
}
