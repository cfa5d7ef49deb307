//! Warnings of a result.

use crate::schema::WarningDocument;
use mechanics::mesh::Warning;

/// Warnings as documents, without repeats.
pub fn warning_documents<'a>(warnings: impl Iterator<Item = &'a Warning>) -> Vec<WarningDocument> {
    let mut documents: Vec<WarningDocument> = Vec::new();
    for warning in warnings.map(WarningDocument::from) {
        if !documents.contains(&warning) {
            documents.push(warning);
        }
    }
    documents
}
