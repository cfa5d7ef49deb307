//! The events of a job as they happen (server-sent events, HTML Living Standard, section 9.2).

use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;

use axum::Extension;
use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures::Stream;
use tokio::sync::watch;
use tokio::time::Instant;
use utoipa_axum::routes;

use super::client::Client;
use super::error::{ApiError, ApiResult};
use super::key_lookup::KeyLookup;
use super::middleware::check_accept;
use super::parameters::{Id, no_such_job};
use super::resources::Resources;
use super::streams::StreamPlace;
use super::{Service, time};
use crate::schema::job::{JobEvent, JobStatus};
use crate::schema::key::Scope;
use crate::store::{Changes, EventRow, Store};

const MEDIA_TYPE: &str = "text/event-stream";
const LAST_ID: &str = "last-event-id";
/// Interval of comments, which keep proxies from closing a silent stream.
const SILENCE: Duration = Duration::from_secs(15);
/// Delay after which a client reconnects a lost stream.
const RETRY: Duration = Duration::from_secs(2);
/// Longest interval between queries of the database, also without notifications.
const LOOK: Duration = Duration::from_secs(1);
/// Shortest interval between queries, for any number of notifications.
const PAUSE: Duration = Duration::from_millis(100);

pub fn router() -> Resources {
    Resources::new().reads(Scope::Read, routes!(follow))
}

