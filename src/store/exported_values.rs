//! What the texts of a row have to be so that the service can read them, beside what the tables demand.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;

use crate::schema::job::JobStatus;
use crate::schema::job_document::JobKind;
use crate::schema::key::scopes_of;

#[derive(Clone, Copy)]
pub(super) enum TextForm {
    JobKind,
    JobStatus,
    Scopes,
    Object,
    ObjectOrNull,
    List,
}

/// Columns whose text is read as more than a text, where it is there.
const WANTED: [(&str, &str, TextForm); 15] = [
    ("keys", "scopes", TextForm::Scopes),
    ("meshes", "report", TextForm::Object),
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
            TextForm::Object => "an object of JSON",
            TextForm::ObjectOrNull => "an object of JSON or null",
            TextForm::List => "a list of JSON",
        }
    }
}
