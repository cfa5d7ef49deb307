//! Error of an answer: the distance of its skin from the true one, whose displacement is known.
//!
//! Node-wise e_i = |u_i - u*_i| at the skin nodes of level 0, which refined meshes keep; closest point
//! e_i = min_{y in S*} |x_i + u_i - y|, S* the skin of level 0 moved by u*. Node i weighs a third of the area of its
//! triangles before the movement, so that no closest point is farther than its node.

use std::collections::BTreeMap;

use super::answer::Refusal;
use super::report::Errors;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};
use crate::prediction::Skin;
use crate::validation::{Statistics, StatisticsError};

/// The skin of level 0 after the true displacement.
pub(super) struct DisplacedSkin<'a> {
    skin: &'a Skin,
    areas: Vec<f64>,
    displacement: &'a [Vector],
    search: SurfaceSearch,
}

/// What is told of an answer.
pub(super) struct Measured {
    pub error: Errors,
    pub closest_point: Errors,
    pub regions: BTreeMap<String, Errors>,
    pub skin_mean_mm: f64,
    /// Share of the moving skin's area that has a scan opposite; none where displacements are compared.
    pub covered_share: Option<f64>,
}

impl<'a> DisplacedSkin<'a> {
    /// Of a skin and its true displacement, as far as there are both.
    pub(super) fn of(
        skin: &'a Result<Skin, Refusal>,
        truth: &'a Result<Vec<Vector>, Refusal>,
    ) -> Result<Self, Refusal> {
        let skin = skin.as_ref().map_err(Refusal::clone)?;
        let displacement = truth.as_ref().map_err(|refusal| {
            Refusal::new("truth-failed", format!("{} ({})", refusal.detail, refusal.code))
        })?;
        let search = SurfaceSearch::new(&moved(&skin.surface, displacement))
            .map_err(|error| Refusal::new("truth-failed", error.to_string()))?;
        Ok(DisplacedSkin { skin, areas: skin.surface.point_areas(), displacement, search })
    }

    /// The errors of another displacement of the same nodes.
    pub(super) fn measure(&self, found: &[Vector]) -> Result<Measured, StatisticsError> {
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
        Ok(Measured {
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

/// A surface after its points have moved.
pub(super) fn moved(surface: &TriangleSurface, displacement: &[Vector]) -> TriangleSurface {
    let mut moved = surface.clone();
    for (point, u) in moved.points.iter_mut().zip(displacement) {
        *point += u;
    }
    moved
}
