//! Physical groups of Gmsh: those of volumes become cell sets and one label array, those of
//! surfaces, curves and points become node sets.

use std::collections::{BTreeMap, HashMap};

use crate::format::arrays::{NamedArray, Values};
use crate::format::cursor::Cursor;
use crate::format::error::FormatError;
use crate::format::parsed::Parsed;

/// The label array that holds the number of the first group of each cell.
const LABEL_ARRAY: &str = "gmsh:physical";

const VOLUME: u8 = 3;

/// Every element is added to all groups of its entity, so that this bounds the work on one.
const MOST_GROUPS_OF_AN_ENTITY: usize = 64;

#[derive(Debug, Default)]
pub(in crate::format) struct Groups {
    names: BTreeMap<(u8, i64), String>,
    of_entities: HashMap<(u8, i64), Vec<i64>>,
    /// Cells of volume groups, nodes of all others.
    members: BTreeMap<(u8, i64), Vec<u32>>,
    /// For each cell the number of its first group, 0 for none.
    pub cell_labels: Vec<i64>,
}

impl Groups {
    /// Lines `dimension number "name"`, as text in binary files too.
    pub fn read_names(&mut self, cursor: &mut Cursor<'_>) -> Result<(), FormatError> {
        let count = cursor.unsigned("a number of names")?;
        cursor.expect_words(count.saturating_mul(3))?;
        for _ in 0..count {
            let dimension = cursor.integer("a dimension")?;
            let number = cursor.integer("a group")?;
            let line = cursor.text_line().unwrap_or_default();
            let name = line.trim().trim_matches('"').to_string();
            let dimension = u8::try_from(dimension).ok().filter(|d| *d <= VOLUME);
            let Some(dimension) = dimension else {
                return Err(cursor.bad_line("a dimension is 0, 1, 2 or 3"));
            };
            self.names.insert((dimension, number), name);
        }
        Ok(())
    }

    /// An entity of the geometry belongs to a group. The sign tells orientation only.
    pub fn add_entity(
        &mut self,
        dimension: u8,
        entity: i64,
        group: i64,
    ) -> Result<(), FormatError> {
        let groups = self.of_entities.entry((dimension, entity)).or_default();
        groups.push(group.abs());
        if groups.len() > MOST_GROUPS_OF_AN_ENTITY {
            return Err(FormatError::Limits {
                what: "physical groups of one entity",
                declared: groups.len() as u64,
                limit: MOST_GROUPS_OF_AN_ENTITY as u64,
            });
        }
        Ok(())
    }

    pub fn of_entity(&self, dimension: i64, entity: i64) -> Vec<i64> {
        let dimension = u8::try_from(dimension).unwrap_or(u8::MAX);
        let groups = self.of_entities.get(&(dimension, entity));
        groups.cloned().unwrap_or_default()
    }

    /// Adds cells to a volume group, or nodes to any other.
    pub fn add(&mut self, dimension: u8, group: i64, members: &[u32]) {
        let group = self.members.entry((dimension, group.abs())).or_default();
        group.extend_from_slice(members);
    }

    pub fn move_to(self, parsed: &mut Parsed) {
        let mut has_volume_group = false;
        for ((dimension, number), mut members) in self.members {
            members.sort_unstable();
            members.dedup();
            // Unknown nodes are refused with their element; a set must not hold them.
            members.retain(|&member| member != u32::MAX);
            let name = self.names.get(&(dimension, number)).filter(|n| !n.is_empty());
            let unnamed = || format!("physical_{dimension}_{number}");
            let name = name.cloned().unwrap_or_else(unnamed);
            if dimension == VOLUME {
                parsed.cell_sets.push((name, members));
                has_volume_group = true;
            } else {
                parsed.node_sets.push((name, members));
            }
        }
        if has_volume_group {
            parsed.arrays.cells.push(NamedArray {
                name: LABEL_ARRAY.into(),
                values: Values::Integers(self.cell_labels),
            });
        }
    }
}
