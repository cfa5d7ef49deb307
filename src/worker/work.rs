//! Interface between a slot and the rest of the worker: input, output and failures of an attempt.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::fail_point::Injected;
use super::process::protocol::{Effort, MeshFile};
use crate::schema::ErrorCode;
use crate::schema::job::ErrorClass;
use crate::store::{Claim, StoreError};
use mechanics::progress::Progress;

/// How often the worker looks whether a job is still wanted, and what its process takes.
pub(super) const LOOK: Duration = Duration::from_millis(100);
/// How long a process, or a publication, may go on that was cancelled, or whose budget of time is used up.
pub(super) const GRACE: Duration = Duration::from_secs(10);

/// Result of an attempt: the manifest, and files in its folder.
pub struct Finished {
    /// JSON.
    pub result: String,
    pub files: Vec<FinishedFile>,
    pub meshes: Vec<FinishedMesh>,
    pub effort: Effort,
    /// When the time of the job is up, and that of its publication, if it has not begun late.
    pub until: Option<Instant>,
}

/// A file by its name in the folder of the attempt.
pub struct FinishedFile {
    pub name: String,
    pub media_type: String,
    pub path: PathBuf,
}

/// A mesh to be stored, and its bytes in the folder of the attempt.
pub struct FinishedMesh {
    pub mesh: MeshFile,
    pub path: PathBuf,
}

/// Why an attempt made nothing.
#[derive(Debug)]
pub enum Failure {
    /// It was cancelled.
    Cancelled,
    /// The job's own fault, never tried again: JSON with `type` and `detail`.
    Permanent(serde_json::Value),
    /// The storage's fault: tried again. JSON with `type` and `detail`, and the reason for the log.
    Storage { error: serde_json::Value, reason: String },
    /// Its process died; the reason. Tried again.
    Lost(String),
}

impl Failure {
    /// The storage did not take the results, for a reason that is for the log only.
    pub fn of_results(reason: impl std::fmt::Display) -> Failure {
        let error = serde_json::json!({
            "type": ErrorCode::Storage,
            "class": ErrorClass::Infrastructure,
            "detail": "the results could not be stored",
        });
        Failure::Storage { error, reason: reason.to_string() }
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Failure::of_results(error)
    }
}

impl From<Injected> for Failure {
    fn from(_: Injected) -> Self {
        Failure::of_results("a fail point erred")
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Failure::of_results(error)
    }
}

/// From a claimed job to files in a folder: the work of one slot.
pub trait Work: Send {
    /// Makes ready for a job before one is claimed; an error says after which wait to ask again.
    fn prepare(&mut self) -> Result<(), Duration> {
        Ok(())
    }

    fn work(
        &mut self,
        claim: &Claim,
        folder: &Path,
        progress: &dyn Progress,
    ) -> Result<Finished, Failure>;
}
