//! Contact result of a solution: contact forces, gaps, and the work of the search.

use std::collections::BTreeMap;

use super::active_set::SettledSet;
use crate::boundary::contact::ContactRow;
use crate::mesh::Vector;

/// A row that presses.
#[derive(Clone, Debug, PartialEq)]
pub struct PressingRow {
    pub row: ContactRow,
    /// In mN, below 0 by more than rounding only where it is kept (`Effort::kept`).
    pub force: f64,
}

/// How tissue presses on what it touches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contact {
    pub pressed: Vec<PressingRow>,
    /// For each node that faces another part of the boundary, the gap in mm.
    pub gaps: BTreeMap<u32, f64>,
    /// In mN, for each node.
    pub forces: Vec<Vector>,
    pub effort: Effort,
    /// How far closest points moved the answer when they were looked for the last time, in mm.
    pub last_moved_mm: f64,
    pub relative_residual: f64,
    /// What pressed at the end of each load step; empty where none were asked for.
    pub at_load_steps: Vec<PressedStep>,
}

/// What presses at the end of a load step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PressedStep {
    pub pressed: Vec<PressingRow>,
    /// For each node in mm², as tissue is deformed then.
    pub areas: BTreeMap<u32, f64>,
}

/// Nodal forces in mN of rows that press, for so many nodes.
pub fn forces_of(pressed: &[PressingRow], nodes: usize) -> Vec<Vector> {
    let mut forces = vec![Vector::zeros(); nodes];
    for PressingRow { row, force } in pressed {
        for (node, along) in &row.terms {
            forces[*node as usize] += along * *force;
        }
    }
    forces
}

/// Cost of the search for the active set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Solutions for a set, in all; how many of them changed the set.
    pub passes: usize,
    pub changes: usize,
    /// Rows that press in the end because they changed too often.
    pub kept: usize,
    /// How often closest points were looked for.
    pub rounds: usize,
    pub iterations: usize,
}

impl Effort {
    /// Counts one more round.
    pub fn count(&mut self, settled: &SettledSet) {
        self.rounds += 1;
        self.passes += settled.passes;
        self.changes += settled.changes;
        self.kept = settled.kept;
        self.iterations += settled.iterations;
    }
}
