//! Every member of every document with values of other types: each is refused at its place, in JSON's own terms.

use std::collections::BTreeSet;

use facies::schema::applied::ApplyDocument;
use facies::schema::key::{KeyDocument, RotationDocument};
use facies::schema::wire::strict;
use facies::schema::{
    CaseDocument, CompareDocument, Limits, OptimiseDocument, PlanDocument, PredictDocument,
    Problem, ResponseDocument, StudyDocument,
};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

/// Words of the program, of its language and of its libraries.
const NOT_JSON: [&str; 16] = [
    "struct",
    "enum",
    "variant",
    "untagged",
    "a map",
    "a sequence",
    "tuple",
    "newtype",
    "unit value",
    "identifier",
    "integer `",
    "floating point",
    "boolean `",
    "f64",
    "usize",
    "Document",
];

/// What stands in the place of a value.
fn others() -> [Value; 7] {
    [json!(true), json!(3.5), json!(-7), json!("x"), json!([]), json!([["x"]]), json!({"x": {}})]
}

type Reader = fn(&[u8]) -> Option<Problem>;

fn read<T: DeserializeOwned>(bytes: &[u8]) -> Option<Problem> {
    strict::parse::<T>(bytes, &Limits::default()).err()
}

/// The documents that clients send, by the names of their schemas.
const DOCUMENTS: [(&str, Reader); 10] = [
    ("CaseDocument", read::<CaseDocument>),
    ("PlanDocument", read::<PlanDocument>),
    ("PredictDocument", read::<PredictDocument>),
    ("CompareDocument", read::<CompareDocument>),
    ("ResponseDocument", read::<ResponseDocument>),
    ("OptimiseDocument", read::<OptimiseDocument>),
    ("StudyDocument", read::<StudyDocument>),
    ("ApplyDocument", read::<ApplyDocument>),
    ("KeyDocument", read::<KeyDocument>),
    ("RotationDocument", read::<RotationDocument>),
];

/// A document with every member that its schema has, and the JSON types that each place takes.
struct Walk<'a> {
    schemas: &'a Value,
    places: Vec<(String, BTreeSet<String>)>,
}

