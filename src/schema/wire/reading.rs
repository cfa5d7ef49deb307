//! The reader of documents: JSON values to typed documents, with each mistake in JSON terms and at its place.
//!
//! Readers derived by serde name Rust types, and accept an array for an object by the order of its
//! members. This one names JSON types: object, array, string, number, true or false, and accepts only objects as objects.

use std::fmt;

use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess,
    SeqAccess, Unexpected, Visitor,
};
use serde_json::{Value, map};

use super::pointer::Pointer;
use crate::schema::code::ErrorCode;

/// The prefix of a detail on a known word without an implementation.
pub const NOT_AVAILABLE: &str = "not available: ";
/// The most characters of a string repeated in a message.
const REPEATED: usize = 40;

/// Why a value is not the expected document.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    pub code: ErrorCode,
    pub detail: String,
    /// The member that is unknown or missing.
    pub member: Option<String>,
    /// From the place of the mistake to the root.
    path: Vec<String>,
}

/// Reads a value as a document.
pub fn read<T: DeserializeOwned>(value: &Value) -> Result<T, Mistake> {
    T::deserialize(Json(value))
}

impl Mistake {
    fn new(code: ErrorCode, detail: String) -> Self {
        Mistake { code, detail, member: None, path: Vec::new() }
    }

    fn of_member(code: ErrorCode, detail: String, name: &str) -> Self {
        Mistake { member: Some(name.to_owned()), ..Mistake::new(code, detail) }
    }

    fn wrong_type(expected: &str, found: &str) -> Self {
        Mistake::new(ErrorCode::WrongType, format!("expected {expected}, found {found}"))
    }

    fn within(mut self, step: String) -> Self {
        self.path.push(step);
        self
    }

    /// The value that is wrong, or the object with the member that is.
    pub fn place(&self) -> Pointer {
        self.path.iter().rev().fold(Pointer::root(), |at, step| at.key(step))
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.detail)
    }
}

impl std::error::Error for Mistake {}

impl Error for Mistake {
    fn custom<T: fmt::Display>(message: T) -> Self {
        let detail = message.to_string();
        let code = match detail.starts_with(NOT_AVAILABLE) {
            true => ErrorCode::MethodNotAvailable,
            false => ErrorCode::WrongType,
        };
        Mistake::new(code, detail)
    }

    fn invalid_type(found: Unexpected, expected: &dyn Expected) -> Self {
        Mistake::wrong_type(&in_json(&expected.to_string()), &json_type_name(found))
    }

    fn invalid_value(found: Unexpected, expected: &dyn Expected) -> Self {
        Mistake::invalid_type(found, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Mistake::wrong_type(&in_json(&expected.to_string()), &array_of(length))
    }

    fn unknown_variant(word: &str, expected: &'static [&'static str]) -> Self {
        let detail = format!("unknown word `{word}`, expected {}", listed(expected));
        Mistake::new(ErrorCode::UnknownWord, detail)
    }

    fn unknown_field(name: &str, expected: &'static [&'static str]) -> Self {
        let detail = format!("unknown field `{name}`, expected {}", listed(expected));
        Mistake::of_member(ErrorCode::UnknownField, detail, name)
    }

    fn missing_field(name: &'static str) -> Self {
        Mistake::of_member(ErrorCode::MissingField, format!("missing field `{name}`"), name)
    }
}

/// Words as listed in a sentence.
fn listed(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
    match quoted.as_slice() {
        [] => "none".to_owned(),
        [only] => only.clone(),
        several => format!("one of {}", several.join(", ")),
    }
}

fn array_of(length: usize) -> String {
    format!("an array of {length}")
}

/// The expectation of serde's readers, in JSON terms.
fn in_json(expected: &str) -> String {
    let length = expected.strip_prefix("an array of length ");
    if let Some(length) = length.or_else(|| expected.strip_prefix("a tuple of size ")) {
        return format!("an array of {length}");
    }
    if expected.starts_with("struct ") {
        return "an object".to_owned();
    }
    let known = match expected {
        "a map" => "an object",
        "a sequence" => "an array",
        "a boolean" => "true or false",
        "f32" | "f64" => "a number",
        "u8" | "u16" | "u32" => "a whole number from 0 to 4294967295",
        "u64" | "usize" => "a whole number from 0",
        "i8" | "i16" | "i32" | "i64" => "a whole number",
        other => other,
    };
    known.to_owned()
}

