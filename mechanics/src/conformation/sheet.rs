//! Sheets of the template: the nodes and faces of its skin, or of what lies on bone.

use std::collections::HashSet;

use super::affine::Affine;
use crate::mesh::surface_edges::edges;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{TriangleSurface, Vector, VolumeMesh};

/// A part of the boundary of a template, as a surface whose points are nodes of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sheet {
    pub surface: TriangleSurface,
    /// For each point whether it lies on the border of the sheet.
    pub is_rim: Vec<bool>,
}

impl Sheet {
    /// The boundary faces all of whose nodes are named.
    pub fn of(mesh: &VolumeMesh, boundary: &[BoundaryFace], nodes: &[u32]) -> Sheet {
        let named: HashSet<u32> = nodes.iter().copied().collect();
        let faces: Vec<BoundaryFace> = boundary
            .iter()
            .filter(|face| face.nodes().iter().all(|node| named.contains(node)))
            .copied()
            .collect();
        let surface = mesh.surface_of(&faces);
        let is_rim = rim(&surface);
        Sheet { surface, is_rim }
    }

    pub fn is_empty(&self) -> bool {
        self.surface.triangles.is_empty()
    }

    /// Its surface with the points elsewhere.
    pub fn moved(&self, map: impl Fn(&Vector) -> Vector + Sync) -> TriangleSurface {
        let points = self.surface.points.iter().map(map).collect();
        TriangleSurface { points, ..self.surface.clone() }
    }

    /// The same sheet at another place of rest.
    pub fn placed(&self, affine: &Affine) -> Sheet {
        Sheet { surface: self.moved(|x| affine.apply(x)), is_rim: self.is_rim.clone() }
    }
}

fn rim(surface: &TriangleSurface) -> Vec<bool> {
    let mut is_rim = vec![false; surface.points.len()];
    for edge in edges(&surface.sorted_sides()).filter(|edge| edge.len() == 1) {
        edge[0].points.iter().for_each(|&point| is_rim[point as usize] = true);
    }
    is_rim
}
