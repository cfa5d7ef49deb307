//! Middleware of every request: its id, its log line, bounds on its head, the key, and problem bodies.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::{MatchedPath, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tracing::Instrument;

use super::access::{Access, Audit, Declared, RouteAccess};
use super::audited::{audited_action_of, carry_out, erased};
use super::body::BodyState;
use super::caller::{self, Caller, Identified};
use super::error::{ApiError, ApiResult, with_problem_body};
use super::headers::guarded;
use super::hosts::check_named_once;
use super::prefer::requested_wait;
use super::rate::RateAllowance;
use super::{Service, body};
use crate::metrics::http;
use crate::schema::ErrorCode;
use crate::schema::key::Scope;
use crate::schema::wire::problem::Problem;
use crate::store::AuditIntent;
use crate::traces::{self, TraceParent};

const REQUEST_ID: &str = "x-request-id";
const TRACE_PARENT: &str = "traceparent";
const LONGEST_URI: usize = 8 << 10;
const LARGEST_HEAD: usize = 16 << 10;

/// The state of the outermost layer.
#[derive(Clone)]
pub struct MiddlewareState {
    pub service: Service,
    pub declared: Arc<Declared>,
}

/// The outermost layer: names the request, logs it, and writes the bodies of errors.
pub async fn surround(
    State(door): State<MiddlewareState>,
    request: Request,
    next: Next,
) -> Response {
    let started = Instant::now();
    let id = request_id(request.headers());
    let method = request.method().clone();
    // The pattern of the route, not the path: ids lead to patients.
    let route = request.extensions().get::<MatchedPath>().cloned();
    let route = route.as_ref().map(MatchedPath::as_str);
    let trace = traces::Request::begin(method.as_str(), route, trace_parent(request.headers()));
    let route = route.unwrap_or("unmatched");
    let counted = http::Request::begin(method.as_str(), route);
    let span = tracing::info_span!("request", request.id = %id, trace.id = trace.trace_id());
    let (head, body) = request.into_parts();
    let (body, unread) = body::held(body);
    let coming = unread.coming();
    let mut request = Request::from_parts(head, body);
    request.extensions_mut().insert(trace.place());
    let answered = async {
        let response = match admit(&door, &mut request).await {
            Ok(Admission::ToAll) => next.run(request).await,
            Ok(Admission::Known(entry)) => {
                entry.pass(&door.service, IncomingRequest { request, coming }, next, &id).await
            }
            Err(error) => error.into_response(),
        };
        // Who still writes when the connection closes hears no answer.
        if !response.status().is_success() {
            unread.drain().await;
        }
        response
    };
    let response = answered.instrument(span.clone()).await;
    let response = named(response, &id);
    counted.answered(response.status().as_u16());
    trace.answered(response.status().as_u16());
    span.in_scope(|| {
        tracing::info!(
            http.method = %method,
            http.route = route,
            http.status = response.status().as_u16(),
            duration_ms = started.elapsed().as_secs_f64() * 1e3,
            "request"
        );
    });
    response
}

/// A response with the id of its request, and its body if it is a problem.
pub fn named(response: Response, id: &str) -> Response {
    let mut response = guarded(with_problem_body(response, id));
    if let Ok(value) = HeaderValue::from_str(id) {
        response.headers_mut().insert(REQUEST_ID, value);
    }
    response
}

/// The id given by the client, if it is safe in a log; else a new one.
fn request_id(headers: &HeaderMap) -> String {
    let given = headers.get(REQUEST_ID).and_then(|value| value.to_str().ok());
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-');
    match given {
        Some(id) if (1..=64).contains(&id.len()) && id.bytes().all(is_plain) => id.to_owned(),
        _ => uuid::Uuid::now_v7().to_string(),
    }
}

/// The client's trace context of a request.
fn trace_parent(headers: &HeaderMap) -> Option<TraceParent> {
    TraceParent::parse(headers.get(TRACE_PARENT)?.to_str().ok()?)
}

/// An admitted request.
enum Admission {
    /// To an open route.
    ToAll,
    Known(Entry),
}

/// Data of a request with a caller.
struct Entry {
    caller: Caller,
    left: Option<RateAllowance>,
    scope: Scope,
    audit: Audit,
}

