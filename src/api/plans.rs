//! Plans stored with their case. A plan may also be part of the job that uses it.

use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::routes;

use super::error::{ApiError, ApiResult};
use super::idempotency::{KeyedRequest, NewId};
use super::paging::PageParameters;
use super::parameters::{Id, Parameters, PlanPath};
use super::resources::Resources;
use super::{Service, body, conditional, json, time, with_header};
use crate::schema::PlanDocument;
use crate::schema::key::Scope;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::strict;
use crate::store::{Change, PlanRow};

/// The route of new plans.
const PLANS: &str = "/v1/cases/{id}/plans";

pub fn router() -> Resources {
    Resources::new()
        .reads(Scope::Read, routes!(list))
        .changes(Scope::Write, routes!(create))
        .reads(Scope::Read, routes!(show))
        .changes(Scope::Write, routes!(replace, remove))
        .json_only()
}

/// A stored plan.
#[derive(Serialize, ToSchema)]
pub struct PlanView {
    pub id: String,
    pub case: String,
    pub version: i64,
    /// RFC 3339, UTC.
    pub created: String,
    pub updated: String,
    pub plan: PlanDocument,
}

#[derive(Serialize, ToSchema)]
struct PlanList {
    items: Vec<PlanView>,
    /// The cursor of the next page; absent on the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    next: Option<String>,
}

fn view(row: &PlanRow) -> ApiResult<PlanView> {
    Ok(PlanView {
        id: row.id.clone(),
        case: row.case_id.clone(),
        version: row.version,
        created: time::rfc3339(row.created),
        updated: time::rfc3339(row.updated),
        plan: serde_json::from_str(&row.document).map_err(ApiError::unreadable("plan", &row.id))?,
    })
}

fn answer(status: StatusCode, row: &PlanRow) -> ApiResult {
    let tag = format!("\"{}\"", row.version);
    Ok(with_header(json(status, &view(row)?), header::ETAG, &tag))
}

async fn row_of(service: &Service, case: &str, id: &str) -> ApiResult<PlanRow> {
    let row = service.store.plan(case, id).await?;
    row.ok_or_else(|| ApiError::not_found("plan of this case"))
}

/// The plan of a body; its form and name are checked here, its meaning with the case when a job uses it.
async fn read(service: &Service, request: Request) -> ApiResult<String> {
    let bytes = body::json(service, request).await?;
    let plan: PlanDocument = strict::parse(&bytes, &service.limits)?;
    let mut faults = Faults::default();
    plan.check_name(&Pointer::root(), &service.limits, &mut faults);
    faults.into_result()?;
    serde_json::to_string(&plan).map_err(ApiError::internal)
}

/// Stores a plan with its case.
#[utoipa::path(
    post, path = "/v1/cases/{id}/plans", operation_id = "create_plan", tag = "plans",
    params(
        ("id" = uuid::Uuid, Path, description = "the case"),
        (
            "Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255, pattern = r"^[!-~]([\t -~]*[!-~])?$",
            description = "a unique word of the client, to repeat the request safely"
        ),
    ),
    request_body = PlanDocument,
    responses((status = 201, description = "kept", body = PlanView, headers(("Location" = String, description = "the plan"), ("ETag" = String, description = "its version"))))
)]
async fn create(service: Service, Id(case): Id, request: Request) -> ApiResult {
    let headers = request.headers().clone();
    let document = read(&service, request).await?;
    let content = [case.as_bytes(), document.as_bytes()];
    let asked = KeyedRequest::at(&service, &headers, PLANS, &content)?;
    let NewId { id, is_known, .. } = asked.reserve(&service).await?;
    let is_there = is_known && service.store.plan(&case, &id).await?.is_some();
    if !is_there && !service.store.add_plan(&case, &id, &document).await? {
        return Err(ApiError::not_found("case"));
    }
    let row = row_of(&service, &case, &id).await?;
    let location = format!("/v1/cases/{case}/plans/{id}");
    Ok(with_header(answer(StatusCode::CREATED, &row)?, header::LOCATION, &location))
}

