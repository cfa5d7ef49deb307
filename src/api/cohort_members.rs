//! Members of a posted cohort: each another patient, all in one frame.

use std::collections::BTreeSet;

use super::Service;
use super::accepted::{fault, require_mesh};
use super::cohort_input::compared;
use super::error::{ApiError, ApiResult};
use super::learn_input::learned;
use super::meshes::document_of;
use crate::schema::case::document::FrameName;
use crate::schema::cohort::stored::{MemberDocument, StoredCohortDocument};
use crate::schema::mesh::MeshDocument;
use crate::schema::{CaseDocument, ErrorCode};
use crate::store::MemberRow;

/// Shared and individual data of members.
#[derive(Default)]
struct CommonProperties {
    frame: Option<FrameName>,
    cases: BTreeSet<String>,
    /// Of meshes after the operation.
    contents: BTreeSet<String>,
}

/// The members of a document with checked form: each of another patient, all in one frame.
pub async fn members_of(
    service: &Service,
    document: &StoredCohortDocument,
) -> ApiResult<Vec<MemberRow>> {
    let mut seen = CommonProperties::default();
    let mut rows = Vec::new();
    for (number, member) in (1..).zip(&document.members) {
        let at = format!("/members/{}", number - 1);
        let case_id = checked(service, &at, member, &mut seen).await?;
        for (method, job) in &member.comparisons {
            let at = format!("{at}/comparisons/{method}");
            compared(service, &at, job).await?;
            if !service.store.cases_of_job(job).await?.contains(&case_id) {
                let detail = "the job compared another case than that of the prediction";
                return Err(fault(&at, ErrorCode::OtherCase, detail));
            }
        }
        rows.push(MemberRow {
            number,
            case_id,
            job_id: member.prediction.clone(),
            mesh_id: member.actual.clone(),
            document: serde_json::to_string(member).map_err(ApiError::internal)?,
        });
    }
    Ok(rows)
}

/// The case of a member.
async fn checked(
    service: &Service,
    at: &str,
    member: &MemberDocument,
    seen: &mut CommonProperties,
) -> ApiResult<String> {
    let (prediction, actual) = (format!("{at}/prediction"), format!("{at}/actual"));
    let found = learned(service, &prediction, &member.prediction).await?;
    let without = || fault(&prediction, ErrorCode::UnknownCase, "the prediction has no case");
    let case_id = found.case.ok_or_else(without)?;
    if !seen.cases.insert(case_id.clone()) {
        let detail = format!(
            "its case {case_id} is listed twice: training and test cases have to be different patients"
        );
        return Err(fault(&prediction, ErrorCode::DuplicateName, &detail));
    }
    let frame = frame_of(service, &found.prediction.case).await?;
    let first = *seen.frame.get_or_insert(frame);
    if frame != first {
        let detail = format!("its case is in {frame:?}, that of the first member in {first:?}");
        return Err(fault(&prediction, ErrorCode::FrameConflict, &detail));
    }
    if !seen.contents.insert(require_mesh(service, &actual, &member.actual).await?) {
        let detail = "the same mesh is that of another member: members are different patients";
        return Err(fault(&actual, ErrorCode::DuplicateName, detail));
    }
    let marked = mesh(service, &member.actual).await?.and_then(|mesh| mesh.report.space);
    if let Some(marked) = marked.filter(|marked| *marked != frame) {
        let detail = format!("the mesh is in {marked:?}, and the case in {frame:?}");
        return Err(fault(&actual, ErrorCode::FrameConflict, &detail));
    }
    Ok(case_id)
}

/// The frame of a case: as stated, or as its mesh is marked.
async fn frame_of(service: &Service, case: &CaseDocument) -> ApiResult<FrameName> {
    match case.frame {
        FrameName::Unspecified => {
            let marked = mesh(service, &case.volume).await?.and_then(|mesh| mesh.report.space);
            Ok(marked.unwrap_or(FrameName::Unspecified))
        }
        stated @ (FrameName::Lps | FrameName::Ras) => Ok(stated),
    }
}

async fn mesh(service: &Service, id: &str) -> ApiResult<Option<MeshDocument>> {
    service.store.mesh(id).await?.as_ref().map(document_of).transpose()
}
