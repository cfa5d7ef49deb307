//! Stored cohorts: operated cases of a tenant, consent for learning, and stale models.

use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::IntoResponse;
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::routes;

use super::cohort_members::members_of;
use super::error::{ApiError, ApiResult};
use super::idempotency::{KeyedRequest, NewId};
use super::paging::PageParameters;
use super::parameters::{Id, Parameters};
use super::resources::Resources;
use super::{Service, body, conditional, json, time, with_header};
use crate::schema::cohort::stored::{ConsentDocument, MemberDocument, StoredCohortDocument};
use crate::schema::job::JobStatus;
use crate::schema::key::Scope;
use crate::schema::wire::strict;
use crate::schema::{ErrorCode, Faults};
use crate::store::{Change, CohortModelRow, CohortRow, LeftRow, MemberRow, NewCohort};

pub fn router() -> Resources {
    Resources::new()
        .reads(Scope::Read, routes!(list))
        .changes(Scope::Write, routes!(create))
        .reads(Scope::Read, routes!(show))
        .changes(Scope::Write, routes!(remove))
        .json_only()
}

/// A stored cohort.
#[derive(Serialize, ToSchema)]
pub struct CohortView {
    pub id: String,
    /// From 1; incremented whenever members leave.
    pub version: i64,
    /// RFC 3339, UTC.
    pub created: String,
    pub updated: String,
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub consent: Option<ConsentDocument>,
    pub members: Vec<CohortMemberView>,
    /// Former members, which left by erasure of the case or of its prediction.
    pub left: Vec<CohortLeftView>,
    /// Models learned from it, newest first, except those that were removed themselves.
    pub models: Vec<CohortModelView>,
}

/// A member.
#[derive(Serialize, ToSchema)]
pub struct CohortMemberView {
    /// Its number as posted, from 1.
    pub number: i64,
    /// The case of its prediction.
    pub case: String,
    pub member: MemberDocument,
}

/// A case that left.
#[derive(Serialize, ToSchema)]
pub struct CohortLeftView {
    pub case: String,
    /// The first version without it.
    pub version: i64,
}

/// A job that learned from the cohort.
#[derive(Serialize, ToSchema)]
pub struct CohortModelView {
    pub job: String,
    /// The version of the cohort that it learned from.
    pub version: i64,
    pub state: ModelState,
    /// Training cases that have left since.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left: Vec<String>,
}

/// Whether a model is up to date with its cohort.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ModelState {
    /// It learned, or learns, from the present members.
    Current,
    /// A training member has left.
    Stale,
    /// It was erased with a training case.
    Erased,
}

/// A cohort in a list.
#[derive(Serialize, ToSchema)]
pub struct CohortEntry {
    pub id: String,
    pub version: i64,
    pub created: String,
    pub updated: String,
    pub name: String,
    /// The number of members.
    pub members: i64,
}

#[derive(Serialize, ToSchema)]
struct CohortList {
    items: Vec<CohortEntry>,
    /// The cursor of the next page; absent on the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    next: Option<String>,
}

fn entry(row: &CohortRow) -> CohortEntry {
    CohortEntry {
        id: row.id.clone(),
        version: row.version,
        created: time::rfc3339(row.created),
        updated: time::rfc3339(row.updated),
        name: row.name.clone(),
        members: row.members,
    }
}

fn member_view(cohort: &str, row: &MemberRow) -> ApiResult<CohortMemberView> {
    let what = format!("member {} of cohort", row.number);
    let member = serde_json::from_str(&row.document);
    let member = member.map_err(ApiError::unreadable(&what, cohort))?;
    Ok(CohortMemberView { number: row.number, case: row.case_id.clone(), member })
}

fn model_view(row: &CohortModelRow, left: &[LeftRow]) -> Option<CohortModelView> {
    let since = left.iter().filter(|left| left.version > row.version);
    let left: Vec<String> = since.map(|left| left.case_id.clone()).collect();
    let state = match row.status {
        // What learned nothing is no model.
        Some(JobStatus::Failed | JobStatus::Dismissed) => return None,
        Some(JobStatus::Accepted | JobStatus::Running | JobStatus::Successful) => {
            if left.is_empty() { ModelState::Current } else { ModelState::Stale }
        }
        None => ModelState::Erased,
    };
    Some(CohortModelView { job: row.job_id.clone(), version: row.version, state, left })
}

async fn answer(service: &Service, status: StatusCode, row: &CohortRow) -> ApiResult {
    let consent = row.consent.as_deref().map(serde_json::from_str).transpose();
    let members = service.store.cohort_members(&row.id).await?;
    let left = service.store.left_cohort(&row.id).await?;
    let models = service.store.cohort_models(&row.id).await?;
    let view = CohortView {
        id: row.id.clone(),
        version: row.version,
        created: time::rfc3339(row.created),
        updated: time::rfc3339(row.updated),
        name: row.name.clone(),
        consent: consent.map_err(ApiError::unreadable("the consent of cohort", &row.id))?,
        members: members
            .iter()
            .map(|member| member_view(&row.id, member))
            .collect::<ApiResult<_>>()?,
        models: models.iter().filter_map(|model| model_view(model, &left)).collect(),
        left: left
            .into_iter()
            .map(|left| CohortLeftView { case: left.case_id, version: left.version })
            .collect(),
    };
    Ok(with_header(json(status, &view), header::ETAG, &format!("\"{}\"", row.version)))
}