impl<'a> Walk<'a> {
    fn resolved(&self, schema: &'a Value) -> &'a Value {
        match schema["$ref"].as_str().and_then(|text| text.rsplit('/').next()) {
            Some(name) => self.resolved(&self.schemas[name]),
            None => schema,
        }
    }

    /// The branches of a schema, itself where it has none.
    fn branches(&self, schema: &'a Value) -> Vec<&'a Value> {
        let schema = self.resolved(schema);
        match schema["oneOf"].as_array() {
            Some(branches) => branches.iter().flat_map(|branch| self.branches(branch)).collect(),
            None => vec![schema],
        }
    }

    fn value(&mut self, schema: &'a Value, at: &str, depth: usize) -> Value {
        let branches = self.branches(schema);
        let types = branches.iter().flat_map(|branch| types_of(branch)).collect();
        self.places.push((at.to_owned(), types));
        let last = branches[branches.len() - 1];
        match types_of(last).first().map(String::as_str) {
            Some("object") => self.object(last, at, depth),
            Some("array") => {
                let least = last["minItems"].as_u64().unwrap_or(1).max(1);
                (0..least)
                    .map(|n| self.value(&last["items"], &format!("{at}/{n}"), depth))
                    .collect()
            }
            Some("string") => last["enum"][0].as_str().unwrap_or("x").into(),
            Some("boolean") => json!(true),
            _ => json!(1),
        }
    }

    fn object(&mut self, schema: &'a Value, at: &str, depth: usize) -> Value {
        let mut members = Map::new();
        for (name, member) in schema["properties"].as_object().into_iter().flatten() {
            // A selection may hold selections.
            if depth < 12 && !(name == "any" && at.contains("/any")) {
                let value = self.value(member, &format!("{at}/{name}"), depth + 1);
                members.insert(name.clone(), value);
            }
        }
        if schema["additionalProperties"].is_object() && members.is_empty() {
            let name = if at.ends_with("/names") { "1" } else { "x" };
            let value =
                self.value(&schema["additionalProperties"], &format!("{at}/{name}"), depth + 1);
            members.insert(name.to_owned(), value);
        }
        members.into()
    }
}

fn types_of(schema: &Value) -> Vec<String> {
    match &schema["type"] {
        Value::String(one) => vec![one.clone()],
        Value::Array(several) => {
            several.iter().map(|one| one.as_str().unwrap().to_owned()).collect()
        }
        _ => Vec::new(),
    }
}

fn is_of(value: &Value, types: &BTreeSet<String>) -> bool {
    let name = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    types.contains(name) || (name == "integer" && types.contains("number"))
}

/// What a study takes apart after it was read.
fn is_read_later(document: &str, place: &str) -> bool {
    document == "StudyDocument"
        && (place.starts_with("/methods/") || place.starts_with("/items/0/"))
}

#[test]
fn a_value_of_another_type_is_refused_at_its_place_in_the_words_of_json() {
    let api = facies::api::document();
    let schemas = &api["components"]["schemas"];
    let mut tried = 0;
    for (name, read) in DOCUMENTS {
        let mut walk = Walk { schemas, places: Vec::new() };
        let whole = walk.value(&schemas[name], "", 0);
        assert_eq!(read(whole.to_string().as_bytes()), None, "{name}: {whole}");
        for (place, types) in &walk.places {
            let wrong = others().into_iter().filter(|value| !is_of(value, types));
            for value in wrong.filter(|_| !is_read_later(name, place)) {
                let mut document = whole.clone();
                *document.pointer_mut(place).unwrap() = value.clone();
                let problem = read(document.to_string().as_bytes());
                let problem = problem.unwrap_or_else(|| panic!("{name}{place} took {value}"));
                let told = &problem.errors[0];
                assert_eq!(&told.pointer, place, "{name}: {value}: {}", told.detail);
                let texts = problem.errors.iter().map(|error| &error.detail);
                for text in texts.chain([&problem.detail]) {
                    let word = NOT_JSON.iter().find(|word| text.contains(*word));
                    assert_eq!(word, None, "{name}{place}: {text}");
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 1000, "{tried}");
}

#[test]
fn what_was_expected_and_what_was_found_are_reported() {
    let detail = |text: &[u8]| read::<CompareDocument>(text).unwrap().errors[0].detail.clone();
    let with = |align: &str| {
        format!(
            r#"{{"kind":"compare","prediction":{{"mesh":"a"}},"actual":{{"mesh":"b"}},{align}}}"#
        )
    };
    for (member, told) in [
        (
            r#""align":"ipc""#,
            r#"unknown word `ipc`, expected one of `none`, `matrix`, `landmarks`, `icp`, `surfaces`"#,
        ),
        (r#""align":["icp"]"#, "expected a name or an object, found an array"),
        (
            r#""align":{"method":"IPC"}"#,
            r#"unknown word `IPC`, expected one of `none`, `matrix`, `landmarks`, `icp`, `surfaces`"#,
        ),
        (
            r#""align":{"method":{"icp":{}}}"#,
            "expected a string, one of `none`, `matrix`, `landmarks`, `icp`, `surfaces`, found an object",
        ),
        (r#""align":{"report_unaligned":1}"#, "expected true or false, found the number 1"),
        (r#""align":{"mask":{"sphere_mm":[1,2]}}"#, "expected an array of 4, found an array of 2"),
        (r#""samples_per_mm2":"1""#, r#"expected a number, found the string "1""#),
        (r#""tags":{}"#, "expected an array, found an object"),
        (r#""regions":[]"#, "expected an object, found an array"),
    ] {
        assert_eq!(detail(with(member).as_bytes()), told, "{member}");
    }
}

#[test]
fn a_member_that_is_null_is_one_mistake_and_not_missing_on_top_of_it() {
    let problem = read::<CaseDocument>(br#"{"units":"mm","volume":null}"#).unwrap();
    let told: Vec<(&str, &str)> =
        problem.errors.iter().map(|error| (error.pointer.as_str(), error.code.name())).collect();
    assert_eq!(told, [("/volume", "null-value")]);
    assert!(problem.detail.starts_with("/volume: null is not a value"), "{}", problem.detail);
}
