//! Boundary conditions of the tissue as penalty springs on points of a volume spline.
//!
//! Bone is not a control point: a held node lies somewhere in a span, and a spline with fewer control points
//! than there are held nodes cannot pass through all of them. Each hold e_k . u(x) = v_k therefore has the
//! energy w/2 (e_k . u(x) - v_k)^2; the system stays positive definite, and sliding holds the normal alone.
//! With w far above the stiffness of the tissue that is the least squares fit to all holds. A spline is smooth,
//! though, and what follows the edge of a bone to the last node has no freedom left beside it: on the slab of
//! docs/verification.md#v29, whose bone moves 8.9 mm, control points 6 mm apart err by 0.9 mm at the skin where they are fitted,
//! and by 0.13 mm where they miss held nodes by 0.1 mm in the mean. The weight is therefore the user's, and what
//! is left at held nodes is told. The springs' forces w (v_k - e_k . u) e_k are the reactions.

use rayon::prelude::*;

use super::lattice::{Lattice, LatticeCoordinates};
use super::stiffness::Assembly;
use crate::boundary::Constraint;
use crate::mesh::{Vector, Warning};
use crate::progress::Unobserved;
use crate::solver::Unknowns;
use crate::solver::half_matrix::HalfMatrix;

/// A hold that the spline misses by more than this many mm is reported.
const TOLD: f64 = 0.01;

/// Holds along the axes of the lattice's frame.
pub struct HeldPoints(Vec<HeldPoint>);

#[derive(Clone)]
struct HeldPoint {
    place: LatticeCoordinates,
    /// Along the frame, with what each is held at in mm.
    directions: Vec<(Vector, f64)>,
    /// w in mN/mm.
    weight: f64,
}

impl HeldPoints {
    /// Holds of a mesh; w is `hold_weight` times the largest stiffness that the tissue gives a control point
    /// around, shared by as many holds as spans with holds have in the mean, so that a finer mesh holds no
    /// harder.
    pub fn new(
        assembly: &Assembly,
        constraints: &[Constraint],
        stiffness: &HalfMatrix<f64, 3>,
        hold_weight: f64,
    ) -> Self {
        let (lattice, mesh) = (assembly.lattice, assembly.tissue.mesh);
        let held = |constraint: &Constraint| {
            let place =
                lattice.place(&lattice.frame.local(&mesh.nodes[constraint.node as usize]))?;
            let direction = |k: usize| {
                let axis = constraint.axes().column(k).into_owned();
                (lattice.frame.axes.transpose() * axis, constraint.values()[k])
            };
            let directions = (0..constraint.count()).map(direction).collect();
            let members = lattice.connectivity.row(place.span).iter();
            let diagonals = members.map(|&control| {
                let block = stiffness.diagonal[assembly.dof_map.row(control)];
                block[0][0].max(block[1][1]).max(block[2][2])
            });
            Some(HeldPoint { place, directions, weight: diagonals.fold(0.0, f64::max) })
        };
        let mut points: Vec<HeldPoint> = constraints.iter().filter_map(held).collect();
        let mut spans: Vec<usize> = points.iter().map(|point| point.place.span).collect();
        spans.sort_unstable();
        spans.dedup();
        let share = spans.len() as f64 / points.len().max(1) as f64;
        points.iter_mut().for_each(|point| point.weight *= share * hold_weight);
        HeldPoints(points)
    }

    /// Those that hold in one or two directions only.
    pub fn sliding(&self) -> HeldPoints {
        HeldPoints(self.0.iter().filter(|point| point.directions.len() < 3).cloned().collect())
    }

    /// The springs' stiffness over control points.
    pub fn stiffness(&self, assembly: &Assembly) -> Option<HalfMatrix<f64, 3>> {
        let mut by_span: Vec<Vec<&HeldPoint>> =
            vec![Vec::new(); assembly.lattice.connectivity.len()];
        self.0.iter().for_each(|point| by_span[point.place.span].push(point));
        let (orders, members) = (assembly.lattice.orders(), assembly.lattice.members());
        assembly.sum_over_spans(&Unobserved, |span| {
            let mut blocks = vec![[[0.0; 3]; 3]; members * members];
            for point in &by_span[span] {
                let across = point
                    .directions
                    .iter()
                    .fold(nalgebra::Matrix3::zeros(), |sum: nalgebra::Matrix3<f64>, (e, _)| {
                        sum + e * e.transpose() * point.weight
                    });
                let values: Vec<f64> = point.place.products(orders).collect();
                for (j, a) in values.iter().enumerate() {
                    for (k, b) in values.iter().enumerate() {
                        let block = &mut blocks[j * members + k];
                        for r in 0..3 {
                            for c in 0..3 {
                                block[r][c] += a * b * across[(r, c)];
                            }
                        }
                    }
                }
            }
            blocks
        })
    }

    /// Adds the springs' pull on the control points, by row.
    pub fn add_forces(&self, assembly: &Assembly, forces: &mut Unknowns) {
        for point in &self.0 {
            let pull = point.directions.iter().fold(Vector::zeros(), |sum, (e, v)| sum + e * *v);
            add_at(assembly, &point.place, &(pull * point.weight), forces);
        }
    }

    /// Remaining error of each constraint, v - e . u, as a vector along the frame.
    pub fn missed(&self, lattice: &Lattice, of_control: &[Vector]) -> Vec<Vector> {
        let missed = |point: &HeldPoint| {
            let u = lattice.displacement(&point.place, of_control);
            point.directions.iter().fold(Vector::zeros(), |sum, (e, v)| sum + e * (v - e.dot(&u)))
        };
        self.0.par_iter().map(missed).collect()
    }

    /// The forces of the holds on the tissue in mN, along the axes of the coordinates.
    pub fn reactions(&self, lattice: &Lattice, missed: &[Vector]) -> Vec<Vector> {
        let reaction =
            |(point, missed): (&HeldPoint, &Vector)| lattice.frame.axes * missed * point.weight;
        self.0.iter().zip(missed).map(reaction).collect()
    }
}

/// Shares a force at a place out to the control points around it.
pub fn add_at(
    assembly: &Assembly,
    place: &LatticeCoordinates,
    force: &Vector,
    forces: &mut Unknowns,
) {
    let members = assembly.lattice.connectivity.row(place.span).iter();
    for (&control, value) in members.zip(place.products(assembly.lattice.orders())) {
        let sum = &mut forces[assembly.dof_map.row(control)];
        (0..3).for_each(|k| sum[k] += force[k] * value);
    }
}

/// How far held nodes are from where they have to be, where that can be seen.
pub fn warning(missed: &[Vector]) -> Option<Warning> {
    let largest = missed.iter().map(|missed| missed.norm()).fold(0.0, f64::max);
    let mean = missed.iter().map(|missed| missed.norm()).sum::<f64>() / missed.len().max(1) as f64;
    let detail = format!(
        "the spline misses what held nodes are held at by {mean:.3} mm in the mean and by {largest:.3} mm at \
         most: control points stand too far apart to follow"
    );
    let warning = Warning::new("held-nodes-missed", detail).with("mean_mm", mean);
    (largest > TOLD).then(|| warning.with("max_mm", largest))
}