/// Admits a request with a valid head, whose caller is known and within the rate limit; its caller, and the access of its
/// route, are attached.
async fn admit(door: &MiddlewareState, request: &mut Request) -> ApiResult<Admission> {
    check_head(request)?;
    check_named_once(request)?;
    if let Some(hosts) = &door.service.hosts {
        hosts.check(request)?;
    }
    let route = request.extensions().get::<MatchedPath>().map(MatchedPath::as_str);
    let RouteAccess { access, is_answered } = door.declared.find(route, request.method())?;
    if is_answered {
        request.extensions_mut().insert(access);
    }
    let Access::Key { scope, audit } = access else { return Ok(Admission::ToAll) };
    let identified = caller::identify(&door.service, request);
    let Identified { caller, foreseen } = identified.await?;
    if let Some(foreseen) = foreseen {
        request.extensions_mut().insert(foreseen);
    }
    let client = caller.client(request.extensions());
    request.extensions_mut().insert(client.clone());
    request.extensions_mut().insert(caller.clone());
    let left = door.service.rates.take(client)?;
    Ok(Admission::Known(Entry { caller, left, scope, audit }))
}

/// A request and its body.
struct IncomingRequest {
    request: Request,
    coming: BodyState,
}

impl Entry {
    /// Forwards a request that its key allows, also when it is answered. Changes and forbidden requests are audited.
    async fn pass(
        self,
        service: &Service,
        entering: IncomingRequest,
        next: Next,
        id: &str,
    ) -> Response {
        let IncomingRequest { mut request, coming } = entering;
        let waits = requested_wait(request.headers(), u32::MAX).is_some();
        let allowed = self.caller.require(self.scope);
        let is_noted = allowed.is_err() || self.audit == Audit::Noted;
        let audited = is_noted.then(|| audited_action_of(&self.caller, &request, id)).flatten();
        let erases = request.method() == Method::DELETE;
        let intent = audited.map(|audited| service.store.audit_intent(audited));
        let mut response = match (allowed, intent) {
            (Err(error), Some(intent)) => refused(error, &intent).await,
            (Err(error), None) => error.into_response(),
            (Ok(()), Some(intent)) => {
                request.extensions_mut().insert(intent.clone());
                let run = next.run(request);
                match erases {
                    true => carry_out(intent, coming, erased(service.store.clone(), run)).await,
                    false => carry_out(intent, coming, run).await,
                }
            }
            (Ok(()), None) => next.run(request).await,
        };
        if let Err(error) = self.require_key(service, waits, response.status()).await {
            response = error.into_response();
        }
        if let Some(left) = self.left {
            left.tell(&mut response);
        }
        response
    }

    /// Refuses the answer to a request whose key was revoked or has expired while it waited or was worked on. A change of
    /// keys is answered though it ends its own: a rotation shows the new key once.
    async fn require_key(
        &self,
        service: &Service,
        waits: bool,
        status: StatusCode,
    ) -> ApiResult<()> {
        let changes_keys = self.scope == Scope::Admin && self.audit == Audit::Noted;
        if changes_keys || status.is_server_error() {
            return Ok(());
        }
        match waits {
            true => self.caller.lookup.require(&service.store).await,
            false => self.caller.lookup.require_if_old(&service.store).await,
        }
    }
}

/// Response to a forbidden request, audited without waiting for writers.
async fn refused(error: ApiError, intent: &AuditIntent) -> Response {
    let response = error.into_response();
    match intent.end(intent.object(), response.status().as_str(), true).await {
        Ok(()) => response,
        Err(error) => ApiError::from(error).into_response(),
    }
}

fn check_head(request: &Request) -> ApiResult<()> {
    let uri_length = request.uri().path_and_query().map_or(0, |uri| uri.as_str().len());
    if uri_length > LONGEST_URI {
        let detail = format!("the address has {uri_length} bytes, {LONGEST_URI} are allowed");
        return Err(Problem::new(ErrorCode::UriTooLong, detail).with("limit", LONGEST_URI).into());
    }
    check_transfer_coding(request.headers())?;
    let head: usize =
        request.headers().iter().map(|(name, value)| name.as_str().len() + value.len()).sum();
    if head > LARGEST_HEAD {
        let detail = format!("the headers have {head} bytes, {LARGEST_HEAD} are allowed");
        return Err(Problem::new(ErrorCode::HeaderTooLarge, detail)
            .with("limit", LARGEST_HEAD)
            .into());
    }
    Ok(())
}

/// Refuses a body whose end is uncertain: one coded otherwise than in chunks, or more than once.
pub fn check_transfer_coding(headers: &HeaderMap) -> ApiResult<()> {
    let codings = || headers.get_all(header::TRANSFER_ENCODING).iter();
    let is_plain = |coding: &HeaderValue| coding.as_bytes().eq_ignore_ascii_case(b"chunked");
    if codings().count() <= 1 && codings().all(is_plain) {
        return Ok(());
    }
    let detail = "a body has no transfer coding but `chunked`, once";
    let error = ApiError::new(ErrorCode::MalformedRequest, detail);
    Err(error.header(header::CONNECTION, HeaderValue::from_static("close")))
}

/// For routes with JSON responses only.
pub async fn accepts_json(request: Request, next: Next) -> Response {
    match check_accept(request.headers(), "application/json") {
        Ok(()) => next.run(request).await,
        Err(error) => error.into_response(),
    }
}

