//! Accepted errors of an adaptive mesh: over the skin that moves, over parts of it, and at landmarks on it.

use std::collections::BTreeMap;

use super::LANDMARK_FAR;
use super::adequate::error_over_estimate;
use super::scene::Scene;
use super::skin::Skin;
use crate::mesh::{SurfaceSearch, Vector};

/// Accepted error, and bounds of the refinement.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinementGoal {
    /// The mean error over the skin nodes of the case that move (`moving_points`), in mm.
    pub skin_mm: f64,
    /// The same for named parts of the skin.
    pub regions_mm: BTreeMap<String, f64>,
    /// The error at landmarks of the case, within [`LANDMARK_FAR`] of its skin.
    pub landmarks_mm: BTreeMap<String, f64>,
    /// Whether these are errors of the answer, of mesh and linearity together, as `auto` accepts them, and not of the mesh alone.
    pub is_of_answer: bool,
    /// The most cells of a mesh.
    pub cells: usize,
    /// For all meshes together, in s.
    pub time_s: f64,
}

/// A limit of something that is not there.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LimitError {
    #[error("{0:?} is no part of the skin")]
    UnknownRegion(String),
    #[error("the case has no landmark {0:?}")]
    UnknownLandmark(String),
    #[error(
        "the landmark {name:?} lies {distance:.1} mm from the skin, and errors are limited at landmarks on it"
    )]
    FarLandmark { name: String, distance: f64 },
}

/// Where an error is limited.
pub(super) enum SkinPart<'a> {
    /// Points of the skin of the case that move.
    Moving(Vec<u32>),
    /// A named part of the skin, its points.
    Region(&'a str, Vec<u32>),
    /// A landmark, in mm.
    Landmark(&'a str, Vector),
}

pub(super) struct Limit<'a> {
    pub part: SkinPart<'a>,
    pub accepted_mm: f64,
}

impl RefinementGoal {
    /// The one over all skin that moves comes first.
    pub(super) fn limits<'a>(&'a self, scene: &Scene) -> Result<Vec<Limit<'a>>, LimitError> {
        let part = SkinPart::Moving(scene.skin.points());
        let mut limits = vec![Limit { part, accepted_mm: self.skin_mm }];
        for (name, &accepted_mm) in &self.regions_mm {
            let points = scene.skin.regions.get(name);
            let points = points.ok_or_else(|| LimitError::UnknownRegion(name.clone()))?;
            limits.push(Limit { part: SkinPart::Region(name, points.clone()), accepted_mm });
        }
        for (name, &accepted_mm) in &self.landmarks_mm {
            let distance = scene.distance_to_skin(name);
            let unknown = || LimitError::UnknownLandmark(name.clone());
            let distance = distance.ok_or_else(unknown)?;
            if distance > LANDMARK_FAR {
                return Err(LimitError::FarLandmark { name: name.clone(), distance });
            }
            limits
                .push(Limit { part: SkinPart::Landmark(name, scene.landmarks[name]), accepted_mm });
        }
        Ok(limits)
    }
}

impl SkinPart<'_> {
    /// Where it is, in a sentence.
    pub fn words(&self) -> String {
        match self {
            SkinPart::Moving(_) => "in the mean over the skin that moves".to_owned(),
            SkinPart::Region(name, _) => format!("in the mean over {name:?}"),
            SkinPart::Landmark(name, _) => format!("at the landmark {name:?}"),
        }
    }
}

impl Limit<'_> {
    /// The error in mm that is expected of the mesh, from what its nodes lack.
    pub fn expected_of_mesh(&self, scenes: [&Scene; 2], missing: &[Vector]) -> f64 {
        error_over_estimate(scenes[0]) * self.error(scenes, missing)
    }

    /// The estimated error in mm, from what nodes of a mesh lack; the first scene is that of the case.
    pub fn error(&self, [first, finest]: [&Scene; 2], missing: &[Vector]) -> f64 {
        match &self.part {
            SkinPart::Moving(points) | SkinPart::Region(_, points) => {
                first.skin.mean_length(points, missing)
            }
            SkinPart::Landmark(_, at) => {
                let corners = corners(&finest.skin, at).into_iter().flatten();
                corners.map(|(node, weight)| missing[node as usize] * weight).sum::<Vector>().norm()
            }
        }
    }

    /// For skin nodes of a mesh what a displacement counts for, per mm² around them: the error made linear, over what is accepted.
    pub fn weights(
        &self,
        scene: &Scene,
        displacement: &[Vector],
        missing: &[Vector],
    ) -> Vec<(u32, Vector)> {
        let (nodes, areas) = (scene.skin.nodes(), scene.skin.surface.point_areas());
        let points = match &self.part {
            SkinPart::Moving(_) => scene.skin.moving_points(displacement),
            SkinPart::Region(name, _) => scene.skin.regions.get(*name).cloned().unwrap_or_default(),
            SkinPart::Landmark(_, at) => return self.at_landmark(scene, at, missing),
        };
        let area: f64 = points.iter().map(|&point| areas[point as usize]).sum();
        let weight = |&point: &u32| {
            let node = nodes[point as usize];
            let along = missing[node as usize].try_normalize(0.0).unwrap_or_default();
            (node, along / (self.accepted_mm * area))
        };
        points.iter().map(weight).collect()
    }

    fn at_landmark(&self, scene: &Scene, at: &Vector, missing: &[Vector]) -> Vec<(u32, Vector)> {
        let areas = scene.skin.surface.point_areas();
        let of_nodes: BTreeMap<u32, f64> = scene.skin.nodes().iter().copied().zip(areas).collect();
        let Some(corners) = corners(&scene.skin, at) else { return Vec::new() };
        let lacks: Vector =
            corners.iter().map(|&(node, weight)| missing[node as usize] * weight).sum();
        let along = lacks.try_normalize(0.0).unwrap_or_default() / self.accepted_mm;
        corners.map(|(node, weight)| (node, along * (weight / of_nodes[&node]))).to_vec()
    }
}

/// The corners of the skin's triangle around the closest point of it, with their parts of that point.
fn corners(skin: &Skin, at: &Vector) -> Option<[(u32, f64); 3]> {
    let closest = SurfaceSearch::new(&skin.surface).ok()?.closest(at);
    let points = skin.surface.triangles[closest.triangle];
    let corner = |i: usize| (skin.nodes()[points[i] as usize], closest.barycentric[i]);
    Some([0, 1, 2].map(corner))
}

impl Scene {
    /// Of a landmark, in mm, infinite where there is no skin; nothing where there is no such landmark.
    pub fn distance_to_skin(&self, landmark: &str) -> Option<f64> {
        let at = self.landmarks.get(landmark)?;
        let search = SurfaceSearch::new(&self.skin.surface);
        Some(search.map_or(f64::INFINITY, |search| search.closest(at).distance))
    }
}
