//! Cells that do not match face to face: hanging nodes, and a face of a hexahedron on two of tetrahedra.
//!
//! Such faces belong to one cell each, and count as the boundary of the mesh although there is tissue on both sides. They lie on each
//! other, look at each other, and have nodes in common; those of a slit have nodes of their own, each at the place of one of the other
//! side.

use rayon::prelude::*;

use super::closest_point::SurfaceSearch;
use super::surface::TriangleSurface;
use super::volume::{BoundaryFace, VolumeMesh};
use super::warning::Warning;

/// Faces nearer to each other than this part of the size of the mesh lie on each other.
const TOUCHING: f64 = 1e-7;

/// Cosine below which normals of faces look at each other.
const OPPOSED: f64 = -0.999;

/// A warning that counts the triangles of the boundary that lie on others of which they share nodes.
pub fn cells_do_not_match(mesh: &VolumeMesh, boundary: &[BoundaryFace]) -> Option<Warning> {
    let surface = mesh.surface_of(boundary);
    let search = SurfaceSearch::new(&surface).ok()?;
    let (low, high) = surface.bounds();
    let near = TOUCHING * (high - low).norm();
    let lies_on_another = |&triangle: &usize| {
        let Some(normal) = surface.area_vector(triangle).try_normalize(f64::MIN_POSITIVE) else {
            return false;
        };
        let from = surface.middle(triangle) - normal * near;
        let hit = search.first_hit(&from, &normal, triangle, 2.0 * near);
        hit.is_some_and(|(other, _)| {
            let opposite = surface.area_vector(other);
            opposite.dot(&normal) < OPPOSED * opposite.norm()
                && do_not_match(&surface, triangle, other, near)
        })
    };
    let triangles = (0..surface.triangles.len()).into_par_iter().with_min_len(256);
    let found: Vec<usize> = triangles.filter(lies_on_another).collect();
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

/// Whether two triangles that lie on each other share nodes without each node having its own or its twin's place in the other.
fn do_not_match(surface: &TriangleSurface, one: usize, other: usize, near: f64) -> bool {
    let [one, other] = [one, other].map(|triangle| surface.triangles[triangle]);
    let shared = one.iter().filter(|point| other.contains(point)).count();
    let place = |point: u32| surface.points[point as usize];
    let has_twin =
        |point: &&u32| other.iter().any(|own| (place(*own) - place(**point)).norm() <= near);
    let twins = one.iter().filter(has_twin).count();
    shared == 3 || (shared > 0 && twins < 3)
}
