//! What callers do that changes something goes into the audit log, with how it ended; also what a key did not allow.

use axum::extract::{MatchedPath, Request};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use tracing::Instrument;

use super::caller::Caller;
use super::error::ApiError;
use crate::store::{Deed, Store};

/// What a caller's request is about to do; none where no route is asked.
pub fn deed_of(caller: &Caller, request: &Request, id: &str) -> Option<Deed> {
    let route = request.extensions().get::<MatchedPath>()?.as_str();
    Some(Deed {
        tenant: caller.tenant.to_string(),
        actor: caller.key.to_string(),
        action: format!("{} {route}", request.method()),
        object: innermost(route, request.uri().path()),
        request: id.to_owned(),
    })
}

/// The same for a request on the admin listener.
pub fn deed_of_admin(request: &Request, id: &str) -> Option<Deed> {
    let route = request.extensions().get::<MatchedPath>()?.as_str();
    let path = request.uri().path();
    let tenant = ids(route, path).find(|(pattern, _)| *pattern == "{tenant}");
    Some(Deed {
        tenant: tenant.map(|(_, tenant)| tenant).unwrap_or_default(),
        actor: "admin".to_owned(),
        action: format!("{} {route}", request.method()),
        object: innermost(route, path),
        request: id.to_owned(),
    })
}

/// Notes a request, carries it out, and notes how it was answered, also when the client goes away meanwhile. What
/// cannot be noted is not carried out.
pub async fn carry_out(
    store: &Store,
    deed: Deed,
    run: impl Future<Output = Response> + Send + 'static,
) -> Response {
    let store = store.clone();
    let work = async move {
        let begun = match store.begin_deed(&deed).await {
            Ok(begun) => begun,
            Err(error) => return ApiError::from(error).into_response(),
        };
        let response = run.await;
        let object = made(&response).unwrap_or(&deed.object);
        let outcome = response.status().as_u16().to_string();
        if let Err(error) = store.end_deed(begun, object, &outcome).await {
            tracing::error!(%error, "the audit log is told later how a request ended");
        }
        response
    };
    let done = tokio::spawn(work.in_current_span()).await;
    done.unwrap_or_else(|error| ApiError::internal(error).into_response())
}

/// The id of what a request made.
fn made(response: &Response) -> Option<&str> {
    let place = response.headers().get(header::LOCATION)?;
    let is_made = response.status() == StatusCode::CREATED;
    place.to_str().ok()?.rsplit('/').next().filter(|_| is_made)
}

/// The parts of a path that stand for an id in its route, behind their patterns.
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

/// Ids have 36 characters and names of tenants 63; what is longer names nothing.
const LONGEST: usize = 64;

#[cfg(test)]
mod tests {
    use super::innermost;

    #[test]
    fn a_deed_names_the_innermost_thing_of_its_path() {
        assert_eq!(innermost("/v1/cases/{case}/plans/{id}", "/v1/cases/a/plans/b"), "b");
        assert_eq!(innermost("/v1/cases", "/v1/cases"), "");
    }
}
