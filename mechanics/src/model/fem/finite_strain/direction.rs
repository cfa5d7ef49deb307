//! Directions of Newton's method: the linear system of a step, solved as far as the step needs.

use super::pressures::Pressures;
use super::tissue::Deformed;
use super::touching::{Change, Touching, TrialState};
use crate::mesh::Vector;
use crate::model::dofs::{Constrained, PrescribedValues};
use crate::model::fem::stability::{Certainty, Tangent};
use crate::model::problem::LoadCase;
use crate::progress::{Inner, Progress};
use crate::solver::conjugate_gradient::{self, StoppingCriterion};
use crate::solver::mixed;
use crate::solver::mixed_system::{Coupling, MixedRightHandSide, MixedSystem};
use crate::solver::multigrid::Multigrid;
use crate::solver::preconditioned::Preconditioned;
use crate::solver::{Solver, SolverError, System, Unknowns};

/// Inner iterations after which a direction is taken as it is, without pressures and with them.
const MOST_INNER: usize = 200;
const MOST_INNER_MIXED: usize = 60;

/// The smallest relative residual of the linear system of a step, once bones stand still.
const SHARPEST: f64 = 1e-3;

/// A hierarchy serves this many steps, unless it has grown this much worse.
const SERVES: usize = 2;
const WORSE: f64 = 1.5;

/// What directions took.
#[derive(Clone, Copy, Default)]
pub(super) struct Tally {
    pub inner: usize,
    pub hierarchies: usize,
    /// Directions along which the tangent was not positive definite.
    pub indefinite: usize,
}

struct Hierarchy {
    solver: Solver,
    served: usize,
    /// Iterations of the first system that it served.
    fresh: usize,
}

/// A step of positions, by row and along the axes of the coordinates, and of pressures.
pub(super) struct Direction {
    pub positions: Vec<Vector>,
    pub pressures: Vec<f64>,
    /// The norm in mN of what the step was to balance.
    pub load: f64,
    /// Forces of the rows of contact in mN after the whole step; nothing where nothing presses.
    pub multipliers: Vec<f64>,
    pub iterations: usize,
    /// Whether the tangent was positive definite along all that was tried; not seen where there are pressures.
    pub is_convex: bool,
    /// Whether the iterations were enough.
    pub is_met: bool,
}

/// What remains of a movement for one step.
pub(super) struct Remaining<'a> {
    /// Movements of the holds and forces that are not balanced yet.
    pub case: &'a LoadCase,
    /// What is left over of the equations of the pressures, in mm^3.
    pub volumes: &'a [f64],
    /// Positions and displacements of the nodes.
    pub nodes: &'a [Vector],
    pub displacement: &'a [Vector],
    /// The share of the movement of bones after the step.
    pub share: f64,
    /// The relative residual that is wanted.
    pub relative: f64,
    /// The norm of the forces in mN that nothing balances.
    pub unbalanced: f64,
    pub progress: &'a dyn Progress,
}

/// Solves the systems of the steps, one after the other.
pub(super) struct Directions {
    pub pressures: Option<Pressures>,
    hierarchy: Option<Hierarchy>,
    pub tally: Tally,
    memory_mb: f64,
}

/// What iterations found.
struct StepSolution {
    unknowns: Unknowns,
    pressures: Vec<f64>,
    iterations: usize,
    is_convex: bool,
    is_met: bool,
}

impl Directions {
    pub fn new(pressures: Option<Pressures>, tally: Tally, memory_mb: f64) -> Self {
        Directions { pressures, hierarchy: None, tally, memory_mb }
    }

