//! Bodies of requests: read within bounds of size and of time.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::body::{Body, BodyDataStream};
use axum::extract::{FromRequest, Multipart, Request};
use axum::http::{HeaderMap, HeaderValue, header};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bytes::{Bytes, BytesMut};
use futures::{Stream, StreamExt};
use sha2::{Digest, Sha256};

use super::Service;
use super::error::{ApiError, ApiResult};
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

/// Bytes a second below which a body is too slow, once it has taken longer than it may stand still.
const LEAST_RATE: f64 = 16.0 * 1024.0;

/// How much may come and how slowly.
#[derive(Clone, Copy)]
struct Bounds {
    bytes: usize,
    idle: Duration,
}

/// What a client may go on sending after its request was refused, and for how long: one that still
/// writes when the connection closes hears no answer.
const DRAINED_BYTES: usize = 8 << 20;
const DRAINED_FOR: Duration = Duration::from_secs(1);

/// The part of a body that its handler has not read.
pub struct Unread(Arc<tokio::sync::Mutex<BodyDataStream>>);

/// A body, and a hold on what will be left of it.
pub fn held(body: Body) -> (Body, Unread) {
    let frames = Arc::new(tokio::sync::Mutex::new(body.into_data_stream()));
    let unread = Unread(frames.clone());
    let frames = futures::stream::unfold(frames, |frames| async {
        let frame = frames.lock().await.next().await;
        frame.map(|frame| (frame, frames))
    });
    (Body::from_stream(frames), unread)
}

impl Unread {
    /// Reads and forgets what is left, within bounds.
    pub async fn drain(self) {
        let mut frames = self.0.lock().await;
        let mut drained = 0;
        let drain = async {
            while let Some(Ok(frame)) = frames.next().await {
                drained += frame.len();
                if drained > DRAINED_BYTES {
                    break;
                }
            }
        };
        // When the time is up the connection closes with what is still on its way.
        let _ = tokio::time::timeout(DRAINED_FOR, drain).await;
    }
}

/// What a request says its body is, in lower case and without parameters.
pub fn content_type(headers: &HeaderMap) -> String {
    let value = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok());
    let name = value.unwrap_or_default().split(';').next();
    name.unwrap_or_default().trim().to_ascii_lowercase()
}

/// Refuses a body that is not of one of these kinds.
pub fn unsupported(found: &str, accepted: &'static str) -> ApiError {
    let found = if found.is_empty() { "missing" } else { found };
    let detail = format!("the Content-Type is {found}, and has to be one of {accepted}");
    ApiError::new(ErrorCode::UnsupportedMediaType, detail)
        .header(header::HeaderName::from_static("accept-post"), HeaderValue::from_static(accepted))
}

/// The whole JSON body.
pub async fn json(service: &Service, request: Request) -> ApiResult<Bytes> {
    const JSON: &str = "application/json";
    let kind = content_type(request.headers());
    if kind != JSON {
        return Err(unsupported(&kind, JSON));
    }
    let most = usize::try_from(service.limits.json_bytes).unwrap_or(usize::MAX);
    whole(service, request, most).await
}

/// The whole body of an upload, equal to its Content-Digest if it has one.
pub async fn upload(service: &Service, request: Request) -> ApiResult<Bytes> {
    let digest = content_digest(request.headers())?;
    let bytes = whole(service, request, service.config.upload_bytes).await?;
    let Some(digest) = digest else {
        return Ok(bytes);
    };
    let (bytes, found) = tokio::task::spawn_blocking(move || {
        let found = Sha256::digest(&bytes);
        (bytes, found)
    })
    .await
    .map_err(ApiError::internal)?;
    if found.as_slice() == digest {
        return Ok(bytes);
    }
    let found = format!("sha-256=:{}:", STANDARD.encode(found));
    let detail = format!("{} bytes came, and their digest is {found}", bytes.len());
    Err(Problem::new(ErrorCode::DigestMismatch, detail).with("digest", found).into())
}

async fn whole(service: &Service, request: Request, most: usize) -> ApiResult<Bytes> {
    check_encoding(request.headers())?;
    let bounds = Bounds { bytes: most, idle: service.config.body_idle };
    check_length(request.headers(), bounds.bytes)?;
    let mut frames = std::pin::pin!(bounded(request.into_body(), bounds));
    let mut bytes = BytesMut::new();
    while let Some(frame) = frames.next().await {
        bytes.extend_from_slice(&frame?);
    }
    Ok(bytes.freeze())
}

/// The parts of a multipart body by their names, all of them within the bounds of one upload.
pub async fn parts(service: &Service, request: Request) -> ApiResult<Vec<(String, Bytes)>> {
    check_encoding(request.headers())?;
    let bounds = Bounds { bytes: service.config.upload_bytes, idle: service.config.body_idle };
    check_length(request.headers(), bounds.bytes)?;
    // The multipart reader wraps what it meets, so the reason for the end of the stream is kept beside it.
    let reason: Arc<Mutex<Option<ApiError>>> = Arc::default();
    let kept = reason.clone();
    let (head, body) = request.into_parts();
    let frames = bounded(body, bounds).map(move |frame| {
        frame.map_err(|error| {
            *kept.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            std::io::Error::other("the body ended early")
        })
    });
    let request = Request::from_parts(head, Body::from_stream(frames));
    let found = read_parts(request, service.limits.multipart_parts as usize).await;
    match reason.lock().unwrap_or_else(PoisonError::into_inner).take() {
        Some(error) => Err(error),
        None => found,
    }
}

