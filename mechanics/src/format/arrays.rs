//! Meaning of the arrays of a file: node sets, cell sets, labels and vectors.
//!
//! A point array `set_NAME` is the node set NAME and a cell array `elset_NAME` the cell set NAME,
//! where non-zero means in. Every other integer array with at most [`ReadLimits::label_values`]
//! different values is a label array. Real arrays of three components are vectors. The rest is ignored,
//! and the mesh says which and why.

use std::collections::BTreeMap;

use super::error::FormatError;
use super::limits::ReadLimits;
use super::scalar::Scalar;
use crate::mesh::{IgnoredArrays, TriangleSurface, ValuesOf, Vector, VolumeMesh, Warning};

/// The label arrays of a file have as many values altogether as so many arrays with as many as one may
/// have: reports list them.
const FULL_LABEL_ARRAYS: u64 = 16;

const OF_A_SURFACE: &str = "belongs to a surface, of whose arrays a stored mesh keeps only the integer point array `node_id`";

/// The point array of a predicted surface that says how far each point was moved, in mm.
pub const DISPLACEMENT: &str = "displacement_mm";

/// What the file of a surface says of its points beside where they are. Comparisons read it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceArrays {
    /// How far each point was moved, in mm: the vectors [`DISPLACEMENT`].
    pub displacement: Option<Vec<Vector>>,
    /// Ascending points by the names of arrays `set_NAME`.
    pub sets: BTreeMap<String, Vec<u32>>,
}

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
    pub ignored: IgnoredArrays,
    /// The distinct values of all label arrays that were placed.
    label_values: u64,
}

/// What an announced array holds, and how many of them for each point or cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Integers(u64),
    Reals(u64),
    /// Text, and types that VTK may add.
    Other,
}

impl Kind {
    pub fn of(scalar: Option<Scalar>, components: u64) -> Kind {
        match scalar {
            None => Kind::Other,
            Some(scalar) if scalar.is_integer() => Kind::Integers(components),
            Some(_) => Kind::Reals(components),
        }
    }

    /// Why no mesh wants it.
    fn why_not(self) -> Option<String> {
        match self {
            Kind::Integers(1) | Kind::Reals(3) => None,
            Kind::Integers(components) => {
                Some(format!("holds {components} integers each, and labels are one"))
            }
            Kind::Reals(1) => Some("holds floating-point numbers, not integers".to_owned()),
            Kind::Reals(components) => Some(format!(
                "holds {components} floating-point numbers each, and vectors are three"
            )),
            Kind::Other => Some("holds neither integers nor floating-point numbers".to_owned()),
        }
    }
}

impl Arrays {
    /// Whether an array of points or cells can mean something; one that cannot is noted and need not be
    /// decoded.
    pub fn wants(&mut self, of: ValuesOf, name: &str, kind: Kind) -> bool {
        let nameless = name.trim().is_empty().then(|| "has no name".to_owned());
        let why = nameless.or_else(|| kind.why_not());
        let wanted = why.is_none();
        if let Some(why) = why {
            self.ignored.add(of, name, why);
        }
        wanted
    }

    /// Notes an array of a surface, which has no place for it.
    pub fn ignore_of_surface(&mut self, of: ValuesOf, name: &str) {
        self.ignored.add(of, name, OF_A_SURFACE.to_owned());
    }

    /// The ignored arrays, their names shortened to what a report can hold.
    pub fn take_ignored(&mut self, limits: &ReadLimits) -> IgnoredArrays {
        let mut ignored = std::mem::take(&mut self.ignored);
        for array in &mut ignored.listed {
            let letters = array.name.chars().filter(|letter| !letter.is_control());
            array.name = letters.take(limits.name_length as usize).collect();
        }
        ignored
    }

    /// Moves every array of a surface to its place: of its own it has only `node_id`.
    pub fn move_to_surface(&mut self, surface: &mut TriangleSurface) -> SurfaceArrays {
        let mut beside = SurfaceArrays::default();
        for array in self.points.drain(..) {
            beside.note(&array);
            let node_ids = match array.values {
                Values::Integers(values) if array.name.trim() == "node_id" => as_nodes(&values),
                _ => None,
            };
            match node_ids {
                Some(ids) if surface.node_ids.is_none() => surface.node_ids = Some(ids),
                _ => self.ignored.add(ValuesOf::Points, &array.name, OF_A_SURFACE.to_owned()),
            }
        }
        for array in self.cells.drain(..) {
            self.ignored.add(ValuesOf::Cells, &array.name, OF_A_SURFACE.to_owned());
        }
        beside
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
                } else if let Some(why) = self.why_no_labels(&values, "regions", limits) {
                    self.ignored.add(ValuesOf::Cells, &name, why);
                    Ok(())
                } else {
                    insert(&mut mesh.cell_labels, name, values)
                }
            }
        }
    }

    /// Why integers make no `what`; nothing where they do, and then their values count.
    fn why_no_labels(&mut self, values: &[i64], what: &str, limits: &ReadLimits) -> Option<String> {
        let distinct = distinct_values(values);
        if distinct > limits.label_values {
            let most = limits.label_values;
            return Some(format!("holds {distinct} distinct values, at most {most} make {what}"));
        }
        let most = FULL_LABEL_ARRAYS * limits.label_values;
        let together = self.label_values + distinct;
        if together > most {
            return Some(format!(
                "is one too many: with it the label arrays hold {together} distinct values, at most {most} are kept"
            ));
        }
        self.label_values = together;
        None
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
                self.ignored.add(
                    ValuesOf::Points,
                    &name,
                    "holds values that are not finite".to_owned(),
                );
                Ok(())
            }
            Values::Integers(values) => {
                if let Some(set) = set_name(&name, "set_") {
                    insert(&mut mesh.node_sets, set.to_string(), members(&values))
                } else if name == "node_id" {
                    self.ignored.add(ValuesOf::Points, &name, "numbers the nodes".to_owned());
                    Ok(())
                } else if let Some(why) = self.why_no_labels(&values, "labels", limits) {
                    self.ignored.add(ValuesOf::Points, &name, why);
                    Ok(())
                } else {
                    insert(&mut mesh.node_labels, name, values)
                }
            }
        }
    }
}

impl SurfaceArrays {
    fn note(&mut self, array: &NamedArray) {
        let name = array.name.trim();
        match &array.values {
            Values::Vectors(vectors) if name == DISPLACEMENT => {
                let is_whole = vectors.iter().all(|vector| is_finite(*vector));
                self.displacement = is_whole.then(|| vectors.clone());
            }
            Values::Integers(values) => {
                if let Some(set) = set_name(name, "set_") {
                    self.sets.insert(set.to_owned(), members(values));
                }
            }
            Values::Vectors(_) => {}
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

/// How many different values there are.
fn distinct_values(values: &[i64]) -> u64 {
    let mut values = values.to_vec();
    // Neighbours are often alike, which leaves little to sort.
    values.dedup();
    values.sort_unstable();
    values.dedup();
    values.len() as u64
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
    named: &mut BTreeMap<String, T>,
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
