//! Newton's method that moves the bones and brings the tissue to rest in the same steps (NONLINEAR, section 1).
//!
//! At x, with the share s of the movement made: K d_f = -f_f - K_fb d_b with d_b on the rest of the way, then x <- x + t d,
//! s <- s + t ds, t the longest step in which every cell keeps a share of its volume. Once s = 1 the energy has to fall too.

use crate::mesh::Vector;
use crate::model::dofs::Constrained;
use crate::model::problem::{LoadCase, ModelError};
use crate::progress::{Inner, Progress};
use crate::solver::conjugate_gradient::{Direction, Enough, direction};
use crate::solver::multigrid::Multigrid;
use crate::solver::{SolveReport, SolverError, System, Tolerance, Unknowns, tell};

use super::cells::{Cells, Deformed};
use super::holds::{along_holds, free_unknowns};

/// What a cell may lose of its volume in one step where the bulk modulus is up to twelve times the shear modulus, and less
/// where it is more: what a loss does to the forces grows with their ratio.
const LOSS: f64 = 0.3;
const SOFT: f64 = 12.0;

/// The relative residual above which tissue whose tangent was not positive definite is brought nearer to rest before bones go on.
const OUT_OF_BALANCE: f64 = 0.3;

/// Relative residual of the linear system of a step while bones move, and the bounds of it afterwards.
const ADVANCING: f64 = 0.01;
const SHARPEST: f64 = 1e-3;

/// Steps after which no rest is expected any more.
const MOST_STEPS: usize = 150;

/// Inner iterations after which a direction is taken as it is.
const MOST_INNER: usize = 200;

/// A hierarchy serves this many steps, unless it has grown this much worse.
const SERVES: usize = 2;
const WORSE: f64 = 1.5;

/// Steps this short, this often one after the other, are a standstill.
const SHORT: f64 = 0.01;
const MOST_SHORT: usize = 5;

/// The least share of the movement that is tried at once.
const LEAST_AHEAD: f64 = 1e-3;

/// The share of the slope by which the energy has to fall, and how often a step is halved for it.
const ENOUGH: f64 = 1e-4;
const MOST_HALVINGS: usize = 30;

/// Forces are measured against what holds and loads exert, at least this share of the most on the way: tissue that is turned
/// as a whole exerts nothing in the end.
const LEAST_SCALE: f64 = 1e-3;

/// What the steps took.
#[derive(Default)]
struct Tally {
    inner: usize,
    hierarchies: usize,
    /// Steps along which the tangent was not positive definite.
    indefinite: usize,
    halved: usize,
}

struct Hierarchy {
    multigrid: Multigrid,
    served: usize,
    /// Iterations of the first system that it served.
    fresh: usize,
}

/// What rounding leaves: the norm of forces in mN, energy in mN mm.
struct Rounding {
    force: f64,
    energy: f64,
}

pub(super) struct Newton<'a> {
    cells: &'a Cells<'a>,
    constrained: &'a Constrained<'a>,
    case: &'a LoadCase,
    tolerance: Tolerance,
    progress: &'a dyn Progress,
    /// Positions by row.
    x: Vec<Vector>,
    /// The share of movement and load that is made, and how much of it the next step tries.
    made: f64,
    ahead: f64,
    /// Steps in a row that were short.
    short: usize,
    /// Whether a tangent was not positive definite since the tissue was last near rest.
    unsettled: bool,
    /// The share of its volume that a cell keeps in one step.
    keep: f64,
    rounding: Rounding,
    hierarchy: Option<Hierarchy>,
    /// The largest norm of the forces of holds and loads on the way, in mN.
    most_exerted: f64,
    /// The norm of the forces on free nodes that nothing balances, in mN, and relative to what is exerted.
    unbalanced: f64,
    residual: f64,
    history: Vec<f64>,
    tally: Tally,
}

/// Where the tissue is and what pulls at it.
struct State<'a> {
    deformed: Deformed<'a>,
    /// By row.
    forces: Vec<Vector>,
}

/// Tissue at rest.
pub(super) struct Rest {
    /// By row.
    pub positions: Vec<Vector>,
    /// Internal forces in mN, by row.
    pub forces: Vec<Vector>,
    pub report: SolveReport,
}

impl<'a> Newton<'a> {
    /// From rest.
    pub fn new(
        cells: &'a Cells<'a>,
        constrained: &'a Constrained<'a>,
        case: &'a LoadCase,
        tolerance: Tolerance,
        progress: &'a dyn Progress,
    ) -> Self {
        Newton {
            cells,
            constrained,
            case,
            tolerance,
            progress,
            x: cells.rest.clone(),
            made: 0.0,
            ahead: 1.0,
            short: 0,
            unsettled: false,
            rounding: Rounding { force: cells.force_rounding(), energy: cells.energy_rounding() },
            keep: 1.0 - LOSS * (SOFT / cells.stiffest()).sqrt().min(1.0),
            hierarchy: None,
            most_exerted: 0.0,
            unbalanced: 0.0,
            residual: 1.0,
            history: Vec::new(),
            tally: Tally::default(),
        }
    }

