//! Kinds of jobs: the table of them, and the body of `POST /v1/jobs`, which is a document of one kind.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::cohort::document::CohortDocument;
use crate::schema::compare::document::CompareDocument;
use crate::schema::conform::document::ConformDocument;
use crate::schema::learn::document::LearnDocument;
use crate::schema::meshing::document::MeshingDocument;
use crate::schema::optimise::document::OptimiseDocument;
use crate::schema::predict::document::PredictDocument;
use crate::schema::reproduce::document::ReproduceDocument;
use crate::schema::response::ResponseDocument;
use crate::schema::study::document::StudyDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::problem::Problem;
use crate::schema::wire::strict;

/// A row of the table of kinds.
struct Row {
    name: &'static str,
    /// Its schema name in the OpenAPI description.
    document: fn() -> Cow<'static, str>,
    priority: i64,
    has_report: bool,
}

/// Makes the enum of the kinds and their table, so that a kind is in both or in neither.
macro_rules! job_kinds {
    ($($kind:ident, $name:tt, $document:ty, $priority:literal, $has_report:literal;)+) => {
        /// The kind of a job.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
        pub enum JobKind {
            $(#[serde(rename = $name)] $kind,)+
        }

        impl JobKind {
            /// Every kind, in the order of lists.
            pub const ALL: &[JobKind] = &[$(JobKind::$kind,)+];

            fn row(self) -> Row {
                match self {
                    $(JobKind::$kind => Row {
                        name: $name,
                        document: <$document as ToSchema>::name,
                        priority: $priority,
                        has_report: $has_report,
                    },)+
                }
            }
        }
    };
}

// Kind, word, document, priority, whether it has a report. Somebody waits for what one plan or one case needs;
// a study can wait.
job_kinds! {
    Predict, "predict", PredictDocument, 0, false;
    Compare, "compare", CompareDocument, 0, false;
    Response, "response", ResponseDocument, 0, false;
    Optimise, "optimise", OptimiseDocument, 0, false;
    Reproduce, "reproduce", ReproduceDocument, 0, false;
    Cohort, "cohort", CohortDocument, 0, false;
    Learn, "learn", LearnDocument, 1, false;
    Conform, "conform", ConformDocument, 0, false;
    Mesh, "mesh", MeshingDocument, 0, false;
    Study, "study", StudyDocument, 1, true;
    Batch, "batch", StudyDocument, 1, true;
}

impl JobKind {
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The name of the schema of its document.
    pub fn document(self) -> Cow<'static, str> {
        (self.row().document)()
    }

    /// Its priority in the queue; the smallest is first.
    pub fn priority(self) -> i64 {
        self.row().priority
    }

    /// Whether its result is a report with rows.
    pub fn has_report(self) -> bool {
        self.row().has_report
    }

    /// The kind of a stored word.
    pub fn from_name(name: &str) -> Option<JobKind> {
        JobKind::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// The words of all kinds, the last one behind `joint`.
    fn listed(joint: &str) -> String {
        let words: Vec<String> =
            JobKind::ALL.iter().map(|kind| format!("`{}`", kind.name())).collect();
        match words.split_last() {
            Some((last, others)) => format!("{} {joint} {last}", others.join(", ")),
            None => String::new(),
        }
    }

    fn read(value: &Value) -> Result<JobKind, Problem> {
        if !value.is_object() {
            let detail = "expected an object with a member `kind`, found something else";
            return Err(Problem::at(&Pointer::root(), ErrorCode::WrongType, detail));
        }
        let at = Pointer::root().key("kind");
        let Some(kind) = value.get("kind") else {
            let detail = format!("missing field `kind`: {}", JobKind::listed("or"));
            return Err(Problem::at(&at, ErrorCode::MissingField, detail));
        };
        let Some(word) = kind.as_str() else {
            return Err(Problem::at(&at, ErrorCode::WrongType, "the kind of a job is a string"));
        };
        JobKind::from_name(word).ok_or_else(|| {
            let detail = format!("`{word}` is not a kind of job; {} are", JobKind::listed("and"));
            Problem::at(&at, ErrorCode::UnknownWord, detail)
        })
    }
}

/// The body of `POST /v1/jobs`, distinguished by `kind`.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum JobDocument {
    // By far the largest of the documents are predictions and studies.
    Predict(Box<PredictDocument>),
    Compare(CompareDocument),
    Response(ResponseDocument),
    Optimise(OptimiseDocument),
    Reproduce(ReproduceDocument),
    Cohort(CohortDocument),
    Learn(LearnDocument),
    Conform(ConformDocument),
    Mesh(MeshingDocument),
    Study(Box<StudyDocument>),
}

impl JobDocument {
    /// Whether it stores meshes for other jobs.
    pub fn keeps_meshes(&self) -> bool {
        match self {
            JobDocument::Mesh(_) | JobDocument::Conform(_) => true,
            JobDocument::Predict(document) => !document.keep.is_empty(),
            JobDocument::Compare(_)
            | JobDocument::Response(_)
            | JobDocument::Optimise(_)
            | JobDocument::Reproduce(_)
            | JobDocument::Cohort(_)
            | JobDocument::Learn(_)
            | JobDocument::Study(_) => false,
        }
    }

    /// The body of `POST /v1/jobs`.
    pub fn parse(bytes: &[u8], limits: &Limits) -> Result<JobDocument, Problem> {
        let value = strict::parse_value(bytes, limits)?;
        match JobKind::read(&value)? {
            JobKind::Predict => {
                let document: PredictDocument = strict::from_value(value)?;
                let mut faults = Faults::default();
                document.check_for_service(&mut faults);
                faults.into_result().map(|()| JobDocument::Predict(Box::new(document)))
            }
            JobKind::Compare => strict::from_value(value).map(JobDocument::Compare),
            JobKind::Response => strict::from_value(value).map(JobDocument::Response),
            JobKind::Optimise => strict::from_value(value).map(JobDocument::Optimise),
            JobKind::Reproduce => strict::from_value(value).map(JobDocument::Reproduce),
            JobKind::Cohort => strict::from_value(value).map(JobDocument::Cohort),
            JobKind::Learn => strict::from_value(value).map(JobDocument::Learn),
            JobKind::Conform => strict::from_value(value).map(JobDocument::Conform),
            JobKind::Mesh => strict::from_value(value).map(JobDocument::Mesh),
            JobKind::Study | JobKind::Batch => {
                strict::from_value(value).map(Box::new).map(JobDocument::Study)
            }
        }
    }
}
