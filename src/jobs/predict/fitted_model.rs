//! A learned model as stored, fitted to its cases before anything is solved.

use crate::schema::learn::model::ModelDocument;
use mechanics::learning::{CohortError, LearnedModel};

/// The model that corrects a prediction.
pub struct FittedModel {
    pub document: ModelDocument,
    pub learned: LearnedModel,
}

impl FittedModel {
    /// An error if the cases do not correspond.
    pub fn new(document: ModelDocument) -> Result<Self, CohortError> {
        Ok(FittedModel { learned: document.to_model()?, document })
    }
}
