//! Jobs: create, read, wait, dismiss.

use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::routes;

use super::accepted::{LONGEST_QUEUE, queue_full};
use super::caller::Caller;
use super::error::{ApiError, ApiResult};
use super::gone::gone;
use super::idempotency::{KeyedRequest, NewId};
use super::job_view::status_info;
use super::paging::Page;
use super::parameters::{Id, Parameters, id, listed_tag, no_such_job};
use super::prefer::{RETRY_AFTER_S, requested_wait, wait_for_end, with_wait};
use super::resources::Resources;

use crate::schema::job_change::JobChangeDocument;
use crate::schema::key::Scope;
use crate::schema::wire::canonical::sha256_hex;
use crate::schema::wire::strict;
use crate::schema::{ErrorCode, Faults};

use super::{Service, body, conditional, job_input, json, with_header};
use crate::schema::job::{JobStatus, StatusInfo};
use crate::schema::job_document::{JobDocument, JobKind};
use crate::store::{Dismissal, Enqueued, JobFilter, JobRow, NewJob};
use crate::traces::TraceParent;

/// Equal jobs that are found and gone again before one more is tried.
const REMOVED_MEANWHILE: usize = 10;

pub fn router() -> Resources {
    Resources::new()
        .reads(Scope::Read, routes!(list))
        .changes(Scope::Run, routes!(create))
        .reads(Scope::Read, routes!(show))
        .changes(Scope::Run, routes!(change, dismiss))
        .json_only()
}

#[derive(Serialize, ToSchema)]
struct JobList {
    items: Vec<StatusInfo>,
    /// The cursor of the next page; absent on the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    next: Option<String>,
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct ListParameters {
    /// Only jobs in this state.
    status: Option<JobStatus>,
    /// Only jobs of this kind.
    kind: Option<JobKind>,
    /// Only jobs with this tag.
    #[param(min_length = 1)]
    tag: Option<String>,
    /// Only jobs of this case, and those that read it among others: all that is erased with it, such as models learned from it.
    #[param(format = Uuid)]
    case: Option<String>,
    cursor: Option<String>,
    /// Default: 50.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
}

/// Accepts a job. Equal inputs, from any client of the tenant, give the same job, which gets the tags of each
/// request; where that was dismissed, or failed by its budget or by infrastructure, it is a new job. With
/// `Prefer: wait=n` the response comes when the job has ended, after at most n seconds (at most 30). One with
/// `keep` stores meshes, which needs a key with `write`.
#[utoipa::path(
    post, path = "/v1/jobs", operation_id = "create_job", tag = "jobs",
    params(
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end"),
        (
            "Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255, pattern = r"^[!-~]([\t -~]*[!-~])?$",
            description = "a unique word of the client, to repeat the request safely"
        ),
    ),
    request_body = JobDocument,
    responses(
        (status = 201, description = "accepted", body = StatusInfo, headers(
            ("Location" = String, description = "the job"), ("Retry-After" = Option<u32>, description = "seconds to wait before the next request"),
            ("Preference-Applied" = Option<String>, description = "the wait that was granted"))),
        (status = 200, description = "successful within the wait, or known already (`deduplicated`)", body = StatusInfo, headers(
            ("Content-Location" = String, description = "the job"), ("Retry-After" = Option<u32>, description = "seconds to wait before the next request"),
            ("Preference-Applied" = Option<String>, description = "the wait that was granted"))),
        (status = 410, description = "the job was erased: during the wait, or since an earlier request with the same Idempotency-Key"),
    )
)]
async fn create(service: Service, caller: Caller, request: Request) -> ApiResult {
    let wait = requested_wait(request.headers(), service.limits.wait_s);
    let headers = request.headers().clone();
    let place = request.extensions().get::<Option<TraceParent>>().cloned().flatten();
    let bytes = body::json(&service, request).await?;
    let document = JobDocument::parse(&bytes, &service.limits)?;
    if document.keeps_meshes() {
        caller.require(Scope::Write)?;
    }
    let asked = KeyedRequest::at(&service, &headers, "/v1/jobs", &[&bytes])?;
    if let Some(known) = asked.known(&service).await?
        && renewed(&service, &known.id).await?
    {
        return created(&service, &known.id, known.was_found, wait).await;
    }
    let mut accepted = job_input::of(&service, document).await?;
    // What comes before this changes nothing, so that it ends with its client.
    let new = asked.reserve(&service).await?;
    if new.is_known && renewed(&service, &new.id).await? {
        return created(&service, &new.id, new.was_found, wait).await;
    }
    accepted.id.clone_from(&new.id);
    accepted.traceparent = place.map(|place| place.to_string());
    let (id, deduplicated) = enqueued(&service, &accepted, &new).await?;
    tracing::info!(job.id = %id, deduplicated, "job accepted");
    created(&service, &id, deduplicated, wait).await
}

