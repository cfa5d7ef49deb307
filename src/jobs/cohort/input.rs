//! Input of a cohort.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::schema::CohortDocument;
use crate::schema::cohort::stored::CohortVersionDocument;
use crate::schema::compare::result::ComparisonDocument;
use crate::schema::hashes::cohort_hash;
use crate::schema::predict::result::ResultDocument;

/// A cohort of comparisons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CohortInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: CohortDocument,
    /// The stored cohort of the groups.
    #[serde(default)]
    pub cohort: Option<CohortVersionDocument>,
    /// Result of each job, by its id.
    pub comparisons: BTreeMap<String, ComparisonDocument>,
    /// The SHA-256 of the scan of each comparison, by its id: it identifies the patient.
    #[serde(default)]
    pub actuals: BTreeMap<String, String>,
}

impl CohortInput {
    /// Adds the result of a job, if it is a comparison.
    pub fn take(&mut self, job: &str, result: ResultDocument) -> bool {
        let inputs = result.provenance.inputs.into_iter();
        let actual = inputs.into_iter().find(|input| input.role == "actual");
        self.actuals.extend(actual.map(|actual| (job.to_owned(), actual.sha256)));
        let found = result.comparison.map(|comparison| (job.to_owned(), comparison));
        let has_compared = found.is_some();
        self.comparisons.extend(found);
        has_compared
    }

    /// The hash of everything that determines the numbers.
    pub fn spec_hash(&self) -> String {
        cohort_hash(&self.spec, self.cohort.as_ref(), &self.comparisons)
    }
}
