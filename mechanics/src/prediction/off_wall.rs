//! Sliding nodes that leave a curved wall: at small displacement they slide along its tangent.
//!
//! A node that slides by t along a wall of radius r ends t^2 / 2 r off it. What is measured is how far it lies
//! from the plane of the closest wall triangle, so that sliding past the rim of a flat wall counts as nothing.

use super::Scene;
use crate::boundary::{NodeClass, Wall};
use crate::mesh::{SurfaceSearch, Vector, Warning};

/// How far off the wall a node is told to be, in mm: as for small strain.
const OFF_WALL_MM: f64 = 0.5;

/// The cosine from which on a face lies on a wall.
const ALONG_WALL: f64 = 0.7;

/// A warning that counts the sliding nodes that are off their wall.
pub(super) fn left_wall(scene: &Scene, displacement: &[Vector]) -> Option<Warning> {
    let class = |node: &u32| scene.conditions.classes[*node as usize];
    let slides = |node: &u32| class(node) == NodeClass::Sliding;
    let nodes: Vec<u32> = (0..scene.mesh.nodes.len() as u32).filter(slides).collect();
    if nodes.is_empty() {
        return None;
    }
    let mut faces = scene.mesh.boundary_faces();
    // A corner of another side of the tissue may have no free node either: it lies across no wall of its nodes.
    faces.retain(|face| {
        let area = face.area_vector(&scene.mesh.nodes);
        let lies_on_wall = |node: &u32| {
            let mut walls = scene.conditions.walls.get(node).into_iter().flatten();
            walls
                .any(|wall| normal_at_rest(scene, wall).dot(&area).abs() > ALONG_WALL * area.norm())
        };
        let mut of_face = face.nodes().iter();
        of_face.clone().any(lies_on_wall) && of_face.all(|node| class(node) != NodeClass::Free)
    });
    let wall = scene.mesh.surface_of(&faces);
    let search = SurfaceSearch::new(&wall).ok()?;
    let off_wall = |moved: Vector| {
        let triangle = wall.triangles[search.closest(&moved).triangle];
        let [a, b, c] = triangle.map(|point| wall.points[point as usize]);
        let normal = (b - a).cross(&(c - a));
        ((moved - a).dot(&normal) / normal.norm()).abs()
    };
    // A wall that a segment carries is looked at from the segment, where it stands still.
    let distance = |node: &u32| {
        let moved = scene.mesh.nodes[*node as usize] + displacement[*node as usize];
        let walls = scene.conditions.walls.get(node).into_iter().flatten();
        let seen_from = |carrier: Option<u32>| match carrier {
            Some(segment) => scene.segments[segment as usize].movement.inverse().apply(&moved),
            None => moved,
        };
        walls.map(|wall| off_wall(seen_from(wall.carrier))).fold(f64::INFINITY, f64::min)
    };
    let distances: Vec<f64> = nodes.iter().map(distance).collect();
    let off = distances.iter().filter(|distance| **distance > OFF_WALL_MM).count();
    let largest = distances.iter().copied().fold(0.0, f64::max);
    let detail = format!(
        "{off} sliding nodes leave their wall, by {largest:.1} mm at most: it is curved, or not across the direction stated for it, and \
         they slide straight on"
    );
    let warning = Warning::new("sliding-off-wall", detail).with("nodes", off as f64);
    (off > 0).then(|| warning.with("largest_mm", largest))
}

/// The normal of a wall before its segment moves.
fn normal_at_rest(scene: &Scene, wall: &Wall) -> Vector {
    let turns = !scene.settings.method.properties().is_small_strain;
    match wall.carrier.filter(|_| turns) {
        Some(segment) => {
            scene.segments[segment as usize].movement.rotation().transpose() * wall.normal
        }
        None => wall.normal,
    }
}
