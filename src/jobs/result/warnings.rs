//! Warnings of a result.

use crate::schema::WarningDocument;
use mechanics::mesh::Warning;

/// Warnings as documents, without duplicates.
pub fn warning_documents<'a>(warnings: impl Iterator<Item = &'a Warning>) -> Vec<WarningDocument> {
    warnings_after(&[], warnings)
}

/// The same after those of the meshing of a volume.
pub fn warnings_after<'a>(
    told: &[WarningDocument],
    warnings: impl Iterator<Item = &'a Warning>,
) -> Vec<WarningDocument> {
    let mut documents: Vec<WarningDocument> = Vec::new();
    for warning in told.iter().cloned().chain(warnings.map(WarningDocument::from)) {
        if !documents.contains(&warning) {
            documents.push(warning);
        }
    }
    documents
}
