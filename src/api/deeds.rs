//! What callers do that changes something goes into the audit log, with how it ended; also what a key did not allow.

use axum::extract::{MatchedPath, Request};
use axum::http::{Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use tracing::Instrument;

use super::caller::{Caller, is_computed_at_once};
use super::error::ApiError;
use crate::store::{Deed, Store};

/// A request that is to be noted when it has been answered.
pub struct Begun(Deed);

impl Begun {
    /// None for requests that change nothing and are not refused for their key.
    pub fn of(caller: &Caller, request: &Request, id: &str, is_refused: bool) -> Option<Begun> {
        let route = request.extensions().get::<MatchedPath>()?.as_str();
        let looks = matches!(*request.method(), Method::GET | Method::HEAD | Method::OPTIONS);
        if !is_refused && (looks || is_computed_at_once(route)) {
            return None;
        }
        Some(Begun(Deed {
            tenant: caller.tenant.to_string(),
            actor: caller.key.to_string(),
            action: format!("{} {route}", request.method()),
            object: named(route, request.uri().path()),
            outcome: String::new(),
            request: id.to_owned(),
        }))
    }

    /// The same, once it has been answered.
    pub fn answered(mut self, response: &Response) -> Deed {
        if response.status() == StatusCode::CREATED {
            let place = response.headers().get(header::LOCATION);
            let made = place.and_then(|place| place.to_str().ok()?.rsplit('/').next());
            self.0.object = made.unwrap_or(&self.0.object).to_owned();
        }
        self.0
    }
}

/// Carries out a request and notes it with its answer, also when the client goes away meanwhile: what is done is noted.
/// What cannot be noted is not answered as if it were: the client comes back.
pub async fn carry_out(
    store: &Store,
    run: impl Future<Output = Response> + Send + 'static,
    deed: impl FnOnce(&Response) -> Deed + Send + 'static,
) -> Response {
    let store = store.clone();
    let work = async move {
        let response = run.await;
        let outcome = response.status().as_u16().to_string();
        let deed = Deed { outcome, ..deed(&response) };
        match store.note(deed).await {
            Ok(()) => response,
            Err(error) => ApiError::from(error).into_response(),
        }
    };
    let done = tokio::spawn(work.in_current_span()).await;
    done.unwrap_or_else(|error| ApiError::internal(error).into_response())
}

/// The last part of a path that stands for an id in its route.
fn named(route: &str, path: &str) -> String {
    let parts = route.split('/').zip(path.split('/'));
    let ids = parts.filter(|(pattern, _)| pattern.starts_with('{'));
    ids.map(|(_, part)| part.chars().take(LONGEST).collect()).last().unwrap_or_default()
}

/// Ids have 36 characters; what is longer names nothing.
const LONGEST: usize = 64;

#[cfg(test)]
mod tests {
    use super::named;

    #[test]
    fn a_deed_names_the_innermost_thing_of_its_path() {
        assert_eq!(named("/v1/cases/{case}/plans/{id}", "/v1/cases/a/plans/b"), "b");
        assert_eq!(named("/v1/cases", "/v1/cases"), "");
    }
}
