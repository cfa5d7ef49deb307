//! SELECT: a set of nodes, given by name, label or distance.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::boundary::NodeSelection;

/// Largest distance from a surface at which nodes may be selected.
const LARGEST_DISTANCE_MM: f64 = 1000.0;

/// A set of nodes: exactly one of `node_set`, `array` with `value`, `surface` with `within_mm`, or `any`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SelectionDocument {
    /// A node set of the volume mesh, as `NAME` or `set_NAME`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub node_set: Option<String>,
    /// An integer point array of the volume mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub array: Option<String>,
    /// The value that `array` has at the nodes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub value: Option<i64>,
    /// A surface mesh: its id, or the name of one of the bones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub surface: Option<String>,
    /// Boundary nodes at most this far from the triangles of `surface`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub within_mm: Option<f64>,
    /// The union of several sets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, no_recursion)]
    pub any: Option<Vec<SelectionDocument>>,
}

impl SelectionDocument {
    /// The node set of a name.
    pub fn node_set(name: &str) -> Self {
        SelectionDocument { node_set: Some(name.to_owned()), ..SelectionDocument::default() }
    }

    /// The selection as the numerics take it; `None` if faults were added.
    pub fn to_selection(
        &self,
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Option<NodeSelection> {
        let by_label = self.array.is_some() || self.value.is_some();
        let by_distance = self.surface.is_some() || self.within_mm.is_some();
        let forms = [self.node_set.is_some(), by_label, by_distance, self.any.is_some()];
        let given = forms.into_iter().filter(|&form| form).count();
        let names = "`node_set`, `array` with `value`, `surface` with `within_mm`, `any`";
        if !faults.check_one_of(at, given, names) {
            return None;
        }
        if let Some(name) = &self.node_set {
            faults.check_name(&at.key("node_set"), name, limits.name_characters as usize);
            return Some(NodeSelection::NodeSet(name.trim().to_owned()));
        }
        if let Some(parts) = &self.any {
            return union(parts, &at.key("any"), limits, faults);
        }
        if by_label { self.label(at, faults) } else { self.near_surface(at, faults) }
    }

    fn label(&self, at: &Pointer, faults: &mut Faults) -> Option<NodeSelection> {
        let (Some(array), Some(value)) = (&self.array, self.value) else {
            faults.add(at, ErrorCode::MissingField, "`array` and `value` go together");
            return None;
        };
        let array = array.clone();
        Some(NodeSelection::Label { array, value })
    }

    fn near_surface(&self, at: &Pointer, faults: &mut Faults) -> Option<NodeSelection> {
        let (Some(surface), Some(distance)) = (&self.surface, self.within_mm) else {
            faults.add(at, ErrorCode::MissingField, "`surface` and `within_mm` go together");
            return None;
        };
        faults.check_range(&at.key("within_mm"), distance, 0.0..=LARGEST_DISTANCE_MM, "mm");
        let surface = surface.clone();
        Some(NodeSelection::NearSurface { surface, distance })
    }

    /// Every surface named here and in the parts of a union, with its place.
    pub fn surfaces_mut<'a>(
        &'a mut self,
        at: &Pointer,
        found: &mut Vec<(Pointer, &'a mut String)>,
    ) {
        if let Some(surface) = &mut self.surface {
            found.push((at.key("surface"), surface));
        }
        for (index, part) in self.any.iter_mut().flatten().enumerate() {
            part.surfaces_mut(&at.key("any").index(index), found);
        }
    }
}

fn union(
    parts: &[SelectionDocument],
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) -> Option<NodeSelection> {
    if parts.is_empty() {
        faults.add(at, ErrorCode::EmptySelection, "the union of no sets is empty");
    }
    faults.check_length(at, parts.len(), limits.list_entries as usize);
    let selections: Vec<_> = parts
        .iter()
        .enumerate()
        .filter_map(|(index, part)| part.to_selection(&at.index(index), limits, faults))
        .collect();
    (selections.len() == parts.len()).then_some(NodeSelection::Any(selections))
}
