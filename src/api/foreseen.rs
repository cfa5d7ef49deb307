//! Prefetched responses of a case: looked up together with the idempotency key of the request that applies a plan,
//! because two queries to a shared database would take twice as long.

use std::time::{Duration, Instant};

use axum::extract::{MatchedPath, Request};

use super::parameters::id;
use crate::store::CaseResponses;

const APPLY: &str = "/v1/cases/{id}/response/apply";
/// A body may take longer to arrive than a lookup stays valid.
const FRESH: Duration = Duration::from_secs(1);

/// The lookup at the arrival of a request.
#[derive(Clone)]
pub struct ResponseLookup {
    at: Instant,
    responses: Option<CaseResponses>,
}

impl ResponseLookup {
    /// A lookup now; `None` if there is no such case.
    pub fn now(responses: Option<CaseResponses>) -> ResponseLookup {
        ResponseLookup { at: Instant::now(), responses }
    }

    /// The responses, unless the lookup is too old; the inner `None` if there was no such case.
    pub fn fresh(self) -> Option<Option<CaseResponses>> {
        (self.at.elapsed() < FRESH).then_some(self.responses)
    }
}

/// The case of a request that applies a plan to its response, if any.
pub fn case_of(request: &Request) -> Option<String> {
    let route = request.extensions().get::<MatchedPath>()?;
    let case = request.uri().path().split('/').nth(3)?;
    (route.as_str() == APPLY).then(|| id(case))?
}
