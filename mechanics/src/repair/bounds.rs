//! Bounds of the moves of nodes in a repair.

use std::collections::HashMap;

use crate::mesh::{Vector, VolumeMesh};

/// How far nodes may go.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Of every node, in mm.
    pub farthest: Vec<f64>,
    /// Unit normals of nodes that move along their surface only.
    pub normals: Vec<Option<Vector>>,
}

impl Bounds {
    /// `outer` mm for nodes on the boundary, `inner` mm for others, in every direction.
    pub fn of(mesh: &VolumeMesh, outer: f64, inner: f64) -> Bounds {
        let mut farthest = vec![inner; mesh.nodes.len()];
        for face in mesh.boundary_faces() {
            face.nodes().iter().for_each(|&node| farthest[node as usize] = outer);
        }
        Bounds { farthest, normals: vec![None; mesh.nodes.len()] }
    }

    /// The same with the nodes of some surfaces kept on their tangent planes, and at their places where their triangles cancel.
    pub fn along(mut self, mesh: &VolumeMesh, kept: &[&[u32]]) -> Bounds {
        let surface = mesh.surface_of(&mesh.boundary_faces());
        let normals = surface.point_normals();
        let nodes = surface.node_ids.iter().flatten();
        let normal_of: HashMap<u32, Vector> = nodes.copied().zip(normals).collect();
        for node in kept.iter().flat_map(|nodes| nodes.iter()) {
            let Some(normal) = normal_of.get(node) else { continue };
            match normal.norm() > 0.5 {
                true => self.normals[*node as usize] = Some(*normal),
                false => self.farthest[*node as usize] = 0.0,
            }
        }
        self
    }
}
