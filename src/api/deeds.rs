//! What callers do that changes something goes into the audit log, with how it ended; also what a key did not allow.

use axum::extract::{MatchedPath, Request};
use axum::http::{Method, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::caller::{Caller, is_computed_at_once};
use super::error::ApiError;
use crate::store::{Deed, Store};

/// A request that is to be noted when it has been answered.
pub struct Begun(Deed);

impl Begun {
    /// None for requests that change nothing.
    pub fn of(caller: &Caller, request: &Request, id: &str) -> Option<Begun> {
        let route = request.extensions().get::<MatchedPath>()?.as_str();
        let looks = matches!(*request.method(), Method::GET | Method::HEAD | Method::OPTIONS);
        if looks || is_computed_at_once(route) {
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

    /// Notes the request with its answer. What cannot be noted is not answered as if it were: the client comes back.
    pub async fn note(mut self, store: &Store, response: Response) -> Response {
        self.0.outcome = response.status().as_u16().to_string();
        if response.status() == StatusCode::CREATED {
            let place = response.headers().get(header::LOCATION);
            let made = place.and_then(|place| place.to_str().ok()?.rsplit('/').next());
            self.0.object = made.unwrap_or(&self.0.object).to_owned();
        }
        match store.note(self.0).await {
            Ok(()) => response,
            Err(error) => ApiError::from(error).into_response(),
        }
    }
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
