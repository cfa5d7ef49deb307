//! Dispatch of jobs: the one function from a job document to result files.

use super::cohort::cohort_job;
use super::compare::compare_job;
use super::conform::conform_job;
use super::failure::JobError;
use super::input::JobInput;
use super::learn::learn_job;
use super::meshing::meshing_job;
use super::optimise::optimise_job;
use super::output::{JobContext, JobOutput};
use super::predict::predict_job;
use super::reproduce::reproduce_job;
use super::response::response_job;
use super::study::study_job;
use mechanics::progress::Progress;

/// Runs a job. The same input and meshes give the same files, except times in `result.json`.
pub fn work(
    input: &JobInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    match input {
        JobInput::Predict(input) => predict_job(input, place, progress),
        JobInput::Compare(input) => compare_job(input, place, progress),
        JobInput::Response(input) => response_job(input, place, progress),
        JobInput::Optimise(input) => optimise_job(input, place, progress),
        JobInput::Reproduce(input) => reproduce_job(input, place, progress),
        JobInput::Cohort(input) => cohort_job(input, place, progress),
        JobInput::Learn(input) => learn_job(input, place, progress),
        JobInput::Conform(input) => conform_job(input, place, progress),
        JobInput::Meshing(input) => meshing_job(input, place, progress),
        JobInput::Study(input) => study_job(input, place, progress),
    }
}
