//! Every error to a status, a code and a sentence (RFC 9457). The only place that knows which status
//! belongs to which code.

use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

use crate::schema::wire::problem::{Problem, ProblemKind};
use crate::store::StoreError;

/// What stands before the code in the `type` of a problem.
const PROBLEM_BASE: &str = "https://facies.invalid/problems/";
const RETRY_AFTER_S: u32 = 5;

/// Status and title of a code.
fn kind_of(code: &str) -> (StatusCode, &'static str) {
    match code {
        "malformed-json" => (StatusCode::BAD_REQUEST, "The body is not valid JSON"),
        "malformed-multipart" => (StatusCode::BAD_REQUEST, "The body is not valid multipart"),
        "malformed-request" => (StatusCode::BAD_REQUEST, "The request could not be read"),
        "digest-mismatch" => (StatusCode::BAD_REQUEST, "The body differs from its Content-Digest"),
        "invalid-parameter" => (StatusCode::BAD_REQUEST, "A parameter is not valid"),
        "unauthorized" => (StatusCode::UNAUTHORIZED, "A key is needed"),
        "forbidden-scope" => (StatusCode::FORBIDDEN, "The key does not allow this"),
        "not-found" => (StatusCode::NOT_FOUND, "There is nothing here"),
        "no-such-job" => (StatusCode::NOT_FOUND, "There is no such job"),
        "no-such-output" => (StatusCode::NOT_FOUND, "The job has no such file"),
        "response-not-built" => (StatusCode::NOT_FOUND, "The case has no response"),
        "result-not-ready" => (StatusCode::NOT_FOUND, "The job has not ended"),
        "method-not-allowed" => {
            (StatusCode::METHOD_NOT_ALLOWED, "The resource does not answer to this method")
        }
        "not-acceptable" => (StatusCode::NOT_ACCEPTABLE, "The resource has no such representation"),
        "request-timeout" => (StatusCode::REQUEST_TIMEOUT, "The body came too slowly"),
        "conflict-in-use" => (StatusCode::CONFLICT, "Something refers to it"),
        "response-stale" => (StatusCode::CONFLICT, "The response is older than its case"),
        "conflict" => (StatusCode::CONFLICT, "It changed meanwhile"),
        "precondition-failed" => (StatusCode::PRECONDITION_FAILED, "It has another version"),
        "precondition-required" => (
            StatusCode::PRECONDITION_REQUIRED,
            "The version that is meant has to be named in If-Match",
        ),
        "gone" => (StatusCode::GONE, "It was erased"),
        "rate-limited" | "too-many-streams" => {
            (StatusCode::TOO_MANY_REQUESTS, "The client asks for more than one may have")
        }
        "payload-too-large" => (StatusCode::PAYLOAD_TOO_LARGE, "The body is too large"),
        "uri-too-long" => (StatusCode::URI_TOO_LONG, "The address is too long"),
        "unsupported-media-type" => {
            (StatusCode::UNSUPPORTED_MEDIA_TYPE, "The body is of a kind that is not read here")
        }
        "range-not-satisfiable" => {
            (StatusCode::RANGE_NOT_SATISFIABLE, "The range is outside the file")
        }
        "header-too-large" => {
            (StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE, "The headers are too large")
        }
        "internal" => (StatusCode::INTERNAL_SERVER_ERROR, "Something broke here"),
        "integrity" => (StatusCode::INTERNAL_SERVER_ERROR, "A stored file is damaged"),
        "not-ready" | "queue-full" | "shutting-down" => {
            (StatusCode::SERVICE_UNAVAILABLE, "Come back later")
        }
        "storage-full" => (StatusCode::INSUFFICIENT_STORAGE, "The disk is full"),
        // Everything else is something wrong with what was sent, and the code says what.
        _ => (StatusCode::UNPROCESSABLE_ENTITY, "The request was understood and is refused"),
    }
}

/// A refusal on its way out. The outermost layer writes its body, because it knows the request's id.
#[derive(Clone, Debug)]
pub struct ApiError {
    pub problem: Problem,
    headers: Vec<(HeaderName, HeaderValue)>,
}

