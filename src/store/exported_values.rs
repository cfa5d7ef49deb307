//! What the values of a row have to be so that the service can read them, beside what the tables demand.

use std::collections::BTreeMap;

use serde::de::{DeserializeOwned, IgnoredAny};

use crate::schema::PlanDocument;
use crate::schema::case::meshed::CaseBody;
use crate::schema::cohort::stored::{ConsentDocument, MemberDocument};
use crate::schema::engine::EngineDocument;
use crate::schema::job::{JobErrorDocument, JobStatus};
use crate::schema::job_document::JobKind;
use crate::schema::key::scopes_of;
use crate::schema::mesh::MeshDocument;
use crate::schema::predict::check::CheckDocument;
use crate::schema::predict::output::media_type_of;
use crate::schema::predict::result::ResultDocument;
use crate::schema::study::expected::TruthCostDocument;

/// Reads a text of JSON for the sake of its error.
pub type JsonReader = fn(&str) -> serde_json::Result<()>;

/// An object, whatever is in it.
pub(super) fn any_object(text: &str) -> serde_json::Result<()> {
    json::<BTreeMap<String, IgnoredAny>>(text)
}

/// Why a text cannot be read; `None` where there is no more to say than what it has to be.
type Reason = Option<serde_json::Error>;

/// What a text has to be so that the service can read it.
#[derive(Clone, Copy)]
pub(super) struct TextForm {
    /// What such a column holds.
    pub name: &'static str,
    read: Reader,
}

#[derive(Clone, Copy)]
enum Reader {
    Word(fn(&str) -> bool),
    Json(JsonReader),
}

/// Columns whose text is read as more than a text, where it is there: as the service reads it. The inputs of jobs are left out, which
/// the store does not know.
const WANTED: [(&str, &str, &str, Reader); 15] = [
    ("keys", "scopes", "scopes", Reader::Word(|text| scopes_of(text).is_ok())),
    ("meshes", "report", "the report of a mesh", Reader::Json(json::<MeshDocument>)),
    ("cases", "document", "a case", Reader::Json(|text| CaseBody::stored(text).map(drop))),
    // A case that is being meshed has none yet.
    ("cases", "report", "the check of a case or null", Reader::Json(json::<Option<CheckDocument>>)),
    ("plans", "document", "a plan", Reader::Json(json::<PlanDocument>)),
    ("jobs", "kind", "a kind of job", Reader::Word(|text| JobKind::from_name(text).is_some())),
    ("jobs", "status", "the status of a job", Reader::Word(is_status)),
    ("jobs", "engine", "the program of a job", Reader::Json(json::<EngineDocument>)),
    ("jobs", "error", "the error of a job", Reader::Json(json::<JobErrorDocument>)),
    ("jobs", "result", "the result of a job", Reader::Json(json::<ResultDocument>)),
    ("jobs", "truths", "the costs of a study", Reader::Json(json::<Vec<TruthCostDocument>>)),
    ("job_events", "status", "the status of a job", Reader::Word(is_status)),
    ("job_files", "name", "the name of a file of a result", Reader::Word(is_file_name)),
    ("cohorts", "consent", "a consent", Reader::Json(json::<ConsentDocument>)),
    ("cohort_members", "document", "a member of a cohort", Reader::Json(json::<MemberDocument>)),
];
const INPUT: (&str, &str, &str) = ("jobs", "document", "the input of a job");

impl TextForm {
    /// That of a column; `input` reads the inputs of jobs.
    pub fn of(table: &str, column: &str, input: JsonReader) -> Option<TextForm> {
        if (table, column) == (INPUT.0, INPUT.1) {
            return Some(TextForm { name: INPUT.2, read: Reader::Json(input) });
        }
        let found = WANTED.iter().find(|row| (row.0, row.1) == (table, column));
        found.map(|&(_, _, name, read)| TextForm { name, read })
    }

    /// Reads a text as the service does.
    pub fn read(self, text: &str) -> Result<(), Reason> {
        match self.read {
            Reader::Word(is_one) if is_one(text) => Ok(()),
            Reader::Word(_) => Err(None),
            Reader::Json(read) => read(text).map_err(Some),
        }
    }
}

fn json<T: DeserializeOwned>(text: &str) -> serde_json::Result<()> {
    serde_json::from_str::<T>(text).map(drop)
}

fn is_status(text: &str) -> bool {
    JobStatus::from_name(text).is_some()
}

/// What is wrong with a line of JSON, and at which column. Its number is that of a file.
pub(super) fn told(error: &serde_json::Error) -> String {
    let (text, column) = (error.to_string(), error.column());
    match text.strip_suffix(&format!(" at line {} column {column}", error.line())) {
        Some(what) => format!("{} at column {column}", in_json(what)),
        None => in_json(&text),
    }
}