    pub fn of(
        &mut self,
        deformed: &Deformed,
        constrained: &Constrained,
        remaining: &Remaining,
        touching: Option<&mut Touching>,
    ) -> Result<Direction, SolverError> {
        let progress = remaining.progress;
        let system = constrained.system(deformed.tangent(progress)?, remaining.nodes);
        self.check_memory(&system)?;
        let known = constrained.known(remaining.case);
        let forces = known.right_hand_side(&system);
        let squares = forces.as_flattened().iter().map(|force| force * force);
        let load = squares.sum::<f64>().sqrt();
        let mut hierarchy = self.hierarchy();
        let inner = Inner(progress);
        let coupling = self
            .pressures
            .as_mut()
            .map(|pressures| pressures.coupling_at(&|cell| deformed.gradients(cell)));
        let mut found = match coupling {
            None => {
                let multigrid = hierarchy.solver.hierarchy(&system, progress)?;
                alone(&system, multigrid, &forces, remaining.relative, &inner)?
            }
            Some(coupling) => {
                let volumes = left_volumes(&known, coupling, remaining.volumes);
                let right = MixedRightHandSide { forces: forces.clone(), volumes };
                let solver = &hierarchy.solver;
                let system = MixedSystem { stiffness: &system, coupling, solver };
                together(&system, &right, remaining.relative, &inner)?
            }
        };
        let mut by_node = constrained.displacement(&known.total(&found.unknowns));
        let mut multipliers = Vec::new();
        if let Some(touching) = touching {
            let multigrid = hierarchy.solver.hierarchy(&system, progress)?;
            let matrix = Preconditioned::new(&system, coupling, multigrid);
            let left = left_forces(&matrix, &forces, &found);
            if let Some(change) = change_by_contact(touching, matrix, remaining, &by_node, &left)? {
                let (_, p) = change.step.split_at(3 * system.ordering.free);
                let added = constrained.displacement(&system.by_row(&change.step));
                by_node.iter_mut().zip(&added).for_each(|(d, added)| *d += added);
                found.pressures.iter_mut().zip(p).for_each(|(d, [added])| *d += added);
                multipliers = change.multipliers;
            }
        }
        self.tally.inner += found.iterations;
        self.tally.indefinite += usize::from(!found.is_convex);
        hierarchy.serve(&found);
        self.hierarchy = Some(hierarchy);
        Ok(Direction {
            positions: constrained.dof_map.by_row(&by_node),
            pressures: found.pressures,
            load,
            multipliers,
            iterations: found.iterations,
            is_convex: found.is_convex,
            is_met: found.is_met,
        })
    }

    /// Whether the tangent, with pressures that answer to displacements, is positive definite; none where that is not known.
    pub fn is_stable(
        &mut self,
        deformed: &Deformed,
        constrained: &Constrained,
        nodes: &[Vector],
        progress: &dyn Progress,
    ) -> Result<Option<bool>, SolverError> {
        let system = &constrained.system(deformed.tangent(progress)?, nodes);
        // The hierarchy of the last step is that of a tangent near by.
        let hierarchy = self.hierarchy.take().unwrap_or_else(|| self.new_hierarchy());
        let coupling = self.pressures.as_mut();
        let coupling = coupling.map(|own| own.coupling_at(&|cell| deformed.gradients(cell)));
        let (solver, certainty) = (&hierarchy.solver, Certainty::OF_ANSWER);
        let tangent = Tangent { constrained, system, coupling, solver, certainty };
        let is_stable = tangent.is_positive_definite(progress)?;
        self.hierarchy = Some(hierarchy);
        Ok(is_stable)
    }

    fn hierarchy(&mut self) -> Hierarchy {
        match self.hierarchy.take().filter(|hierarchy| hierarchy.served < SERVES) {
            Some(hierarchy) => hierarchy,
            None => self.new_hierarchy(),
        }
    }

    fn new_hierarchy(&mut self) -> Hierarchy {
        self.tally.hierarchies += 1;
        Hierarchy { solver: Solver::default(), served: 0, fresh: 0 }
    }

    fn check_memory(&self, system: &System) -> Result<(), SolverError> {
        let pressures = self.pressures.as_ref().map_or(0.0, Pressures::megabytes);
        let needed_mb = system.megabytes() + pressures;
        let allowed_mb = self.memory_mb;
        match needed_mb > allowed_mb {
            true => Err(SolverError::OverBudget { needed_mb, allowed_mb }),
            false => Ok(()),
        }
    }
}

