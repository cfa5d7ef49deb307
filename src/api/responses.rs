//! Plan responses: the columns for clients that apply plans themselves, and the skin for one plan.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::Request;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::routes;

use super::case_state::whole;
use super::download::ServedFile;
use super::error::{ApiError, ApiResult};
use super::foreseen::ResponseLookup;
use super::middleware::preferred;
use super::parameters::{Id, Parameters, id as spelled};
use super::resources::Resources;
use super::{Service, body, conditional, with_header};
use crate::jobs::response::{
    COLUMNS_FILE, COLUMNS_MEDIA_TYPE, DESCRIPTION_FILE, DESCRIPTION_MEDIA_TYPE, SECOND_ORDER_FILE,
};
use crate::library::applied::Applied;
use crate::library::loaded_response::LoadedResponse;
use crate::library::responses::{FoundResponse, MissingResponse, ResponseChoice};
use crate::library::upload::not_written;
use crate::schema::applied::{AppliedDocument, ApplyDocument};
use crate::schema::key::Scope;
use crate::schema::predict::document::{RANGES_MM, USUAL_RANGE_MM};
use crate::schema::response_description::ResponseDescription;
use crate::schema::wire::strict;
use crate::schema::{ErrorCode, PlanDocument};
use mechanics::format::WriteError;

const GLB_MEDIA_TYPE: &str = "model/gltf-binary";

pub fn router() -> Resources {
    Resources::new().reads(Scope::Read, routes!(show)).reads(Scope::Run, routes!(apply))
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct ResponseParameters {
    /// The job that built the response. Default: the newest for the present version of the case, by `fem_linear` with the usual element, the
    /// materials of the case, no membrane and a tolerance of 1e-8 or less, of any order; of these first one with all segments. Only if there is none
    /// is another one taken; the response to the request says which.
    #[param(format = Uuid)]
    job: Option<String>,
    /// 2: the columns of second order instead, little-endian i16 [column][node][xyz], which `second_order` of
    /// the description specifies; 404 if the response was built to order 1. Default: 1.
    #[param(minimum = 1, maximum = 2)]
    order: Option<u8>,
}

impl ResponseParameters {
    /// The file with the columns of the requested order.
    fn columns_file(&self) -> ApiResult<&'static str> {
        match self.order {
            None | Some(1) => Ok(COLUMNS_FILE),
            Some(2) => Ok(SECOND_ORDER_FILE),
            Some(other) => {
                let detail = format!("{other} is neither 1 nor 2");
                Err(ApiError::invalid_parameter("order", detail))
            }
        }
    }
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct ApplyParameters {
    /// The job that built the response. Default: the newest for the present version of the case, by `fem_linear` with the usual element, the
    /// materials of the case, no membrane and a tolerance of 1e-8 or less, of any order; of these first one with all columns that the plan needs. Only if there is none
    /// is another one taken, with the warning `other-response`; the response to the request says which.
    #[param(format = Uuid)]
    job: Option<String>,
    /// The displacement in mm at which the colours of `model/gltf-binary` end; they begin at 0. Default: 10.
    #[param(minimum = 0.001, maximum = 1000.0)]
    range_mm: Option<f64>,
    /// Whether to look for triangles of the moved skin that intersect and did not before (warning
    /// `skin-overlaps`): some milliseconds for each ten thousand triangles. Default: false, and the result says that
    /// it was not checked.
    check_skin: Option<bool>,
}

impl ApplyParameters {
    fn range_mm(&self) -> ApiResult<f64> {
        let range = self.range_mm.unwrap_or(USUAL_RANGE_MM);
        match RANGES_MM.contains(&range) {
            true => Ok(range),
            false => {
                let detail = format!("{range} mm is not within 0.001 to 1000 mm");
                Err(ApiError::invalid_parameter("range_mm", detail))
            }
        }
    }
}

/// The response of a request.
struct ResponseReference<'a> {
    case: &'a str,
    job: Option<&'a str>,
    plan: Option<&'a PlanDocument>,
    foreseen: Option<ResponseLookup>,
}

