//! Cases: a patient's meshes and what they mean. One request may bring the case and all its meshes.

use std::collections::BTreeMap;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::IntoResponse;
use bytes::Bytes;
use serde::{Deserialize, Serialize};
use tokio::runtime::Handle;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::error::{ApiError, ApiResult};
use super::guard::check_accept;
use super::meshes::{TakenIn, document_of, take_in};
use super::paging::Page;
use super::parameters::{Id, Parameters};
use super::{Service, body, conditional, job_input, json, json_only, time, with_header};
use crate::jobs::upload::{Statement, Upload};
use crate::jobs::{CheckReport, PredictInput, StoredMesh};
use crate::schema::check::CheckDocument;
use crate::schema::mesh::MeshDocument;
use crate::schema::{CaseDocument, Faults, Limits, PredictDocument, Problem, strict};
use crate::store::{CaseRow, Change, NewCase};

const JSON: &str = "application/json";
const SVG: &str = "image/svg+xml";
const MULTIPART: &str = "multipart/form-data";
const READ_HERE: &str = "application/json, multipart/form-data";
/// The part of a form that holds the document; the other parts are meshes.
const CASE_PART: &str = "case";

pub fn router() -> OpenApiRouter<Service> {
    let router = OpenApiRouter::new().routes(routes!(create, list));
    json_only(router.routes(routes!(show, remove))).routes(routes!(check))
}

/// A case as it is kept.
#[derive(Serialize, ToSchema)]
pub struct CaseView {
    pub id: String,
    pub version: i64,
    /// RFC 3339, UTC.
    pub created: String,
    pub updated: String,
    pub case: CaseDocument,
    /// The meshes that the case refers to.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub meshes: Vec<MeshDocument>,
    /// What holds its nodes before any segment moves; absent where it takes a plan to hold it.
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
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct CreateParameters {
    /// Takes meshes that are smaller or larger than any head. Default: false.
    allow_any_scale: Option<bool>,
}

#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct ListParameters {
    /// Only cases with this tag.
    tag: Option<String>,
    cursor: Option<String>,
    /// Default: 50.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
}

/// The document in a part `case`, and one part for each mesh, named as the document refers to it.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the form for the OpenAPI document")]
struct CaseForm {
    case: CaseDocument,
    #[serde(flatten)]
    meshes: BTreeMap<String, MeshPart>,
}

/// A mesh in a part of a form.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the form for the OpenAPI document")]
#[schema(value_type = String, format = Binary)]
struct MeshPart(Vec<u8>);

/// Keeps a case. As a form it brings its meshes along: the document in the part `case` refers to the
/// meshes by the names of their parts.
#[utoipa::path(
    post, path = "/v1/cases", operation_id = "create_case", tag = "cases", params(CreateParameters),
    request_body(description = "the case", content((CaseDocument = "application/json"), (CaseForm = "multipart/form-data"))),
    responses((status = 201, description = "kept", body = CaseView, headers(("Location" = String, description = "the case"), ("ETag" = String, description = "its version"))))
)]
async fn create(
    State(service): State<Service>,
    Parameters(parameters): Parameters<CreateParameters>,
    request: Request,
) -> ApiResult {
    let kind = body::content_type(request.headers());
    let (document, parts) = match kind.as_str() {
        JSON => (body::json(&service, request).await?, Vec::new()),
        MULTIPART => split(body::parts(&service, request).await?)?,
        _ => return Err(body::unsupported(&kind, READ_HERE)),
    };
    let document: CaseDocument = strict::parse(&document, &service.limits)?;
    let draft = Draft::read(&service, document, parts, parameters.allow_any_scale).await?;
    let check = draft.check(&service).await?;
    let id = draft.store(&service, check.as_ref()).await?;
    let row = row_of(&service, &id).await?;
    let answer = answer(&service, StatusCode::CREATED, &row).await?;
    Ok(with_header(answer, header::LOCATION, &format!("/v1/cases/{id}")))
}

type Parts = Vec<(String, Bytes)>;

/// The document and the meshes of a form.
fn split(mut parts: Parts) -> ApiResult<(Bytes, Parts)> {
    let at = parts.iter().position(|(name, _)| name == CASE_PART);
    let at =
        at.ok_or_else(|| ApiError::new("malformed-multipart", "the form has no part `case`"))?;
    let (_, document) = parts.remove(at);
    Ok((document, parts))
}

/// A case on its way in, with the meshes that came with it.
struct Draft {
    document: CaseDocument,
    uploads: Vec<Upload>,
}

