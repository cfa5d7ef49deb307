//! A learned model as it was stored, fitted to its cases before anything is solved.

use crate::schema::learn::model::ModelDocument;
use mechanics::learning::{CohortError, LearnedModel};

/// What a prediction is corrected by.
pub struct FittedModel {
    pub document: ModelDocument,
    pub learned: LearnedModel,
}

impl FittedModel {
    /// Nothing can be learned from cases that do not correspond.
    pub fn new(document: ModelDocument) -> Result<Self, CohortError> {
        Ok(FittedModel { learned: document.to_model()?, document })
    }
}
