//! Cross-origin requests (CORS): none are allowed except from origins in the settings.

use std::time::Duration;

use axum::http::{HeaderName, HeaderValue, Method, header};
use tower_http::cors::CorsLayer;

/// How long a browser may cache a preflight response.
const REMEMBERED: Duration = Duration::from_secs(3600);

/// The permissions of pages of these origins; `None` if there are none.
pub fn allowed(origins: &[String]) -> Option<CorsLayer> {
    let origins: Vec<HeaderValue> =
        origins.iter().filter_map(|origin| HeaderValue::from_str(origin).ok()).collect();
    if origins.is_empty() {
        return None;
    }
    let sent = [
        header::ACCEPT,
        header::AUTHORIZATION,
        header::CONTENT_TYPE,
        header::IF_MATCH,
        header::IF_NONE_MATCH,
        header::IF_RANGE,
        header::RANGE,
        HeaderName::from_static("content-digest"),
        HeaderName::from_static("idempotency-key"),
        HeaderName::from_static("last-event-id"),
        HeaderName::from_static("prefer"),
        HeaderName::from_static("traceparent"),
        HeaderName::from_static("x-request-id"),
    ];
    let read = [
        header::CONTENT_DISPOSITION,
        header::CONTENT_LOCATION,
        header::CONTENT_RANGE,
        header::ETAG,
        header::LOCATION,
        header::RETRY_AFTER,
        HeaderName::from_static("facies-job"),
        HeaderName::from_static("facies-largest-rotation-deg"),
        HeaderName::from_static("facies-max-mm"),
        HeaderName::from_static("facies-second-order-mm"),
        HeaderName::from_static("facies-nonlinearity-estimate-mm"),
        HeaderName::from_static("facies-not-measured"),
        HeaderName::from_static("facies-order"),
        HeaderName::from_static("facies-outcome"),
        HeaderName::from_static("facies-warning"),
        HeaderName::from_static("facies-within-linear-range"),
        HeaderName::from_static("preference-applied"),
        HeaderName::from_static("ratelimit"),
        HeaderName::from_static("ratelimit-policy"),
        HeaderName::from_static("x-request-id"),
    ];
    Some(
        CorsLayer::new()
            .allow_origin(origins)
            .allow_methods([Method::GET, Method::POST, Method::PUT, Method::PATCH, Method::DELETE])
            .allow_headers(sent)
            .expose_headers(read)
            .max_age(REMEMBERED),
    )
}
