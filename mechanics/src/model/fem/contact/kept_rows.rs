//! Contact constraints kept between rounds: unchanged ones stay as they are, so that a point that slides over an edge
//! does not alternate between faces.

use std::collections::{BTreeMap, BTreeSet};

use super::touch::{Contact, PressingRow, forces_of};
use crate::boundary::contact::{Alike, ContactRow};
use crate::mesh::Vector;

/// The rows of one round, by node.
#[derive(Clone, Debug, Default)]
pub(in crate::model::fem) struct KeptRows {
    pub rows: Vec<ContactRow>,
    /// Nodes whose rows press.
    pub pressing: BTreeSet<u32>,
}

/// Result of a round.
pub(in crate::model::fem) struct Round {
    /// For each row its number of before, where it stays as it was.
    pub same: Vec<Option<usize>>,
    /// Rows that say something new of what presses or nearly does.
    pub new: usize,
}

impl KeptRows {
    /// Takes up the rows found after a displacement and a share of the movement of bones, but for those that are alike.
    pub fn take(
        &mut self,
        mut found: Vec<ContactRow>,
        alike: Alike,
        displacement: &[Vector],
        share: f64,
    ) -> Round {
        let before: BTreeMap<u32, usize> =
            self.rows.iter().enumerate().map(|(place, row)| (row.node, place)).collect();
        let mut round = Round { same: vec![None; found.len()], new: 0 };
        for (row, same) in found.iter_mut().zip(&mut round.same) {
            let old = before.get(&row.node).copied();
            *same = old.filter(|&old| self.rows[old].agrees(row, alike, displacement, share));
            match *same {
                Some(old) => *row = self.rows[old].clone(),
                None => {
                    let is_near = row.is_near(displacement, share);
                    let counts = is_near || self.pressing.contains(&row.node);
                    round.new += usize::from(counts);
                }
            }
        }
        let has = |node: &u32| found.binary_search_by_key(node, |row| row.node).is_ok();
        let lost = before.keys().filter(|node| self.pressing.contains(node) && !has(node));
        round.new += lost.count();
        self.rows = found;
        round
    }

    /// Contact constraints with these numbers and multipliers.
    pub fn pressed(&self, pressing: impl Iterator<Item = (usize, f64)>) -> Vec<PressingRow> {
        pressing.map(|(row, force)| PressingRow { row: self.rows[row].clone(), force }).collect()
    }

    /// Their nodal forces in mN, for so many nodes.
    pub fn forces(&self, pressed: impl Iterator<Item = (usize, f64)>, nodes: usize) -> Vec<Vector> {
        forces_of(&self.pressed(pressed), nodes)
    }

    /// By node, the gap in mm after a displacement and a share of the movement of bones.
    pub fn gaps(&self, displacement: &[Vector], share: f64) -> BTreeMap<u32, f64> {
        self.rows.iter().map(|row| (row.node, row.gap_after(displacement, share))).collect()
    }

    /// The contact of an answer, all movement made, in which rows with these numbers press with forces in mN.
    pub fn contact(
        &self,
        pressing: impl Iterator<Item = (usize, f64)>,
        displacement: &[Vector],
    ) -> Contact {
        let pressed = self.pressed(pressing);
        Contact {
            gaps: self.gaps(displacement, 1.0),
            forces: forces_of(&pressed, displacement.len()),
            pressed,
            ..Contact::default()
        }
    }
}
