//! Scenes that the program makes itself: the octant of a thick sphere, a slab, half a head.

mod half_head;
mod slab;
mod sphere;

pub use half_head::{half_head, half_head_far};
pub use slab::{slab, slab_far, slab_hex, slab_wedge};
pub use sphere::{sphere, sphere_of};

use std::collections::BTreeMap;

use super::variant::{Materials, Strain, StudyScene, Truth};
use crate::material::LinearElastic;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::plan::{PlannedSegment, RigidMovement};
use crate::prediction::{Case, ElementChoice, Plan};

/// What `scene_of` knows.
pub const SCENES: [&str; 6] =
    ["sphere", "slab", "slab_hex", "slab_far", "half_head", "half_head_far"];

/// Cells up to which a truth of hexahedra halves every edge twice.
const HALVED_TWICE: usize = 16_000;

/// A scene by its name.
pub fn scene_of(name: &str) -> Option<StudyScene> {
    match name {
        "sphere" => Some(sphere()),
        "slab" => Some(slab()),
        "slab_hex" => Some(slab_hex()),
        "slab_far" => Some(slab_far()),
        "half_head" => Some(half_head()),
        "half_head_far" => Some(half_head_far()),
        _ => None,
    }
}

/// What is held for true of a case without more knowledge: quadratic tetrahedra on halved edges where the mesh is made
/// of tetrahedra, else mean-dilatation cells on edges halved twice, or once on large meshes.
pub fn default_truth(case: &Case) -> Truth {
    let element = usual_truth_element(case);
    let is_small = case.volume.cells.len() <= HALVED_TWICE;
    let times = if is_small && element != ElementChoice::Quadratic { 2 } else { 1 };
    Truth::Refined { times, element, strain: Strain::Small }
}

/// The most accurate element that serves every cell of a case.
pub fn usual_truth_element(case: &Case) -> ElementChoice {
    let mut cells = case.volume.cells.iter();
    match cells.all(|(shape, _)| shape == CellShape::Tet4) {
        true => ElementChoice::Quadratic,
        false => ElementChoice::MeanDilatation,
    }
}

/// Materials of the scenes: Young's modulus in kPa and Poisson's ratio by region.
fn materials(name: &str, by_region: &[(&str, f64, f64)]) -> Materials {
    let material = |&(region, e, nu): &(&str, f64, f64)| {
        let made = LinearElastic::new(e, nu, 1.0);
        (region.to_owned(), made.expect("the constants of the scenes are within the ranges"))
    };
    let by_region: BTreeMap<_, _> = by_region.iter().map(material).collect();
    Materials { name: name.to_owned(), by_region, ..Materials::default() }
}

/// One segment shifted by a length in mm along a direction, e.g. `patch 4 mm`.
fn shift(segment: &str, length: f64, direction: Vector) -> (String, Plan) {
    let along = direction.normalize() * length;
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), along);
    (format!("{segment} {length} mm"), plan_of(segment, movement))
}

/// One segment turned by an angle in degrees about an axis through a pivot, e.g. `patch 5 deg`.
fn rotated(segment: &str, degrees: f64, axis: Vector, pivot: Vector) -> (String, Plan) {
    let angles = axis * degrees.to_radians();
    let movement = RigidMovement::about_pivot(angles, pivot, Vector::zeros());
    (format!("{segment} {degrees} deg"), plan_of(segment, movement))
}

fn plan_of(segment: &str, movement: RigidMovement) -> Plan {
    let segments = vec![PlannedSegment { name: segment.to_owned(), movement }];
    Plan { segments, ..Plan::default() }
}

/// The nodes for which something holds, ascending.
fn nodes_where(mesh: &VolumeMesh, is_inside: impl Fn(&Vector) -> bool) -> Vec<u32> {
    let nodes = (0_u32..).zip(&mesh.nodes).filter(|(_, x)| is_inside(x));
    nodes.map(|(node, _)| node).collect()
}
