//! The work of the service's jobs: the job document of a claim, the meshes of the library, the numerics.

use std::path::Path;

use serde_json::json;

use super::failure::JobError;
use super::input::JobInput;
use super::library::LibrarySource;
use super::work::{Workplace, work};
use super::worker::{Failure, Finished, FinishedFile, Work};
use crate::prediction::Progress;
use crate::schema::Limits;
use crate::schema::job::ErrorClass;
use crate::store::Claim;

/// Jobs over stored meshes.
pub struct Numerics {
    pub source: LibrarySource,
    pub limits: Limits,
}

impl Work for Numerics {
    fn work(
        &self,
        claim: &Claim,
        folder: &Path,
        progress: &dyn Progress,
    ) -> Result<Finished, Failure> {
        let input = read_input(claim)?;
        let place = Workplace { sources: &self.source, limits: &self.limits, out: folder };
        let output = work(&input, &place, progress).map_err(|error| failure(&error))?;
        let result = serde_json::to_string(&output.result)
            .map_err(|error| internal(&format!("the manifest: {error}")))?;
        let files = output.files.into_iter().map(|file| FinishedFile {
            path: folder.join(&file.name),
            name: file.name,
            media_type: file.media_type,
        });
        Ok(Finished { result, files: files.collect() })
    }
}

/// The document of a claim, which now knows its job and how long it waited.
fn read_input(claim: &Claim) -> Result<JobInput, Failure> {
    let mut input: JobInput = serde_json::from_str(&claim.document)
        .map_err(|error| internal(&format!("the document of the job: {error}")))?;
    let job = Some(claim.lease.job.clone());
    let queue_s = Some((claim.started - claim.created) as f64 / 1e3);
    match &mut input {
        JobInput::Predict(input) => (input.job, input.queue_s) = (job, queue_s),
        JobInput::Compare(input) => (input.job, input.queue_s) = (job, queue_s),
        JobInput::Response(input) => (input.job, input.queue_s) = (job, queue_s),
        JobInput::Optimise(input) => (input.job, input.queue_s) = (job, queue_s),
        JobInput::Study(input) => (input.job, input.queue_s) = (job, queue_s),
    }
    Ok(input)
}

fn internal(reason: &str) -> Failure {
    tracing::error!(%reason, "a job could not be worked on");
    let detail = "the work broke off; the log has the details under the job's id";
    Failure::Permanent(json!({"type": "internal", "class": "infrastructure", "detail": detail}))
}

fn failure(error: &JobError) -> Failure {
    match error.class() {
        ErrorClass::Cancelled => Failure::Cancelled,
        ErrorClass::Infrastructure => Failure::Storage(error.to_string()),
        ErrorClass::Numerical | ErrorClass::Input | ErrorClass::Budget => {
            Failure::Permanent(json!(error.to_document()))
        }
    }
}
