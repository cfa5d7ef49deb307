//! A template's mesh on a patient: nodes moved, sets and labels kept, directions turned with the tissue.

use super::deformation::Deformation;
use crate::mesh::{Vector, VolumeMesh};

/// The mesh of a template where a deformation takes it. Vectors of cells and nodes, such as the directions of fibres,
/// are turned by the rotation of the deformation's gradient at their place and keep their length.
pub fn carried(template: &VolumeMesh, deformation: &Deformation) -> VolumeMesh {
    let mut mesh = template.clone();
    mesh.nodes = template.nodes.iter().map(|x| deformation.apply(x)).collect();
    for vectors in mesh.cell_vectors.values_mut() {
        for (cell, vector) in vectors.iter_mut().enumerate() {
            let corners = template.corners(cell);
            let count = corners.len() as f64;
            *vector = turned(deformation, &(corners.sum::<Vector>() / count), vector);
        }
    }
    for vectors in mesh.node_vectors.values_mut() {
        for (vector, place) in vectors.iter_mut().zip(&template.nodes) {
            *vector = turned(deformation, place, vector);
        }
    }
    mesh
}

fn turned(deformation: &Deformation, place: &Vector, vector: &Vector) -> Vector {
    if *vector == Vector::zeros() { *vector } else { deformation.turned(place, vector) }
}
