//! What the arrays of a file mean: node sets, cell sets, labels and vectors.
//!
//! A point array `set_NAME` is the node set NAME and a cell array `elset_NAME` the cell set NAME,
//! where non-zero means in. Every other integer array with at most [`MOST_LABELS`] values is a
//! label array. Real arrays of three components are vectors. The rest is ignored by name.

use std::collections::BTreeSet;

use super::error::FormatError;
use super::limits::ReadLimits;
use crate::mesh::{TriangleSurface, Vector, VolumeMesh, Warning};

/// An integer array with more different values is a numbering and not a label.
pub const MOST_LABELS: usize = 64;

/// As many ignored arrays are named in a report; the rest is counted.
const MOST_IGNORED_NAMES: usize = 100;

/// The values of an array, one or three for each point or cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Integers(Vec<i64>),
    Vectors(Vec<Vector>),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct NamedArray {
    pub name: String,
    pub values: Values,
}

/// Arrays as a reader found them, before the mesh that they belong to is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Arrays {
    pub points: Vec<NamedArray>,
    pub cells: Vec<NamedArray>,
    pub ignored: Vec<String>,
}

impl Arrays {
    /// Whether an array of points or cells can mean something; one that cannot is noted and need not be
    /// decoded.
    pub fn wants(&mut self, name: &str, components: u64, is_integer: bool) -> bool {
        let wanted = match is_integer {
            true => components == 1,
            false => components == 3,
        };
        let wanted = wanted && !name.trim().is_empty();
        if !wanted {
            self.ignored.push(name.to_string());
        }
        wanted
    }

    /// The names of ignored arrays, shortened to what a report can hold.
    pub fn ignored_names(mut self, limits: &ReadLimits) -> Vec<String> {
        let more = self.ignored.len().saturating_sub(MOST_IGNORED_NAMES);
        self.ignored.truncate(MOST_IGNORED_NAMES);
        for name in &mut self.ignored {
            *name = name.chars().take(limits.name_length as usize).collect();
        }
        if more > 0 {
            self.ignored.push(format!("and {more} more"));
        }
        self.ignored
    }

    /// Moves every array of a surface to its place: only `node_id` has one.
    pub fn move_to_surface(&mut self, surface: &mut TriangleSurface) {
        for array in self.points.drain(..) {
            let node_ids = match array.values {
                Values::Integers(values) if array.name.trim() == "node_id" => as_nodes(&values),
                _ => None,
            };
            match node_ids {
                Some(ids) if surface.node_ids.is_none() => surface.node_ids = Some(ids),
                _ => self.ignored.push(array.name),
            }
        }
        let cells = self.cells.drain(..);
        self.ignored.extend(cells.map(|array| array.name));
    }

    /// Moves every array of a volume mesh to its place.
    pub fn move_to_volume(
        &mut self,
        mesh: &mut VolumeMesh,
        warnings: &mut Vec<Warning>,
        limits: &ReadLimits,
    ) -> Result<(), FormatError> {
        for array in std::mem::take(&mut self.points) {
            self.place_point_array(array, mesh, warnings, limits)?;
        }
        for array in std::mem::take(&mut self.cells) {
            self.place_cell_array(array, mesh, warnings, limits)?;
        }
        Ok(())
    }

    fn place_cell_array(
        &mut self,
        array: NamedArray,
        mesh: &mut VolumeMesh,
        warnings: &mut Vec<Warning>,
        limits: &ReadLimits,
    ) -> Result<(), FormatError> {
        let name = checked_name(&array.name, limits)?;
        match array.values {
            Values::Vectors(mut vectors) => {
                // Directions often have no value where there is no muscle.
                let wrong = vectors.iter_mut().filter(|vector| !is_finite(**vector));
                let count = wrong.map(|vector| *vector = Vector::zeros()).count();
                if count > 0 {
                    let detail = format!(
                        "cell array {name:?} has {count} vectors that are not finite; they are taken as zero"
                    );
                    let warning = Warning::new("array-nonfinite", detail);
                    warnings.push(warning.with("count", count as f64));
                }
                insert(&mut mesh.cell_vectors, name, vectors)
            }
            Values::Integers(values) => {
                if let Some(set) = set_name(&name, "elset_") {
                    insert(&mut mesh.cell_sets, set.to_string(), members(&values))
                } else if has_few_values(&values) {
                    insert(&mut mesh.cell_labels, name, values)
                } else {
                    self.ignored.push(name);
                    Ok(())
                }
            }
        }
    }

    fn place_point_array(
        &mut self,
        array: NamedArray,
        mesh: &mut VolumeMesh,
        warnings: &mut Vec<Warning>,
        limits: &ReadLimits,
    ) -> Result<(), FormatError> {
        let name = checked_name(&array.name, limits)?;
        match array.values {
            Values::Vectors(vectors) if vectors.iter().all(|vector| is_finite(*vector)) => {
                insert(&mut mesh.node_vectors, name, vectors)
            }
            Values::Vectors(_) => {
                let detail = format!("point array {name:?} holds values that are not finite");
                warnings.push(Warning::new("array-nonfinite", detail));
                self.ignored.push(name);
                Ok(())
            }
            Values::Integers(values) => {
                if let Some(set) = set_name(&name, "set_") {
                    insert(&mut mesh.node_sets, set.to_string(), members(&values))
                } else if name != "node_id" && has_few_values(&values) {
                    insert(&mut mesh.node_labels, name, values)
                } else {
                    self.ignored.push(name);
                    Ok(())
                }
            }
        }
    }
}

pub(super) fn is_finite(vector: Vector) -> bool {
    vector.iter().all(|component| component.is_finite())
}

fn as_nodes(values: &[i64]) -> Option<Vec<u32>> {
    let nodes = values.iter().map(|&value| u32::try_from(value).ok());
    nodes.collect()
}

fn set_name<'a>(name: &'a str, prefix: &str) -> Option<&'a str> {
    let set = name.strip_prefix(prefix)?.trim();
    (!set.is_empty()).then_some(set)
}

fn members(values: &[i64]) -> Vec<u32> {
    let numbered = values.iter().enumerate();
    let inside = numbered.filter(|(_, value)| **value != 0);
    inside.map(|(number, _)| number as u32).collect()
}

/// Whether an array has no more different values than a label array may have.
pub(super) fn has_few_values(values: &[i64]) -> bool {
    let mut found = BTreeSet::new();
    let mut last = None;
    for &value in values {
        if last != Some(value) {
            found.insert(value);
            last = Some(value);
        }
        if found.len() > MOST_LABELS {
            return false;
        }
    }
    true
}

/// A name without surrounding space; refuses one that is too long or cannot be written as XML.
pub(super) fn checked_name(name: &str, limits: &ReadLimits) -> Result<String, FormatError> {
    let name = name.trim();
    let length = name.chars().count() as u64;
    if length > limits.name_length {
        return Err(FormatError::Limits {
            what: "characters in the name of a set or array",
            declared: length,
            limit: limits.name_length,
        });
    }
    let unwritable =
        |character: char| character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}');
    if name.contains(unwritable) {
        return Err(FormatError::Name { detail: format!("{name:?} holds a control character") });
    }
    Ok(name.to_string())
}

/// Adds a set or an array under a name that must not be taken.
pub(super) fn insert<T>(
    named: &mut std::collections::BTreeMap<String, T>,
    name: String,
    values: T,
) -> Result<(), FormatError> {
    if named.contains_key(&name) {
        return Err(FormatError::Name {
            detail: format!("two sets or arrays are called {name:?}"),
        });
    }
    named.insert(name, values);
    Ok(())
}