async fn row_of(service: &Service, id: &str) -> ApiResult<CohortRow> {
    let row = service.store.cohort(id).await?;
    row.ok_or_else(|| ApiError::not_found("cohort"))
}

/// Stores a cohort of operated cases: of each a prediction, the outcome after the operation, and consent for its uses.
/// A member leaves if its case or prediction is erased. Jobs of kind `learn` and `cohort` may name the cohort instead of its
/// members.
#[utoipa::path(
    post, path = "/v1/cohorts", operation_id = "create_cohort", tag = "cohorts",
    params((
        "Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255, pattern = r"^[!-~]([\t -~]*[!-~])?$",
        description = "a unique word of the client, to repeat the request safely"
    )),
    request_body = StoredCohortDocument,
    responses(
        (status = 201, description = "kept", body = CohortView, headers(
            ("Location" = String, description = "the cohort"), ("ETag" = String, description = "its version"))),
        (status = 410, description = "the cohort was erased since an earlier request with the same Idempotency-Key"),
    )
)]
async fn create(service: Service, request: Request) -> ApiResult {
    let headers = request.headers().clone();
    let bytes = body::json(&service, request).await?;
    let document: StoredCohortDocument = strict::parse(&bytes, &service.limits)?;
    let mut faults = Faults::default();
    document.check(&service.limits, &mut faults);
    faults.into_result()?;
    let asked = KeyedRequest::at(&service, &headers, "/v1/cohorts", &[&bytes])?;
    if let Some(known) = asked.known(&service).await?
        && let Some(row) = service.store.cohort(&known.id).await?
    {
        return created(&service, &row).await;
    }
    let members = members_of(&service, &document).await?;
    let consent = document.consent.as_ref().map(serde_json::to_string).transpose();
    let consent = consent.map_err(ApiError::internal)?;
    // What comes before this changes nothing, so that it ends with its client.
    let NewId { id, .. } = asked.reserve(&service).await?;
    let cohort = NewCohort { id, name: document.name, consent, members };
    if !service.store.add_cohort(&cohort).await? {
        let detail = "a prediction or a mesh of a member was deleted meanwhile";
        return Err(ApiError::new(ErrorCode::Conflict, detail));
    }
    created(&service, &row_of(&service, &cohort.id).await?).await
}

async fn created(service: &Service, row: &CohortRow) -> ApiResult {
    let answer = answer(service, StatusCode::CREATED, row).await?;
    Ok(with_header(answer, header::LOCATION, &format!("/v1/cohorts/{}", row.id)))
}

/// Cohorts, newest first, without their members.
#[utoipa::path(
    get, path = "/v1/cohorts", operation_id = "list_cohorts", tag = "cohorts", params(PageParameters),
    responses((status = 200, description = "a page of them", body = CohortList))
)]
async fn list(service: Service, Parameters(parameters): Parameters<PageParameters>) -> ApiResult {
    let page = parameters.page()?;
    let mut rows = service.store.cohorts(page.after.as_deref(), page.rows()).await?;
    let next = page.cut(&mut rows, |row| &row.id);
    Ok(json(StatusCode::OK, &CohortList { items: rows.iter().map(entry).collect(), next }))
}

/// One cohort with its present and former members, and the models learned from it.
#[utoipa::path(
    get, path = "/v1/cohorts/{id}", operation_id = "show_cohort", tag = "cohorts",
    params(("id" = uuid::Uuid, Path, description = "the cohort")),
    responses((status = 200, description = "the cohort", body = CohortView, headers(
        ("ETag" = String, description = "its version, independent of its models"))))
)]
async fn show(service: Service, Id(id): Id) -> ApiResult {
    answer(&service, StatusCode::OK, &row_of(&service, &id).await?).await
}

/// Deletes a cohort. Its cases stay, and so do accepted jobs, including models.
#[utoipa::path(
    delete, path = "/v1/cohorts/{id}", operation_id = "remove_cohort", tag = "cohorts",
    params(
        ("id" = uuid::Uuid, Path, description = "the cohort"),
        ("If-Match" = String, Header, description = "the version to change, or *"),
    ),
    responses(
        (status = 204, description = "deleted"),
        (status = 412, description = "it has another version"),
        (status = 428, description = "If-Match is missing"),
    )
)]
async fn remove(service: Service, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let row = row_of(&service, &id).await?;
    conditional::require_match(&headers, &row.version.to_string())?;
    match service.store.delete_cohort(&id, row.version).await? {
        Change::Done => Ok(StatusCode::NO_CONTENT.into_response()),
        Change::OtherVersion(version) => Err(conditional::other_version(&version.to_string())),
        Change::NotFound => Err(ApiError::not_found("cohort")),
    }
}