    /// Goes on until rest is found, or says why it is not.
    pub fn solve(mut self) -> Result<Rest, ModelError> {
        let wanted = self.tolerance.relative_residual;
        loop {
            let cells = self.cells;
            let deformed = cells.at(&self.x);
            let forces = deformed.forces();
            let state = State { deformed, forces };
            self.residual = self.relative_residual(&state.forces);
            self.history.push(self.residual);
            tell(self.progress, self.history.len(), self.residual, wanted)?;
            let rests = self.residual <= wanted || self.unbalanced <= self.rounding.force;
            if self.made >= 1.0 && rests {
                let report = self.report(&state);
                return Ok(Rest { positions: self.x, forces: state.forces, report });
            }
            if self.history.len() > MOST_STEPS {
                return Err(self.not_converged().into());
            }
            self.step(&state)?;
        }
    }

    /// One step: a direction, how far, and the same of the movement of the bones.
    fn step(&mut self, state: &State) -> Result<(), ModelError> {
        let rests = self.unsettled && self.residual > OUT_OF_BALANCE;
        let ahead = if rests { 0.0 } else { self.ahead.min(1.0 - self.made) };
        let (step, is_convex) = self.direction(state, ahead)?;
        self.unsettled = !is_convex || (self.unsettled && self.residual > OUT_OF_BALANCE);
        let longest = self.cells.longest_step(&self.x, &step, self.keep);
        let taken = match ahead > 0.0 {
            true => longest,
            false => self.falling(state, &step, longest)?,
        };
        self.x.iter_mut().zip(&step).for_each(|(x, d)| *x += d * taken);
        if ahead > 0.0 {
            self.made = advanced(self.made, taken * ahead);
            self.ahead = (2.0 * taken * ahead).max(LEAST_AHEAD);
        }
        self.short = if taken < SHORT { self.short + 1 } else { 0 };
        match self.short > MOST_SHORT {
            true => Err(self.standstill(state)),
            false => Ok(()),
        }
    }

    /// The direction by row, along the axes of the coordinates, and whether the tangent was positive definite on its way.
    fn direction(&mut self, state: &State, ahead: f64) -> Result<(Vec<Vector>, bool), ModelError> {
        let system = self.constrained.system(state.deformed.tangent(), &self.positions());
        self.check_memory(&system)?;
        let known = self.constrained.known(&self.remaining(state, ahead));
        let right_hand_side = known.right_hand_side(&system);
        let relative = self.inner_tolerance();
        let found = self.solve_inner(&system, &right_hand_side, relative)?;
        self.tally.inner += found.iterations;
        self.tally.indefinite += usize::from(!found.is_convex);
        let by_node = self.constrained.displacement(&known.total(&found.unknowns));
        Ok((self.constrained.numbering.by_row(&by_node), found.is_convex))
    }

    fn check_memory(&self, system: &System) -> Result<(), SolverError> {
        let needed_mb = system.megabytes() + self.cells.megabytes();
        let allowed_mb = self.tolerance.memory_mb;
        match needed_mb > allowed_mb {
            true => Err(SolverError::OverBudget { needed_mb, allowed_mb }),
            false => Ok(()),
        }
    }

    fn solve_inner(
        &mut self,
        system: &System,
        right_hand_side: &Unknowns,
        relative: f64,
    ) -> Result<Direction, SolverError> {
        let hierarchy = match self.hierarchy.take().filter(|h| h.served < SERVES) {
            Some(hierarchy) => hierarchy,
            None => {
                self.tally.hierarchies += 1;
                Hierarchy { multigrid: Multigrid::new(system), served: 0, fresh: 0 }
            }
        };
        let inner = Inner(self.progress);
        let enough = Enough { relative_residual: relative, most_iterations: MOST_INNER };
        let Hierarchy { multigrid, served, fresh } = hierarchy;
        let found = direction(system, &multigrid, right_hand_side, enough, &inner)?;
        let fresh = if served == 0 { found.iterations } else { fresh };
        let is_worse = found.iterations as f64 > WORSE * fresh as f64 + 2.0 || !found.is_convex;
        let served = if is_worse { SERVES } else { served + 1 };
        self.hierarchy = Some(Hierarchy { multigrid, served, fresh });
        Ok(found)
    }

    /// Eisenstat, Walker 1996, choice 2, once the bones stand still.
    fn inner_tolerance(&self) -> f64 {
        if self.made < 1.0 {
            return ADVANCING;
        }
        let last = self.history.iter().rev().nth(1).copied().unwrap_or(1.0);
        let wanted = self.tolerance.relative_residual;
        let ratio = self.residual / last;
        (0.9 * ratio * ratio).clamp(SHARPEST, 2.0 * ADVANCING).max(0.3 * wanted / self.residual)
    }

