//! Equilibrium by Newton's method on the energy W - f . u.
//!
//! K(p) d = f - dW/dp over what is free, p <- p + a d, K the tangent of the springs. The first step is the
//! answer of springs that keep their directions. Where pressed springs make K indefinite, their geometric stiffness
//! is raised until it is positive definite. a = 1, halved until the energy falls by a part of what the slope
//! promises (Nocedal, Wright, Numerical Optimization, 2nd ed., 2006, section 3.1).

use super::network::{MassSpringSettings, Network, SpringEquilibrium, length};
use super::springs::GeometricStiffness;
use crate::mesh::Vector;
use crate::model::dofs::nodes_of_cells;
use crate::model::dofs::{Constrained, number};
use crate::model::fem::displacement::Problem;
use crate::model::problem::{LoadCase, ModelError};
use crate::progress::{Inner, Progress};
use crate::solver::{self, SolveReport, SolverError, Tolerance, tell};

/// The share of the slope by which the energy has to fall.
const ENOUGH: f64 = 1e-4;

/// Halvings after which a step goes nowhere.
const MOST_HALVINGS: usize = 40;

/// A change of energy below this share of it is rounding.
const ROUNDING: f64 = 1e-14;

/// Steps with regularised tangents after which the exact one is tried again.
const MOST_RAISED: usize = 4;

/// The relative residual to which the system of a step is solved, at most and at least.
const INNER: [f64; 2] = [1e-10, 1e-3];

pub(super) fn solve(
    network: &Network,
    problem: &Problem,
    settings: &MassSpringSettings,
    progress: &dyn Progress,
) -> Result<SpringEquilibrium, ModelError> {
    let mesh = problem.tissue.mesh;
    let dof_map = number(&nodes_of_cells(mesh), &mesh.nodes, problem.constraints);
    let constrained = Constrained { constraints: problem.constraints, dof_map: &dof_map };
    let wanted = problem.tolerance.relative_residual;
    let positions = network.start.clone();
    let mut newton = Newton {
        network,
        constrained: &constrained,
        problem,
        progress,
        positions,
        residual: 1.0,
        raised_ahead: 0,
        wait: 1,
        history: Vec::new(),
        tally: Tally::default(),
    };
    newton.first_step()?;
    while newton.residual > wanted {
        if newton.history.len() >= settings.most_iterations {
            return Err(newton.not_converged().into());
        }
        newton.step()?;
    }
    Ok(newton.found())
}

/// Work of the steps.
#[derive(Default)]
struct Tally {
    inner: usize,
    raised: usize,
    halved: usize,
}

struct Newton<'a> {
    network: &'a Network<'a>,
    constrained: &'a Constrained<'a>,
    problem: &'a Problem<'a>,
    progress: &'a dyn Progress,
    positions: Vec<Vector>,
    /// Relative, at the positions.
    residual: f64,
    /// Steps to take with regularised tangents before the exact one is tried again.
    raised_ahead: usize,
    /// The next such number: it doubles while exact tangents stay indefinite.
    wait: usize,
    history: Vec<f64>,
    tally: Tally,
}

