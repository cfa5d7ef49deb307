//! What the check of a scan found of its values, beside the error of a meshing that failed.

use super::input::PreparedMeshing;
use crate::jobs::failure::JobError;
use mechanics::image::scan_report;
use mechanics::mesh::Warning;

/// Findings by which thresholds mean nothing.
const DOUBTS: [&str; 2] = ["no-hounsfield", "values-implausible"];

/// The same error, with findings that may be its cause.
pub(super) fn with_doubts(error: JobError, prepared: &PreparedMeshing) -> JobError {
    if !matches!(error, JobError::Anatomy(_) | JobError::Refused(_)) {
        return error;
    }
    let Some(image) = prepared.body.image() else { return error };
    let of_file = prepared.meshes.iter().flat_map(|(_, mesh)| mesh.warnings.iter().cloned());
    let findings = of_file.chain(scan_report(image, prepared.frame).findings);
    let found: Vec<String> = findings
        .filter(|finding| DOUBTS.contains(&finding.code))
        .map(|Warning { code, detail, .. }| format!("{detail} ({code})"))
        .collect();
    if found.is_empty() {
        return error;
    }
    let found = found.join("; ");
    match error {
        JobError::Anatomy(error) => JobError::DoubtfulScan { error: Box::new(error), found },
        JobError::Refused(mut problem) => {
            problem.detail = format!("{}; the check of the scan found: {found}", problem.detail);
            JobError::Refused(problem)
        }
        other => other,
    }
}