/// Whether the client accepts a media type (RFC 9110, section 12.5.1).
pub fn check_accept(headers: &HeaderMap, offered: &str) -> Result<(), ApiError> {
    if preference(headers, offered).1 > 0.0 {
        return Ok(());
    }
    let detail = format!("the response is {offered}, which the header Accept does not allow");
    Err(ApiError::new(ErrorCode::NotAcceptable, detail))
}

/// The media type that a client prefers; of equals the one named most precisely, then the first.
pub fn preferred(headers: &HeaderMap, offered: &[&str]) -> Result<usize, ApiError> {
    let mut best: Option<(usize, f32, u8)> = None;
    for (number, offer) in offered.iter().enumerate() {
        let (precision, quality) = preference(headers, offer);
        let better = |(_, most, precisest)| (quality, precision) > (most, precisest);
        if quality > 0.0 && best.is_none_or(better) {
            best = Some((number, quality, precision));
        }
    }
    let detail = || format!("the header Accept allows none of {}", offered.join(", "));
    best.map(|(number, ..)| number).ok_or_else(|| ApiError::new(ErrorCode::NotAcceptable, detail()))
}

/// The precision with which a client names a media type, and its quality, from 0 to 1.
fn preference(headers: &HeaderMap, offered: &str) -> (u8, f32) {
    let values = headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok());
    let mut ranges = values
        .flat_map(|value| value.split(','))
        .filter(|range| !range.trim().is_empty())
        .peekable();
    if ranges.peek().is_none() {
        return (1, 1.0);
    }
    let likings = ranges.map(|range| {
        let mut parts = range.split(';').map(str::trim);
        let name = parts.next().unwrap_or_default().to_ascii_lowercase();
        let quality = parts.find_map(|parameter| parameter.strip_prefix("q=")?.parse().ok());
        (precision_of(&name, offered), quality.unwrap_or(1.0))
    });
    likings.fold((0, 0.0), |best, preference| if preference.0 > best.0 { preference } else { best })
}

/// The precision with which a range names the offered type; 0 if it does not.
fn precision_of(range: &str, offered: &str) -> u8 {
    if range == offered {
        return 3;
    }
    if range == "*/*" {
        return 1;
    }
    match (range.strip_suffix("/*"), offered.split_once('/')) {
        (Some(group), Some((kind, _))) if group == kind => 2,
        _ => 0,
    }
}

/// A panic in a handler fails only that request.
pub fn after_panic(panic: Box<dyn std::any::Any + Send + 'static>) -> Response {
    let reason = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("a panic without words");
    ApiError::internal(reason).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn accepts(accept: &str, offered: &str) -> bool {
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT, accept.parse().unwrap());
        check_accept(&headers, offered).is_ok()
    }

    #[test]
    fn the_most_precise_range_decides_what_is_accepted() {
        assert!(accepts("*/*", "application/json"));
        assert!(accepts("text/html, application/json;q=0.2", "application/json"));
        assert!(accepts("application/*", "application/json"));
        assert!(!accepts("image/png", "application/json"));
        assert!(!accepts("*/*, application/json;q=0", "application/json"));
        assert!(!accepts("application/json; q=0.0", "application/json"));
    }

    #[test]
    fn the_best_liked_of_several_kinds_is_chosen_and_the_first_of_equals() {
        let offered = ["application/json", "application/octet-stream", "model/gltf-binary"];
        let chosen = |accept: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::ACCEPT, accept.parse().unwrap());
            preferred(&headers, &offered).ok()
        };
        assert_eq!(preferred(&HeaderMap::new(), &offered).unwrap(), 0);
        assert_eq!(chosen("*/*"), Some(0));
        assert_eq!(chosen("application/octet-stream, */*"), Some(1));
        assert_eq!(chosen("application/*;q=0.5, model/gltf-binary"), Some(2));
        assert_eq!(chosen("*/*, application/json;q=0"), Some(1));
        assert_eq!(chosen("application/octet-stream;q=0.4, model/gltf-binary;q=0.6"), Some(2));
        assert_eq!(chosen("text/html"), None);
    }

    #[test]
    fn an_id_that_could_forge_a_log_line_is_replaced() {
        let id_for = |given: &[u8]| {
            let mut headers = HeaderMap::new();
            headers.insert(REQUEST_ID, HeaderValue::from_bytes(given).unwrap());
            request_id(&headers)
        };
        assert_eq!(id_for(b"abc-1_2.X"), "abc-1_2.X");
        for given in [&b"a b"[..], b"a\"b", b"", b"\xff", &[b'a'; 65]] {
            assert_ne!(id_for(given).as_bytes(), given);
        }
    }
}
