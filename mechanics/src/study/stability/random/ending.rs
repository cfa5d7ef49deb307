//! Outcome of a random scene, and the conditions that an answer has to meet.

use std::panic::{AssertUnwindSafe, catch_unwind};

use nalgebra::Matrix3;

use crate::boundary::Constraint;
use crate::material::hyperelastic::point::{FibreAtPoint, Point};
use crate::material::hyperelastic::{Hyperelastic, Law, SaintVenantKirchhoff};
use crate::mesh::Vector;
use crate::model::fem::strain::gradient_at_centre;
use crate::prediction::{
    ElementChoice, Laws, MethodKind, ModelError, Prediction, Scene, SolverError, Unknowns, predict,
};
use crate::progress::Unobserved;
use crate::study::deadline::Deadline;
use crate::study::stability::{Bounds, Probe};

/// How far a held node may be from where it is held, relative to what it moves by, and in mm.
const HELD: f64 = 1e-6;

/// The relative residual that is found by other means than those of the solver.
const AT_REST: f64 = 1e-4;

/// What rounding leaves of forces, relative to the moduli.
const ROUNDING: f64 = 1e-12;

/// How a scene ended.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ending {
    /// An answer that is what it has to be.
    Answered,
    /// The same with warnings that cells are inside out, or that small strain is left behind.
    Warned,
    /// Refused before anything is solved, by this code.
    Refused(String),
    /// Ended with this code.
    Failed(String),
    /// An answer that is wrong without a word, or a panic: must not appear.
    Wrong(String),
}

/// Warnings that say how far an answer may be trusted.
const DOUBTS: [&str; 4] = ["cells-inverted", "large-rotation", "large-strain", "locking"];

pub(super) fn ending(probe: &Probe, bounds: &Bounds) -> Ending {
    let solved = catch_unwind(AssertUnwindSafe(|| solve(probe, bounds)));
    solved.unwrap_or_else(|_| Ending::Wrong("panicked".to_owned()))
}

fn solve(probe: &Probe, bounds: &Bounds) -> Ending {
    let scene = match Scene::new(&probe.case, &probe.plan, &probe.settings) {
        Ok(scene) => scene,
        Err(errors) => {
            let code = errors.0.first().map_or("refused", |error| error.code.name());
            return Ending::Refused(code.to_owned());
        }
    };
    let deadline = Deadline::after(bounds.seconds, bounds.stopwatch, &Unobserved);
    match predict(&scene, &deadline) {
        Err(ModelError::Solver(SolverError::Stopped)) => {
            Ending::Failed("budget-exceeded".to_owned())
        }
        Err(error) => Ending::Failed(error.code().to_owned()),
        Ok(prediction) => match mistake(&scene, &prediction) {
            Some(mistake) => Ending::Wrong(mistake),
            None if is_doubted(&prediction) => Ending::Warned,
            None => Ending::Answered,
        },
    }
}

fn is_doubted(prediction: &Prediction) -> bool {
    prediction.warnings.iter().any(|warning| DOUBTS.contains(&warning.code))
}

/// What is wrong with an answer and said by no warning.
fn mistake(scene: &Scene, prediction: &Prediction) -> Option<String> {
    let numbers = prediction.displacement.iter().chain(prediction.reactions.values());
    if numbers.flatten().any(|number| !number.is_finite()) {
        return Some("displacements or reactions are no numbers".to_owned());
    }
    let least = prediction.deformation.iter().map(|cell| cell.det_f).fold(f64::INFINITY, f64::min);
    let is_told = prediction.warnings.iter().any(|warning| warning.code == "cells-inverted");
    if least.is_nan() || (least <= 0.0 && (!is_told || never_inverts(scene))) {
        return Some(format!("the least det F is {least}"));
    }
    let knows_constraints = match scene.settings.method.properties().unknowns {
        Unknowns::Elements | Unknowns::Springs => true,
        // A spline misses what it is held at, and says so; a warp has no equations.
        Unknowns::ControlPoints | Unknowns::None => false,
    };
    let missed = if knows_constraints { missed(scene, &prediction.displacement) } else { 0.0 };
    if missed > HELD {
        return Some(format!("a held node is {missed} mm from where it is held"));
    }
    if prediction.warnings.iter().any(|warning| warning.code == "pressure-unsettled") {
        return None;
    }
    let residual = out_of_balance(scene, prediction).unwrap_or(0.0);
    (residual > AT_REST).then(|| format!("the relative residual is {residual}"))
}