    /// What of movement and load is made in this step, with the forces that are not balanced yet, for each node.
    fn remaining(&self, state: &State, ahead: f64) -> LoadCase {
        let share = self.made + ahead;
        let row = |node: u32| self.constrained.numbering.row(node);
        let held = self.constrained.holds.iter().zip(&self.case.held).map(|(hold, target)| {
            let moved = self.x[row(hold.node)] - self.cells.rest[row(hold.node)];
            let own = hold.axes().transpose() * moved;
            Vector::from_fn(|k, _| match k < hold.count() {
                true if share < 1.0 => (target[k] - own[k]) * ahead / (1.0 - self.made),
                true => target[k] - own[k],
                false => 0.0,
            })
        });
        let forces = self
            .case
            .forces
            .iter()
            .enumerate()
            .map(|(node, acting)| acting * share.min(1.0) - state.forces[row(node as u32)]);
        LoadCase { held: held.collect(), forces: forces.collect() }
    }

    /// The longest part of a step with bones at rest that lets the energy fall.
    fn falling(
        &mut self,
        state: &State,
        step: &[Vector],
        longest: f64,
    ) -> Result<f64, SolverError> {
        let acting = self.acting();
        let along = |forces: &[Vector]| -> f64 {
            forces.iter().zip(step).map(|(force, d)| force.dot(d)).sum()
        };
        let (pull, work) = (along(&state.forces), along(&acting));
        let energy = self.cells.energy(&self.x);
        let mut taken = longest;
        for _ in 0..MOST_HALVINGS {
            let there: Vec<Vector> = self.x.iter().zip(step).map(|(x, d)| x + d * taken).collect();
            let change = self.cells.energy(&there) - energy - taken * work;
            if change <= ENOUGH * taken * (pull - work) + self.rounding.energy {
                return Ok(taken);
            }
            taken *= 0.5;
            self.tally.halved += 1;
        }
        Err(self.not_converged())
    }

    /// What acts so far, by row.
    fn acting(&self) -> Vec<Vector> {
        let forces: Vec<Vector> = self.case.forces.iter().map(|f| f * self.made).collect();
        self.constrained.numbering.by_row(&forces)
    }

    /// |f_free| / |f_held|, of what is unbalanced against what the holds and the loads exert.
    fn relative_residual(&mut self, internal: &[Vector]) -> f64 {
        let acting = self.acting();
        let mut unbalanced: Vec<Vector> =
            internal.iter().zip(&acting).map(|(internal, acting)| internal - acting).collect();
        let mut exerted: f64 = acting.iter().map(|force| force.norm_squared()).sum();
        for hold in self.constrained.holds {
            let force = &mut unbalanced[self.constrained.numbering.row(hold.node)];
            let own = along_holds(hold, force);
            *force -= own;
            exerted += own.norm_squared();
        }
        self.unbalanced = unbalanced.iter().map(|force| force.norm_squared()).sum::<f64>().sqrt();
        self.most_exerted = self.most_exerted.max(exerted.sqrt());
        let scale = exerted.sqrt().max(LEAST_SCALE * self.most_exerted);
        if scale > 0.0 { self.unbalanced / scale } else { 0.0 }
    }

    /// Of the nodes.
    fn positions(&self) -> Vec<Vector> {
        let places = self.constrained.numbering.layout.place.iter();
        places.map(|&row| self.x[row as usize]).collect()
    }

    fn not_converged(&self) -> SolverError {
        SolverError::NotConverged {
            iterations: self.history.len(),
            residual: self.residual,
            wanted: self.tolerance.relative_residual,
            history: self.history.clone(),
        }
    }

    fn standstill(&self, state: &State) -> ModelError {
        let least_det_f = state.deformed.least_volume();
        ModelError::Standstill { made: self.made, steps: self.history.len(), least_det_f }
    }

    fn report(&self, state: &State) -> SolveReport {
        let Tally { inner, hierarchies, indefinite, halved } = self.tally;
        SolveReport {
            method: "newton",
            preconditioner: "multigrid",
            why: format!(
                "{inner} inner iterations with {hierarchies} hierarchies; along {indefinite} steps the tangent was not \
                 positive definite, {halved} times a step was halved; energy {:.6e} mN mm, least det F {:.4}",
                self.cells.energy(&self.x),
                state.deformed.least_volume()
            ),
            unknowns: free_unknowns(self.constrained),
            iterations: self.history.len() - 1,
            relative_residual: self.residual,
            wanted_residual: self.tolerance.relative_residual,
            history: self.history.clone(),
            steps: 1,
        }
    }
}

/// The share of the movement after one more part of it.
fn advanced(made: f64, more: f64) -> f64 {
    let made = made + more;
    if 1.0 - made < 1e-12 { 1.0 } else { made }
}