/// The events of a job, from the first or from the one after `Last-Event-ID`, to the end of the job. `event` is
/// `state` when a job is accepted or an attempt begins, `progress` for its progress, and `end`; `id` counts from 1
/// without gaps; `data` is a `JobEvent`. If the job is removed meanwhile, the `end` says so (`removed`). A stream also ends, without it, when its key is revoked or expires. The last thousand events of a job are kept. A broken stream is resumed
/// with the last id that was read; if there are no more events, the response is 204: do not reconnect.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/events", operation_id = "follow_job", tag = "jobs",
    params(
        ("id" = uuid::Uuid, Path, description = "the job"),
        ("Last-Event-ID" = Option<u64>, Header, description = "the id of the last event read"),
    ),
    responses(
        (status = 200, description = "the events", content((String = "text/event-stream"))),
        (status = 204, description = "the job has ended and there are no more events"),
    )
)]
async fn follow(
    service: Service,
    Id(job): Id,
    client: Option<Extension<Client>>,
    headers: HeaderMap,
) -> ApiResult<Response> {
    check_accept(&headers, MEDIA_TYPE)?;
    let after = last_id(&headers)?;
    let row = service.store.job(&job).await?.ok_or_else(no_such_job)?;
    let mut events = service.store.job_events(&job, after).await?.ok_or_else(no_such_job)?;
    if events.is_empty() && after == 0 {
        service.store.record_job(&job).await?;
        events = service.store.job_events(&job, after).await?.ok_or_else(no_such_job)?;
    }
    if events.is_empty() && row.status.is_terminal() {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let client = client.map_or_else(|| Client::named(""), |Extension(client)| client);
    let mut told = EventStream {
        place: service.streams.enter(client)?,
        changes: service.store.job_changes(),
        stopping: service.streams.stopping(),
        key: service.key_lookup,
        store: service.store,
        job,
        after,
        last: None,
        waiting: VecDeque::from([Event::default().retry(RETRY)]),
        ended: false,
        looked: Instant::now(),
    };
    told.take(&events);
    let stream = Sse::new(told.stream()).keep_alive(KeepAlive::new().interval(SILENCE));
    Ok(stream.into_response())
}

/// 0 for all events.
fn last_id(headers: &HeaderMap) -> ApiResult<i64> {
    let Some(value) = headers.get(LAST_ID) else { return Ok(0) };
    let number = value.to_str().ok().and_then(|text| text.parse().ok());
    let detail = "Last-Event-ID is the id of an event, a number from 0";
    number
        .filter(|number: &i64| *number >= 0)
        .ok_or_else(|| ApiError::invalid_parameter("Last-Event-ID", detail))
}

/// Position of a stream among the events of its job.
struct EventStream {
    place: StreamPlace,
    changes: Changes,
    stopping: watch::Receiver<bool>,
    key: KeyLookup,
    store: Store,
    job: String,
    /// The number of the last event sent.
    after: i64,
    last: Option<EventRow>,
    waiting: VecDeque<Event>,
    ended: bool,
    looked: Instant,
}

impl EventStream {
    fn stream(self) -> impl Stream<Item = Result<Event, Infallible>> {
        futures::stream::unfold(self, |mut told| async move {
            loop {
                if let Some(event) = told.waiting.pop_front() {
                    return Some((Ok(event), told));
                }
                if told.ended {
                    drop(told.place);
                    return None;
                }
                told.wait().await;
                if let Err(error) = told.look().await {
                    // The client comes back and misses nothing, unless its key is not in force any more.
                    let error = error.problem.detail;
                    tracing::warn!(job.id = %told.job, %error, "a stream of events broke off");
                    told.ended = true;
                }
            }
        })
    }

    /// Waits until there may be new events, or the process is about to stop.
    async fn wait(&mut self) {
        tokio::time::sleep_until(self.looked + PAUSE).await;
        tokio::select! {
            _ = tokio::time::timeout(LOOK, self.changes.of(&self.job)) => {}
            _ = self.stopping.wait_for(|stopping| *stopping) => self.ended = true,
        }
    }

    /// Takes the new events, if the key of the client is still in force.
    async fn look(&mut self) -> ApiResult<()> {
        self.changes.mark_seen();
        self.looked = Instant::now();
        self.key.require(&self.store).await?;
        match self.store.job_events(&self.job, self.after).await? {
            Some(events) => self.take(&events),
            None => self.end_removed().await?,
        }
        Ok(())
    }

    /// The end of a job that was removed, with the events that this stream did not read.
    async fn end_removed(&mut self) -> ApiResult<()> {
        self.ended = true;
        let Some(at) = self.store.erased(&self.job).await? else { return Ok(()) };
        let before = self.last.as_ref();
        let end = EventRow {
            number: self.after + 1,
            at,
            status: JobStatus::Dismissed,
            phase: None,
            progress: before.map_or(0, |row| row.progress),
            iteration: None,
            residual: None,
            attempt: before.map_or(0, |row| row.attempt),
        };
        self.put(&end, true);
        Ok(())
    }

    fn take(&mut self, rows: &[EventRow]) {
        for row in rows {
            self.put(row, false);
        }
        self.last = rows.last().cloned().or(self.last.take());
        // A job that failed may have been accepted once more, so only its last state can be the end.
        if rows.last().is_some_and(|row| row.status.is_terminal()) {
            self.ended = true;
        }
    }

    fn put(&mut self, row: &EventRow, removed: bool) {
        self.after = row.number;
        match event(row, removed) {
            Ok(event) => self.waiting.push_back(event),
            Err(error) => tracing::error!(job.id = %self.job, %error, "an event was not sent"),
        }
    }
}

fn event(row: &EventRow, removed: bool) -> Result<Event, axum::Error> {
    let name = match row.status {
        status if status.is_terminal() => "end",
        JobStatus::Running if row.phase.is_some() => "progress",
        _ => "state",
    };
    let unsigned = |number: i64| u64::try_from(number).unwrap_or_default();
    let data = JobEvent {
        number: unsigned(row.number),
        at: time::rfc3339(row.at),
        status: row.status,
        phase: row.phase.clone().filter(|_| row.status == JobStatus::Running),
        progress: u8::try_from(row.progress.clamp(0, 100)).unwrap_or(100),
        iteration: row.iteration.map(unsigned),
        residual: row.residual,
        attempt: u32::try_from(row.attempt).unwrap_or(u32::MAX),
        removed,
    };
    Event::default().event(name).id(row.number.to_string()).json_data(data)
}

#[cfg(test)]
mod tests {
    use axum::body::to_bytes;

    use super::*;
    use crate::store::NewJob;

    #[tokio::test]
    async fn the_stream_of_a_job_that_is_dismissed_and_removed_at_once_ends_with_that() {
        let folder = tempfile::tempdir().unwrap();
        let service = Service::example(folder.path(), &[]).await;
        let store = service.store.clone();
        let job = NewJob::example("01890000-0000-7000-8000-000000000001");
        store.enqueue(&job, 10).await.unwrap();
        let followed = follow(service, Id(job.id.clone()), None, HeaderMap::new()).await.unwrap();
        for _ in 0..2 {
            store.dismiss(&job.id).await.unwrap();
        }
        let told = to_bytes(followed.into_body(), 1 << 16).await.unwrap();
        let told = String::from_utf8(told.to_vec()).unwrap();
        let (_, end) = told.split_once("event: end").expect("an end");
        assert!(end.contains("id: 2") && end.contains(r#""removed":true"#), "{told}");
    }
}
