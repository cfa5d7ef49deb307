//! Overlaps of bones between surfaces.

use rayon::prelude::*;

use super::shell::Shell;
use super::surface::SurfaceDomain;
use crate::mesh::Vector;

/// Two bones that lie in one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    pub bones: [usize; 2],
    /// In mm³.
    pub volume: f64,
    /// In mm.
    pub centre: Vector,
}

/// Points in another bone are fewer by chance: of a bone that touches it.
const LEAST_POINTS: usize = 3;

impl SurfaceDomain {
    /// The overlap of each two bones, by the points of the smaller one that lie in the other.
    pub fn overlaps(&self) -> Vec<Overlap> {
        let bones: Vec<&Shell> = self.bone_shells().collect();
        let volume = |bone: usize| self.assessments()[bone + 1].volume;
        let overlap = |one: usize, other: usize| {
            let [small, large] =
                if volume(one) <= volume(other) { [one, other] } else { [other, one] };
            let points = &bones[small].inside;
            let within = points.par_iter().filter(|point| bones[large].value(point) > 0.0);
            let within: Vec<Vector> = within.copied().collect();
            (within.len() >= LEAST_POINTS).then(|| Overlap {
                bones: [one, other],
                volume: volume(small) * within.len() as f64 / points.len() as f64,
                centre: within.iter().sum::<Vector>() / within.len() as f64,
            })
        };
        let pairs = (0..bones.len()).flat_map(|one| (one + 1..bones.len()).map(move |n| (one, n)));
        pairs.filter_map(|(one, other)| overlap(one, other)).collect()
    }
}
