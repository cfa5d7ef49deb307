//! Contact in linear elasticity: closest points and active set, in steps along the movement, and at its end until the
//! closest points no longer change.

use std::collections::BTreeMap;

use super::active_set::{ActiveSet, MOST_PASSES, SettledSet, Task};
use super::equations::FreeUnknowns;
use super::kept_rows::{KeptRows, Round};
use super::touch::{Contact, Effort};
use crate::boundary::contact::{Alike, CLOSED_MM, ContactRow, FacingSurfaces};
use crate::mesh::Vector;
use crate::model::fem::linear_system::{Correction, LinearSystem, Residual, Solved};
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::Progress;
use crate::solver::SolverError;
use crate::solver::constrained::{ConstraintTarget, Equations, Point};

/// Beyond this, in mm, an answer is none.
pub const UNSETTLED_MM: f64 = 0.1;

/// How often closest points are looked for again at the end of the movement.
pub const MOST_ROUNDS: usize = 15;

/// How often they are with the normals of the answer: surfaces of tissue turn with it.
const EXACT_ROUNDS: usize = 12;

/// What moves goes by at most this part of its longest edges in a step; the second where the first does not settle.
const STEPS: [f64; 2] = [0.5, 0.125];

/// Relative residual and passes of the active set as long as closest points change: the next ones say more than a set that repeats.
const ON_THE_WAY: f64 = 0.01;
const FEW_PASSES: usize = 3;

/// Relative residual where the last closest points moved the answer by less than this, in mm.
const NEARLY: f64 = 1e-3;
const NEAR_MM: f64 = 0.05;

/// Closest points whose answer moves by more than this part of what it moved by before alternate between two states: they are looked
/// for half way between these.
pub const ALTERNATES: f64 = 0.5;

/// Closest points that move the answer by less than this, in mm, are not looked for again; by more in the end, they are reported.
pub const SETTLED_MM: f64 = 0.005;

/// A linear system, its answer without contact, and what may touch.
pub struct ContactProblem<'a> {
    pub system: &'a LinearSystem<'a>,
    pub free: &'a Solved,
    pub surfaces: &'a FacingSurfaces<'a>,
    pub relative_residual: f64,
}

/// An answer with contact.
pub struct InContact<'a> {
    pub solved: Solved,
    pub contact: Contact,
    pub pressing: Pressing<'a>,
}

/// The equations of what presses in an answer.
pub struct Pressing<'a> {
    system: &'a LinearSystem<'a>,
    equations: Equations<'a>,
    /// Those that are met.
    rows: Vec<usize>,
}

impl<'a> ContactProblem<'a> {
    /// The answer with contact; none where nothing touches.
    pub fn solve(&self, progress: &dyn Progress) -> Result<Option<InContact<'a>>, ModelError> {
        match self.solve_in_steps(STEPS[0], progress) {
            Err(ModelError::ContactUnsettled { .. }) => self.solve_in_steps(STEPS[1], progress),
            other => other,
        }
    }

    fn solve_in_steps(
        &self,
        step: f64,
        progress: &dyn Progress,
    ) -> Result<Option<InContact<'a>>, ModelError> {
        let mut rounds = Rounds::new(self, progress)?;
        let steps = self.surfaces.steps(self.free(), step);
        for step in 1..=steps {
            if progress.is_cancelled() {
                return Err(SolverError::Stopped.into());
            }
            rounds.share = step as f64 / steps as f64;
            rounds.look(Alike::Nearly);
            if rounds.touches() {
                rounds.settle(ON_THE_WAY, FEW_PASSES, progress)?;
            } else {
                rounds.displacement = self.free_part(rounds.share);
                rounds.reached = rounds.share;
            }
        }
        if !rounds.has_touched() {
            rounds.look(Alike::Nearly);
            if !rounds.touches() {
                return Ok(None);
            }
            rounds.settle(ON_THE_WAY, FEW_PASSES, progress)?;
        }
        let last_moved_mm = self.settle_points(&mut rounds, progress)?;
        match rounds.repeats {
            true => Ok(Some(rounds.answer(last_moved_mm))),
            false => Err(rounds.unsettled(last_moved_mm)),
        }
    }

    /// Looks for closest points at the end of the movement until they no longer move the answer, with the normals of that answer if
    /// that ends; how far they do, in mm.
    fn settle_points(
        &self,
        rounds: &mut Rounds,
        progress: &dyn Progress,
    ) -> Result<f64, ModelError> {
        let nearly = (Alike::Nearly, MOST_ROUNDS);
        let mut last_moved_mm = rounds.settle_rows(nearly, NEAR_MM, progress)?;
        if last_moved_mm < NEAR_MM {
            let exactly = (Alike::Exactly, EXACT_ROUNDS);
            last_moved_mm = rounds.settle_rows(exactly, SETTLED_MM, progress)?;
            if last_moved_mm > SETTLED_MM {
                last_moved_mm = rounds.settle_rows(nearly, SETTLED_MM, progress)?;
            }
        }
        if last_moved_mm > UNSETTLED_MM {
            return Err(rounds.unsettled(last_moved_mm));
        }
        let moved_mm = rounds.settle(self.relative_residual, MOST_PASSES, progress)?;
        Ok(last_moved_mm.max(moved_mm))
    }

    fn free(&self) -> &[Vector] {
        &self.free.equilibrium.displacement
    }

    fn free_part(&self, share: f64) -> Vec<Vector> {
        self.free().iter().map(|u| u * share).collect()
    }
}

