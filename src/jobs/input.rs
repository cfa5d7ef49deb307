//! Job input: a job as queued, and the common parts of the inputs of all kinds.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::cohort::CohortInput;
use super::compare::CompareInput;
use super::conform::ConformInput;
use super::failure::JobError;
use super::learn::LearnInput;
use super::meshing::MeshingInput;
use super::optimise::OptimiseInput;
use super::predict::PredictInput;
use super::reproduce::ReproduceInput;
use super::response::ResponseInput;
use super::study::StudyInput;
use crate::schema::CaseDocument;
use crate::schema::case::document::LengthUnit;
use crate::schema::job_document::JobKind;
use crate::schema::study::document::StudyKind;

/// Everything that determines its result, except the meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(clippy::large_enum_variant, reason = "there is one for each job, not thousands in a row")]
pub enum JobInput {
    Predict(PredictInput),
    Compare(CompareInput),
    Response(ResponseInput),
    Optimise(OptimiseInput),
    Reproduce(ReproduceInput),
    Cohort(CohortInput),
    Learn(LearnInput),
    Conform(ConformInput),
    Meshing(MeshingInput),
    Study(StudyInput),
}

impl JobInput {
    pub fn kind(&self) -> JobKind {
        match self {
            JobInput::Predict(_) => JobKind::Predict,
            JobInput::Compare(_) => JobKind::Compare,
            JobInput::Response(_) => JobKind::Response,
            JobInput::Optimise(_) => JobKind::Optimise,
            JobInput::Reproduce(_) => JobKind::Reproduce,
            JobInput::Cohort(_) => JobKind::Cohort,
            JobInput::Learn(_) => JobKind::Learn,
            JobInput::Conform(_) => JobKind::Conform,
            JobInput::Meshing(_) => JobKind::Mesh,
            JobInput::Study(input) => match input.spec.kind {
                StudyKind::Study => JobKind::Study,
                StudyKind::Batch => JobKind::Batch,
            },
        }
    }

    /// Reads a stored input, which lacks its case as long as that waits for its mesh.
    pub fn check_stored(text: &str) -> serde_json::Result<()> {
        let mut stored: Value = serde_json::from_str(text)?;
        let inputs = stored.as_object_mut().into_iter().flat_map(Map::values_mut);
        if let Some(case) =
            inputs.filter_map(|input| input.get_mut("case")).find(|case| case.is_null())
        {
            *case = serde_json::to_value(CaseDocument::of_volume("", LengthUnit::Mm))?;
        }
        serde_json::from_value::<JobInput>(stored).map(drop)
    }

    /// An error of the job with its places in the document that was posted: the parts of an input have them in theirs. The meshing of a
    /// case is a member of that.
    pub fn as_posted(&self, error: JobError) -> JobError {
        let is_of_case = matches!(self, JobInput::Meshing(meshing) if meshing.case.is_some());
        match error {
            JobError::Refused(problem) => {
                JobError::Refused(problem.moved("/spec", if is_of_case { "/meshing" } else { "" }))
            }
            other => other,
        }
    }

    /// The same with the id of its job and its wait from acceptance to start, in s.
    pub fn of_job(mut self, id: &str, waited_s: f64) -> JobInput {
        let (job, queue_s) = (Some(id.to_owned()), Some(waited_s));
        match &mut self {
            JobInput::Predict(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Compare(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Response(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Optimise(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Reproduce(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Cohort(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Learn(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Conform(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Meshing(input) => (input.job, input.queue_s) = (job, queue_s),
            JobInput::Study(input) => (input.job, input.queue_s) = (job, queue_s),
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stored_input_may_lack_its_case_and_nothing_else() {
        let whole = r#"{"predict":{"case":{"units":"mm","volume":"a"},"plan":{},"spec":{}}}"#;
        let waiting = r#"{"predict":{"case":null,"plan":{},"spec":{}}}"#;
        for text in [whole, waiting] {
            JobInput::check_stored(text).unwrap();
        }
        let wrong = [
            "",
            "{}",
            r#"{"predict":{}}"#,
            r#"{"predict":{"plan":{},"spec":{}}}"#,
            r#"{"predict":{"case":{},"plan":{},"spec":{}}}"#,
            r#"{"predict":{"case":null,"plan":null,"spec":{}}}"#,
            r#"{"guess":{"case":null,"plan":{},"spec":{}}}"#,
        ];
        for text in wrong {
            assert!(JobInput::check_stored(text).is_err(), "{text}");
        }
    }
}
