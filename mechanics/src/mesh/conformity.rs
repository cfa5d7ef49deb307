//! Cells that do not match face to face: hanging nodes, and a face of a hexahedron on two of tetrahedra.
//!
//! Such faces belong to one cell each, and count as the boundary of the mesh although there is tissue on both sides. They lie on each
//! other, look at each other, and have nodes in common; the nodes of faces of a slit are each at the place of one of the other side.

use rayon::prelude::*;

use super::Vector;
use super::closest_point::SurfaceSearch;
use super::volume::{BoundaryFace, VolumeMesh};
use super::warning::Warning;
use crate::rows::Rows;

/// Faces nearer to each other than this part of the size of the mesh lie on each other.
const TOUCHING: f64 = 1e-7;

/// Cosine below which normals of faces look at each other.
const OPPOSED: f64 = -0.999;

/// A warning that counts the triangles of the boundary that lie on others of which they share nodes.
pub fn cells_do_not_match(mesh: &VolumeMesh, boundary: &[BoundaryFace]) -> Option<Warning> {
    let suspects = opposed_to_neighbours(mesh, boundary);
    if suspects.is_empty() {
        return None;
    }
    let surface = mesh.surface_of(boundary);
    let search = SurfaceSearch::new(&surface).ok()?;
    let faces: Vec<&BoundaryFace> = boundary.iter().flat_map(triangles_of).collect();
    let (low, high) = surface.bounds();
    let near = TOUCHING * (high - low).norm();
    let lies_on_another = |&triangle: &usize| {
        let normal = surface.area_vector(triangle).normalize();
        let from = surface.middle(triangle) - normal * near;
        let hit = search.first_hit(&from, &normal, triangle, 2.0 * near);
        hit.is_some_and(|(other, _)| {
            let opposite = surface.area_vector(other);
            opposite.dot(&normal) < OPPOSED * opposite.norm()
                && do_not_match(mesh, [faces[triangle], faces[other]], near)
        })
    };
    let found: Vec<usize> = suspects.into_par_iter().filter(lies_on_another).collect();
    let at = surface.middle(*found.first()?);
    let count = found.len();
    let detail = format!(
        "{count} triangles of the boundary lie on others that look at them and share nodes with them, the first around ({:.1}, {:.1}, {:.1}): \
         cells there do not match face to face (hanging nodes, or a face of a hexahedron on two of tetrahedra), tissue comes apart between \
         them and their faces count as skin or bone; mesh it so that cells share whole faces, with pyramids replaced by tetrahedra",
        at.x, at.y, at.z
    );
    Some(Warning::new("cells-do-not-match", detail).with("count", count as f64))
}

/// The triangles of the boundary, in the order of `surface_of`, that look at a triangle of another face at one of the nodes of their
/// own: in most meshes there are none, and nothing has to be searched.
fn opposed_to_neighbours(mesh: &VolumeMesh, boundary: &[BoundaryFace]) -> Vec<usize> {
    let (mut nodes, mut normals) = (Rows::default(), Rows::default());
    for face in boundary {
        nodes.push(face.nodes().iter().copied());
        normals.push(face.triangles(&mesh.nodes).map(|triangle| {
            let [a, b, c] = triangle.map(|node| mesh.nodes[node as usize]);
            let area_vector = (b - a).cross(&(c - a));
            area_vector.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()
        }));
    }
    let around = nodes.inverted(mesh.nodes.len());
    let opposed = |face: usize, normal: &Vector| {
        let others = nodes.row(face).iter().flat_map(|&node| around.row(node as usize));
        others.filter(|other| **other as usize != face).any(|&other| {
            normals.row(other as usize).iter().any(|own: &Vector| own.dot(normal) < OPPOSED)
        })
    };
    let of_face = |face: usize| {
        let (opposed, normals) = (&opposed, &normals);
        normals.range(face).filter(move |at| opposed(face, &normals.entries()[*at]))
    };
    (0..boundary.len()).into_par_iter().with_min_len(256).flat_map_iter(of_face).collect()
}

/// A face once for each triangle of it, in the order of `surface_of`.
fn triangles_of(face: &BoundaryFace) -> impl Iterator<Item = &BoundaryFace> {
    std::iter::repeat_n(face, face.nodes().len() - 2)
}

/// Whether two faces that lie on each other share nodes without each node of one having its place among those of the other.
fn do_not_match(mesh: &VolumeMesh, [one, other]: [&BoundaryFace; 2], near: f64) -> bool {
    let (one, other) = (one.nodes(), other.nodes());
    let place = |node: u32| mesh.nodes[node as usize];
    let has_twin = |node: &u32| other.iter().any(|own| (place(*own) - place(*node)).norm() <= near);
    let is_twin = one.len() == other.len() && one.iter().all(has_twin);
    !is_twin && one.iter().any(|node| other.contains(node))
}
