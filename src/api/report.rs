//! The report of a study: as JSON, table, test results or chart, judged against a selected baseline.

use axum::http::{HeaderMap, StatusCode, header};
use axum::response::IntoResponse;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::routes;

use super::download::ServedFile;
use super::error::{ApiError, ApiResult};
use super::middleware::preferred;
use super::parameters::{Id, Parameters, id as spelled, no_such_job};
use super::prefer::successful;
use super::resources::Resources;
use super::{Service, conditional, with_header};
use crate::jobs::study::files::{
    CHART_SVG, CSV_MEDIA_TYPE, JSON_MEDIA_TYPE, JUNIT_MEDIA_TYPE, REPORT_CSV, REPORT_JSON,
    REPORT_JUNIT, SVG_MEDIA_TYPE, csv, junit,
};
use crate::jobs::study::report::encode_report;
use crate::jobs::study::verdict::{Baseline, judge};
use crate::schema::ErrorCode;
use crate::schema::ReportDocument;

use crate::schema::job::JobStatus;
use crate::schema::job_document::JobKind;
use crate::schema::key::Scope;
use crate::store::FileRow;

pub fn router() -> Resources {
    Resources::new().reads(Scope::Read, routes!(report))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
enum ReportFormat {
    Json,
    Csv,
    Junit,
    Svg,
}

const FORMATS: [ReportFormat; 4] =
    [ReportFormat::Json, ReportFormat::Csv, ReportFormat::Junit, ReportFormat::Svg];

impl ReportFormat {
    fn media_type(self) -> &'static str {
        match self {
            ReportFormat::Json => JSON_MEDIA_TYPE,
            ReportFormat::Csv => CSV_MEDIA_TYPE,
            ReportFormat::Junit => JUNIT_MEDIA_TYPE,
            ReportFormat::Svg => SVG_MEDIA_TYPE,
        }
    }

    fn file(self) -> &'static str {
        match self {
            ReportFormat::Json => REPORT_JSON,
            ReportFormat::Csv => REPORT_CSV,
            ReportFormat::Junit => REPORT_JUNIT,
            ReportFormat::Svg => CHART_SVG,
        }
    }
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct ReportParameters {
    /// Default: the preferred type of the header Accept, else `json`.
    #[param(inline)]
    format: Option<ReportFormat>,
    /// Judges the study again, with the study of this job as baseline. Default: the baseline of its spec.
    #[param(format = Uuid)]
    baseline: Option<String>,
}

/// The report of a study: every row with its time and its error, Pareto fronts, comparisons of variants, and the outcome:
/// `pass`, `worse`, `incomplete` or `no-baseline`. A row is worse if it exceeds a threshold of the spec, if its p95
/// error grew by more than 5 % and 1e-4 mm over the baseline, or its iterations by more than half and 5, unless the spec
/// states other ratios, or its time by a stated ratio and 20 ms; a failed row is worse unless expected or as before.
/// The test results have a failure or an error exactly if the outcome is not `pass`. The chart shows all scenes;
/// a study of several has one for each in its files.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/report", operation_id = "show_report", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end"),
        ReportParameters
    ),
    responses(
        (status = 200, description = "the report", content(
            (ReportDocument = "application/json"), (String = "text/csv"), (String = "application/xml"),
            (String = "image/svg+xml")),
            headers(("Facies-Outcome" = String, description = "pass, worse, incomplete or no-baseline"))),
        (status = 206, description = "the requested range", content((Vec<u8> = "*/*"))),
        (status = 304, description = "the client has it already"),
        (status = 404, description = "there is no such job, it is not a study, or has not ended"),
        (status = 416, description = "the range is outside the report"),
        (status = 422, description = "the job failed or was dismissed"),
    )
)]
async fn report(
    service: Service,
    Id(id): Id,
    Parameters(parameters): Parameters<ReportParameters>,
    headers: HeaderMap,
) -> ApiResult {
    let format = wanted(&parameters, &headers)?;
    let job = successful(&service, &id, &headers).await?;
    if !JobKind::from_name(&job.kind).is_some_and(JobKind::has_report) {
        let reported = JobKind::ALL.iter().filter(|kind| kind.has_report());
        let reported: Vec<String> = reported.map(|kind| format!("a {}", kind.name())).collect();
        let reported = reported.join(" and ");
        let detail = format!("a job of kind {} has no report; {reported} have", job.kind);
        return Err(ApiError::new(ErrorCode::NoSuchOutput, detail));
    }
    let stored = stored_report(&service, &id).await?;
    let (row, mut report) = stored.ok_or_else(|| ApiError::internal("a study without report"))?;
    let Some(baseline) = &parameters.baseline else {
        let outcome = report.verdict.outcome.name();
        let row = match format {
            ReportFormat::Json => row,
            other => file(&service, &id, other.file()).await?,
        };
        if conditional::is_known(&headers, &row.blob) {
            return Ok(conditional::not_modified(&row.blob));
        }
        let file = ServedFile::blob(&service, &row.blob).await;
        let file =
            file.map_err(|error| error.of_bytes(format_args!("{} of job {id}", row.name)))?;
        let answer = conditional::file(&headers, file, (&row.media_type, &row.name), &row.blob)?;
        return Ok(told(answer, outcome));
    };
    let baseline = spelled(baseline).ok_or_else(|| {
        ApiError::invalid_parameter("baseline", "the baseline is the id of a job")
    })?;
    let earlier = stored_report(&service, &baseline).await?;
    match &earlier {
        Some((_, earlier)) => judge(&mut report, &Baseline::Report(earlier)),
        None => {
            let why = format!("job {baseline} is no study that has ended well");
            judge(&mut report, &Baseline::Missing(why));
        }
    }
    let outcome = report.verdict.outcome.name();
    let body = match format {
        ReportFormat::Json => encode_report(&report).map_err(ApiError::internal)?,
        ReportFormat::Csv => csv(&report).into_bytes(),
        ReportFormat::Junit => junit(&report).into_bytes(),
        ReportFormat::Svg => {
            let row = file(&service, &id, CHART_SVG).await?;
            service.store.read_blob(&row.blob).await?.to_vec()
        }
    };
    let answer = (StatusCode::OK, body).into_response();
    let answer = with_header(answer, header::CONTENT_TYPE, format.media_type());
    let answer = with_header(answer, header::CACHE_CONTROL, "private, no-store");
    Ok(told(answer, outcome))
}

