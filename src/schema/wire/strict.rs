//! Strict JSON: anything that a lenient reader would drop or guess is refused, with its place.
//!
//! Syntax (RFC 8259), size, depth and encoding are refused as `malformed-json` with line and column;
//! repeated keys, nulls and anything a document does not know as `validation-failed` with JSON pointers.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;

use serde::Deserialize;
use serde::de::{DeserializeOwned, DeserializeSeed, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

use super::fault::{Faults, Pointer};
use super::limits::Limits;
use super::problem::Problem;
use super::reading;
use crate::schema::code::ErrorCode;

/// One document of a known shape.
pub fn parse<T: DeserializeOwned>(bytes: &[u8], limits: &Limits) -> Result<T, Problem> {
    from_value(parse_value(bytes, limits)?)
}

/// Any JSON within the limits that repeats no key.
pub fn parse_value(bytes: &[u8], limits: &Limits) -> Result<Value, Problem> {
    if bytes.len() as u64 > limits.json_bytes {
        let detail = format!(
            "the document has {} bytes, at most {} are allowed",
            bytes.len(),
            limits.json_bytes
        );
        return Err(
            Problem::new(ErrorCode::PayloadTooLarge, detail).with("limit", limits.json_bytes)
        );
    }
    // Editors of Windows put it at the beginning.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| not_utf8(bytes, error.valid_up_to()))?;
    let scan = Scan {
        depth_limit: limits.json_depth as usize,
        path: RefCell::default(),
        faults: RefCell::default(),
    };
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = ScanValue(&scan)
        .deserialize(&mut deserializer)
        .and_then(|value| deserializer.end().map(|()| value))
        .map_err(|error| malformed(&error, &scan.pointer()))?;
    scan.faults.into_inner().into_result()?;
    Ok(value)
}

/// A document of a known type from JSON accepted by `parse_value`.
/// What is unknown, missing or of another type is reported and left out, so that what follows is found too; of an array the first
/// such entry.
pub fn from_value<T: DeserializeOwned>(mut value: Value) -> Result<T, Problem> {
    let mut faults = Faults::default();
    remove_nulls(&mut value, &Pointer::root(), &mut faults);
    let mut left_out = BTreeSet::new();
    loop {
        let mistake = match reading::read::<T>(&value) {
            Ok(document) => return faults.into_result().map(|()| document),
            Err(mistake) => mistake,
        };
        let parent = mistake.place();
        let at = match &mistake.member {
            Some(name) => parent.key(name),
            None => parent.clone(),
        };
        let is_missing = mistake.code == ErrorCode::MissingField;
        if !is_missing || !left_out.contains(at.as_str()) {
            faults.add(&at, mistake.code, mistake.detail.clone());
        }
        let wrong = if is_missing { parent } else { at };
        let goes_on = mistake.code == ErrorCode::UnknownField || !faults.is_full();
        match remove(&mut value, wrong.as_str()).filter(|_| goes_on) {
            Some(place) => left_out.insert(place),
            None => {
                faults.into_result()?;
                return Err(Problem::new(ErrorCode::ValidationFailed, mistake.detail));
            }
        };
    }
}

/// Removes the value at a place, or the array that it is in, whose other entries keep no place without it. What was removed.
fn remove(value: &mut Value, mut at: &str) -> Option<String> {
    loop {
        let (parent, name) = at.rsplit_once('/')?;
        match value.pointer_mut(parent)? {
            Value::Object(members) => {
                members.remove(&name.replace("~1", "/").replace("~0", "~"))?;
                return Some(at.to_owned());
            }
            _ => at = parent,
        }
    }
}

/// A null member is equivalent to a missing one; entries of arrays are checked by their type.
fn remove_nulls(value: &mut Value, at: &Pointer, faults: &mut Faults) {
    match value {
        Value::Object(members) => {
            members.retain(|name, member| {
                if member.is_null() {
                    faults.add(&at.key(name), ErrorCode::NullValue, "null is not a value here");
                } else {
                    remove_nulls(member, &at.key(name), faults);
                }
                !member.is_null()
            });
        }
        Value::Array(entries) => {
            for (index, entry) in entries.iter_mut().enumerate() {
                remove_nulls(entry, &at.index(index), faults);
            }
        }
        _ => {}
    }
}

fn not_utf8(bytes: &[u8], valid: usize) -> Problem {
    let before = &bytes[..valid];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let line_start =
        before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    let column = valid - line_start + 1;
    let detail = format!("byte {valid} is not UTF-8 (line {line}, column {column})");
    Problem::new(ErrorCode::MalformedJson, detail).with("line", line).with("column", column)
}

fn malformed(error: &serde_json::Error, at: &Pointer) -> Problem {
    let problem = Problem::new(ErrorCode::MalformedJson, error.to_string())
        .with("line", error.line())
        .with("column", error.column());
    match at.as_str() {
        "" => problem,
        pointer => problem.with("pointer", pointer),
    }
}

/// Whole numbers in here are exact in 64 bits.
const INTEGERS: Range<f64> = -9_223_372_036_854_775_808.0..9_223_372_036_854_775_808.0;

enum Step {
    Key(String),
    Index(usize),
}

/// The position of the reader and its findings.
struct Scan {
    depth_limit: usize,
    path: RefCell<Vec<Step>>,
    faults: RefCell<Faults>,
}

impl Scan {
    fn pointer(&self) -> Pointer {
        self.path.borrow().iter().fold(Pointer::root(), |at, step| match step {
            Step::Key(key) => at.key(key),
            Step::Index(index) => at.index(*index),
        })
    }

    /// Descends into a member or entry; if that is refused the path still points at it.
    fn enter<E: Error>(&self, step: Step) -> Result<(), E> {
        self.path.borrow_mut().push(step);
        let depth = self.path.borrow().len();
        if depth > self.depth_limit {
            return Err(E::custom(format_args!("nested deeper than {} levels", self.depth_limit)));
        }
        Ok(())
    }

    fn leave(&self) {
        self.path.borrow_mut().pop();
    }
}

struct ScanValue<'a>(&'a Scan);

impl<'de> DeserializeSeed<'de> for ScanValue<'_> {
    type Value = Value;

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for ScanValue<'_> {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("any JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    /// 3.0 is the integer 3, as in JSON Schema.
    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        if value.fract() == 0.0 && INTEGERS.contains(&value) {
            return Ok(Value::Number((value as i64).into()));
        }
        let number = Number::from_f64(value).ok_or_else(|| E::custom("number out of range"))?;
        Ok(Value::Number(number))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Value, E> {
        Ok(Value::String(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut array = Vec::new();
        loop {
            self.0.enter(Step::Index(array.len()))?;
            let entry = entries.next_element_seed(ScanValue(self.0))?;
            self.0.leave();
            match entry {
                Some(entry) => array.push(entry),
                None => return Ok(Value::Array(array)),
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(Key(key)) = members.next_key()? {
            self.0.enter(Step::Key(key.clone()))?;
            if object.contains_key(&key) {
                let detail = format!("the key `{key}` is given more than once");
                let at = self.0.pointer();
                self.0.faults.borrow_mut().add(&at, ErrorCode::DuplicateKey, detail);
            }
            let member = members.next_value_seed(ScanValue(self.0))?;
            self.0.leave();
            object.insert(key, member);
        }
        Ok(Value::Object(object))
    }
}

#[derive(Deserialize)]
struct Key(String);
