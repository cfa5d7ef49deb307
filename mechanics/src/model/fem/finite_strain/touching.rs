//! Contact while Newton's method goes on: which points press, with the forces that they press with, found anew at each tangent
//! by the active set of `contact`.
//!
//! At x with forces G^T m the step d without a change of contact meets K d = f - f_int + G^T m; what presses then follows from
//! K a = G^T (m' - m), g(x + d + a) >= 0, m' >= 0, m' g = 0, and the step is d + a. Where K is not positive definite d is no solution,
//! and a answers to what it leaves, too: tissue that buckles by itself may be held by what it presses on.

use std::collections::{BTreeMap, BTreeSet};

use crate::boundary::Constraint;
use crate::boundary::contact::{Alike, CLOSED_MM, ContactRow, FacingSurfaces, with_pressing};
use crate::mesh::Vector;
use crate::model::dofs::DofMap;
use crate::model::fem::contact::{
    ALTERNATES, ActiveSet, Contact, Effort, FreeUnknowns, KeptRows, MOST_PASSES, MOST_ROUNDS,
    PressedStep, Task, UNSETTLED_MM, forces_of,
};
use crate::model::problem::ModelError;
use crate::progress::Progress;
use crate::solver::SolverError;
use crate::solver::constrained::{Equations, Point};
use crate::solver::preconditioned::Preconditioned;

/// Relative residual of what contact adds to a step.
const LOOSELY: f64 = 1e-3;

/// How often rows take the normals of the state once bones rest: each time Newton's method goes on.
const EXACT_ROUNDS: usize = 6;

/// Rounds after which what points move the state by says that they alternate: before, it is tissue that comes to rest.
const FIRST_ROUNDS: usize = 2;

/// What touches, at one state of tissue and bones.
#[derive(Clone)]
pub(super) struct Touching<'a> {
    surfaces: &'a FacingSurfaces<'a>,
    unknowns: FreeUnknowns<'a>,
    kept_rows: KeptRows,
    /// Of each row, in mN.
    multipliers: Vec<f64>,
    /// The part of the movement that one step may make.
    pub most_ahead: f64,
    /// Rounds since the bones rest.
    late_rounds: usize,
    /// Rounds of these in which rows took the normals of the state.
    exact_rounds: usize,
    /// Rows that said something new in the last round.
    new: usize,
    /// The displacement of the last round, and by how much it differs from that of the round before, in mm; infinite in the first.
    last: Vec<Vector>,
    last_moved_mm: f64,
    /// Whether the set that presses repeated at the last step.
    repeats: bool,
    /// A node that began or ceased to press in the last step.
    changed: Option<u32>,
    effort: Effort,
    /// What pressed at the end of each load step.
    at_load_steps: Vec<PressedStep>,
}

/// What contact changes of a step.
pub(super) struct Change {
    /// Of unknowns: three for each free row, then the pressures.
    pub step: Vec<[f64; 1]>,
    /// Forces of the rows in mN after a whole step.
    pub multipliers: Vec<f64>,
}

/// A state that contact is looked for at.
pub(super) struct TrialState<'a> {
    /// Displacements after the step without a change of contact, by node.
    pub displacement: &'a [Vector],
    /// The share of the movement of bones after it.
    pub share: f64,
    /// Forces in mN that the step leaves, by unknown, where the tangent is not positive definite: what presses may hold tissue that
    /// buckles without it. Nothing otherwise.
    pub left: &'a [[f64; 1]],
    /// The norm of the forces in mN that the step is to balance, and the part of it that may be left.
    pub unbalanced: f64,
    pub relative: f64,
    pub progress: &'a dyn Progress,
}

impl<'a> Touching<'a> {
    pub fn new(
        surfaces: &'a FacingSurfaces<'a>,
        constraints: &[Constraint],
        dof_map: &'a DofMap,
        most_ahead: f64,
    ) -> Self {
        Touching {
            surfaces,
            unknowns: FreeUnknowns::new(constraints, dof_map),
            kept_rows: KeptRows::default(),
            multipliers: Vec::new(),
            most_ahead,
            late_rounds: 0,
            exact_rounds: 0,
            new: 0,
            last: Vec::new(),
            last_moved_mm: f64::INFINITY,
            repeats: true,
            changed: None,
            effort: Effort::default(),
            at_load_steps: Vec::new(),
        }
    }