impl Draft {
    /// Reads the meshes and puts their ids where the document names their parts.
    async fn read(
        service: &Service,
        mut document: CaseDocument,
        parts: Parts,
        allow_any_scale: Option<bool>,
    ) -> ApiResult<Draft> {
        let statement = Statement {
            units: Some(document.units),
            frame: Some(document.frame),
            role: None,
            allow_any_scale: allow_any_scale.unwrap_or(false),
        };
        let mut ids: BTreeMap<String, String> = BTreeMap::new();
        let mut uploads: Vec<Upload> = Vec::new();
        for (name, bytes) in parts {
            let taken = take_in(service, bytes, &statement, false).await;
            let id = match taken.map_err(|error| in_part(error, &name))? {
                TakenIn::Known(row) => row.id,
                TakenIn::New(upload) => {
                    let same = |other: &&Upload| other.row.sha256 == upload.row.sha256;
                    match uploads.iter().find(same) {
                        Some(other) => other.row.id.clone(),
                        None => {
                            let id = upload.row.id.clone();
                            uploads.push(*upload);
                            id
                        }
                    }
                }
            };
            ids.insert(name, id);
        }
        let mut unused: Vec<String> = ids.keys().cloned().collect();
        for (_, reference) in document.mesh_references_mut() {
            if let Some(id) = ids.get(reference) {
                unused.retain(|name| name != reference);
                *reference = id.clone();
            }
        }
        if unused.is_empty() {
            return Ok(Draft { document, uploads });
        }
        let detail = format!("the case refers to no part called {}", unused.join(", "));
        Err(ApiError::new("unused-part", detail))
    }

    /// Whether the document and its meshes make sense; `None` where only a plan can tell.
    async fn check(&self, service: &Service) -> ApiResult<Option<CheckDocument>> {
        let input = PredictInput {
            job: None,
            queue_s: None,
            case: self.document.clone(),
            plan: Default::default(),
            spec: PredictDocument::default(),
        };
        let extra = self.uploads.iter().map(|upload| (upload.row.id.clone(), upload.mesh.clone()));
        let checked = checked(service, input, extra.collect()).await;
        match checked {
            Ok(report) => Ok(Some(report.document)),
            Err(error) if needs_a_plan(&error.problem) => Ok(None),
            Err(error) => Err(error.problem.moved("/case", "").into()),
        }
    }

    async fn store(self, service: &Service, check: Option<&CheckDocument>) -> ApiResult<String> {
        let id = uuid::Uuid::now_v7().to_string();
        let text = |value: serde_json::Result<String>| value.map_err(ApiError::internal);
        let (rows, meshes): (Vec<_>, Vec<_>) =
            self.uploads.into_iter().map(|upload| (upload.row, upload.mesh)).unzip();
        let new = NewCase {
            id: id.clone(),
            document: text(serde_json::to_string(&self.document))?,
            report: text(serde_json::to_string(&check))?,
            tags: self.document.tags.clone(),
            mesh_ids: self.document.mesh_ids(),
            meshes: rows,
        };
        if !service.store.add_case(&new).await? {
            let detail = "a mesh of the case came or went meanwhile; send the case again";
            return Err(ApiError::new("conflict", detail));
        }
        for (row, mesh) in new.meshes.iter().zip(meshes) {
            service.library.keep(&row.blob, mesh.shape);
        }
        tracing::info!(case.id = %id, meshes = new.mesh_ids.len(), "case stored");
        Ok(id)
    }
}

/// Says in which part of a form a mesh was refused.
fn in_part(error: ApiError, name: &str) -> ApiError {
    error.map_problem(|problem| {
        let detail = format!("part {name}: {}", problem.detail);
        Problem { detail, ..problem }.with("part", name)
    })
}

/// Loose parts may be held by the sets that a plan names.
fn needs_a_plan(problem: &Problem) -> bool {
    !problem.errors.is_empty()
        && problem.errors.iter().all(|error| error.code == "underconstrained")
}

/// Checks a prediction over stored meshes and those of a request.
async fn checked(
    service: &Service,
    input: PredictInput,
    extra: BTreeMap<String, StoredMesh>,
) -> ApiResult<CheckReport> {
    let sources = service.library.source(Handle::current(), extra);
    let limits: Limits = (*service.limits).clone();
    let report = service.compute(move || crate::jobs::check(&input, &sources, &limits)).await?;
    report.map_err(job_input::refusal)
}

async fn row_of(service: &Service, id: &str) -> ApiResult<CaseRow> {
    let row = service.store.case(id).await?;
    row.ok_or_else(|| ApiError::not_found("case"))
}

fn view(row: &CaseRow) -> ApiResult<CaseView> {
    Ok(CaseView {
        id: row.id.clone(),
        version: row.version,
        created: time::rfc3339(row.created),
        updated: time::rfc3339(row.updated),
        case: serde_json::from_str(&row.document).map_err(ApiError::internal)?,
        meshes: Vec::new(),
        check: serde_json::from_str(&row.report).map_err(ApiError::internal)?,
    })
}

