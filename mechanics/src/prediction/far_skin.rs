//! Skin that moves farther than anything that moves it: springs that give way, or tissue that is pressed out sideways.

use super::Scene;
use crate::mesh::{Vector, Warning};

/// How many times as far as what moves it skin may move; nearly incompressible tissue bulges beside what presses on it.
const FARTHER: f64 = 1.25;
/// And by how much, in mm.
const FARTHER_MM: f64 = 0.5;

/// A warning where skin moves beyond all constrained nodes and beyond where any segment would carry it, which is far from a pivot, in a
/// scene in which nothing else acts.
pub(super) fn outrun(scene: &Scene, displacement: &[Vector]) -> Option<Warning> {
    let acts = scene.forces.iter().any(|force| *force != Vector::zeros());
    if acts || !scene.distributed.inner.is_zero() {
        return None;
    }
    let length = |node: u32| displacement[node as usize].norm();
    let constraints = scene.conditions.constraints.iter();
    let moving = constraints.map(|constraint| length(constraint.node)).fold(0.0, f64::max);
    let carried = |node: u32| {
        let at = &scene.mesh.nodes[node as usize];
        let by = scene.segments.iter().map(|segment| segment.movement.displacement(at).norm());
        by.fold(moving, f64::max)
    };
    let outruns = |&(_, skin, moving): &(u32, f64, f64)| {
        skin > FARTHER * moving && skin - moving > FARTHER_MM
    };
    let of_skin = scene.skin.nodes().iter().map(|&node| (node, length(node), carried(node)));
    let (node, skin, moving) = of_skin.filter(outruns).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let [x, y, z] = scene.mesh.nodes[node as usize].into();
    let detail = format!(
        "skin at ({x:.1}, {y:.1}, {z:.1}) mm moves by {skin:.1} mm, and nothing that moves it by more than {moving:.1} mm: tissue gives way there"
    );
    let warning = Warning::new("skin-outruns-plan", detail).with("node", f64::from(node));
    Some(warning.with("skin_mm", skin).with("moving_mm", moving))
}