async fn find(service: &Service, meant: ResponseReference<'_>) -> ApiResult<FoundResponse> {
    let ResponseReference { case, job, plan, foreseen } = meant;
    let job = match job {
        Some(text) => {
            let unknown = || refusal(MissingResponse::NotOfCase { job: text.to_owned() });
            Some(spelled(text).ok_or_else(unknown)?)
        }
        None => None,
    };
    let wanted = ResponseChoice { job: job.as_deref(), plan };
    let found = match foreseen.and_then(ResponseLookup::fresh) {
        Some(built) => service.responses.find_among(built, case, wanted).await,
        None => service.responses.find(case, wanted).await,
    };
    match found {
        Err(missing @ MissingResponse::NotBuilt) => {
            let row = service.store.case(case).await?;
            Err(row.and_then(|row| whole(&row).err()).unwrap_or_else(|| refusal(missing)))
        }
        found => found.map_err(refusal),
    }
}

async fn load(service: &Service, found: &FoundResponse) -> ApiResult<Arc<LoadedResponse>> {
    let loaded = service.responses.load(found).await;
    loaded.map_err(|error| of_response(error.into(), found))
}

fn of_response(error: ApiError, found: &FoundResponse) -> ApiError {
    error.of_bytes(format_args!("response of job {}", found.job))
}

fn refusal(missing: MissingResponse) -> ApiError {
    let detail = missing.to_string();
    match missing {
        MissingResponse::NoCase => ApiError::not_found("case"),
        MissingResponse::NotBuilt | MissingResponse::NotOfCase { .. } => {
            ApiError::new(ErrorCode::ResponseNotBuilt, detail)
        }
        MissingResponse::Stale { job } => ApiError::new(ErrorCode::ResponseStale, detail)
            .map_problem(|problem| problem.with("job", job)),
        MissingResponse::Store(error) => error.into(),
    }
}

/// The columns of a response, or their description. A front end with both moves the skin without further
/// requests: u = sum over segments of column 12 s + 4 i + j times (R - I)_ij (j < 3) or t_i (j = 3), with x
/// measured from the segment's centre, and of `inner_columns`, growth and muscles, after these.
#[utoipa::path(
    get, path = "/v1/cases/{id}/response", operation_id = "show_response", tag = "responses",
    params(("id" = uuid::Uuid, Path, description = "the case"), ResponseParameters),
    responses(
        (status = 200, description = "the description; or the columns as little-endian f32 [column][node][xyz] in mm; or the skin at rest, its vertices in the order of `node_ids`", content(
            (ResponseDescription = "application/json"), (Vec<u8> = "application/octet-stream"), (Vec<u8> = "model/gltf-binary")),
            headers(("ETag" = String, description = "the hash of the content"))),
        (status = 206, description = "the requested range", content((Vec<u8> = "*/*"))),
        (status = 304, description = "the client has it already"),
        (status = 404, description = "there is no such case, or no response was built"),
        (status = 409, description = "the case or the program changed since the response was built"),
        (status = 416, description = "the range is outside the file"),
    )
)]
async fn show(
    service: Service,
    Id(id): Id,
    Parameters(parameters): Parameters<ResponseParameters>,
    headers: HeaderMap,
) -> ApiResult {
    let offered = [DESCRIPTION_MEDIA_TYPE, COLUMNS_MEDIA_TYPE, GLB_MEDIA_TYPE];
    let wanted = preferred(&headers, &offered)?;
    let columns_file = parameters.columns_file()?;
    let job = parameters.job.as_deref();
    let meant = ResponseReference { case: &id, job, plan: None, foreseen: None };
    let found = find(&service, meant).await?;
    let files = [DESCRIPTION_FILE, columns_file];
    let Some(file) = files.get(wanted) else {
        return rest(&service, &found, &headers).await;
    };
    let row = service.store.job_file(&found.job, file).await?;
    let row = row.ok_or_else(|| {
        let detail =
            "the response was built to order 1; post a job of kind `response` with `order` 2";
        ApiError::new(ErrorCode::ResponseNotBuilt, detail.to_owned())
    })?;
    let response = if conditional::is_known(&headers, &row.blob) {
        conditional::not_modified(&row.blob)
    } else {
        let file = ServedFile::blob(&service, &row.blob).await;
        let file = file.map_err(|error| of_response(error, &found))?;
        conditional::file(&headers, file, (&row.media_type, &row.name), &row.blob)?
    };
    let response = with_header(response, header::VARY, "Accept");
    Ok(with_header(response, HeaderName::from_static("facies-job"), &found.job))
}