/// Whether a method keeps every cell as it is turned: det F stays positive at the points where it is integrated, and tetrahedra
/// with edge nodes may fold beside theirs.
fn never_inverts(scene: &Scene) -> bool {
    let settings = &scene.settings;
    settings.method.kind() == MethodKind::FemNonlinear
        && settings.element != ElementChoice::Quadratic
}

/// The farthest that a held node is from where it is held, in mm or relative to its movement.
fn missed(scene: &Scene, u: &[Vector]) -> f64 {
    let missed = |constraint: &Constraint| {
        let own = constraint.axes().transpose() * u[constraint.node as usize];
        let along = (0..constraint.count()).map(|k| (own[k] - constraint.values()[k]).abs());
        along.fold(0.0, f64::max) / constraint.values().norm().max(1.0)
    };
    scene.conditions.constraints.iter().map(missed).fold(0.0, f64::max)
}

/// |f_free| / |f_held| of plain tetrahedra at finite strain, from F of each cell alone; none of anything else.
fn out_of_balance(scene: &Scene, prediction: &Prediction) -> Option<f64> {
    let followed =
        |material: &crate::material::LinearElastic| match scene.settings.method.properties().laws {
            Laws::AtRest => None,
            Laws::SaintVenantKirchhoff => {
                let (lambda, mu) = (material.lambda(), material.shear_modulus());
                let law = Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu });
                Some(Hyperelastic { law, fibres: None })
            }
            Laws::Any => Some(material.hyperelastic()),
        };
    if prediction.elements != ["tet4 plain"] {
        return None;
    }
    let tissues: Vec<Hyperelastic> = scene.materials.iter().map(followed).collect::<Option<_>>()?;
    let (mut left, rounding) = internal_forces(scene, &tissues, &prediction.displacement)?;
    let acting = scene.acting_in(&prediction.displacement);
    left.iter_mut().zip(&acting).for_each(|(left, acting)| *left -= acting);
    let mut exerted: f64 = acting.iter().map(Vector::norm_squared).sum();
    for constraint in &scene.conditions.constraints {
        let force = &mut left[constraint.node as usize];
        let own = constraint.axes().transpose() * *force;
        let held = Vector::from_fn(|k, _| if k < constraint.count() { own[k] } else { 0.0 });
        *force -= constraint.axes() * held;
        exerted += held.norm_squared();
    }
    let left = left.iter().map(Vector::norm_squared).sum::<f64>().sqrt();
    Some(if left <= rounding { 0.0 } else { left / exerted.sqrt() })
}

/// By node in mN, and the norm of what rounding leaves of them.
fn internal_forces(
    scene: &Scene,
    tissues: &[Hyperelastic],
    u: &[Vector],
) -> Option<(Vec<Vector>, f64)> {
    let mut forces = vec![Vector::zeros(); u.len()];
    let mut rounding = 0.0;
    for (cell, (_, nodes)) in scene.mesh.cells.iter().enumerate() {
        let tissue = &tissues[usize::from(scene.material_of_cell[cell])];
        let direction = scene.fibres.get(cell).copied().unwrap_or_default();
        let fibres = tissue.fibres.as_ref().map(|law| FibreAtPoint { law, direction });
        let x: Vec<Vector> = scene.mesh.corners(cell).collect();
        let edges = Matrix3::from_columns(&[x[1] - x[0], x[2] - x[0], x[3] - x[0]]);
        let gradients = edges.try_inverse()?;
        let f = Matrix3::identity() + gradient_at_centre(&scene.mesh, u, cell);
        let volume = edges.determinant() / 6.0;
        let stress = Point::new(&tissue.law, fibres, f).stress() * volume;
        let (lambda, mu) = tissue.law.at_rest();
        for (k, row) in gradients.row_iter().enumerate() {
            let force = stress * row.transpose();
            forces[nodes[k + 1] as usize] += force;
            forces[nodes[0] as usize] -= force;
            rounding += (ROUNDING * volume * (lambda + 2.0 * mu) * row.norm()).powi(2);
        }
    }
    Some((forces, rounding.sqrt()))
}