impl Pressing<'_> {
    /// What a residual changes where holds stay and what presses neither opens nor gives way, to a relative residual.
    pub fn correction(
        &mut self,
        residual: &Residual,
        relative_residual: f64,
        progress: &dyn Progress,
    ) -> Result<Correction, ModelError> {
        let less = self.system.negated(residual);
        let values = vec![0.0; self.rows.len()];
        let wanted =
            ConstraintTarget { rows: &self.rows, values: &values, less: &less, relative_residual };
        let found = self.equations.solve(&wanted, Point::default(), progress)?;
        let iterations = found.iterations;
        Ok(self.system.correction(&found.point.x, iterations, found.relative_residual))
    }
}

/// State of the search for contact points.
struct Rounds<'a, 'b> {
    problem: &'b ContactProblem<'a>,
    unknowns: FreeUnknowns<'a>,
    /// Those of `kept_rows`.
    equations: Equations<'a>,
    kept_rows: KeptRows,
    /// The part of the movement that is to be done.
    share: f64,
    /// The answer so far, and the part of the movement that it is of.
    displacement: Vec<Vector>,
    reached: f64,
    /// The answer before it.
    before: Vec<Vector>,
    /// Change of the solution by contact, and the multipliers of the active constraints.
    added: Point,
    active: Vec<usize>,
    /// The same by node, whatever rows are found next.
    pressed: BTreeMap<u32, f64>,
    effort: Effort,
    relative_residual: f64,
    /// Whether the last set repeated.
    repeats: bool,
}

impl<'a, 'b> Rounds<'a, 'b> {
    fn new(problem: &'b ContactProblem<'a>, progress: &dyn Progress) -> Result<Self, SolverError> {
        let system = problem.system;
        Ok(Rounds {
            problem,
            unknowns: FreeUnknowns::new(system.constraints, &system.dof_map),
            equations: Equations::new(system.preconditioned(progress)?, Vec::new()),
            kept_rows: KeptRows::default(),
            share: 0.0,
            displacement: vec![Vector::zeros(); problem.free().len()],
            reached: 0.0,
            before: Vec::new(),
            added: Point::default(),
            active: Vec::new(),
            pressed: BTreeMap::new(),
            effort: Effort::default(),
            relative_residual: 0.0,
            repeats: false,
        })
    }

    fn unsettled(&self, moved_mm: f64) -> ModelError {
        ModelError::ContactUnsettled { passes: self.effort.passes, moved_mm }
    }

    /// Looks for closest points with the answer so far; how many rows say something new.
    fn look(&mut self, alike: Alike) -> usize {
        let displacement = std::mem::take(&mut self.displacement);
        let new = self.look_at(&displacement, alike);
        self.displacement = displacement;
        new
    }

    /// Whether that finds nothing new, and the set repeats.
    fn finds_nothing(&mut self, alike: Alike) -> bool {
        self.look(alike) == 0 && self.repeats
    }

    /// The same half way between this answer and the one before.
    fn look_half_way(&mut self, alike: Alike) {
        let pairs = self.displacement.iter().zip(&self.before);
        let half_way: Vec<Vector> = pairs.map(|(u, before)| (u + before) * 0.5).collect();
        self.look_at(&half_way, alike);
    }

    fn look_at(&mut self, displacement: &[Vector], alike: Alike) -> usize {
        let mut found = self.problem.surfaces.rows(displacement, self.reached);
        found.retain(|row| !self.unknowns.equation(row).is_empty());
        let Round { same, new } = self.kept_rows.take(found, alike, displacement, self.reached);
        let equations = self.kept_rows.rows.iter().map(|row| self.unknowns.equation(row));
        self.equations.replace(equations.collect(), &same);
        new
    }

    fn has_touched(&self) -> bool {
        self.effort.rounds > 0
    }

    /// Whether anything touches or has touched.
    fn touches(&self) -> bool {
        let free = self.problem.free();
        let closes = |row: &ContactRow| row.gap_after_part(free, self.share) < -CLOSED_MM;
        self.has_touched() || self.kept_rows.rows.iter().any(closes)
    }

