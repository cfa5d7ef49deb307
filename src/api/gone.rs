//! Status 410 instead of 404 for erased resources, for every handler.

use axum::extract::rejection::RawPathParamsRejection;
use axum::extract::{RawPathParams, Request, State};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::caller::Caller;
use super::error::ApiError;
use super::parameters::id;
use super::{Service, time};
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

/// Looks for the tombstone of the resource of an address that a handler did not find.
pub async fn tell(
    State(service): State<Service>,
    parameters: Result<RawPathParams, RawPathParamsRejection>,
    request: Request,
    next: Next,
) -> Response {
    let caller = request.extensions().get::<Caller>().cloned();
    let response = next.run(request).await;
    let is_missing =
        |problem: &Problem| matches!(problem.code, ErrorCode::NotFound | ErrorCode::NoSuchJob);
    if !response.extensions().get::<Problem>().is_some_and(is_missing) {
        return response;
    }
    let Some(caller) = caller else { return response };
    let store = service.store.of_tenant(&caller.tenant);
    let named = parameters.iter().flatten().filter_map(|(_, text)| id(text));
    for id in named.collect::<Vec<_>>() {
        match store.erased(&id).await {
            Ok(Some(erased)) => return gone(&id, erased).into_response(),
            Ok(None) => {}
            Err(error) => return ApiError::from(error).into_response(),
        }
    }
    response
}

/// The refusal for an erased resource.
pub fn gone(id: &str, erased: i64) -> ApiError {
    let erased_at = time::rfc3339(erased);
    let problem = Problem::new(ErrorCode::Gone, format!("{id} was erased at {erased_at}"));
    problem.with("erased_at", erased_at).into()
}