/// The undeformed skin as binary glTF. Its tag is that of the description, which the same job wrote.
async fn rest(service: &Service, found: &FoundResponse, headers: &HeaderMap) -> ApiResult {
    let tag = format!("{}-rest", found.job);
    let response = if conditional::is_known(headers, &tag) {
        conditional::not_modified(&tag)
    } else {
        let permit = service.parse_permit().await?;
        let loaded = load(service, found).await?;
        let written = move || loaded.rest_glb().map_err(not_written);
        let file = ServedFile::made(service, &permit, written).await?;
        conditional::file(headers, file, (GLB_MEDIA_TYPE, "rest.glb"), &tag)?
    };
    let response = with_header(response, header::VARY, "Accept");
    Ok(with_header(response, HeaderName::from_static("facies-job"), &found.job))
}

/// The skin after a plan, computed in milliseconds. Segments that the plan does not name stay; growth and activations
/// of the plan need their columns in the response. A response of order
/// 1 is exact within linear elasticity; the linearisation error is estimated from samples of the second order along and about
/// each axis of each segment (unknown of quadratic tetrahedra and of fibres that only pull). A response of order 2 adds the
/// second-order term of finite strain, reports its mean length, and estimates the third order from samples. Out of range the result has the
/// warning `outside-linear-range` or `outside-second-order-range`. With a binary body the numbers are in headers.
#[utoipa::path(
    post, path = "/v1/cases/{id}/response/apply", operation_id = "apply_response", tag = "responses",
    params(("id" = uuid::Uuid, Path, description = "the case"), ApplyParameters),
    request_body = ApplyDocument,
    responses(
        (status = 200, description = "displacement of the skin nodes in mm; as octets little-endian f32 xyz a node in the order of `node_ids`; or the moved skin", content(
            (AppliedDocument = "application/json"), (Vec<u8> = "application/octet-stream"), (Vec<u8> = "model/gltf-binary")),
            headers(
                ("Facies-Job" = String, description = "the job that built the response"),
                ("Facies-Max-Mm" = f64, description = "the largest displacement of a skin node"),
                ("Facies-Largest-Rotation-Deg" = f64, description = "the largest rotation of a segment"),
                ("Facies-Order" = u8, description = "that of the response: 2 if the displacement includes the second-order term"),
                ("Facies-Second-Order-Mm" = Option<f64>, description = "of order 2: the mean length of the second-order term, as `second_order_mm`"),
                ("Facies-Nonlinearity-Estimate-Mm" = Option<f64>, description = "the linearisation error: of order 1 the second-order term, of order 2 the third-order term, from samples; absent where it is unknown"),
                ("Facies-Within-Linear-Range" = Option<bool>, description = "as `within_linear_range`; absent where it is null"),
                ("Facies-Warning" = Option<String>, description = "the codes of the warnings: outside-linear-range, outside-second-order-range, nonlinearity-unknown, nothing-moves, plan-units-suspect, sliding-normal-turned, tearing, skin-overlaps, other-response, solved-loosely, and those of the case as the response was built"),
                ("Facies-Not-Measured" = Option<String>, description = "codes of warnings that were not checked, as `not_measured`"),
                ("Server-Timing" = String, description = "milliseconds to find the response, to add up its columns, to check the skin, and to write the result"))),
        (status = 404, description = "there is no such case, or no response was built"),
        (status = 409, description = "the case or the program changed since the response was built"),
        (status = 422, description = "the response does not support the plan: loads, prescribed displacements, other segments, growth and muscles without a column, movements beyond the limits"),
    )
)]
async fn apply(
    service: Service,
    Id(id): Id,
    Parameters(parameters): Parameters<ApplyParameters>,
    request: Request,
) -> ApiResult {
    let started = Instant::now();
    let offered = [DESCRIPTION_MEDIA_TYPE, COLUMNS_MEDIA_TYPE, GLB_MEDIA_TYPE];
    let media_type = offered[preferred(request.headers(), &offered)?];
    let wanted = ReplyOptions {
        media_type,
        range_mm: parameters.range_mm()?,
        check_skin: parameters.check_skin.unwrap_or(false),
    };
    let foreseen = request.extensions().get::<ResponseLookup>().cloned();
    let bytes = body::json(&service, request).await?;
    let document: ApplyDocument = strict::parse(&bytes, &service.limits)?;
    let (job, plan) = (parameters.job.as_deref(), Some(&document.plan));
    let meant = ResponseReference { case: &id, job, plan, foreseen };
    let found = find(&service, meant).await?;
    let loaded = load(&service, &found).await?;
    let amounts = loaded.description.amounts(&document.plan, &service.limits)?;
    let loading = started.elapsed();

    // Numerics keep off the threads that answer; a turn on one that may block costs some 20 µs. No permit is
    // asked for: a parse of a large mesh would hold it for seconds.
    let (job, other) = (found.job.clone(), found.warning());
    let computed = tokio::task::spawn_blocking(move || {
        let started = Instant::now();
        let mut applied = loaded.apply(&amounts).warned(other.into_iter().collect());
        let applying = started.elapsed();
        if wanted.check_skin {
            applied = loaded.check_skin(applied);
        }
        let checking = started.elapsed() - applying;
        let body = wanted.encoded(&loaded, &applied, &job);
        (body, applied, applying, checking, started.elapsed() - applying - checking)
    });
    let (body, applied, applying, checking, writing) =
        computed.await.map_err(ApiError::internal)?;
    let body = body.map_err(ApiError::internal)?;
    let times = [("load", loading), ("apply", applying), ("check", checking), ("write", writing)];
    let times = times.map(|(name, time)| format!("{name};dur={:.3}", time.as_secs_f64() * 1e3));
    let response = with_summary((StatusCode::OK, body).into_response(), &found.job, &applied);
    let response = with_header(response, header::CONTENT_TYPE, media_type);
    Ok(with_header(response, HeaderName::from_static("server-timing"), &times.join(", ")))
}