/// The job of a request, and whether it was there before. One that is removed before it has the tags of the request was not.
async fn enqueued(service: &Service, accepted: &NewJob, new: &NewId) -> ApiResult<(String, bool)> {
    for _ in 0..REMOVED_MEANWHILE {
        match service.store.enqueue(accepted, LONGEST_QUEUE).await? {
            Enqueued::Accepted => return Ok((accepted.id.clone(), false)),
            Enqueued::Known(id) if id == accepted.id => return Ok((id, false)),
            Enqueued::Known(id) => {
                if found(service, &id, &accepted.tags, new).await? {
                    return Ok((id, true));
                }
            }
            Enqueued::QueueFull => return Err(queue_full()),
            Enqueued::NotMeshed => {
                let detail = "the meshing of the case ended meanwhile without a mesh";
                return Err(ApiError::new(ErrorCode::CaseNotReady, detail));
            }
            Enqueued::InputGone => {
                let detail = "the case or a mesh of the job was deleted meanwhile";
                return Err(ApiError::new(ErrorCode::Conflict, detail));
            }
        }
    }
    let detail =
        "equal jobs of other clients are removed as fast as they are found; send the request again";
    Err(ApiError::new(ErrorCode::Conflict, detail))
}

/// Begins the retention of a job anew that is asked for again; false where there is none.
async fn renewed(service: &Service, id: &str) -> ApiResult<bool> {
    Ok(service.store.change_tags(id, &[], &[], 0).await?)
}

/// Gives a job that was found the tags of the request; false where it was removed meanwhile.
async fn found(service: &Service, id: &str, tags: &[String], new: &NewId) -> ApiResult<bool> {
    match tag(service, id, tags, &[]).await {
        Err(error) if error.problem.code == ErrorCode::NoSuchJob => Ok(false),
        tagged => {
            tagged?;
            new.found(service, id).await?;
            Ok(true)
        }
    }
}

/// The response to a request that created a job, or found it.
async fn created(service: &Service, id: &str, deduplicated: bool, wait: Option<u32>) -> ApiResult {
    let Some(job) = wait_for_end(service, id, wait.unwrap_or(0)).await? else {
        let erased = service.store.erased(id).await?;
        return Err(erased.map_or_else(no_such_job, |at| gone(id, at)));
    };
    let location = format!("/v1/jobs/{id}");
    let answer = if deduplicated || job.status == JobStatus::Successful {
        let answer = answer(StatusCode::OK, &job, deduplicated, wait)?;
        with_header(answer, header::CONTENT_LOCATION, &location)
    } else {
        let answer = answer(StatusCode::CREATED, &job, false, wait)?;
        with_header(answer, header::LOCATION, &location)
    };
    Ok(answer)
}

/// The state of a job with its headers.
fn answer(status: StatusCode, job: &JobRow, deduplicated: bool, wait: Option<u32>) -> ApiResult {
    let mut answer = json(status, &status_info(job, deduplicated)?);
    if !job.status.is_terminal() {
        answer = with_header(answer, header::RETRY_AFTER, &RETRY_AFTER_S.to_string());
    }
    Ok(with_wait(answer, wait))
}

