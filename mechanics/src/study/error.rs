//! Error of an answer: the distance of its skin from the reference skin, whose displacement is known.
//!
//! Node-wise e_i = |u_i - u*_i| at the skin nodes of level 0, which refined meshes keep; closest point
//! e_i = min_{y in S*} |x_i + u_i - y|, S* the skin of level 0 moved by u*. Node i weighs a third of the area of its
//! triangles before the movement, so that no closest point is farther than its node.

use std::collections::BTreeMap;

use super::answer::{Answer, Refusal};
use super::estimated::{TrueErrors, lengths};
use super::report::Errors;
use super::variant::Strain;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use crate::prediction::Skin;
use crate::validation::{Statistics, StatisticsError};

/// The skin of level 0 after the true displacement.
pub(super) struct DisplacedSkin<'a> {
    skin: &'a Skin,
    areas: Vec<f64>,
    displacement: &'a [Vector],
    /// None where it is not known what the truth takes for strain.
    pub strain: Option<Strain>,
    search: SurfaceSearch,
}

/// Errors of an answer.
pub(super) struct Measured {
    pub error: Errors,
    pub closest_point: Errors,
    pub regions: BTreeMap<String, Errors>,
    pub skin_mean_mm: f64,
    pub estimated: Estimated,
    /// Share of the moving skin's area that has a scan opposite; none where displacements are compared.
    pub covered_share: Option<f64>,
}

/// What an answer tells of its own error.
#[derive(Default)]
pub(super) struct Estimated {
    pub numerical_error: Option<Errors>,
    pub linearity_error: Option<Errors>,
    pub effectivity: Option<f64>,
}

impl<'a> DisplacedSkin<'a> {
    /// Of a skin and its true displacement, as far as there are both.
    pub(super) fn of(
        skin: &'a Result<Skin, Refusal>,
        truth: &'a Result<Vec<Vector>, Refusal>,
        strain: Option<Strain>,
    ) -> Result<Self, Refusal> {
        let skin = skin.as_ref().map_err(Refusal::clone)?;
        let displacement = truth.as_ref().map_err(|refusal| {
            Refusal::new("truth-failed", format!("{} ({})", refusal.detail, refusal.code))
        })?;
        let search = SurfaceSearch::new(&moved(&skin.surface, displacement))
            .map_err(|error| Refusal::new("truth-failed", error.to_string()))?;
        Ok(DisplacedSkin { skin, areas: skin.surface.point_areas(), displacement, strain, search })
    }

    /// The errors of an answer at the same nodes.
    pub(super) fn measure(&self, answer: &Answer) -> Result<Measured, StatisticsError> {
        let found = &answer.displacement;
        let length: Vec<f64> = found.iter().map(|u| u.norm()).collect();
        let apart: Vec<f64> =
            found.iter().zip(self.displacement).map(|(u, truth)| (u - truth).norm()).collect();
        let places = self.skin.surface.points.iter().zip(found);
        let closest: Vec<f64> =
            places.map(|(x, u)| self.search.closest(&(x + u)).distance).collect();
        let mut regions = BTreeMap::new();
        for (name, points) in &self.skin.regions {
            let of = |values: &[f64]| -> Vec<f64> {
                points.iter().map(|&point| values[point as usize]).collect()
            };
            regions.insert(name.clone(), errors(&of(&apart), &of(&self.areas))?);
        }
        let Answer { estimates, strain, .. } = answer;
        let truth = TrueErrors { errors: &apart, areas: &self.areas, strain: self.strain };
        let estimated = Estimated {
            numerical_error: errors_of(estimates.mesh.as_ref(), &self.areas),
            linearity_error: errors_of(estimates.linearity.as_ref(), &self.areas),
            effectivity: estimates.effectivity(found, *strain, &truth),
        };
        Ok(Measured {
            estimated,
            error: errors(&apart, &self.areas)?,
            closest_point: errors(&closest, &self.areas)?,
            regions,
            skin_mean_mm: Statistics::weighted(&length, &self.areas)?.mean,
            covered_share: None,
        })
    }
}

/// Of lengths with their areas.
pub(super) fn errors(values: &[f64], areas: &[f64]) -> Result<Errors, StatisticsError> {
    let Statistics { mean, p95, max, .. } = Statistics::weighted(values, areas)?;
    Ok(Errors { mean, p95, max })
}

/// Of an estimate, in mm by area; none where it is not known.
fn errors_of(estimate: Option<&Vec<Vector>>, areas: &[f64]) -> Option<Errors> {
    errors(&lengths(estimate?), areas).ok()
}

/// A surface after its points have moved.
pub(super) fn moved(surface: &TriangleSurface, displacement: &[Vector]) -> TriangleSurface {
    let mut moved = surface.clone();
    for (point, u) in moved.points.iter_mut().zip(displacement) {
        *point += u;
    }
    moved
}
