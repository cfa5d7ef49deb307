//! Audit of requests: changes by callers, with their outcome, and attempts that a key did not allow.

use axum::extract::{MatchedPath, Request};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use tokio::task::AbortHandle;
use tracing::Instrument;

use super::body::BodyState;
use super::caller::Caller;
use super::error::ApiError;
use crate::store::{AuditIntent, AuditedAction, Store};

/// The audit intent of a caller's request; none without a route.
pub fn audited_action_of(caller: &Caller, request: &Request, id: &str) -> Option<AuditedAction> {
    let route = request.extensions().get::<MatchedPath>()?.as_str();
    Some(AuditedAction {
        tenant: caller.tenant.to_string(),
        actor: caller.key.to_string(),
        action: format!("{} {route}", request.method()),
        object: innermost(route, request.uri().path()),
        request: id.to_owned(),
    })
}

/// The same for a request on the admin listener.
pub fn audited_admin_action(request: &Request, id: &str) -> Option<AuditedAction> {
    let route = request.extensions().get::<MatchedPath>()?.as_str();
    let path = request.uri().path();
    let tenant = ids(route, path).find(|(pattern, _)| *pattern == "{tenant}");
    Some(AuditedAction {
        tenant: tenant.map(|(_, tenant)| tenant).unwrap_or_default(),
        actor: "admin".to_owned(),
        action: format!("{} {route}", request.method()),
        object: innermost(route, path),
        request: id.to_owned(),
    })
}

/// Runs a request that may change something. It is audited before its first change, and then runs to its end, even if
/// its client disconnects; until then it ends with its client. Its status is audited as well, but not if its body
/// never came.
pub async fn carry_out(
    intent: AuditIntent,
    coming: BodyState,
    run: impl Future<Output = Response> + Send + 'static,
) -> Response {
    let own = intent.clone();
    let work = async move {
        let response = run.await;
        let object = made(&response).unwrap_or(own.object());
        let status = response.status();
        let is_told = !coming.is_broken() && is_told(status);
        match own.end(object, status.as_str(), is_told).await {
            Ok(()) => response,
            Err(error) => ApiError::from(error).into_response(),
        }
    };
    let task = tokio::spawn(work.in_current_span());
    let _client = Client { intent, task: task.abort_handle() };
    task.await.unwrap_or_else(|error| ApiError::internal(error).into_response())
}

/// The same for erasures, which need to work on a full disk and free space on it.
pub async fn erased(store: Store, run: impl Future<Output = Response>) -> Response {
    store.release_reserve().await;
    let response = run.await;
    store.refill_reserve().await;
    response
}

/// Whether the response to a request without changes is audited: not server errors, nor bodies that came too late.
fn is_told(status: StatusCode) -> bool {
    !status.is_server_error() && status != StatusCode::REQUEST_TIMEOUT
}

/// A waiting client; dropped when it has its response, or disconnects.
struct Client {
    intent: AuditIntent,
    task: AbortHandle,
}

impl Drop for Client {
    fn drop(&mut self) {
        if self.intent.leave() {
            self.task.abort();
        }
    }
}

/// The id of the created resource, also of a job that ended while its client waited and is returned instead.
fn made(response: &Response) -> Option<&str> {
    let place = match response.status() {
        StatusCode::CREATED => header::LOCATION,
        StatusCode::OK => header::CONTENT_LOCATION,
        _ => return None,
    };
    response.headers().get(place)?.to_str().ok()?.rsplit('/').next()
}

/// The ids in a path, behind their patterns in its route.
fn ids<'a>(route: &'a str, path: &'a str) -> impl Iterator<Item = (&'a str, String)> {
    let parts = route.split('/').zip(path.split('/'));
    parts
        .filter(|(pattern, _)| pattern.starts_with('{'))
        .map(|(pattern, part)| (pattern, part.chars().take(LONGEST).collect()))
}

/// The last of them.
fn innermost(route: &str, path: &str) -> String {
    ids(route, path).last().map(|(_, id)| id).unwrap_or_default()
}

/// Ids have 36 characters and names of tenants 64; longer texts are no names.
const LONGEST: usize = 64;

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use futures::FutureExt as _;

    use super::*;

    #[tokio::test]
    async fn what_has_changed_nothing_ends_with_its_client() {
        let folder = tempfile::TempDir::new().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let (held, ended) = tokio::sync::oneshot::channel::<()>();
        let run = async move {
            let _held = held;
            std::future::pending::<Response>().await
        };
        let intent = store.audit_intent(AuditedAction::default());
        let mut request = Box::pin(carry_out(intent, BodyState::default(), run));
        assert!((&mut request).now_or_never().is_none(), "it is at work");
        drop(request);
        let ended = tokio::time::timeout(Duration::from_secs(60), ended).await;
        assert!(ended.expect("it ends").is_err(), "it is given up");
    }

    #[test]
    fn an_audited_action_names_the_innermost_thing_of_its_path() {
        assert_eq!(innermost("/v1/cases/{case}/plans/{id}", "/v1/cases/a/plans/b"), "b");
        assert_eq!(innermost("/v1/cases", "/v1/cases"), "");
    }
}