async fn read_parts(request: Request, most: usize) -> ApiResult<Vec<(String, Bytes)>> {
    let malformed = |detail: String| ApiError::new(ErrorCode::MalformedMultipart, detail);
    let mut multipart = Multipart::from_request(request, &())
        .await
        .map_err(|error| malformed(error.body_text()))?;
    let mut parts: Vec<(String, Bytes)> = Vec::new();
    let mut unread = 0;
    while let Some(part) =
        multipart.next_field().await.map_err(|error| malformed(error.body_text()))?
    {
        if parts.len() == most {
            // A client that still writes hears no answer, so the rest is passed over.
            unread += 1;
            continue;
        }
        let Some(name) = part.name().map(str::to_owned) else {
            return Err(malformed(format!("part {} has no name", parts.len() + 1)));
        };
        if parts.iter().any(|(other, _)| *other == name) {
            return Err(malformed(format!("part {} has the name of another", parts.len() + 1)));
        }
        let bytes = part.bytes().await.map_err(|error| malformed(error.body_text()))?;
        parts.push((name, bytes));
    }
    if unread == 0 {
        return Ok(parts);
    }
    let detail = format!("the body has {} parts, at most {most} are read", most + unread);
    Err(Problem::new(ErrorCode::PayloadTooLarge, detail).with("limit", most).into())
}

fn check_encoding(headers: &HeaderMap) -> ApiResult<()> {
    let encoding =
        headers.get(header::CONTENT_ENCODING).map(|value| value.to_str().unwrap_or("unreadable"));
    match encoding {
        None | Some("identity") => Ok(()),
        Some(encoding) => {
            let detail = format!(
                "the Content-Encoding is {encoding}: send the body as it is, or use the compression of its own format"
            );
            let error = ApiError::new(ErrorCode::UnsupportedMediaType, detail);
            Err(error.header(header::ACCEPT_ENCODING, HeaderValue::from_static("identity")))
        }
    }
}

fn check_length(headers: &HeaderMap, most: usize) -> ApiResult<()> {
    let declared = headers
        .get(header::CONTENT_LENGTH)
        .and_then(|value| value.to_str().ok())
        .and_then(|value| value.parse::<u64>().ok());
    match declared {
        Some(declared) if declared > most as u64 => Err(too_large(most)),
        _ => Ok(()),
    }
}

fn too_large(most: usize) -> ApiError {
    let detail = format!("the body has more than {most} bytes");
    Problem::new(ErrorCode::PayloadTooLarge, detail).with("limit", most).into()
}

/// The frames of a body until it is too large or too slow.
fn bounded(body: Body, bounds: Bounds) -> impl Stream<Item = ApiResult<Bytes>> {
    let started = Instant::now();
    let state = (body.into_data_stream(), 0usize, false);
    futures::stream::unfold(state, move |(mut frames, before, ended)| async move {
        if ended {
            return None;
        }
        let frame = match tokio::time::timeout(bounds.idle, frames.next()).await {
            Err(_) => Err(too_slow(before)),
            Ok(None) => return None,
            Ok(Some(Err(_))) => Err(ApiError::new(
                ErrorCode::MalformedRequest,
                format!("the body broke off after {before} bytes"),
            )),
            Ok(Some(Ok(frame))) => Ok(frame),
        };
        let count = before + frame.as_ref().map_or(0, Bytes::len);
        let frame = frame.and_then(|frame| {
            let elapsed = started.elapsed();
            if count > bounds.bytes {
                Err(too_large(bounds.bytes))
            } else if elapsed > bounds.idle && (count as f64) < LEAST_RATE * elapsed.as_secs_f64() {
                Err(too_slow(count))
            } else {
                Ok(frame)
            }
        });
        let ended = frame.is_err();
        Some((frame, (frames, count, ended)))
    })
}

fn too_slow(count: usize) -> ApiError {
    ApiError::new(
        ErrorCode::RequestTimeout,
        format!("the body came too slowly: {count} bytes so far"),
    )
    .header(header::CONNECTION, HeaderValue::from_static("close"))
}

/// The SHA-256 of a Content-Digest (RFC 9530); other algorithms say nothing here.
fn content_digest(headers: &HeaderMap) -> ApiResult<Option<Vec<u8>>> {
    let Some(value) = headers.get("content-digest") else {
        return Ok(None);
    };
    let wrong = || {
        ApiError::invalid_parameter(
            "Content-Digest",
            "the header Content-Digest has the form sha-256=:BASE64:",
        )
    };
    let value = value.to_str().map_err(|_| wrong())?;
    let entry = value.split(',').find_map(|entry| entry.trim().strip_prefix("sha-256="));
    let Some(entry) = entry else { return Ok(None) };
    let inner =
        entry.strip_prefix(':').and_then(|entry| entry.split(':').next()).ok_or_else(wrong)?;
    let digest = STANDARD.decode(inner).map_err(|_| wrong())?;
    if digest.len() == 32 { Ok(Some(digest)) } else { Err(wrong()) }
}
