//! Dihedral angles of single tetrahedra.

use crate::mesh::Vector;

/// The edges of a tetrahedron, and for each the faces that meet there, by the corner that they lack.
const EDGES: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];

/// Six times the signed volume.
pub(super) fn determinant(corners: &[Vector; 4]) -> f64 {
    let [a, b, c, d] = corners;
    (b - a).cross(&(c - a)).dot(&(d - a))
}

/// The smallest sine of the six dihedral angles, with the sign of the volume: 1 is never reached, 0.5 means that all angles
/// lie between 30 and 150 degrees.
pub(super) fn worst_sine(corners: &[Vector; 4]) -> f64 {
    let [a, b, c, d] = corners;
    let normals = [
        (c - b).cross(&(d - b)),
        (c - a).cross(&(d - a)),
        (b - a).cross(&(d - a)),
        (b - a).cross(&(c - a)),
    ];
    let determinant = normals[3].dot(&(d - a));
    // |n x m| = |edge| 6 V for the normals of two faces with twice their areas as lengths.
    let inverse = normals.map(|normal| 1.0 / normal.norm_squared());
    let ratio = EDGES.map(|[from, to, one, other]| {
        (corners[to] - corners[from]).norm_squared() * inverse[one] * inverse[other]
    });
    let smallest = ratio.into_iter().fold(f64::INFINITY, f64::min);
    // A face without area has no normal; the sine is 0 then.
    if smallest.is_finite() { determinant * smallest.sqrt() } else { 0.0 }
}

/// The cosines of the six dihedral angles.
pub(super) fn dihedral_cosines(corners: &[Vector; 4]) -> [f64; 6] {
    let [a, b, c, d] = corners;
    // Outwards, by the corner that the face lacks.
    let normals = [
        (c - b).cross(&(d - b)),
        (d - a).cross(&(c - a)),
        (b - a).cross(&(d - a)),
        (c - a).cross(&(b - a)),
    ];
    let units = normals.map(|normal| normal / normal.norm());
    EDGES.map(|[_, _, one, other]| -units[one].dot(&units[other]))
}