    /// Looks for closest points at most so often, until they move the answer by less than this, in mm; how far the last ones do.
    fn settle_rows(
        &mut self,
        (alike, most): (Alike, usize),
        until_mm: f64,
        progress: &dyn Progress,
    ) -> Result<f64, ModelError> {
        let (mut before_mm, mut last_mm) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..most {
            if last_mm > ALTERNATES * before_mm {
                self.look_half_way(alike);
            } else if self.finds_nothing(alike) {
                return Ok(0.0);
            }
            let is_near = alike == Alike::Exactly || last_mm < NEAR_MM;
            let residual = if is_near { NEARLY } else { ON_THE_WAY };
            before_mm = last_mm;
            last_mm = self.settle(residual, FEW_PASSES, progress)?;
            if self.repeats && last_mm < until_mm {
                break;
            }
        }
        Ok(last_mm)
    }

    /// The set that presses after at most so many passes, for rows that stay as they are, and the answer with it; how far the
    /// answer moved, in mm.
    fn settle(
        &mut self,
        relative_residual: f64,
        most_passes: usize,
        progress: &dyn Progress,
    ) -> Result<f64, ModelError> {
        let free = self.problem.free();
        let of_bones = self.problem.surfaces.movement_of_bones();
        let movement = self.share * free.iter().map(Vector::norm).fold(of_bones, f64::max);
        let gaps: Vec<f64> =
            self.kept_rows.rows.iter().map(|row| row.gap_after_part(free, self.share)).collect();
        let mut set = ActiveSet::of_gaps(&gaps, movement);
        if self.has_touched() {
            set.presses = self
                .kept_rows
                .rows
                .iter()
                .map(|row| self.kept_rows.pressing.contains(&row.node))
                .collect();
        }
        let task = Task {
            gaps: &gaps,
            movement,
            relative_residual,
            first_residual: ON_THE_WAY,
            most_passes,
            before: &[],
            left: &[],
            progress,
        };
        let rows = self.kept_rows.rows.iter();
        let pressed = rows.map(|row| self.pressed.get(&row.node).copied().unwrap_or_default());
        let start = Point { x: std::mem::take(&mut self.added.x), multipliers: pressed.collect() };
        let settled = set.settle(&mut self.equations, &task, start)?;
        self.effort.count(&settled);
        self.relative_residual = settled.relative_residual;
        self.repeats = settled.repeats;
        let SettledSet { point, rows: active, .. } = settled;
        (self.added, self.active) = (point, active);
        let forces = self.pressing().map(|(row, force)| (self.kept_rows.rows[row].node, force));
        self.pressed = forces.collect();
        self.kept_rows.pressing = self.pressed.keys().copied().collect();
        let displacement = self.moved();
        let pairs = self.displacement.iter().zip(&displacement);
        let moved_mm = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
        self.before = std::mem::replace(&mut self.displacement, displacement);
        self.reached = self.share;
        Ok(moved_mm)
    }

    /// The rows that press, with their forces in mN.
    fn pressing(&self) -> impl Iterator<Item = (usize, f64)> {
        self.active.iter().copied().zip(self.added.multipliers.iter().copied())
    }

    /// Displacements by row that contact adds.
    fn added_by_row(&self) -> Vec<[[f64; 1]; 3]> {
        self.problem.system.stiffness.by_row(&self.added.x)
    }

    /// The part of the answer without contact, and what contact adds to it.
    fn moved(&self) -> Vec<Vector> {
        let added = self.problem.system.constrained().displacement(&self.added_by_row());
        let free = self.problem.free().iter();
        free.zip(added).map(|(free, added)| free * self.share + added).collect()
    }

    /// At the end of the movement.
    fn answer(self, last_moved_mm: f64) -> InContact<'a> {
        let Rounds { effort, relative_residual, .. } = self;
        let found = self.kept_rows.contact(self.pressing(), &self.displacement);
        let contact = Contact { effort, last_moved_mm, relative_residual, ..found };
        let solved = self.solved(&contact.forces);
        let Rounds { problem, equations, active: rows, .. } = self;
        let pressing = Pressing { system: problem.system, equations, rows };
        InContact { solved, contact, pressing }
    }

    fn solved(&self, forces: &[Vector]) -> Solved {
        let ContactProblem { system, free, .. } = self.problem;
        let (_, p) = self.added.x.split_at(3 * system.stiffness.ordering.free);
        let constrained = system.constrained();
        let held = vec![Vector::zeros(); system.constraints.len()];
        let known =
            constrained.known(&LoadCase { held, forces: forces.to_vec(), ..LoadCase::default() });
        let internal = system.internal_at_constraints(&self.added_by_row(), p);
        let reactions = constrained.reactions(&internal, &known.force);
        let Solved { equilibrium: free, pressures } = free;
        let sum = |(one, other): (&Vector, &Vector)| one + other;
        Solved {
            equilibrium: Equilibrium {
                displacement: self.displacement.clone(),
                reactions: free.reactions.iter().zip(&reactions).map(sum).collect(),
                solver: free.solver.clone(),
                warnings: free.warnings.clone(),
                states: Default::default(),
            },
            pressures: pressures.iter().zip(p).map(|(free, [added])| free + added).collect(),
        }
    }
}
