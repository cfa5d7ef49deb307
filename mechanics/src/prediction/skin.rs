//! Skin: the surface whose displacement is predicted.

use std::collections::BTreeMap;

use crate::boundary::NodeClass;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, VolumeMesh, Warning};

/// Skin moves where it goes by more than this part of what moves farthest.
const MOVING: f64 = 0.1;

/// The length from which on skin moves, of the lengths of all its displacements.
pub fn least_moving(lengths: impl Iterator<Item = f64>) -> f64 {
    MOVING * lengths.fold(0.0, f64::max)
}

/// Skin as triangles, and its named parts.
#[derive(Clone, Debug)]
pub struct Skin {
    /// With `node_ids`.
    pub surface: TriangleSurface,
    /// Named parts as ascending points of `surface`.
    pub regions: BTreeMap<String, Vec<u32>>,
    /// How many nodes of the selection of such a part are not on the skin, where there are any.
    pub off: BTreeMap<String, usize>,
}

impl Skin {
    /// The nodes of the volume mesh, ascending, one for each point of the surface.
    pub fn nodes(&self) -> &[u32] {
        self.surface.node_ids.as_deref().unwrap_or_default()
    }

    /// The lengths of vectors of nodes, one for each point of the surface.
    pub fn lengths(&self, of_nodes: &[Vector]) -> Vec<f64> {
        self.nodes().iter().map(|&node| of_nodes[node as usize].norm()).collect()
    }

    /// All points of the surface.
    pub fn points(&self) -> Vec<u32> {
        (0..self.nodes().len() as u32).collect()
    }

    /// The points that move by more than a tenth of what moves farthest; all where nothing moves. What the scalp and the neck
    /// are not off by says nothing of a face.
    pub fn moving_points(&self, displacement: &[Vector]) -> Vec<u32> {
        let lengths = self.lengths(displacement);
        let least = least_moving(lengths.iter().copied());
        let points = (0_u32..).zip(&lengths).filter(|(_, length)| **length >= least);
        points.map(|(point, _)| point).collect()
    }

    /// The mean length of vectors of nodes over some points of the surface; zero over none.
    pub fn mean_length(&self, points: &[u32], of_nodes: &[Vector]) -> f64 {
        let nodes = self.nodes();
        let length = |&point: &u32| of_nodes[nodes[point as usize] as usize].norm();
        points.iter().map(length).sum::<f64>() / points.len().max(1) as f64
    }

    /// The skin after its nodes have moved.
    pub fn moved(&self, displacement: &[Vector]) -> TriangleSurface {
        let mut moved = self.surface.clone();
        for (point, &node) in moved.points.iter_mut().zip(self.nodes()) {
            *point += displacement[node as usize];
        }
        moved
    }
}

/// All boundary faces without a joined, fixed or sliding node; where none is left, the whole boundary.
pub(super) fn default_faces(
    boundary: &[BoundaryFace],
    classes: &[NodeClass],
    warnings: &mut Vec<Warning>,
) -> Vec<BoundaryFace> {
    let is_bare =
        |node: &u32| matches!(classes[*node as usize], NodeClass::Free | NodeClass::Prescribed);
    let bare: Vec<BoundaryFace> =
        boundary.iter().filter(|face| face.nodes().iter().all(is_bare)).copied().collect();
    if !bare.is_empty() {
        return bare;
    }
    let detail = "every boundary face touches a joined, fixed or sliding node: the whole boundary is taken as skin";
    warnings.push(Warning::new("no-free-skin", detail));
    boundary.to_vec()
}

/// The displacement of each landmark: that of the boundary point closest to it, and how far that is.
pub(super) fn landmark_displacement(
    mesh: &VolumeMesh,
    landmarks: &BTreeMap<String, Vector>,
    displacement: &[Vector],
) -> BTreeMap<String, (Vector, f64)> {
    if landmarks.is_empty() {
        return BTreeMap::new();
    }
    let surface = mesh.surface_of(&mesh.boundary_faces());
    let nodes = surface.node_ids.clone().unwrap_or_default();
    let Ok(search) = SurfaceSearch::new(&surface) else {
        return BTreeMap::new();
    };
    let moved = |landmark: &Vector| {
        let closest = search.closest(landmark);
        let corners = surface.triangles[closest.triangle];
        let sum = corners
            .iter()
            .zip(closest.barycentric)
            .fold(Vector::zeros(), |sum, (&corner, weight)| {
                sum + displacement[nodes[corner as usize] as usize] * weight
            });
        (sum, closest.distance)
    };
    landmarks.iter().map(|(name, landmark)| (name.clone(), moved(landmark))).collect()
}
