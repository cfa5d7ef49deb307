//! Cases: a patient's meshes with their meaning. One request may upload the case and all its meshes.

use std::collections::BTreeMap;

use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::routes;

use super::accepted::checked_in_time;
use super::caller::Caller;
use super::case_draft::{PostedCase, checked, split};
use super::case_state::{CaseMeshingView, CaseState, meshed_again, meshing_view, tag_of};
use super::error::{ApiError, ApiResult};
use super::idempotency::KeyedRequest;
use super::meshes::document_of;
use super::middleware::check_accept;
use super::paging::Page;
use super::parameters::{Id, Parameters, listed_tag};
use super::prefer::{requested_wait, wait_for_end, with_wait};
use super::resources::Resources;
use super::{Service, body, case_state, conditional, job_input, json, time, with_header};
use crate::jobs::PredictInput;
use crate::schema::case::meshed::CaseBody;
use crate::schema::key::Scope;
use crate::schema::mesh::MeshDocument;
use crate::schema::predict::check::CheckDocument;
use crate::schema::wire::canonical::sha256_hex;
use crate::schema::wire::strict;
use crate::schema::{ErrorCode, Faults, PredictDocument};
use crate::store::{CaseRow, Change};
use crate::traces::TraceParent;

const JSON: &str = "application/json";
const SVG: &str = "image/svg+xml";
const MULTIPART: &str = "multipart/form-data";
const READ_HERE: &str = "application/json, multipart/form-data";

pub fn router() -> Resources {
    let json = Resources::new()
        .reads(Scope::Read, routes!(list))
        .changes(Scope::Write, routes!(create))
        .reads(Scope::Read, routes!(show))
        .changes(Scope::Write, routes!(remove))
        .json_only();
    json.reads(Scope::Run, routes!(check))
}

/// A stored case.
#[derive(Serialize, ToSchema)]
pub struct CaseView {
    pub id: String,
    pub version: i64,
    /// RFC 3339, UTC.
    pub created: String,
    pub updated: String,
    pub state: CaseState,
    /// The job that makes or made its mesh, if that was not uploaded.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub meshing: Option<CaseMeshingView>,
    /// As posted; with the mesh once it is made.
    pub case: CaseBody,
    /// The meshes that the case refers to.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<MeshDocument>,
    /// Its boundary conditions before any segment moves; absent if they depend on a plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub check: Option<CheckDocument>,
}

#[derive(Serialize, ToSchema)]
struct CaseList {
    items: Vec<CaseView>,
    /// The cursor of the next page; absent on the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    next: Option<String>,
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct CreateParameters {
    /// Accepts meshes smaller or larger than any head. Default: false.
    allow_any_scale: Option<bool>,
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct ListParameters {
    /// Only cases with this tag.
    #[param(min_length = 1)]
    tag: Option<String>,
    cursor: Option<String>,
    /// Default: 50.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
}

/// The document in a part `case`, and a part for each mesh, named as the document refers to it.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the form for the OpenAPI document")]
struct CaseForm {
    case: CaseBody,
    #[serde(flatten)]
    meshes: BTreeMap<String, MeshPart>,
}

/// A mesh in a part of a form.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the form for the OpenAPI document")]
#[schema(value_type = String, format = Binary)]
struct MeshPart(Vec<u8>);

/// Stores a case. A form includes its meshes: the document in the part `case` refers to the
/// meshes by the names of their parts. A case with a scan to be meshed (`meshing`) is stored in the state `meshing`, and its
/// job is accepted, which needs a key with `run`: jobs on it wait until it is `ready`, and fail if it has `failed`. With
/// `Prefer: wait=n` the response comes when that job has ended, after at most n seconds (at most 30).
#[utoipa::path(
    post, path = "/v1/cases", operation_id = "create_case", tag = "cases",
    params(
        CreateParameters,
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end of its meshing"),
        (
            "Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255, pattern = r"^[!-~]([\t -~]*[!-~])?$",
            description = "a unique word of the client, to repeat the request safely"
        ),
    ),
    request_body(description = "the case", content((CaseBody = "application/json"), (CaseForm = "multipart/form-data"))),
    responses(
        (status = 201, description = "kept", body = CaseView, headers(
            ("Location" = String, description = "the case"), ("ETag" = String, description = "its version"),
            ("Preference-Applied" = Option<String>, description = "the wait that was granted"))),
        (status = 410, description = "the case was erased since an earlier request with the same Idempotency-Key"),
    )
)]
async fn create(
    service: Service,
    caller: Caller,
    Parameters(parameters): Parameters<CreateParameters>,
    request: Request,
) -> ApiResult {
    let wait = requested_wait(request.headers(), service.limits.wait_s);
    let place = request.extensions().get::<Option<TraceParent>>().cloned().flatten();
    let kind = body::content_type(request.headers());
    let headers = request.headers().clone();
    let (text, parts) = match kind.as_str() {
        JSON => (body::json(&service, request).await?, Vec::new()),
        MULTIPART => {
            let (document, parts) = split(body::parts(&service, request).await?)?;
            (body::document(&service, document).await?, parts)
        }
        _ => return Err(body::unsupported(&kind, READ_HERE)),
    };
    let document = CaseBody::parse(&text, &service.limits)?;
    if matches!(document, CaseBody::ToMesh(_)) {
        caller.require(Scope::Run)?;
    }
    let content: Vec<&[u8]> = parts
        .iter()
        .flat_map(|(name, part)| [name.as_bytes(), &part.sha256])
        .chain([&text[..]])
        .collect();
    let asked = KeyedRequest::at(&service, &headers, "/v1/cases", &content)?;
    if let Some(known) = asked.known(&service).await?
        && let Some(row) = service.store.case(&known.id).await?
    {
        meshed_again(&service, row).await?;
        return created(&service, &known.id, wait).await;
    }
    let place = place.map(|place| place.to_string());
    let allow_any_scale = parameters.allow_any_scale.unwrap_or(false);
    let posted = PostedCase { document, parts, allow_any_scale };
    let id = posted.stored(&service, &asked, place).await?;
    created(&service, &id, wait).await
}