/// The state of a job; with `Prefer: wait=n` when it has ended, after at most n seconds (at most 30).
#[utoipa::path(
    get, path = "/v1/jobs/{id}", operation_id = "show_job", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("Prefer" = Option<String>, Header, description = "wait=n: wait at most n seconds for the end"),
        ("If-None-Match" = Option<String>, Header, description = "the state that the client has"),
    ),
    responses(
        (status = 200, description = "its state, with its results once successful", body = StatusInfo, headers(
            ("ETag" = String, description = "the hash of this state"),
            ("Retry-After" = Option<u32>, description = "seconds to wait before the next request"),
            ("Preference-Applied" = Option<String>, description = "the wait that was granted"))),
        (status = 304, description = "the client has it already"),
    )
)]
async fn show(service: Service, Id(id): Id, headers: HeaderMap) -> ApiResult {
    let wait = requested_wait(&headers, service.limits.wait_s);
    let job = wait_for_end(&service, &id, wait.unwrap_or(0)).await?;
    let answer = answer(StatusCode::OK, &job.ok_or_else(no_such_job)?, false, wait)?;
    conditional::document(&headers, answer).await
}

/// Changes the tags of a job, in any state. Adds the tags of `add` and removes those of `remove`;
/// others stay, but beyond the limit of tags those put on longest ago go; redundant changes are no mistake. So changes of several clients do not overwrite each other, and need no
/// If-Match; one that is sent has to name the present state of the job.
#[utoipa::path(
    patch, path = "/v1/jobs/{id}", operation_id = "change_job", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("If-Match" = Option<String>, Header, description = "the state to change, or *"),
    ),
    request_body = JobChangeDocument,
    responses(
        (status = 200, description = "changed", body = StatusInfo, headers(("ETag" = String, description = "the hash of this state"))),
        (status = 412, description = "it is in another state"),
    )
)]
async fn change(service: Service, Id(id): Id, request: Request) -> ApiResult {
    allow_match(&service, &id, request.headers()).await?;
    let bytes = body::json(&service, request).await?;
    let change: JobChangeDocument = strict::parse(&bytes, &service.limits)?;
    let mut faults = Faults::default();
    change.check(&service.limits, &mut faults);
    faults.into_result()?;
    tag(&service, &id, &change.tags.add, &change.tags.remove).await?;
    let job = service.store.job(&id).await?.ok_or_else(no_such_job)?;
    let answer = answer(StatusCode::OK, &job, false, None)?;
    conditional::document(&HeaderMap::new(), answer).await
}

/// Refuses a change of another state of a job than the present one, if the request names one.
async fn allow_match(service: &Service, id: &str, headers: &HeaderMap) -> ApiResult<()> {
    if !headers.contains_key(header::IF_MATCH) {
        return Ok(());
    }
    let job = service.store.job(id).await?.ok_or_else(no_such_job)?;
    conditional::allow_match(headers, &state_tag(&job)?)
}

/// The hash of the state of a job, as in a GET.
fn state_tag(job: &JobRow) -> ApiResult<String> {
    let state = serde_json::to_vec(&status_info(job, false)?).map_err(ApiError::internal)?;
    Ok(sha256_hex(&state))
}

/// Adds tags to a job and removes others.
async fn tag(service: &Service, id: &str, add: &[String], remove: &[String]) -> ApiResult<()> {
    let most = service.limits.tags as usize;
    match service.store.change_tags(id, add, remove, most).await? {
        true => Ok(()),
        false => Err(no_such_job()),
    }
}

/// Jobs, newest first.
#[utoipa::path(
    get, path = "/v1/jobs", operation_id = "list_jobs", tag = "jobs", params(ListParameters),
    responses((status = 200, description = "a page of them", body = JobList))
)]
async fn list(service: Service, Parameters(parameters): Parameters<ListParameters>) -> ApiResult {
    let page = Page::new(parameters.cursor.as_deref(), parameters.limit)?;
    let case_id = parameters.case.map(|text| {
        id(&text).ok_or_else(|| ApiError::invalid_parameter("case", "it is not the id of a case"))
    });
    let filter = JobFilter {
        status: parameters.status.map_or("", JobStatus::name).to_owned(),
        kind: parameters.kind.map_or("", JobKind::name).to_owned(),
        tag: listed_tag(parameters.tag)?,
        case_id: case_id.transpose()?.unwrap_or_default(),
        cursor: page.after.clone(),
        limit: page.rows(),
    };
    let permit = service.list_permit().await?;
    let mut rows = service.store.jobs(&filter).await?;
    let next = page.cut(&mut rows, |row| &row.id);
    let written = permit.compute(move || {
        let items = rows.iter().map(|row| status_info(row, false)).collect::<ApiResult<_>>()?;
        Ok(json(StatusCode::OK, &JobList { items, next }))
    });
    written.await?
}