impl Hierarchy {
    /// Counts a system that it served.
    fn serve(&mut self, found: &StepSolution) {
        if self.served == 0 {
            self.fresh = found.iterations;
        }
        let is_worse = found.iterations as f64 > WORSE * self.fresh as f64 + 2.0;
        self.served = if is_worse || !found.is_convex { SERVES } else { self.served + 1 };
    }
}

/// That residual, at most `most`, after these residuals of rest (Eisenstat, Walker 1996, choice 2).
pub(super) fn inner_tolerance_at_rest([last, residual]: [f64; 2], wanted: f64, most: f64) -> f64 {
    let ratio = residual / last;
    (0.9 * ratio * ratio).clamp(SHARPEST, most).max(0.3 * wanted / residual)
}

/// Displacements without pressures.
fn alone(
    system: &System,
    multigrid: &Multigrid,
    right_hand_side: &Unknowns,
    relative_residual: f64,
    progress: &Inner,
) -> Result<StepSolution, SolverError> {
    let criterion = StoppingCriterion { relative_residual, most_iterations: MOST_INNER };
    let found =
        conjugate_gradient::direction(system, multigrid, right_hand_side, criterion, progress)?;
    let conjugate_gradient::Direction { unknowns, iterations, is_convex } = found;
    Ok(StepSolution { unknowns, pressures: Vec::new(), iterations, is_convex, is_met: true })
}

/// Displacements and pressures.
fn together(
    system: &MixedSystem,
    right_hand_side: &MixedRightHandSide,
    relative_residual: f64,
    progress: &Inner,
) -> Result<StepSolution, SolverError> {
    let criterion = StoppingCriterion { relative_residual, most_iterations: MOST_INNER_MIXED };
    let found = mixed::direction(system, right_hand_side, criterion, progress)?;
    let mixed::MixedDirection { unknowns, pressures, iterations, is_met } = found;
    let pressures = pressures.into_iter().map(|[pressure]| pressure).collect();
    Ok(StepSolution { unknowns, pressures, iterations, is_convex: true, is_met })
}

/// What contact changes of a step, given by node, that leaves some forces.
fn change_by_contact(
    touching: &mut Touching,
    matrix: Preconditioned,
    remaining: &Remaining,
    step: &[Vector],
    left: &[[f64; 1]],
) -> Result<Option<Change>, SolverError> {
    let Remaining { displacement, share, unbalanced, relative, .. } = *remaining;
    let displacement: Vec<Vector> =
        displacement.iter().zip(step).map(|(u, step)| u + step).collect();
    let (displacement, progress) = (&*displacement, &Inner(remaining.progress));
    let ahead = TrialState { displacement, share, left, unbalanced, relative, progress };
    touching.change(matrix, &ahead)
}

/// What a direction leaves of the forces that it was to balance where the tangent is not positive definite; nothing otherwise.
fn left_forces(matrix: &Preconditioned, forces: &Unknowns, found: &StepSolution) -> Vec<[f64; 1]> {
    if found.is_convex {
        return Vec::new();
    }
    let found: Vec<[f64; 1]> = found.unknowns.as_flattened().iter().map(|value| [*value]).collect();
    let product = matrix.product(&found);
    let pairs = forces.as_flattened().iter().zip(&product);
    pairs.map(|(force, [balanced])| [force - balanced]).collect()
}

/// -r - B d of the rows of pressures, d what is known of the step.
fn left_volumes(known: &PrescribedValues, coupling: &Coupling, residual: &[f64]) -> Vec<[f64; 1]> {
    let mut volumes = vec![[0.0]; residual.len()];
    coupling.divergence.contract(&known.displacement, &mut volumes);
    let pairs = volumes.iter().zip(residual);
    pairs.map(|([moved], left)| [-(moved + left)]).collect()
}
