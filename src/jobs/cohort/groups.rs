//! The groups of a cohort: the same subjects by each method.

use crate::jobs::failure::JobError;
use crate::schema::cohort::document::CohortDocument;
use crate::schema::cohort::result::{CohortGroupDocument, CohortRowDocument};
use crate::schema::compare::result::StatDocument;
use mechanics::validation::{Statistics, StatisticsError};

/// Groups that are tested in pairs, and others that are only in the table.
pub(super) struct Groups {
    pub tested: Vec<CohortGroupDocument>,
    pub beside: Vec<CohortGroupDocument>,
}

/// A group of subjects with their distances.
pub(super) fn group(
    spec: &CohortDocument,
    name: &str,
    rows: Vec<CohortRowDocument>,
) -> Result<CohortGroupDocument, JobError> {
    let values: Vec<f64> = rows.iter().map(|row| spec.statistic.of(&row.distances)).collect();
    let over_subjects = match Statistics::of_subjects(&values) {
        Err(StatisticsError::Empty) => StatDocument::default(),
        found => StatDocument::from(&found?),
    };
    Ok(CohortGroupDocument { name: name.to_owned(), rows, over_subjects })
}
