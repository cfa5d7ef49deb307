//! An answer of linear elasticity in which nothing passes through what it faces: closest points, the set that presses, and
//! closest points again until they stay.

use std::collections::{BTreeMap, BTreeSet};

use super::active_set::{ActiveSet, Settled, Task};
use super::equations::FreeUnknowns;
use crate::boundary::contact::{ContactRow, FacingSurfaces};
use crate::mesh::Vector;
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::Progress;
use crate::solver::constrained::{Equations, Point};
use crate::solver::preconditioned::Preconditioned;

/// Closest points that move the answer less than this, in mm, are those of the answer.
const STAY_MM: f64 = 1e-6;

/// Beyond this, in mm, an answer is none.
const UNSETTLED_MM: f64 = 0.1;

/// How often closest points are looked for again.
const MOST_ROUNDS: usize = 12;

/// Where the answer moves by more than this part of its last movement, closest points are those half the way.
const SLOW: f64 = 0.5;

/// A linear system, its answer without contact, and what may touch.
pub struct ContactProblem<'a> {
    pub system: &'a LinearSystem<'a>,
    pub free: &'a Solved,
    pub surfaces: &'a FacingSurfaces<'a>,
    pub relative_residual: f64,
}

/// A row that presses.
#[derive(Clone, Debug, PartialEq)]
pub struct Pressed {
    pub row: ContactRow,
    /// In mN, never below 0 but for rounding.
    pub force: f64,
}

/// How tissue presses on what it touches.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    pub pressed: Vec<Pressed>,
    /// For each node that faces another part of the boundary, the gap in mm.
    pub gaps: BTreeMap<u32, f64>,
    /// In mN, for each node.
    pub forces: Vec<Vector>,
    /// Solutions for a set, in all; how many of them changed the set.
    pub passes: usize,
    pub changes: usize,
    /// Rows that press because they changed too often.
    pub kept: usize,
    /// How often closest points were looked for, and how far they moved the last time, in mm.
    pub rounds: usize,
    pub last_moved_mm: f64,
    pub iterations: usize,
    pub relative_residual: f64,
}

/// An answer with contact.
pub struct InContact {
    pub solved: Solved,
    pub contact: Contact,
}

