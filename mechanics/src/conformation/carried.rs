//! A template's mesh on a patient: nodes moved, sets and labels kept, directions rotated with the tissue.

use super::deformation::Deformation;
use super::warp::Warp;
use crate::mesh::{Vector, VolumeMesh};

/// The mesh of a template where a deformation takes it. Vectors of cells and nodes are directions of fibres: lines of the
/// tissue, which the deformation's gradient at their place turns, and which keep their length.
pub fn carried(template: &VolumeMesh, deformation: &Deformation) -> VolumeMesh {
    let mut mesh = template.clone();
    mesh.nodes = template.nodes.iter().map(|x| deformation.apply(x)).collect();
    for vectors in mesh.cell_vectors.values_mut() {
        for (cell, vector) in vectors.iter_mut().enumerate() {
            turn(deformation, &template.centroid(cell), vector);
        }
    }
    for vectors in mesh.node_vectors.values_mut() {
        for (vector, place) in vectors.iter_mut().zip(&template.nodes) {
            turn(deformation, place, vector);
        }
    }
    mesh
}

fn turn(deformation: &Deformation, place: &Vector, vector: &mut Vector) {
    *vector = deformation.along(place, vector).unwrap_or(*vector);
}