pub type ApiResult<T = Response> = Result<T, ApiError>;

impl ApiError {
    pub fn new(code: &'static str, detail: impl Into<String>) -> Self {
        Problem::new(code, detail).into()
    }

    pub fn not_found(what: &str) -> Self {
        ApiError::new("not-found", format!("there is no such {what}"))
    }

    pub fn invalid_parameter(name: &str, detail: impl Into<String>) -> Self {
        Problem::new("invalid-parameter", detail).with("parameter", name).into()
    }

    pub fn header(mut self, name: HeaderName, value: HeaderValue) -> Self {
        self.headers.push((name, value));
        self
    }

    /// The same error with another problem.
    pub fn map_problem(mut self, change: impl FnOnce(Problem) -> Problem) -> Self {
        self.problem = change(self.problem);
        self
    }

    /// The same request may succeed later.
    pub fn out_of_reach() -> Self {
        ApiError::new("not-ready", "the database or the store of blobs is out of reach")
    }

    /// An error of ours, told in the log only.
    pub fn internal(reason: impl std::fmt::Display) -> Self {
        tracing::error!(%reason, "internal error");
        ApiError::new("internal", "the log has the details under the request's id")
    }
}

impl From<Problem> for ApiError {
    fn from(problem: Problem) -> Self {
        ApiError { problem, headers: Vec::new() }
    }
}

impl From<StoreError> for ApiError {
    fn from(error: StoreError) -> Self {
        if error.is_full() {
            tracing::error!(%error, "storage is full");
            return ApiError::new("storage-full", "the disk of the service is full");
        }
        if error.is_unavailable() {
            tracing::warn!(%error, "storage is busy");
            return ApiError::out_of_reach();
        }
        if let StoreError::Integrity { .. } | StoreError::Missing { .. } = error {
            tracing::error!(%error, "a blob is damaged");
            return ApiError::new(
                "integrity",
                "the stored bytes are lost or differ from their hash",
            );
        }
        ApiError::internal(error)
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let (status, _) = kind_of(self.problem.code);
        let mut response = status.into_response();
        if status == StatusCode::SERVICE_UNAVAILABLE {
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(RETRY_AFTER_S));
        }
        response.headers_mut().extend(self.headers);
        response.extensions_mut().insert(self.problem);
        response
    }
}

/// Gives an error its body: `application/problem+json` with the request as `instance`. Errors that the
/// framework made itself become problems too.
pub fn with_problem_body(mut response: Response, request_id: &str) -> Response {
    let status = response.status();
    let told = response.extensions_mut().remove::<Problem>();
    if !status.is_client_error() && !status.is_server_error() {
        return response;
    }
    let problem = told.unwrap_or_else(|| problem_for(status));
    let (_, title) = kind_of(problem.code);
    let kind = ProblemKind {
        base: PROBLEM_BASE.to_owned(),
        title: title.to_owned(),
        status: status.as_u16(),
    };
    let document = problem.into_document(kind, Some(request_id.to_owned()));
    let body = serde_json::to_vec(&document).unwrap_or_default();
    let (mut parts, _) = response.into_parts();
    parts.headers.remove(header::CONTENT_LENGTH);
    parts
        .headers
        .insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
    parts.headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("private, no-store"));
    Response::from_parts(parts, body.into())
}

/// For an error that came without a problem of ours.
fn problem_for(status: StatusCode) -> Problem {
    match status {
        StatusCode::NOT_FOUND => Problem::new("not-found", "there is no such resource"),
        StatusCode::METHOD_NOT_ALLOWED => Problem::new(
            "method-not-allowed",
            "the header Allow names the methods that are answered",
        ),
        StatusCode::PAYLOAD_TOO_LARGE => Problem::new("payload-too-large", "the body is too large"),
        StatusCode::UNSUPPORTED_MEDIA_TYPE => {
            Problem::new("unsupported-media-type", "the Content-Type is not read here")
        }
        status if status.is_client_error() => {
            Problem::new("malformed-request", "the request could not be read")
        }
        _ => Problem::new("internal", "the log has the details under the request's id"),
    }
}
