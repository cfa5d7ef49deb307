//! The result of a cohort: a table, boxes, and tests in pairs.

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
    /// The statistic of boxes and tests.
    pub statistic: CohortStatistic,
    /// Of twins the four variants of the model, then the outcome with measurement errors, and no movement.
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
    /// Of the statistic over subjects: `min`, `p25`, `median`, `p75` and `max` are its box plot.
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
    /// Median of first minus second over the subjects.
    pub median_difference_mm: f64,
    /// Subjects that differ by more than 1e-4 mm.
    pub differing: u64,
    /// Rank sums of subjects whose first is larger, and whose second is.
    pub w_first_larger: f64,
    pub w_second_larger: f64,
    /// Two-sided; absent if no subject differs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub p: Option<f64>,
    /// Whether it is exact, over all signs (up to 25 that differ), and not approximated.
    pub is_exact: bool,
    /// The smallest p possible with this number of differing subjects: with fewer than 6 none is below 0.05.
    pub smallest_p: f64,
}
