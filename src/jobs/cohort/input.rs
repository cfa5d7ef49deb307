//! Input of a cohort.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::schema::CohortDocument;
use crate::schema::compare::result::ComparisonDocument;
use crate::schema::hashes::cohort_hash;

/// A cohort of comparisons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CohortInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: CohortDocument,
    /// What each job found, by its id.
    pub comparisons: BTreeMap<String, ComparisonDocument>,
}

impl CohortInput {
    /// The hash of everything that decides the numbers.
    pub fn spec_hash(&self) -> String {
        cohort_hash(&self.spec, &self.comparisons)
    }
}