impl ContactProblem<'_> {
    /// The answer with contact; none where nothing touches.
    pub fn solve(&self, progress: &dyn Progress) -> Result<Option<InContact>, ModelError> {
        let free = &self.free.equilibrium.displacement;
        let Some(mut rows) = self.closing_rows(free) else { return Ok(None) };
        let matrix = self.system.preconditioned();
        let mut tried =
            Tried { looked_from: vec![Vector::zeros(); free.len()], ..Tried::default() };
        let mut last = self.round(&matrix, rows, &mut tried, progress)?;
        while last.contact.last_moved_mm >= STAY_MM && tried.rounds < MOST_ROUNDS {
            let displacement = &last.solved.equilibrium.displacement;
            let share = if tried.is_slow() { 0.5 } else { 1.0 };
            let places = tried.looked_from.iter_mut().zip(displacement);
            places.for_each(|(from, u)| *from += (u - *from) * share);
            rows = self.rows(&tried.looked_from);
            last = self.round(&matrix, rows, &mut tried, progress)?;
        }
        match last.contact.last_moved_mm > UNSETTLED_MM {
            true => {
                let (passes, moved_mm) = (tried.passes, last.contact.last_moved_mm);
                Err(ModelError::ContactUnsettled { passes, moved_mm })
            }
            false => Ok(Some(last)),
        }
    }

    /// The rows at rest, or where these stay open those of the answer without contact; none where all stay open.
    fn closing_rows(&self, free: &[Vector]) -> Option<Vec<ContactRow>> {
        let closes = |row: &ContactRow| row.gap_after(free) < -STAY_MM;
        let at_rest = self.rows(&vec![Vector::zeros(); free.len()]);
        if at_rest.iter().any(closes) {
            return Some(at_rest);
        }
        let moved = self.rows(free);
        moved.iter().any(closes).then_some(moved)
    }

    /// The set that presses, for rows that stay as they are, and the answer with it.
    fn round(
        &self,
        matrix: &Preconditioned,
        rows: Vec<ContactRow>,
        tried: &mut Tried,
        progress: &dyn Progress,
    ) -> Result<InContact, ModelError> {
        let free = &self.free.equilibrium.displacement;
        let movement = free.iter().map(Vector::norm).fold(0.0, f64::max);
        let gaps: Vec<f64> = rows.iter().map(|row| row.gap_after(free)).collect();
        let unknowns = FreeUnknowns::new(self.system.holds, &self.system.numbering);
        let equations = rows.iter().map(|row| unknowns.equation(row)).collect();
        let mut equations = Equations::new(matrix, equations);
        let mut set = ActiveSet::of_gaps(&gaps, movement);
        if tried.rounds > 0 {
            set.presses = rows.iter().map(|row| tried.pressing.contains(&row.node)).collect();
        }
        let relative_residual = self.relative_residual;
        let task = Task { gaps: &gaps, movement, relative_residual, progress };
        let start = Point { x: std::mem::take(&mut tried.x), multipliers: Vec::new() };
        let settled = set.settle(&mut equations, &task, start)?;
        tried.count(&settled);
        if !settled.repeats {
            let (passes, moved_mm) = (tried.passes, f64::INFINITY);
            return Err(ModelError::ContactUnsettled { passes, moved_mm });
        }
        let Settled { point, rows: active, kept, relative_residual, .. } = settled;
        let forces = self.forces(&rows, &active, &point.multipliers);
        let solved = self.moved(&point, &forces);
        let displacement = &solved.equilibrium.displacement;
        tried.moves_to(displacement);
        let pressed = active.iter().zip(&point.multipliers);
        let pressed: Vec<Pressed> =
            pressed.map(|(&row, &force)| Pressed { row: rows[row].clone(), force }).collect();
        tried.pressing = pressed.iter().map(|pressed| pressed.row.node).collect();
        tried.x = point.x;
        let gaps = rows.iter().map(|row| (row.node, row.gap_after(displacement))).collect();
        let Tried { passes, changes, iterations, rounds, last_moved_mm, .. } = *tried;
        let contact = Contact {
            pressed,
            gaps,
            forces,
            passes,
            changes,
            kept,
            rounds,
            last_moved_mm,
            iterations,
            relative_residual,
        };
        Ok(InContact { solved, contact })
    }

    /// The rows that take of a free unknown.
    fn rows(&self, displacement: &[Vector]) -> Vec<ContactRow> {
        let unknowns = FreeUnknowns::new(self.system.holds, &self.system.numbering);
        let mut rows = self.surfaces.rows(displacement);
        rows.retain(|row| !unknowns.equation(row).is_empty());
        rows
    }

    /// What presses on each node.
    fn forces(&self, rows: &[ContactRow], active: &[usize], multipliers: &[f64]) -> Vec<Vector> {
        let mut forces = vec![Vector::zeros(); self.free.equilibrium.displacement.len()];
        for (&row, force) in active.iter().zip(multipliers) {
            for (node, along) in &rows[row].terms {
                forces[*node as usize] += along * *force;
            }
        }
        forces
    }

    /// The answer without contact, and what contact adds to it.
    fn moved(&self, added: &Point, forces: &[Vector]) -> Solved {
        let system = self.system;
        let rows = system.stiffness.matrix.rows();
        let mut total = vec![[[0.0]; 3]; rows];
        let (u, p) = added.x.split_at(3 * system.stiffness.layout.free);
        total.iter_mut().zip(u.as_chunks::<3>().0).for_each(|(total, u)| *total = *u);
        let constrained = system.constrained();
        let held = vec![Vector::zeros(); system.holds.len()];
        let known =
            constrained.known(&LoadCase { held, forces: forces.to_vec(), ..LoadCase::default() });
        let internal = system.internal_at_holds(&total, p);
        let reactions = constrained.reactions(&internal, &known.force);
        let Solved { equilibrium: free, pressures } = self.free;
        let sum = |one: &[Vector], other: &[Vector]| -> Vec<Vector> {
            one.iter().zip(other).map(|(one, other)| one + other).collect()
        };
        Solved {
            equilibrium: Equilibrium {
                displacement: sum(&free.displacement, &constrained.displacement(&total)),
                reactions: sum(&free.reactions, &reactions),
                solver: free.solver.clone(),
                warnings: free.warnings.clone(),
            },
            pressures: pressures.iter().zip(p).map(|(free, [added])| free + added).collect(),
        }
    }
}

/// What rounds so far have found.
#[derive(Default)]
struct Tried {
    /// The displacement at which closest points were looked for.
    looked_from: Vec<Vector>,
    displacement: Vec<Vector>,
    /// What contact adds.
    x: Vec<[f64; 1]>,
    pressing: BTreeSet<u32>,
    passes: usize,
    changes: usize,
    iterations: usize,
    rounds: usize,
    /// In mm; infinite before there are two answers.
    last_moved_mm: f64,
    before_mm: f64,
}

impl Tried {
    fn count(&mut self, settled: &Settled) {
        self.rounds += 1;
        self.passes += settled.passes;
        self.changes += settled.changes;
        self.iterations += settled.iterations;
    }

    fn moves_to(&mut self, displacement: &[Vector]) {
        let pairs = self.displacement.iter().zip(displacement);
        let farthest = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
        self.before_mm = self.last_moved_mm;
        self.last_moved_mm = if self.displacement.is_empty() { f64::INFINITY } else { farthest };
        self.displacement = displacement.to_vec();
    }

    fn is_slow(&self) -> bool {
        self.rounds > 2 && self.last_moved_mm > SLOW * self.before_mm
    }
}