/// The same in terms of JSON, which knows no types of a program.
fn in_json(what: &str) -> String {
    const STRUCT: &str = "expected struct ";
    match what.split_once(STRUCT) {
        Some((before, after)) => {
            let name = after.find(|letter: char| !letter.is_alphanumeric()).unwrap_or(after.len());
            format!("{before}expected an object{}", &after[name..])
        }
        None => what.to_owned(),
    }
}

/// A name without folders, as jobs make them.
fn is_file_name(text: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-');
    text.bytes().all(is_plain) && !text.starts_with('.') && media_type_of(text).is_some()
}

/// Columns of times, in ms since 1970.
const TIMES: [&str; 12] = [
    "created",
    "updated",
    "started",
    "finished",
    "claimable_from",
    "lease_expires",
    "heartbeat",
    "at",
    "alive",
    "erased",
    "expires",
    "revoked",
];
/// The end of the year 9999.
const LATEST_MS: i64 = 253_402_300_799_999;

/// What integers of a column are, where this is none of them.
pub(super) fn other_integer(column: &str, number: i64) -> Option<&'static str> {
    let (range, name) = match TIMES.contains(&column) {
        true => (0..=LATEST_MS, "times in ms from 1970 to 9999"),
        false => (0..=i64::MAX, "integers from 0"),
    };
    (!range.contains(&number)).then_some(name)
}

/// What is wrong with a file of a job whose blob has so many bytes.
pub(super) fn wrong_file(name: &str, media_type: &str, bytes: i64, blob: u64) -> Option<String> {
    let wanted = media_type_of(name)?;
    if media_type != wanted {
        return Some(format!("column media_type holds {wanted} for {name}, not {media_type:?}"));
    }
    let is_size = u64::try_from(bytes) == Ok(blob);
    (!is_size).then(|| format!("column bytes holds {bytes}, and the blob has {blob} bytes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(table: &str, column: &str) -> TextForm {
        TextForm::of(table, column, any_object).unwrap()
    }

    #[test]
    fn a_document_is_read_by_its_own_type_and_its_reason_names_no_type_of_the_program() {
        let read = [
            ("cases", "document", r#"{"units":"mm","volume":""}"#),
            ("cases", "report", "null"),
            ("plans", "document", "{}"),
            ("jobs", "document", "{}"),
            ("jobs", "truths", "[]"),
            ("jobs", "error", r#"{"type":"worker-lost","class":"infrastructure","detail":""}"#),
            ("cohorts", "consent", r#"{"statement":"a form","uses":["learn"]}"#),
        ];
        for (table, column, text) in read {
            assert!(form(table, column).read(text).is_ok(), "{table} {column}");
        }
        let wrong = [
            ("cases", "document", "{}", "missing field `units`"),
            ("cases", "report", "{}", "missing field `nodes` at column 2"),
            ("plans", "document", "5", "invalid type: integer `5`, expected an object at column 1"),
            ("plans", "document", r#"{"colour":1}"#, "unknown field `colour`"),
            ("jobs", "document", "[]", "expected"),
            ("jobs", "engine", "{}", "missing field `name`"),
            ("jobs", "error", "{}", "missing field `type`"),
            ("jobs", "result", "{}", "missing field `files`"),
            ("jobs", "truths", "{}", "expected a sequence"),
            ("cohorts", "consent", "{}", "missing field `statement`"),
            ("cohort_members", "document", "{}", "missing field `prediction`"),
            ("meshes", "report", "{}", "missing field `id`"),
        ];
        for (table, column, text, wanted) in wrong {
            let reason = told(&form(table, column).read(text).unwrap_err().unwrap());
            assert!(reason.contains(wanted) && !reason.contains("struct"), "{table}: {reason}");
        }
        assert!(matches!(form("jobs", "kind").read("abc"), Err(None)));
    }

    #[test]
    fn a_file_of_a_job_has_a_plain_name_and_the_media_type_of_its_ending() {
        let reads = |name| form("job_files", "name").read(name).is_ok();
        for name in ["skin.vtp", "report.junit.xml", "chart-1-a_b-.svg"] {
            assert!(reads(name), "{name}");
        }
        for name in ["", "../../x", "a/skin.vtp", "skin.vtp\n", ".svg", "skin", "skin.exe"] {
            assert!(!reads(name), "{name}");
        }
        let told = |media_type, bytes| wrong_file("skin.vtp", media_type, bytes, 5);
        assert_eq!(told("application/vnd.vtk.xml", 5), None);
        for media_type in ["text/html", "application/vnd.vtk.xml\r\nX: y"] {
            assert!(told(media_type, 5).unwrap().contains("column media_type"), "{media_type}");
        }
        for bytes in [-5, 4] {
            assert!(told("application/vnd.vtk.xml", bytes).unwrap().contains("column bytes"));
        }
    }
}