    /// Looks for what faces what after a displacement and a share of the movement of bones; once the bones rest, only so often.
    pub fn look(&mut self, displacement: &[Vector], share: f64, bones_rest: bool) {
        if !bones_rest {
            (self.late_rounds, self.exact_rounds) = (0, 0);
        }
        self.late_rounds += usize::from(bones_rest);
        self.new = 0;
        if self.late_rounds > MOST_ROUNDS {
            return;
        }
        let half_way = self.half_way(displacement);
        let displacement = half_way.as_deref().unwrap_or(displacement);
        let rows = self.kept_rows.rows.iter().zip(&self.multipliers);
        let before: BTreeMap<u32, f64> = rows.map(|(row, m)| (row.node, *m)).collect();
        let mut found = self.surfaces.rows(displacement, share);
        found.retain(|row| !self.unknowns.equation(row).is_empty());
        let is_late = bones_rest && self.exact_rounds < EXACT_ROUNDS;
        let again = is_late.then(|| found.clone());
        self.new = self.kept_rows.take(found, Alike::Nearly, displacement, share).new;
        if let (0, Some(found)) = (self.new, again) {
            self.exact_rounds += 1;
            self.new = self.kept_rows.take(found, Alike::Exactly, displacement, share).new;
        }
        let rows = self.kept_rows.rows.iter();
        self.multipliers =
            rows.map(|row| before.get(&row.node).copied().unwrap_or_default()).collect();
    }

    /// Half way between a displacement of tissue and that of the round before, where points alternate between two states.
    fn half_way(&mut self, displacement: &[Vector]) -> Option<Vec<Vector>> {
        let last = std::mem::replace(&mut self.last, displacement.to_vec());
        let pairs = || displacement.iter().zip(&last);
        let moved_mm = match last.is_empty() {
            true => f64::INFINITY,
            false => pairs().map(|(u, last)| (u - last).norm()).fold(0.0, f64::max),
        };
        let before_mm = std::mem::replace(&mut self.last_moved_mm, moved_mm);
        let alternates = self.late_rounds > FIRST_ROUNDS && moved_mm > ALTERNATES * before_mm;
        alternates.then(|| pairs().map(|(u, last)| (u + last) * 0.5).collect())
    }

    /// Whether nothing of contact is left to do after a displacement and a share of the movement of bones. Where nothing moves any
    /// more, rows that others determine, as of two nodes that face each other, keep what their normals differ by.
    pub fn rests(&self, displacement: &[Vector], share: f64) -> bool {
        let stands = self.last_moved_mm <= CLOSED_MM;
        let is_met = || self.deepest(displacement, share) <= CLOSED_MM;
        self.new == 0 && self.repeats && (stands || is_met())
    }

    /// What presses on each node, in mN.
    pub fn forces(&self, nodes: usize) -> Vec<Vector> {
        self.kept_rows.forces(self.pressing(), nodes)
    }

    pub fn presses(&self) -> bool {
        self.pressing().next().is_some()
    }

    /// The rows that press, with their forces in mN.
    fn pressing(&self) -> impl Iterator<Item = (usize, f64)> {
        let forces = self.multipliers.iter().copied().enumerate();
        forces.filter(|(_, force)| *force != 0.0)
    }

    /// Holds of tissue, with those of the points that press, also where the rows of what they face have all of the force.
    pub fn held(&self, constraints: &[Constraint]) -> Vec<Constraint> {
        let KeptRows { rows, pressing } = &self.kept_rows;
        with_pressing(constraints, rows.iter().filter(|row| pressing.contains(&row.node)))
    }

