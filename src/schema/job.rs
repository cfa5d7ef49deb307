//! The state of a job: statusInfo (OGC API Processes part 1, section 7.12) and its error.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::job_document::JobKind;
use crate::schema::link::Link;
use crate::schema::predict::result::{EngineDocument, ResultDocument};
use crate::schema::study::expected::TruthCostDocument;
use crate::schema::wire::warning::WarningDocument;

/// The status of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum JobStatus {
    Accepted,
    Running,
    Successful,
    Failed,
    Dismissed,
}

impl JobStatus {
    pub fn name(self) -> &'static str {
        match self {
            JobStatus::Accepted => "accepted",
            JobStatus::Running => "running",
            JobStatus::Successful => "successful",
            JobStatus::Failed => "failed",
            JobStatus::Dismissed => "dismissed",
        }
    }

    /// The status of a stored word.
    pub fn from_name(name: &str) -> Option<JobStatus> {
        use JobStatus::{Accepted, Dismissed, Failed, Running, Successful};
        [Accepted, Running, Successful, Failed, Dismissed]
            .into_iter()
            .find(|status| status.name() == name)
    }

    /// Whether the status is final.
    pub fn is_terminal(self) -> bool {
        !matches!(self, JobStatus::Accepted | JobStatus::Running)
    }
}

/// The state of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StatusInfo {
    pub id: String,
    pub kind: JobKind,
    pub status: JobStatus,
    /// `validate`, `mesh`, `assemble`, `solve`, `estimate`, `contact`, `surface`, `compare`, `correct` or `write`, while it runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub phase: Option<String>,
    pub message: String,
    /// 0 to 100, never decreasing.
    #[schema(maximum = 100)]
    pub progress: u8,
    /// Of the present solution; absent once the job has ended, as `residual` and `phase`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub iteration: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub residual: Option<f64>,
    /// RFC 3339, UTC.
    pub created: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub started: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub finished: Option<String>,
    pub updated: String,
    /// The number of starts.
    pub attempt: u32,
    /// Position in the queue, 0 is next; absent once it has started, and while it waits for the mesh of its case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub queue_position: Option<u64>,
    pub spec_hash: String,
    pub engine: EngineDocument,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub case: Option<String>,
    pub tags: Vec<String>,
    /// True if this is an earlier job with the same hash.
    #[serde(default)]
    #[schema(required)]
    pub deduplicated: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error: Option<JobErrorDocument>,
    pub warnings: Vec<WarningDocument>,
    /// The manifest, as soon as `status` is successful.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub results: Option<ResultDocument>,
    /// Of a study: the expected cost of the reference solutions, known from the start.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub truths: Vec<TruthCostDocument>,
    pub links: Vec<Link>,
}

/// A past state of a job: the `data` of an event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobEvent {
    /// From 1, without gaps: the `id` of the event.
    pub number: u64,
    /// RFC 3339, UTC.
    pub at: String,
    pub status: JobStatus,
    /// As in statusInfo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub phase: Option<String>,
    /// 0 to 100, never decreasing.
    #[schema(maximum = 100)]
    pub progress: u8,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub iteration: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub residual: Option<f64>,
    /// The number of starts.
    pub attempt: u32,
    /// True if the job was removed before this stream had its end: `status` is `dismissed` whatever the end was.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub removed: bool,
}

/// Why a job failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobErrorDocument {
    /// A stable word, e.g. `solver-diverged`, `budget-exceeded`, `worker-lost`.
    #[serde(rename = "type")]
    pub kind: String,
    pub class: ErrorClass,
    pub detail: String,
    /// Members of the type, e.g. `which` of `budget-exceeded`.
    #[serde(flatten)]
    #[schema(value_type = Object)]
    pub members: Map<String, Value>,
}

impl JobErrorDocument {
    /// That of a meshing which was dismissed or removed before its end.
    pub fn of_unended_meshing(how: &str) -> Self {
        JobErrorDocument {
            kind: ErrorCode::Cancelled.name().to_owned(),
            class: ErrorClass::Cancelled,
            detail: format!("the meshing was {how} before it made a mesh"),
            members: Map::new(),
        }
    }
}

/// The cause of a failure; only `infrastructure` is retried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ErrorClass {
    /// The numerics: a repetition would fail again.
    Numerical,
    /// The documents or meshes.
    Input,
    /// Disks, databases, processes.
    Infrastructure,
    /// Stopped on request.
    Cancelled,
    /// Time or memory limits of the spec.
    Budget,
}