/// The requested format; the parameter takes precedence over the header.
fn wanted(parameters: &ReportParameters, headers: &HeaderMap) -> ApiResult<ReportFormat> {
    if let Some(format) = parameters.format {
        return Ok(format);
    }
    let plain = |format: ReportFormat| format.media_type().split(';').next().unwrap_or_default();
    Ok(FORMATS[preferred(headers, &FORMATS.map(plain))?])
}

fn told(answer: axum::response::Response, outcome: &str) -> axum::response::Response {
    let name = header::HeaderName::from_static("facies-outcome");
    with_header(with_header(answer, header::VARY, "Accept"), name, outcome)
}

async fn file(service: &Service, job: &str, name: &str) -> ApiResult<FileRow> {
    if let Some(row) = service.store.job_file(job, name).await? {
        return Ok(row);
    }
    // It may have been erased since it was found.
    match service.store.job(job).await? {
        Some(_) => Err(ApiError::internal(format!("a study without {name}"))),
        None => Err(no_such_job()),
    }
}

/// The report of a job, if it has one.
pub(super) async fn stored_report(
    service: &Service,
    job: &str,
) -> ApiResult<Option<(FileRow, ReportDocument)>> {
    let is_study = |row: &crate::store::JobRow| {
        JobKind::from_name(&row.kind).is_some_and(JobKind::has_report)
            && row.status == JobStatus::Successful
    };
    if !service.store.job(job).await?.is_some_and(|row| is_study(&row)) {
        return Ok(None);
    }
    let Some(row) = service.store.job_file(job, REPORT_JSON).await? else { return Ok(None) };
    let bytes = service.store.read_blob(&row.blob).await;
    let bytes = bytes.map_err(|error| {
        ApiError::from(error).of_bytes(format_args!("{REPORT_JSON} of job {job}"))
    })?;
    let report =
        serde_json::from_slice(&bytes).map_err(ApiError::unreadable("the report of job", job))?;
    Ok(Some((row, report)))
}

/// The report of an earlier study with the same rows, if its cases are all among those of the new one: it is stored with the
/// new one's document, and erased with these.
pub(super) async fn with_rows(
    service: &Service,
    rows_key: &str,
    owners: &[String],
) -> ApiResult<Option<ReportDocument>> {
    for job in service.store.studies_with_rows(rows_key).await? {
        let of = service.store.cases_of_job(&job).await?;
        if !of.iter().all(|case| owners.contains(case)) {
            continue;
        }
        let Some((_, report)) = stored_report(service, &job).await? else {
            continue;
        };
        if report.rows_key == rows_key && report.is_complete() {
            return Ok(Some(report));
        }
    }
    Ok(None)
}