/// The response to a request that created a case, or found it.
async fn created(service: &Service, id: &str, wait: Option<u32>) -> ApiResult {
    let row = row_when_meshed(service, id, wait).await?;
    let answer = with_wait(answer(service, StatusCode::CREATED, &row).await?, wait);
    Ok(with_header(answer, header::LOCATION, &format!("/v1/cases/{id}")))
}

/// The row of a case, once its meshing or the wait has ended.
async fn row_when_meshed(service: &Service, id: &str, wait: Option<u32>) -> ApiResult<CaseRow> {
    let row = row_of(service, id).await?;
    match (&row.meshing, wait) {
        (Some(meshing), Some(wait)) => {
            wait_for_end(service, &meshing.job, wait).await?;
            row_of(service, id).await
        }
        _ => Ok(row),
    }
}

async fn row_of(service: &Service, id: &str) -> ApiResult<CaseRow> {
    let row = service.store.case(id).await?;
    row.ok_or_else(|| ApiError::not_found("case"))
}

fn view(row: &CaseRow) -> ApiResult<CaseView> {
    let case = case_state::body_of(row)?;
    let state = case_state::state(row, &case);
    let meshing = row.meshing.as_ref().map(|meshing| meshing_view(meshing, state));
    Ok(CaseView {
        id: row.id.clone(),
        version: row.version,
        created: time::rfc3339(row.created),
        updated: time::rfc3339(row.updated),
        state,
        meshing: meshing.transpose()?,
        case,
        meshes: Vec::new(),
        check: serde_json::from_str(&row.report)
            .map_err(ApiError::unreadable("the check of case", &row.id))?,
    })
}

async fn answer(service: &Service, status: StatusCode, row: &CaseRow) -> ApiResult {
    let mut view = view(row)?;
    for id in view.case.mesh_ids() {
        if let Some(mesh) = service.store.mesh(&id).await? {
            view.meshes.push(document_of(&mesh)?);
        }
    }
    let tag = format!("\"{}\"", tag_of(row, view.state));
    Ok(with_header(json(status, &view), header::ETAG, &tag))
}

/// Cases, newest first, without their meshes.
#[utoipa::path(
    get, path = "/v1/cases", operation_id = "list_cases", tag = "cases", params(ListParameters),
    responses((status = 200, description = "a page of them", body = CaseList))
)]
async fn list(service: Service, Parameters(parameters): Parameters<ListParameters>) -> ApiResult {
    let page = Page::new(parameters.cursor.as_deref(), parameters.limit)?;
    let tag = listed_tag(parameters.tag)?;
    let mut rows = service.store.cases(&tag, page.after.as_deref(), page.rows()).await?;
    let next = page.cut(&mut rows, |row| &row.id);
    let items = rows.iter().map(view).collect::<ApiResult<_>>()?;
    Ok(json(StatusCode::OK, &CaseList { items, next }))
}

/// One case with its meshes; with `Prefer: wait=n` when its meshing has ended, after at most n seconds (at most 30).
#[utoipa::path(
    get, path = "/v1/cases/{id}", operation_id = "show_case", tag = "cases",
    params(
        ("id" = uuid::Uuid, Path, description = "the case"),
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end of its meshing"),
    ),
    responses(
        (status = 200, description = "the case", body = CaseView, headers(
            ("ETag" = String, description = "its version, with its state if not ready"),
            ("Preference-Applied" = Option<String>, description = "the wait that was granted"))),
        (status = 304, description = "the client has it already"),
    )
)]
async fn show(service: Service, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let wait = requested_wait(&headers, service.limits.wait_s);
    let row = row_when_meshed(&service, &id, wait).await?;
    let version = current_tag(&row)?;
    if conditional::is_known(&headers, &version) {
        return Ok(conditional::not_modified(&version));
    }
    Ok(with_wait(answer(&service, StatusCode::OK, &row).await?, wait))
}

