//! The names of methods and of elements.

use std::sync::LazyLock;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::openapi::schema::{ObjectBuilder, SchemaType};
use utoipa::openapi::{RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use crate::schema::wire::reading::NOT_AVAILABLE;
use mechanics::prediction::{ElementChoice, MethodKind};

/// The choice of `auto` without estimates to choose by.
pub const WHY_LINEAR: &str = "auto: fem_linear, without estimates to choose between models";
/// The models of `auto`.
pub const WHY_ESTIMATED: &str = "auto: the cheapest of fem_linear, its second order and fem_nonlinear, corrected for the mesh or \
    not, whose estimated error of the skin is accepted";
/// What a check adds to it where it does not foresee the choice.
pub const WHY_NOT_FORESEEN: &str = "; which one is not foreseen here: movements of segments say nothing of loads, prescribed displacements, growth, muscles and fibres that only pull, and the prediction \
    itself solves, estimates and chooses";
/// The choice of `auto` for a mesh that is refined.
pub const WHY_REFINED: &str = "auto: fem_linear, on meshes that are refined until the estimated error of the skin is accepted";
/// Reason of a method that the spec names.
pub const WHY_ASKED: &str = "named by the spec";

/// Methods of the first version of the API that were never built.
const NOT_BUILT: [&str; 5] =
    ["fem_corotational", "fem_neo_hookean", "fem_mooney_rivlin", "fem_ogden", "fem_rubin_bodner"];

/// A model of soft tissue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MethodName {
    #[default]
    Auto,
    Named(MethodKind),
}

/// The finite element of cells, by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ElementName(ElementChoice);

impl MethodName {
    /// The method named; of `auto` the linear one, with which it begins.
    pub fn chosen(self) -> MethodKind {
        match self {
            MethodName::Auto => MethodKind::FemLinear,
            MethodName::Named(method) => method,
        }
    }

    /// Its name in documents.
    pub fn name(self) -> &'static str {
        match self {
            MethodName::Auto => "auto",
            MethodName::Named(method) => method.name(),
        }
    }

    pub fn why(self) -> &'static str {
        match self {
            MethodName::Auto => WHY_LINEAR,
            MethodName::Named(_) => WHY_ASKED,
        }
    }

    fn all() -> impl Iterator<Item = MethodName> {
        let named = MethodKind::ALL.iter().copied().map(MethodName::Named);
        std::iter::once(MethodName::Auto).chain(named)
    }
}

impl Serialize for MethodName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for MethodName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        MethodName::all().find(|method| method.name() == word).ok_or_else(|| {
            if !NOT_BUILT.contains(&word.as_str()) {
                return D::Error::unknown_variant(&word, &WORDS);
            }
            let known: Vec<String> = WORDS.iter().map(|name| format!("`{name}`")).collect();
            let known = known.join(", ");
            D::Error::custom(format_args!(
                "{NOT_AVAILABLE}`{word}` is not built; there are {known}"
            ))
        })
    }
}

/// The names of all methods.
static WORDS: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| MethodName::all().map(MethodName::name).collect());

impl PartialSchema for MethodName {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(SchemaType::Type(Type::String))
            .description(Some("A model of soft tissue."))
            .enum_values(Some(MethodName::all().map(MethodName::name)))
            .into()
    }
}

impl ToSchema for MethodName {}

impl ElementName {
    /// Its name in documents.
    pub fn name(self) -> &'static str {
        self.0.name()
    }

    /// The element of the numerics.
    pub fn choice(self) -> ElementChoice {
        self.0
    }
}

impl From<ElementChoice> for ElementName {
    fn from(choice: ElementChoice) -> Self {
        ElementName(choice)
    }
}

impl Serialize for ElementName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for ElementName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        let found = ElementChoice::ALL.iter().find(|element| element.name() == word);
        found
            .map(|element| ElementName(*element))
            .ok_or_else(|| D::Error::unknown_variant(&word, &ELEMENTS))
    }
}

/// The names of all elements.
static ELEMENTS: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| ElementChoice::ALL.iter().map(|element| element.name()).collect());

impl PartialSchema for ElementName {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(SchemaType::Type(Type::String))
            .description(Some("The finite element of cells."))
            .enum_values(Some(ElementChoice::ALL.iter().map(|element| element.name())))
            .into()
    }
}

impl ToSchema for ElementName {}