/// The plans of a case, newest first.
#[utoipa::path(
    get, path = "/v1/cases/{id}/plans", operation_id = "list_plans", tag = "plans", params(("id" = uuid::Uuid, Path, description = "the case"), PageParameters),
    responses((status = 200, description = "a page of them", body = PlanList))
)]
async fn list(
    service: Service,
    Id(case): Id,
    Parameters(parameters): Parameters<PageParameters>,
) -> ApiResult {
    let page = parameters.page()?;
    if service.store.case(&case).await?.is_none() {
        return Err(ApiError::not_found("case"));
    }
    let mut rows = service.store.plans(&case, page.after.as_deref(), page.rows()).await?;
    let next = page.cut(&mut rows, |row| &row.id);
    let items = rows.iter().map(view).collect::<ApiResult<_>>()?;
    Ok(json(StatusCode::OK, &PlanList { items, next }))
}

/// One plan.
#[utoipa::path(
    get, path = "/v1/cases/{id}/plans/{plan}", operation_id = "show_plan", tag = "plans",
    params(("id" = uuid::Uuid, Path, description = "the case"), ("plan" = uuid::Uuid, Path, description = "the plan")),
    responses(
        (status = 200, description = "the plan", body = PlanView, headers(("ETag" = String, description = "its version"))),
        (status = 304, description = "the client has it already"),
    )
)]
async fn show(service: Service, PlanPath { case, id }: PlanPath, headers: HeaderMap) -> ApiResult {
    let row = row_of(&service, &case, &id).await?;
    let version = row.version.to_string();
    if conditional::is_known(&headers, &version) {
        return Ok(conditional::not_modified(&version));
    }
    answer(StatusCode::OK, &row)
}

/// Replaces a plan. Accepted jobs keep the plan of their acceptance.
#[utoipa::path(
    put, path = "/v1/cases/{id}/plans/{plan}", operation_id = "replace_plan", tag = "plans",
    params(
        ("id" = uuid::Uuid, Path, description = "the case"), ("plan" = uuid::Uuid, Path, description = "the plan"),
        ("If-Match" = String, Header, description = "the version to change, or *"),
    ),
    request_body = PlanDocument,
    responses(
        (status = 200, description = "replaced", body = PlanView, headers(("ETag" = String, description = "its version"))),
        (status = 412, description = "it has another version"),
        (status = 428, description = "If-Match is missing"),
    )
)]
async fn replace(
    service: Service,
    PlanPath { case, id }: PlanPath,
    headers: HeaderMap,
    request: Request,
) -> ApiResult {
    let row = row_of(&service, &case, &id).await?;
    conditional::require_match(&headers, &row.version.to_string())?;
    let document = read(&service, request).await?;
    let change = service.store.replace_plan((&case, &id), &document, Some(row.version)).await?;
    done(change)?;
    answer(StatusCode::OK, &row_of(&service, &case, &id).await?)
}

/// Deletes a plan. Accepted jobs keep it.
#[utoipa::path(
    delete, path = "/v1/cases/{id}/plans/{plan}", operation_id = "remove_plan", tag = "plans",
    params(
        ("id" = uuid::Uuid, Path, description = "the case"), ("plan" = uuid::Uuid, Path, description = "the plan"),
        ("If-Match" = String, Header, description = "the version to change, or *"),
    ),
    responses(
        (status = 204, description = "deleted"),
        (status = 412, description = "it has another version"),
        (status = 428, description = "If-Match is missing"),
    )
)]
async fn remove(
    service: Service,
    PlanPath { case, id }: PlanPath,
    headers: HeaderMap,
) -> ApiResult<Response> {
    let row = row_of(&service, &case, &id).await?;
    conditional::require_match(&headers, &row.version.to_string())?;
    done(service.store.delete_plan((&case, &id), Some(row.version)).await?)?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

fn done(change: Change) -> ApiResult<()> {
    match change {
        Change::Done => Ok(()),
        Change::OtherVersion(version) => Err(conditional::other_version(&version.to_string())),
        Change::NotFound => Err(ApiError::not_found("plan of this case")),
    }
}
