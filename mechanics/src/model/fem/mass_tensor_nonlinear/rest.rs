//! Equilibrium of the nonlinear mass-tensor model: load steps, each solved by Newton's method before the next one.
//!
//! A part begins with the step that its tangent asks for, K d_f = -f_f - K_fb d_b, and goes on with steps in which the energy
//! falls (Nocedal, Wright 2006, section 3.1). A part that comes to no rest is halved, one that does is doubled.

use crate::boundary::Constraint;
use crate::mesh::Vector;
use crate::model::dofs::Constrained;
use crate::model::fem::strain::determinants;
use crate::model::parts::Parts;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Inner, Progress};
use crate::solver::conjugate_gradient::{StoppingCriterion, direction};
use crate::solver::multigrid::Multigrid;
use crate::solver::{SolveReport, SolverError, System, Tolerance, tell};

use super::tissue::Tetrahedra;

/// Steps after which a part is given up, and all steps together.
const MOST_STEPS: usize = 15;
const MOST_ALTOGETHER: usize = 150;

/// The relative residual at which a part that is not the last one rests.
const ON_THE_WAY: f64 = 1e-2;

/// Relative residual of the linear system of a step, at most and at least, and its iterations.
const INNER: [f64; 2] = [1e-8, 1e-2];
const MOST_INNER: usize = 300;

/// The share of the slope by which the energy has to fall, and how often a step is halved for it.
const ENOUGH: f64 = 1e-4;
const MOST_HALVINGS: usize = 12;

pub(super) struct Search<'a> {
    pub tetrahedra: &'a Tetrahedra<'a>,
    pub constrained: &'a Constrained<'a>,
    pub case: &'a LoadCase,
    pub progress: &'a dyn Progress,
}

/// Displacements on the way, for each node, and what was done for them.
#[derive(Clone, Default)]
struct State {
    u: Vec<Vector>,
    forces: Vec<Vector>,
    residual: f64,
}

#[derive(Default)]
struct Tally {
    history: Vec<f64>,
    inner: usize,
    parts: u32,
    halved: usize,
    indefinite: usize,
}

/// How a part of the movement ended.
enum Ending {
    Rest(State),
    NoRest,
}