    /// What presses after a step, and what that changes of it; nothing where nothing presses before and after.
    pub fn change(
        &mut self,
        matrix: Preconditioned,
        ahead: &TrialState,
    ) -> Result<Option<Change>, SolverError> {
        let rows = &self.kept_rows.rows;
        let gaps: Vec<f64> =
            rows.iter().map(|row| row.gap_after(ahead.displacement, ahead.share)).collect();
        let of_bones = ahead.share * self.surfaces.movement_of_bones();
        let movement = ahead.displacement.iter().map(Vector::norm).fold(of_bones, f64::max);
        let mut set = ActiveSet::of_gaps(&gaps, movement);
        for (presses, row) in set.presses.iter_mut().zip(rows) {
            *presses |= self.kept_rows.pressing.contains(&row.node);
        }
        self.repeats = true;
        if set.presses.iter().all(|presses| !presses) {
            self.changed = self.kept_rows.pressing.pop_first();
            self.kept_rows.pressing.clear();
            return Ok(None);
        }
        let pressing: f64 = self.multipliers.iter().map(|m| m * m).sum::<f64>().sqrt();
        let relative_residual = match pressing > 0.0 {
            true => (ahead.relative * ahead.unbalanced / pressing).clamp(1e-12, LOOSELY),
            false => LOOSELY,
        };
        let equations = rows.iter().map(|row| self.unknowns.equation(row)).collect();
        let mut equations = Equations::new(matrix, equations);
        let (before, progress) = (&*self.multipliers, ahead.progress);
        let first_residual = LOOSELY;
        let task = Task {
            gaps: &gaps,
            movement,
            relative_residual,
            first_residual,
            most_passes: MOST_PASSES,
            before,
            left: ahead.left,
            progress,
        };
        let settled = set.settle(&mut equations, &task, Point::default())?;
        self.effort.count(&settled);
        self.repeats = settled.repeats;
        let (point, active) = (settled.point, settled.rows);
        let pressing: BTreeSet<u32> = active.iter().map(|&row| rows[row].node).collect();
        self.changed = self.kept_rows.pressing.symmetric_difference(&pressing).next().copied();
        self.kept_rows.pressing = pressing;
        let mut multipliers = vec![0.0; rows.len()];
        active.iter().zip(&point.multipliers).for_each(|(&row, m)| multipliers[row] = *m);
        Ok(Some(Change { step: point.x, multipliers }))
    }

    /// Takes up the forces of the rows in mN after a step; none where nothing presses.
    pub fn press(&mut self, mut multipliers: Vec<f64>) {
        multipliers.resize(self.kept_rows.rows.len(), 0.0);
        self.multipliers = multipliers;
    }

    /// Keeps what presses at the end of a load step, and on which area at these positions of all nodes.
    pub fn keep_load_step(&mut self, positions: &[Vector]) {
        let pressed = self.kept_rows.pressed(self.pressing());
        let areas = self.surfaces.areas(&forces_of(&pressed, positions.len()), positions);
        self.at_load_steps.push(PressedStep { pressed, areas });
    }

    /// How deep points lie behind what they face after a displacement and a share of the movement of bones, in mm.
    pub fn deepest(&self, displacement: &[Vector], share: f64) -> f64 {
        let gaps = self.kept_rows.rows.iter().map(|row| row.gap_after(displacement, share));
        gaps.fold(0.0, |most, gap| most.max(-gap))
    }

    /// What ends without an answer.
    pub fn unsettled(&self, moved_mm: f64) -> ModelError {
        ModelError::ContactUnsettled { passes: self.effort.passes, moved_mm }
    }

    /// What ends after so many steps with forces in balance to a residual: points that begin and cease to press, or go deeper than
    /// what they face each time that this is looked for.
    pub fn alternates(
        &mut self,
        displacement: &[Vector],
        share: f64,
        steps: usize,
        residual: f64,
    ) -> ModelError {
        self.late_rounds = 0;
        self.look(displacement, share, true);
        let gap = |row: &ContactRow| row.gap_after(displacement, share);
        let nearest = self.kept_rows.rows.iter().min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let deepest = nearest.filter(|row| gap(row) < -CLOSED_MM).map(|row| row.node);
        let node = deepest.or(self.changed).or(nearest.map(|row| row.node));
        let place = node.map(|node| self.surfaces.rest_positions()[node as usize].into());
        let depth_mm = self.deepest(displacement, share);
        ModelError::ContactAlternates { steps, residual, depth_mm, place }
    }

    /// The contact of an answer; none where nothing presses, at the end of load steps either.
    pub fn answer(
        mut self,
        displacement: &[Vector],
        relative_residual: f64,
    ) -> Result<Option<Contact>, ModelError> {
        let found = self.kept_rows.contact(self.pressing(), displacement);
        // Where points were not looked for any more, what a last look finds is what they still move by.
        self.late_rounds = 0;
        self.look(displacement, 1.0, true);
        let last_moved_mm = self.deepest(displacement, 1.0);
        if last_moved_mm > UNSETTLED_MM {
            return Err(self.unsettled(last_moved_mm));
        }
        let Touching { effort, kept_rows, at_load_steps, .. } = self;
        let gaps = kept_rows.gaps(displacement, 1.0);
        let rows = at_load_steps.iter().map(|step| &step.pressed).chain([&found.pressed]);
        let has_pressed = rows.into_iter().any(|rows| !rows.is_empty());
        let contact =
            Contact { gaps, effort, last_moved_mm, relative_residual, at_load_steps, ..found };
        Ok(has_pressed.then_some(contact))
    }
}