/// The value found, in JSON terms.
fn json_type_name(found: Unexpected) -> String {
    match found {
        Unexpected::Bool(value) => value.to_string(),
        Unexpected::Unsigned(number) => format!("the number {number}"),
        Unexpected::Signed(number) => format!("the number {number}"),
        Unexpected::Float(number) => format!("the number {number}"),
        Unexpected::Str(text) => shortened(text),
        Unexpected::Unit | Unexpected::Option => "null".to_owned(),
        Unexpected::Seq => "an array".to_owned(),
        Unexpected::Map => "an object".to_owned(),
        _ => "something else".to_owned(),
    }
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(REPEATED) {
        None => format!("the string {text:?}"),
        Some((end, _)) => format!("a string that begins with {:?}", &text[..end]),
    }
}

fn found(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(value) => value.to_string(),
        Value::Number(number) => format!("the number {number}"),
        Value::String(text) => shortened(text),
        Value::Array(_) => "an array".to_owned(),
        Value::Object(_) => "an object".to_owned(),
    }
}

/// A value being read.
struct Json<'de>(&'de Value);

impl<'de> Deserializer<'de> for Json<'de> {
    type Error = Mistake;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mistake> {
        match self.0 {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Number(number) => match (number.as_u64(), number.as_i64()) {
                (Some(number), _) => visitor.visit_u64(number),
                (None, Some(number)) => visitor.visit_i64(number),
                (None, None) => visitor.visit_f64(number.as_f64().unwrap_or(f64::NAN)),
            },
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Array(entries) => visitor.visit_seq(Entries(entries.iter().enumerate())),
            Value::Object(members) => {
                visitor.visit_map(Members { left: members.iter(), entered: None })
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Mistake> {
        match self.0 {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Mistake> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Mistake> {
        match self.0 {
            Value::Array(entries) if entries.len() != length => {
                Err(Mistake::wrong_type(&array_of(length), &array_of(entries.len())))
            }
            Value::Array(_) => self.deserialize_any(visitor),
            other => Err(Mistake::wrong_type(&array_of(length), &found(other))),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mistake> {
        match self.0 {
            Value::Object(_) => self.deserialize_any(visitor),
            other => Err(Mistake::wrong_type("an object", &found(other))),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Mistake> {
        match self.0 {
            Value::String(word) => {
                let word: StrDeserializer<'_, Mistake> = word.as_str().into_deserializer();
                visitor.visit_enum(word)
            }
            other => {
                let expected = format!("a string, {}", listed(words));
                Err(Mistake::wrong_type(&expected, &found(other)))
            }
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq
        tuple_struct map identifier ignored_any
    }
}

/// The remaining entries of an array.
struct Entries<'de>(std::iter::Enumerate<std::slice::Iter<'de, Value>>);

impl<'de> SeqAccess<'de> for Entries<'de> {
    type Error = Mistake;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Mistake> {
        let Some((index, entry)) = self.0.next() else { return Ok(None) };
        let read = seed.deserialize(Json(entry));
        read.map(Some).map_err(|mistake| mistake.within(index.to_string()))
    }
}

/// The remaining members of an object, and the one whose name was read last.
struct Members<'de> {
    left: map::Iter<'de>,
    entered: Option<(&'de String, &'de Value)>,
}

impl<'de> MapAccess<'de> for Members<'de> {
    type Error = Mistake;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Mistake> {
        self.entered = self.left.next();
        let Some((name, _)) = self.entered else { return Ok(None) };
        let name: StrDeserializer<'de, Mistake> = name.as_str().into_deserializer();
        seed.deserialize(name).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Mistake> {
        let Some((name, member)) = self.entered.take() else {
            return Err(Mistake::custom("a member without a name"));
        };
        seed.deserialize(Json(member)).map_err(|mistake| mistake.within(name.clone()))
    }
}