impl Search<'_> {
    pub fn solve(&self, tolerance: Tolerance) -> Result<Equilibrium, ModelError> {
        let mut tally = Tally::default();
        let nodes = self.tetrahedra.mesh.nodes.len();
        let mut at = State { u: vec![Vector::zeros(); nodes], ..State::default() };
        let mut parts = Parts::beginning_with(1.0);
        while parts.made() < 1.0 {
            let share = parts.target();
            let wanted = match share < 1.0 {
                true => ON_THE_WAY.max(tolerance.relative_residual),
                false => tolerance.relative_residual,
            };
            let goal = Goal { share, wanted, memory_mb: tolerance.memory_mb };
            match self.part(&at, &goal, &mut tally)? {
                Ending::Rest(rest) => {
                    at = rest;
                    parts.rested();
                    tally.parts += 1;
                }
                Ending::NoRest if parts.halve() => {}
                Ending::NoRest => return Err(self.standstill(parts.made(), &at, &tally)),
            }
            if tally.history.len() > MOST_ALTOGETHER {
                return Err(self.standstill(parts.made(), &at, &tally));
            }
        }
        Ok(self.equilibrium(at, tolerance, tally))
    }

    /// From rest at one share of the movement to rest at another.
    fn part(&self, from: &State, goal: &Goal, tally: &mut Tally) -> Result<Ending, ModelError> {
        let mut at = from.clone();
        for step in 0..=MOST_STEPS {
            at.forces = self.tetrahedra.forces(&at.u);
            at.residual = self.relative_residual(&at, goal.share);
            if step == 0 && at.residual == 0.0 && self.is_made(&at, goal.share) {
                return Ok(Ending::Rest(at));
            }
            if step > 0 {
                tally.history.push(at.residual);
                tell(self.progress, tally.history.len(), at.residual, goal.wanted)?;
                if at.residual <= goal.wanted {
                    return Ok(Ending::Rest(at));
                }
            }
            let moved = self.step(&mut at, goal, step == 0, tally)?;
            if !moved {
                return Ok(Ending::NoRest);
            }
        }
        Ok(Ending::NoRest)
    }

    /// False where no step lets the energy fall, or leads to numbers.
    fn step(
        &self,
        at: &mut State,
        goal: &Goal,
        is_first: bool,
        tally: &mut Tally,
    ) -> Result<bool, ModelError> {
        let matrix = self.tetrahedra.tangent(&at.u, self.constrained.dof_map, self.progress)?;
        let system = self.constrained.system(matrix, &self.tetrahedra.mesh.nodes);
        goal.check_memory(&system, self.tetrahedra)?;
        let known = self.constrained.known(&self.remaining(at, goal.share));
        let right_hand_side = known.right_hand_side(&system);
        let relative_residual =
            if is_first { ON_THE_WAY } else { (0.1 * at.residual).clamp(INNER[0], INNER[1]) };
        let criterion = StoppingCriterion { relative_residual, most_iterations: MOST_INNER };
        let multigrid = Multigrid::new(&system, self.progress)?;
        let inner = Inner(self.progress);
        let found = match direction(&system, &multigrid, &right_hand_side, criterion, &inner) {
            Ok(found) => found,
            Err(SolverError::NotFinite) => return Ok(false),
            Err(other) => return Err(other.into()),
        };
        tally.inner += found.iterations;
        tally.indefinite += usize::from(!found.is_convex);
        let step = self.constrained.displacement(&known.total(&found.unknowns));
        let taken = if is_first { Some(1.0) } else { self.falling(at, &step, goal, tally) };
        let Some(taken) = taken else { return Ok(false) };
        at.u.iter_mut().zip(&step).for_each(|(u, d)| *u += d * taken);
        Ok(true)
    }

    /// The largest of 1, 1/2, 1/4 ... of a step along which the energy falls enough.
    fn falling(&self, at: &State, step: &[Vector], goal: &Goal, tally: &mut Tally) -> Option<f64> {
        let along = |forces: &[Vector]| -> f64 {
            forces.iter().zip(step).map(|(force, d)| force.dot(d)).sum()
        };
        let work = goal.share * along(&self.case.forces);
        let slope = along(&at.forces) - work;
        let (energy, largest) = (self.tetrahedra.energy(&at.u), largest(&at.u));
        let rounding = self.tetrahedra.energy_rounding(largest);
        let mut taken = 1.0;
        for _ in 0..MOST_HALVINGS {
            let there: Vec<Vector> = at.u.iter().zip(step).map(|(u, d)| u + d * taken).collect();
            let change = self.tetrahedra.energy(&there) - energy - taken * work;
            if change <= ENOUGH * taken * slope + rounding {
                return Some(taken);
            }
            taken *= 0.5;
            tally.halved += 1;
        }
        None
    }

    /// Residual at a share of movement and load.
    fn remaining(&self, at: &State, share: f64) -> LoadCase {
        let constraints = self.constrained.constraints.iter().zip(&self.case.held);
        let held = constraints.map(|(constraint, target)| {
            let own = constraint.axes().transpose() * at.u[constraint.node as usize];
            Vector::from_fn(
                |k, _| if k < constraint.count() { target[k] * share - own[k] } else { 0.0 },
            )
        });
        let pairs = self.case.forces.iter().zip(&at.forces);
        let forces = pairs.map(|(acting, internal)| acting * share - internal);
        LoadCase { held: held.collect(), forces: forces.collect(), ..LoadCase::default() }
    }

    /// Whether nothing has to be moved any more for a share of the movement.
    fn is_made(&self, at: &State, share: f64) -> bool {
        self.remaining(at, share).held.iter().all(|left| *left == Vector::zeros())
    }

    /// |f_free| / |f_held|, of what is unbalanced against what holds and loads exert.
    fn relative_residual(&self, at: &State, share: f64) -> f64 {
        let pairs = at.forces.iter().zip(&self.case.forces);
        let mut left: Vec<Vector> =
            pairs.map(|(internal, acting)| internal - acting * share).collect();
        let mut exerted: f64 =
            self.case.forces.iter().map(|force| (force * share).norm_squared()).sum();
        for constraint in self.constrained.constraints {
            let own = constraint.part_along(&left[constraint.node as usize]);
            left[constraint.node as usize] -= own;
            exerted += own.norm_squared();
        }
        let unbalanced = left.iter().map(Vector::norm_squared).sum::<f64>().sqrt();
        match unbalanced <= self.tetrahedra.force_rounding(largest(&at.u)) {
            true => 0.0,
            false => unbalanced / exerted.sqrt(),
        }
    }

    fn standstill(&self, made: f64, at: &State, tally: &Tally) -> ModelError {
        let cells = determinants(self.tetrahedra.mesh, &at.u);
        let least_det_f = cells.into_iter().fold(f64::INFINITY, f64::min);
        ModelError::Standstill { made, steps: tally.history.len(), least_det_f }
    }

    fn equilibrium(&self, at: State, tolerance: Tolerance, tally: Tally) -> Equilibrium {
        let reaction = |constraint: &Constraint| {
            let node = constraint.node as usize;
            constraint.part_along(&(at.forces[node] - self.case.forces[node]))
        };
        let reactions = self.constrained.constraints.iter().map(reaction).collect();
        let Tally { history, inner, parts, halved, indefinite } = tally;
        let report = SolveReport {
            method: "newton",
            preconditioner: "multigrid",
            why: format!(
                "{parts} parts of the movement, {inner} inner iterations; along {indefinite} steps the tangent was not positive \
                 definite, {halved} times a step was halved; energy {:.6e} mN mm",
                self.tetrahedra.energy(&at.u)
            ),
            unknowns: self.constrained.free_unknowns(),
            iterations: history.len(),
            relative_residual: at.residual,
            wanted_residual: tolerance.relative_residual,
            history,
            steps: parts,
            newton: None,
        };
        Equilibrium {
            displacement: at.u,
            reactions,
            solver: report,
            states: Default::default(),
            warnings: Vec::new(),
        }
    }
}

/// Target of a load step.
struct Goal {
    share: f64,
    /// Relative residual.
    wanted: f64,
    memory_mb: f64,
}

impl Goal {
    fn check_memory(&self, system: &System, tetrahedra: &Tetrahedra) -> Result<(), SolverError> {
        let needed_mb = system.megabytes() + tetrahedra.megabytes();
        match needed_mb > self.memory_mb {
            true => Err(SolverError::OverBudget { needed_mb, allowed_mb: self.memory_mb }),
            false => Ok(()),
        }
    }
}

fn largest(u: &[Vector]) -> f64 {
    u.iter().map(Vector::norm).fold(0.0, f64::max)
}
