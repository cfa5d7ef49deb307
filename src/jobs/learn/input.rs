//! Input of learning.

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::jobs::failure::JobError;
use crate::jobs::predict::PredictInput;
use crate::schema::cohort::stored::CohortVersionDocument;
use crate::schema::wire::canonical::{hash, to_value};
use crate::schema::{ErrorCode, LearnDocument, Pointer, Problem};
use mechanics::prediction::MethodKind;

/// Cases to learn from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearnInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: LearnDocument,
    /// The stored cohort that the spec has its cases from.
    #[serde(default)]
    pub cohort: Option<CohortVersionDocument>,
    /// One for each case of the spec.
    pub cases: Vec<LearnedCase>,
}

/// What was predicted of a case, as its job was asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearnedCase {
    /// Of the service.
    pub case: Option<String>,
    pub spec_hash: Option<String>,
    pub prediction: PredictInput,
}

impl LearnedCase {
    /// Refuses a prediction that chose its model or its mesh itself: another case is answered by another one, which misses
    /// something else. `at` is its place.
    pub fn check_settings(&self, at: &Pointer) -> Result<(), Problem> {
        let spec = &self.prediction.spec;
        let (what, instead) = match (&spec.refine, spec.accepted()) {
            (Some(_), _) => ("its mesh was refined (`refine`)", "on the mesh of the case"),
            (None, Some(_)) => ("the method `auto` chose its model", "by a named `method`"),
            (None, None) => return Ok(()),
        };
        let detail = format!(
            "{what}, and each case is then missed by something else: predict the case {instead} to learn from it"
        );
        Err(Problem::at(at, ErrorCode::MethodMismatch, detail))
    }
}

impl LearnInput {
    /// The method of the predictions; virtual patients are predicted by linear elements.
    pub fn predicted_by(&self) -> String {
        let stated = self.cases.first().map(|case| case.prediction.spec.method.chosen().name());
        stated.unwrap_or(MethodKind::FemLinear.name()).to_owned()
    }

    /// The hash of everything that decides the numbers, meshes by their ids.
    pub fn spec_hash(&self) -> String {
        let mut spec = self.spec.clone();
        spec.tags.clear();
        let predictions: Vec<_> = self.cases.iter().map(|case| &case.spec_hash).collect();
        match &self.cohort {
            None => hash(json!({ "spec": to_value(&spec), "predictions": predictions })),
            Some(cohort) => hash(
                json!({ "spec": to_value(&spec), "predictions": predictions, "cohort": to_value(cohort) }),
            ),
        }
    }

    /// What is wrong with a case, at its place in the document that was posted.
    pub fn at_its_place(&self, error: JobError) -> JobError {
        match (error, &self.cohort) {
            (JobError::Refused(problem), Some(_)) => {
                JobError::Refused(problem.moved("/spec/cases", "/spec/cohort/members"))
            }
            (error, _) => error,
        }
    }
}
