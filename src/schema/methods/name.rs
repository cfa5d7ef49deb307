//! The names of methods and of elements.

use std::sync::LazyLock;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::openapi::schema::{ObjectBuilder, SchemaType};
use utoipa::openapi::{RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use crate::schema::wire::reading::NOT_AVAILABLE;
use mechanics::prediction::{ElementChoice, MethodKind};

/// What `auto` is where nothing is estimated that could choose between models.
pub const WHY_LINEAR: &str = "auto: fem_linear, where no estimate chooses between models";
/// What `auto` chooses from.
pub const WHY_ESTIMATED: &str = "auto: the cheapest of fem_linear, its second order and fem_nonlinear, corrected for the mesh or \
    not, whose estimated error of the skin is accepted";
/// Why a method that was asked for by name is used.
pub const WHY_ASKED: &str = "asked for by the spec";

/// Words for methods that the first version of the API knew and that were never built.
const NOT_BUILT: [&str; 5] =
    ["fem_corotational", "fem_neo_hookean", "fem_mooney_rivlin", "fem_ogden", "fem_rubin_bodner"];

/// A model soft tissue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MethodName {
    #[default]
    Auto,
    Named(MethodKind),
}

/// The treatment of cells, by its word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ElementName(ElementChoice);

impl MethodName {
    /// The method that is used: what `auto` chooses, or the one asked for.
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

/// The words of all methods.
static WORDS: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| MethodName::all().map(MethodName::name).collect());

impl PartialSchema for MethodName {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(SchemaType::Type(Type::String))
            .description(Some("A model soft tissue."))
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

    /// The element of the path.
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

/// The words of all elements.
static ELEMENTS: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| ElementChoice::ALL.iter().map(|element| element.name()).collect());

impl PartialSchema for ElementName {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(SchemaType::Type(Type::String))
            .description(Some("The treatment of cells."))
            .enum_values(Some(ElementChoice::ALL.iter().map(|element| element.name())))
            .into()
    }
}

impl ToSchema for ElementName {}
