//! Error responses: a status, a code and a sentence (RFC 9457).

use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;
use crate::store::StoreError;

const RETRY_AFTER_S: u32 = 5;
const DAMAGED_BYTES: &str = "the stored bytes are lost or differ from their hash";

/// An error response. The outermost layer writes its body, because it knows the request's id.
#[derive(Clone, Debug)]
pub struct ApiError {
    pub problem: Problem,
    headers: Vec<(HeaderName, HeaderValue)>,
}

pub type ApiResult<T = Response> = Result<T, ApiError>;

impl ApiError {
    pub fn new(code: ErrorCode, detail: impl Into<String>) -> Self {
        Problem::new(code, detail).into()
    }

    pub fn not_found(what: &str) -> Self {
        ApiError::new(ErrorCode::NotFound, format!("there is no such {what}"))
    }

    pub fn invalid_parameter(name: &str, detail: impl Into<String>) -> Self {
        Problem::new(ErrorCode::InvalidParameter, detail).with("parameter", name).into()
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

    /// The same error; one of damaged bytes names what they are of.
    pub fn of_bytes(self, what: impl std::fmt::Display) -> Self {
        self.map_problem(|problem| match problem.code {
            ErrorCode::Integrity => {
                Problem::new(ErrorCode::Integrity, format!("{what}: {DAMAGED_BYTES}"))
            }
            _ => problem,
        })
    }

    /// The same request may succeed later.
    pub fn unavailable() -> Self {
        ApiError::new(ErrorCode::NotReady, "the database or the store of blobs is unreachable")
    }

    pub fn storage_full() -> Self {
        ApiError::new(ErrorCode::StorageFull, "the disk of the service is full")
    }

    /// An internal error, reported in the log only.
    pub fn internal(reason: impl std::fmt::Display) -> Self {
        tracing::error!(%reason, "internal error");
        ApiError::new(ErrorCode::Internal, "the log has the details under the request's id")
    }

    /// An internal error at a stored row, which the log names: one that cannot be read ends the whole page that it is on.
    pub fn unreadable<E: std::fmt::Display>(what: &str, id: &str) -> impl Fn(E) -> ApiError {
        move |error| ApiError::internal(format_args!("{what} {id} cannot be read: {error}"))
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
            return ApiError::storage_full();
        }
        if let StoreError::Busy { most } = error {
            let problem = Problem::new(ErrorCode::Busy, error.to_string());
            return problem.with("limit", most).into();
        }
        if error.is_unavailable() {
            tracing::warn!(%error, "storage is busy");
            return ApiError::unavailable();
        }
        if let StoreError::Erased = error {
            return ApiError::new(ErrorCode::NotFound, error.to_string());
        }
        if let StoreError::Integrity { .. } | StoreError::Missing { .. } = error {
            tracing::error!(%error, "a blob is damaged");
            return ApiError::new(ErrorCode::Integrity, DAMAGED_BYTES);
        }
        if let StoreError::TooManyKeys { keys, most } = error {
            let problem = Problem::new(ErrorCode::TooManyKeys, error.to_string());
            return problem.with("keys", keys).with("limit", most).into();
        }
        ApiError::internal(error)
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.problem.code.status())
            .unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let mut response = status.into_response();
        if status == StatusCode::SERVICE_UNAVAILABLE {
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(RETRY_AFTER_S));
        }
        response.headers_mut().extend(self.headers);
        response.extensions_mut().insert(self.problem);
        response
    }
}

/// Writes the body of an error: `application/problem+json` with the request as `instance`. Errors of the
/// framework become problems too.
pub fn with_problem_body(mut response: Response, request_id: &str) -> Response {
    let status = response.status();
    let told = response.extensions_mut().remove::<Problem>();
    if !status.is_client_error() && !status.is_server_error() {
        return response;
    }
    let problem = told.unwrap_or_else(|| problem_for(status));
    let document = problem.into_document(status.as_u16(), Some(request_id.to_owned()));
    let body = serde_json::to_vec(&document).unwrap_or_default();
    let (mut parts, _) = response.into_parts();
    parts.headers.remove(header::CONTENT_LENGTH);
    parts
        .headers
        .insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
    parts.headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("private, no-store"));
    Response::from_parts(parts, body.into())
}

/// For an error of the framework.
fn problem_for(status: StatusCode) -> Problem {
    match status {
        StatusCode::NOT_FOUND => Problem::new(ErrorCode::NotFound, "there is no such resource"),
        StatusCode::METHOD_NOT_ALLOWED => Problem::new(
            ErrorCode::MethodNotAllowed,
            "the header Allow names the supported methods",
        ),
        StatusCode::PAYLOAD_TOO_LARGE => {
            Problem::new(ErrorCode::PayloadTooLarge, "the body is too large")
        }
        StatusCode::UNSUPPORTED_MEDIA_TYPE => {
            Problem::new(ErrorCode::UnsupportedMediaType, "the Content-Type is not read here")
        }
        status if status.is_client_error() => {
            Problem::new(ErrorCode::MalformedRequest, "the request could not be read")
        }
        _ => Problem::new(ErrorCode::Internal, "the log has the details under the request's id"),
    }
}