/// Dismisses a job that has not ended; removes one that has, with its results, which needs a key with `write`.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", operation_id = "dismiss_job", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("If-Match" = Option<String>, Header, description = "the state to dismiss or remove, or *"),
    ),
    responses(
        (status = 200, description = "dismissed", body = StatusInfo),
        (status = 204, description = "it had ended, and is removed"),
        (status = 412, description = "it is in another state"),
    )
)]
async fn dismiss(
    service: Service,
    caller: Caller,
    Id(id): Id,
    headers: HeaderMap,
) -> ApiResult<Response> {
    allow_match(&service, &id, &headers).await?;
    let what = match caller.require(Scope::Write) {
        Ok(()) => service.store.dismiss(&id).await?,
        Err(_) if service.store.dismiss_unended(&id).await? => Dismissal::Dismissed,
        Err(refusal) => {
            service.store.job(&id).await?.ok_or_else(no_such_job)?;
            return Err(refusal);
        }
    };
    tracing::info!(job.id = %id, ?what, "job dismissed");
    match what {
        Dismissal::Dismissed => {
            let job = service.store.job(&id).await?.ok_or_else(no_such_job)?;
            Ok(json(StatusCode::OK, &status_info(&job, false)?))
        }
        Dismissal::Removed => {
            service.pictures.forget(&id);
            Ok(StatusCode::NO_CONTENT.into_response())
        }
        Dismissal::NotFound => Err(no_such_job()),
    }
}

#[cfg(test)]
mod tests {
    use futures::FutureExt as _;
    use futures::future::BoxFuture;

    use super::*;

    fn listed(service: &Service) -> BoxFuture<'static, ApiResult> {
        let (status, kind, tag, case, cursor, limit) = (None, None, None, None, None, None);
        let parameters = ListParameters { status, kind, tag, case, cursor, limit };
        list(service.clone(), Parameters(parameters)).boxed()
    }

    #[tokio::test]
    async fn a_job_that_is_removed_as_it_is_found_is_made_anew_and_one_removed_later_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let service = Service::example(folder.path(), &[]).await;
        let store = service.store.clone();
        let asked = KeyedRequest::at(&service, &HeaderMap::new(), "/v1/jobs", &[]).unwrap();
        let new = asked.reserve(&service).await.unwrap();
        let job = NewJob::example(&new.id);
        assert_eq!(enqueued(&service, &job, &new).await.unwrap(), (new.id.clone(), false));
        let again = NewJob::example("01890000-0000-7000-8000-000000000001");
        assert_eq!(enqueued(&service, &again, &new).await.unwrap(), (new.id.clone(), true));
        for _ in 0..2 {
            store.dismiss(&new.id).await.unwrap();
        }
        assert!(!found(&service, &new.id, &[], &new).await.unwrap());
        assert_eq!(enqueued(&service, &again, &new).await.unwrap(), (again.id.clone(), false));
        let removed = created(&service, &new.id, true, None).await.unwrap_err();
        assert_eq!(removed.problem.code, ErrorCode::Gone);
    }

    #[tokio::test]
    async fn a_list_waits_for_the_turn_of_its_tenant_and_no_more_wait_than_may() {
        let folder = tempfile::tempdir().unwrap();
        let service = Service::example(folder.path(), &[("waiting-requests", "1")]).await;
        let held = [service.list_permit().await.unwrap(), service.list_permit().await.unwrap()];
        let mut first = listed(&service);
        assert!((&mut first).now_or_never().is_none());
        let refused = listed(&service).now_or_never().expect("it is told at once");
        assert_eq!(refused.unwrap_err().into_response().status(), StatusCode::SERVICE_UNAVAILABLE);
        drop(held);
        assert_eq!(first.await.unwrap().status(), StatusCode::OK);
    }
}