async fn answer(service: &Service, status: StatusCode, row: &CaseRow) -> ApiResult {
    let mut view = view(row)?;
    for id in view.case.mesh_ids() {
        if let Some(mesh) = service.store.mesh(&id).await? {
            view.meshes.push(document_of(&mesh)?);
        }
    }
    let tag = format!("\"{}\"", row.version);
    Ok(with_header(json(status, &view), header::ETAG, &tag))
}

/// Cases, newest first, without their meshes.
#[utoipa::path(
    get, path = "/v1/cases", operation_id = "list_cases", tag = "cases", params(ListParameters),
    responses((status = 200, description = "a page of them", body = CaseList))
)]
async fn list(
    State(service): State<Service>,
    Parameters(parameters): Parameters<ListParameters>,
) -> ApiResult {
    let page = Page::new(parameters.cursor.as_deref(), parameters.limit)?;
    let tag = parameters.tag.unwrap_or_default();
    let mut rows = service.store.cases(&tag, page.after.as_deref(), page.rows()).await?;
    let next = page.cut(&mut rows, |row| &row.id);
    let items = rows.iter().map(view).collect::<ApiResult<_>>()?;
    Ok(json(StatusCode::OK, &CaseList { items, next }))
}

/// One case with its meshes.
#[utoipa::path(
    get, path = "/v1/cases/{id}", operation_id = "show_case", tag = "cases", params(("id" = uuid::Uuid, Path, description = "the case")),
    responses(
        (status = 200, description = "the case", body = CaseView, headers(("ETag" = String, description = "its version"))),
        (status = 304, description = "the client has it already"),
    )
)]
async fn show(State(service): State<Service>, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let row = row_of(&service, &id).await?;
    let version = row.version.to_string();
    if conditional::is_known(&headers, &version) {
        return Ok(conditional::not_modified(&version));
    }
    answer(&service, StatusCode::OK, &row).await
}

/// Erases a case: its plans, its jobs with their results, and the meshes that came with it.
#[utoipa::path(
    delete, path = "/v1/cases/{id}", operation_id = "erase_case", tag = "cases",
    params(
        ("id" = uuid::Uuid, Path, description = "the case"),
        ("If-Match" = Option<String>, Header, description = "the version that is meant, or *"),
    ),
    responses(
        (status = 204, description = "erased"),
        (status = 412, description = "it has another version"),
        (status = 428, description = "If-Match is missing"),
    )
)]
async fn remove(State(service): State<Service>, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let row = row_of(&service, &id).await?;
    conditional::require_match(&headers, &row.version.to_string())?;
    match service.store.delete_case(&id, Some(row.version)).await? {
        Change::Done => Ok(StatusCode::NO_CONTENT.into_response()),
        Change::OtherVersion(version) => Err(conditional::other_version(&version.to_string())),
        Change::NotFound => Err(ApiError::not_found("case")),
    }
}

/// What a job with this spec would be held by and take, without solving anything. The body is the spec
/// that would be posted to /v1/jobs; `case` may be left out, and without a plan nothing moves. A client
/// that accepts `image/svg+xml` only gets a picture of the boundary, coloured by what holds it.
#[utoipa::path(
    post, path = "/v1/cases/{id}/check", operation_id = "check_case", tag = "cases", params(("id" = uuid::Uuid, Path, description = "the case")),
    request_body = CheckRequest,
    responses((
        status = 200, description = "the counts of joined, fixed, sliding and free nodes, or their picture",
        content((CheckDocument = "application/json"), (String = "image/svg+xml"))
    ))
)]
async fn check(State(service): State<Service>, Id(id): Id, request: Request) -> ApiResult {
    let wants_counts = check_accept(request.headers(), JSON).is_ok();
    if !wants_counts {
        check_accept(request.headers(), SVG)?;
    }
    let bytes = body::json(&service, request).await?;
    let spec: PredictDocument = strict::parse(&bytes, &service.limits)?;
    let row = row_of(&service, &id).await?;
    if spec.case.as_ref().is_some_and(|case| *case != id) {
        let mut faults = Faults::default();
        let at = crate::schema::Pointer::root().key("case");
        faults.add(&at, "other-case", "the spec names another case than the address");
        faults.into_result()?;
    }
    let input = job_input::predict_input(&service, &row, spec).await?;
    let to_spec = |error: ApiError| error.map_problem(|problem| problem.moved("/spec", ""));
    let report = checked(&service, input, BTreeMap::new()).await.map_err(to_spec)?;
    if wants_counts {
        return Ok(json(StatusCode::OK, &report.document));
    }
    let picture = service.compute(move || report.picture()).await?.map_err(job_input::refusal)?;
    let headers = [(header::CONTENT_TYPE, SVG), (header::CACHE_CONTROL, "private, no-store")];
    Ok((headers, picture).into_response())
}

/// The spec of a prediction in which everything may be left out.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes the body for the OpenAPI document")]
struct CheckRequest {
    #[schema(nullable = false)]
    plan: Option<crate::schema::PlanDocument>,
    #[schema(nullable = false)]
    plan_id: Option<String>,
}