impl Newton<'_> {
    fn first_step(&mut self) -> Result<(), SolverError> {
        let network = self.network;
        let moved: Vec<Vector> =
            self.positions.iter().zip(network.rest).map(|(p, x)| p - x).collect();
        let resistance = network.springs.linear_forces(network.rest, &moved);
        let unbalanced = network.unbalanced(&resistance);
        let step = self.solve_tangent(network.rest, &unbalanced, GeometricStiffness::Exact)?;
        self.take(&step)
    }

    fn step(&mut self) -> Result<(), SolverError> {
        let network = self.network;
        let unbalanced = network.unbalanced(&network.springs.forces(&self.positions));
        let (mut step, mut slope) = self.direction(&unbalanced)?;
        let rounding = ROUNDING * network.springs.energy(&self.positions);
        for _ in 0..MOST_HALVINGS {
            let work: f64 = network.acting.iter().zip(&step).map(|(f, u)| f.dot(u)).sum();
            let change = network.springs.energy_change(&self.positions, &step) - work;
            if change <= rounding - ENOUGH * slope {
                return self.take(&step);
            }
            step.iter_mut().for_each(|d| *d *= 0.5);
            slope *= 0.5;
            self.tally.halved += 1;
        }
        Err(self.not_converged())
    }

    fn take(&mut self, step: &[Vector]) -> Result<(), SolverError> {
        self.positions.iter_mut().zip(step).for_each(|(p, d)| *p += d);
        let resistance = self.network.springs.forces(&self.positions);
        self.residual = length(&self.network.unbalanced(&resistance)) / self.network.scale;
        self.history.push(self.residual);
        let wanted = self.problem.tolerance.relative_residual;
        tell(self.progress, self.history.len(), self.residual, wanted)
    }

    /// A direction in which the energy falls, and how steeply.
    fn direction(&mut self, unbalanced: &[Vector]) -> Result<(Vec<Vector>, f64), SolverError> {
        let positions = self.positions.clone();
        let slope = |direction: &[Vector]| -> f64 {
            unbalanced.iter().zip(direction).map(|(r, d)| r.dot(d)).sum()
        };
        if self.raised_ahead == 0 {
            match self.solve_tangent(&positions, unbalanced, GeometricStiffness::Exact) {
                Ok(exact) if slope(&exact) > 0.0 => {
                    self.wait = 1;
                    let slope = slope(&exact);
                    return Ok((exact, slope));
                }
                Err(error @ (SolverError::Stopped | SolverError::OverBudget { .. })) => {
                    return Err(error);
                }
                _ => {
                    self.raised_ahead = self.wait;
                    self.wait = (2 * self.wait).min(MOST_RAISED);
                }
            }
        }
        self.raised_ahead -= 1;
        self.tally.raised += 1;
        let raised = self.solve_tangent(&positions, unbalanced, GeometricStiffness::Raised)?;
        let slope = slope(&raised);
        Ok((raised, slope))
    }

    /// K^-1 times what is unbalanced, for each node.
    fn solve_tangent(
        &mut self,
        positions: &[Vector],
        unbalanced: &[Vector],
        geometric: GeometricStiffness,
    ) -> Result<Vec<Vector>, SolverError> {
        let Problem { constraints, tolerance, .. } = self.problem;
        let matrix = self.network.springs.tangent(positions, geometric, self.constrained.dof_map);
        let system = self.constrained.system(matrix, positions);
        let case = LoadCase {
            held: vec![Vector::zeros(); constraints.len()],
            forces: unbalanced.to_vec(),
            ..LoadCase::default()
        };
        let known = self.constrained.known(&case);
        let [least, most] = INNER;
        let relative_residual =
            (0.1 * tolerance.relative_residual / self.residual).clamp(least, most);
        let tolerance = Tolerance { relative_residual, ..*tolerance };
        let right_hand_side = known.right_hand_side(&system);
        let solved = solver::solve(&system, &[right_hand_side], &tolerance, &Inner(self.progress));
        let solution = solved.map_err(|error| self.constrained.in_nodes(error))?.remove(0);
        self.tally.inner += solution.report.iterations;
        Ok(self.constrained.displacement(&known.total(&solution.unknowns)))
    }

    fn not_converged(&self) -> SolverError {
        SolverError::NotConverged {
            iterations: self.history.len(),
            residual: self.residual,
            wanted: self.problem.tolerance.relative_residual,
            history: self.history.clone(),
        }
    }

    fn found(self) -> SpringEquilibrium {
        let Tally { inner, raised, halved } = self.tally;
        let solver = SolveReport {
            method: "newton",
            preconditioner: "none",
            why: format!(
                "{inner} inner iterations; {raised} tangents were raised to be positive definite, \
                 {halved} times a step was halved"
            ),
            unknowns: self.network.unknowns(),
            iterations: self.history.len(),
            relative_residual: self.residual,
            wanted_residual: self.problem.tolerance.relative_residual,
            history: self.history,
            steps: 1,
            newton: None,
        };
        SpringEquilibrium { positions: self.positions, solver }
    }
}
