//! The answer of a cohort: a table, boxes, and tests in pairs.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::document::{CohortDistance, CohortStatistic};
use super::stored::CohortVersionDocument;
use crate::schema::compare::result::StatDocument;

/// Methods over the same subjects. Lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortResultDocument {
    /// The stored cohort whose members are the subjects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cohort: Option<CohortVersionDocument>,
    pub distance: CohortDistance,
    /// The number that boxes and tests are of.
    pub statistic: CohortStatistic,
    /// Of twins the four variants of the model, then what happened, with the errors of measuring it, and no movement.
    pub groups: Vec<CohortGroupDocument>,
    /// Every two groups, in the order of their names; of twins every two variants.
    pub pairs: Vec<CohortPairDocument>,
}

/// One method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortGroupDocument {
    pub name: String,
    /// One for each subject.
    pub rows: Vec<CohortRowDocument>,
    /// Of the statistic over subjects: `min`, `p25`, `median`, `p75` and `max` make its box.
    pub over_subjects: StatDocument,
}

/// The distances of one subject.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortRowDocument {
    pub subject: String,
    pub distances: StatDocument,
}

/// Wilcoxon's signed rank test of two methods on the same subjects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortPairDocument {
    pub first: String,
    pub second: String,
    /// Of first less second over the subjects: half of them are below it.
    pub median_difference_mm: f64,
    /// Subjects that differ by more than 1e-4 mm.
    pub differing: u64,
    /// Sums of the ranks of subjects whose first is larger, and whose second is.
    pub w_first_larger: f64,
    pub w_second_larger: f64,
    /// Two-sided; absent where no subject differs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub p: Option<f64>,
    /// Whether it is counted over all signs (up to 25 that differ) and not approximated.
    pub is_exact: bool,
    /// The smallest that so many differing subjects can give: with fewer than 6 no difference is below 0.05.
    pub smallest_p: f64,
}