/// The form of a result, and the checks of it.
#[derive(Clone, Copy)]
struct ReplyOptions {
    media_type: &'static str,
    range_mm: f64,
    check_skin: bool,
}

impl ReplyOptions {
    /// The body of a result.
    fn encoded(
        &self,
        loaded: &LoadedResponse,
        applied: &Applied,
        job: &str,
    ) -> Result<Vec<u8>, WriteError> {
        match self.media_type {
            COLUMNS_MEDIA_TYPE => Ok(applied.to_bytes()),
            GLB_MEDIA_TYPE => loaded.glb(applied, self.range_mm),
            _ => {
                let document = AppliedDocument {
                    job: job.to_owned(),
                    node_ids: loaded.description.node_ids.clone(),
                    displacement_mm: applied.to_triples(),
                    summary: applied.summary,
                    warnings: applied.warnings.clone(),
                    not_measured: applied.not_measured(),
                };
                let failed =
                    |_| WriteError::NonFinite { array: "displacement_mm".into(), count: 1 };
                serde_json::to_vec(&document).map_err(failed)
            }
        }
    }
}

/// The numbers of a result as headers.
fn with_summary(response: Response, job: &str, applied: &Applied) -> Response {
    let summary = &applied.summary;
    let numbers = [
        ("cache-control", "private, no-store".to_owned()),
        ("vary", "Accept".to_owned()),
        ("facies-job", job.to_owned()),
        ("facies-max-mm", summary.max_mm.to_string()),
        ("facies-largest-rotation-deg", summary.largest_rotation_deg.to_string()),
        ("facies-order", summary.order.to_string()),
    ];
    let warnings: Vec<String> =
        applied.warnings.iter().map(|warning| warning.code.clone()).collect();
    let estimate = summary.nonlinearity_estimate_mm.map(|estimate| estimate.to_string());
    let within = summary.within_linear_range.map(|is_within| is_within.to_string());
    let second_order = summary.second_order_mm.map(|length| length.to_string());
    let words = [
        ("facies-second-order-mm", second_order.unwrap_or_default()),
        ("facies-nonlinearity-estimate-mm", estimate.unwrap_or_default()),
        ("facies-within-linear-range", within.unwrap_or_default()),
        ("facies-warning", warnings.join(", ")),
        ("facies-not-measured", applied.not_measured().join(", ")),
    ];
    let words = words.into_iter().filter(|(_, text)| !text.is_empty());
    numbers.into_iter().chain(words).fold(response, |response, (name, value)| {
        with_header(response, HeaderName::from_static(name), &value)
    })
}
