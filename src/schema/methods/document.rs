//! Description of a method: its assumptions, its input, its parameters.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::name::{ElementName, MethodName};
use mechanics::prediction::MethodKind;

/// A model that a spec may name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MethodDocument {
    pub name: MethodName,
    pub title: String,
    /// Its assumptions and limits.
    pub assumptions: Vec<String>,
    /// Its elements; none if it has no elements.
    pub elements: Vec<ElementName>,
    /// Supported cell shapes.
    pub cells: Vec<String>,
    /// The fields of case, plan and spec that it reads.
    pub reads: Vec<String>,
    /// Its parameters, in the field of the spec that has its name.
    pub parameters: Vec<ParameterDocument>,
}

/// Description of a method in words; its name, its elements and its cells are those of the table of methods.
pub(super) struct Description {
    pub title: &'static str,
    pub assumptions: &'static [&'static str],
    pub reads: &'static [&'static str],
    pub parameters: Vec<ParameterDocument>,
}

impl MethodDocument {
    pub(super) fn new(method: MethodKind, description: Description) -> Self {
        let properties = method.properties();
        let words = |list: &[&str]| list.iter().map(|word| (*word).to_owned()).collect();
        MethodDocument {
            name: MethodName::Named(method),
            title: description.title.to_owned(),
            assumptions: words(description.assumptions),
            elements: properties.elements.iter().copied().map(ElementName::from).collect(),
            cells: properties.cells.iter().map(|shape| shape.name().to_owned()).collect(),
            reads: words(description.reads),
            parameters: description.parameters,
        }
    }
}

/// A parameter of a method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ParameterDocument {
    /// Its name in the spec, with its unit.
    pub name: String,
    pub meaning: String,
    /// As JSON.
    pub default: serde_json::Value,
    /// As text, e.g. `(0, 100]` or `static | backward_euler`.
    pub range: String,
}

pub(super) fn parameter(
    name: &str,
    meaning: &str,
    default: serde_json::Value,
    range: &str,
) -> ParameterDocument {
    ParameterDocument {
        name: name.to_owned(),
        meaning: meaning.to_owned(),
        default,
        range: range.to_owned(),
    }
}
