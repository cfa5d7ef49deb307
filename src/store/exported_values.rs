//! What the values of a row have to be so that the service can read them, beside what the tables demand.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;

use crate::schema::job::JobStatus;
use crate::schema::job_document::JobKind;
use crate::schema::key::scopes_of;
use crate::schema::mesh::MeshDocument;
use crate::schema::predict::output::media_type_of;

#[derive(Clone, Copy)]
pub(super) enum TextForm {
    JobKind,
    JobStatus,
    Scopes,
    MeshDocument,
    FileName,
    Object,
    ObjectOrNull,
    List,
}

/// Columns whose text is read as more than a text, where it is there.
const WANTED: [(&str, &str, TextForm); 16] = [
    ("keys", "scopes", TextForm::Scopes),
    ("meshes", "report", TextForm::MeshDocument),
    ("cases", "document", TextForm::Object),
    // A case that is being meshed has none yet.
    ("cases", "report", TextForm::ObjectOrNull),
    ("plans", "document", TextForm::Object),
    ("jobs", "kind", TextForm::JobKind),
    ("jobs", "status", TextForm::JobStatus),
    ("jobs", "document", TextForm::Object),
    ("jobs", "engine", TextForm::Object),
    ("jobs", "error", TextForm::Object),
    ("jobs", "result", TextForm::Object),
    ("jobs", "truths", TextForm::List),
    ("job_events", "status", TextForm::JobStatus),
    ("job_files", "name", TextForm::FileName),
    ("cohorts", "consent", TextForm::Object),
    ("cohort_members", "document", TextForm::Object),
];

impl TextForm {
    pub fn of(table: &str, column: &str) -> Option<TextForm> {
        let found = WANTED.iter().find(|row| (row.0, row.1) == (table, column));
        found.map(|row| row.2)
    }

    pub fn is(self, text: &str) -> bool {
        match self {
            TextForm::JobKind => JobKind::from_name(text).is_some(),
            TextForm::JobStatus => JobStatus::from_name(text).is_some(),
            TextForm::Scopes => scopes_of(text).is_ok(),
            TextForm::MeshDocument => serde_json::from_str::<MeshDocument>(text).is_ok(),
            TextForm::FileName => is_file_name(text),
            TextForm::Object => serde_json::from_str::<BTreeMap<String, IgnoredAny>>(text).is_ok(),
            TextForm::ObjectOrNull => text == "null" || TextForm::Object.is(text),
            TextForm::List => serde_json::from_str::<Vec<IgnoredAny>>(text).is_ok(),
        }
    }

    /// What such a column holds.
    pub fn name(self) -> &'static str {
        match self {
            TextForm::JobKind => "a kind of job",
            TextForm::JobStatus => "the status of a job",
            TextForm::Scopes => "scopes",
            TextForm::MeshDocument => "the report of a mesh",
            TextForm::FileName => "the name of a file of a result",
            TextForm::Object => "an object of JSON",
            TextForm::ObjectOrNull => "an object of JSON or null",
            TextForm::List => "a list of JSON",
        }
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

    #[test]
    fn a_file_of_a_job_has_a_plain_name_and_the_media_type_of_its_ending() {
        for name in ["skin.vtp", "report.junit.xml", "chart-1-a_b-.svg"] {
            assert!(TextForm::FileName.is(name), "{name}");
        }
        for name in ["", "../../x", "a/skin.vtp", "skin.vtp\n", ".svg", "skin", "skin.exe"] {
            assert!(!TextForm::FileName.is(name), "{name}");
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
