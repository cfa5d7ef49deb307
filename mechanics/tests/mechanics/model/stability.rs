//! Whether rest at finite strain is stable, and how often its search asks whether to stop.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::finite_strain::Elements;
use mechanics::progress::{Phase, Progress, Unobserved};

use super::finite_strain::{RING, constraints, hard_block, neo_hookean, rest_of};

/// A bar of 100 x 10 x 10 mm in tetrahedra that lie alike on both sides of its middle planes.
fn symmetric_bar() -> VolumeMesh {
    let quarter = block(Vector::new(100.0, 5.0, 5.0), [20, 1, 1], CellShape::Tet4);
    let mut mesh = VolumeMesh::default();
    let mut known = BTreeMap::new();
    for (y, z) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        for (shape, nodes) in quarter.cells.iter() {
            let mut own: Vec<u32> = nodes
                .iter()
                .map(|&node| {
                    let at = quarter.nodes[node as usize].component_mul(&Vector::new(1.0, y, z));
                    let key = [at.x, at.y, at.z].map(|value| value.round() as i64);
                    *known.entry(key).or_insert_with(|| {
                        mesh.nodes.push(at);
                        mesh.nodes.len() as u32 - 1
                    })
                })
                .collect();
            if y * z < 0.0 {
                own.swap(0, 1);
            }
            mesh.cells.push(shape, &own);
        }
    }
    mesh
}

/// A straight bar of plain tetrahedra or of pressures, pressed along itself past the force at which it buckles, rests as straight as it
/// is meshed; it is not stable. One that is pressed by less is.
#[test]
fn a_bar_that_is_pressed_and_does_not_buckle_is_told_not_to_be_stable() {
    let mesh = symmetric_bar();
    for elements in [Elements::PLAIN, Elements::STABLE] {
        let told = |by_mm: f64| {
            let ends = constraints(&mesh, |x| match x.x {
                x if x < 1e-9 => Some(Vector::zeros()),
                x if x > 99.9 => Some(Vector::x() * by_mm),
                _ => None,
            });
            let law = neo_hookean(0.3);
            let moved = rest_of(elements, &mesh, law, &ends, &Unobserved).unwrap();
            let aside = moved.displacement.iter().map(|u| u.z.abs()).fold(0.0, f64::max);
            (moved.solver.newton.unwrap().is_stable, aside)
        };
        let (is_stable, aside) = told(-15.0);
        // Straight to rounding, or out of the way.
        assert_eq!(is_stable, Some(aside > 1.0), "{elements:?} {aside}");
        assert_eq!(told(-1.0).0, Some(true), "{elements:?}");
    }
}

/// Asks nothing but how often it was asked whether to stop.
#[derive(Default)]
struct Polls(AtomicUsize);

impl Progress for Polls {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed);
        false
    }
}

/// Beside each iteration it is asked for each thousand nodes of each tangent, and on each level of a hierarchy.
#[test]
fn whether_to_stop_is_asked_while_tangents_and_hierarchies_are_made() {
    let (mesh, held) = hard_block([40, 40, 8], 0.2, RING);
    for elements in [Elements::PLAIN, Elements::STABLE] {
        let polls = Polls::default();
        let moved = rest_of(elements, &mesh, neo_hookean(0.46), &held, &polls).unwrap();
        let newton = moved.solver.newton.unwrap();
        let (asked, steps) = (polls.0.into_inner(), moved.solver.iterations);
        let at_least = newton.inner_iterations
            + steps * mesh.nodes.len().div_ceil(1024)
            + 3 * newton.hierarchies;
        assert!(asked >= at_least, "{elements:?}: {asked} of {at_least}, {steps} steps");
    }
}