/// The ETag of a case.
fn current_tag(row: &CaseRow) -> ApiResult<String> {
    Ok(tag_of(row, case_state::state(row, &case_state::body_of(row)?)))
}

/// Erases a case: its plans, its jobs with their results, and the meshes uploaded with it. A running meshing of it
/// is stopped.
#[utoipa::path(
    delete, path = "/v1/cases/{id}", operation_id = "erase_case", tag = "cases",
    params(
        ("id" = uuid::Uuid, Path, description = "the case"),
        ("If-Match" = String, Header, description = "the version to change, or *"),
    ),
    responses(
        (status = 204, description = "erased"),
        (status = 412, description = "it has another version"),
        (status = 428, description = "If-Match is missing"),
    )
)]
async fn remove(service: Service, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let row = row_of(&service, &id).await?;
    conditional::require_match(&headers, &current_tag(&row)?)?;
    match service.store.delete_case(&id, Some(row.version)).await? {
        Change::Done => {
            service.pictures.forget(&id);
            Ok(StatusCode::NO_CONTENT.into_response())
        }
        Change::OtherVersion(version) => Err(conditional::other_version(&version.to_string())),
        Change::NotFound => Err(ApiError::not_found("case")),
    }
}

/// Boundary conditions and expected cost of a job with this spec, without solving. The body is the spec
/// of /v1/jobs; `case` may be omitted, and without a plan, or without a body, nothing moves. A client
/// that accepts `image/svg+xml` only gets a picture of the boundary, coloured by node class.
#[utoipa::path(
    post, path = "/v1/cases/{id}/check", operation_id = "check_case", tag = "cases", params(("id" = uuid::Uuid, Path, description = "the case")),
    request_body = CheckRequest,
    responses((
        status = 200, description = "the counts of joined, fixed, sliding and free nodes, or their picture",
        content((CheckDocument = "application/json"), (String = "image/svg+xml"))
    ))
)]
async fn check(service: Service, Id(id): Id, request: Request) -> ApiResult {
    let wants_counts = check_accept(request.headers(), JSON).is_ok();
    if !wants_counts {
        check_accept(request.headers(), SVG)?;
    }
    let spec: PredictDocument = match has_no_body(request.headers()) {
        true => PredictDocument::default(),
        false => strict::parse(&body::json(&service, request).await?, &service.limits)?,
    };
    let row = row_of(&service, &id).await?;
    if spec.case.as_ref().is_some_and(|case| *case != id) {
        let mut faults = Faults::default();
        let at = crate::schema::Pointer::root().key("case");
        faults.add(&at, ErrorCode::OtherCase, "the spec names another case than the address");
        faults.into_result()?;
    }
    let input = job_input::predict_input(&service, &row, spec).await?;
    let question = question(&input)?;
    let known = question.as_ref().filter(|_| !wants_counts);
    if let Some(svg) = known.and_then(|question| service.pictures.get(&id, question)) {
        return Ok(picture(svg));
    }
    let to_spec = |error: ApiError| error.map_problem(|problem| problem.moved("/spec", ""));
    let report = checked(&service, input, BTreeMap::new()).await.map_err(to_spec)?;
    if wants_counts {
        return Ok(json(StatusCode::OK, &report.document));
    }
    let svg = Bytes::from(checked_in_time(&service, move |_, _| report.picture()).await?);
    if let Some(question) = question {
        service.pictures.keep(&id, question, svg.clone());
    }
    Ok(picture(svg))
}

/// The input of a picture, as a hash: meshes never change, and those of a case exist as long as it does. `None` if others
/// are named, which may be deleted by the next request.
fn question(input: &PredictInput) -> ApiResult<Option<String>> {
    let of_case = input.mesh_ids() == input.case.mesh_ids();
    let text = serde_json::to_vec(input).map_err(ApiError::internal)?;
    Ok(of_case.then(|| sha256_hex(&text)))
}

fn picture(svg: Bytes) -> Response {
    let headers = [
        (header::CONTENT_TYPE, SVG),
        (header::CACHE_CONTROL, "private, no-store"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"check.svg\""),
    ];
    (headers, svg).into_response()
}

/// Whether a request has no body of any kind.
fn has_no_body(headers: &HeaderMap) -> bool {
    let length = headers.get(header::CONTENT_LENGTH);
    length.is_none_or(|length| length == "0") && !headers.contains_key(header::TRANSFER_ENCODING)
}

/// The spec of a prediction with all members optional.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the body for the OpenAPI document")]
struct CheckRequest {
    #[schema(nullable = false)]
    plan: Option<crate::schema::PlanDocument>,
    #[schema(nullable = false)]
    plan_id: Option<String>,
}
