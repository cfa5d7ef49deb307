//! Request bodies, read within bounds of size and of time.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::BoxError;
use axum::body::{Body, BodyDataStream};
use axum::extract::{FromRequest, Multipart, Request};
use axum::http::{HeaderMap, HeaderValue, header};
use bytes::Bytes;
use futures::{Stream, StreamExt};

use super::Service;
use super::budget::ByteReservation;
use super::content_digest::ContentDigest;
use super::error::{ApiError, ApiResult};
use super::pace::Pace;
use super::spool::{IN_MEMORY, Spool, SpooledBody};
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

/// Limits of size and pace of a body, and its digest where one is stated.
struct Bounds {
    bytes: usize,
    idle: Duration,
    digest: Option<ContentDigest>,
}

/// The amount and the time that a client may still send after its request was refused: one that still
/// writes when the connection closes gets no response.
const DRAINED_BYTES: usize = 8 << 20;
const DRAINED_FOR: Duration = Duration::from_secs(1);

/// The part of a body not read by its handler.
pub struct Unread {
    frames: Arc<tokio::sync::Mutex<BodyDataStream>>,
    coming: BodyState,
}

/// Whether a body is still arriving, or broke off.
#[derive(Clone, Default)]
pub struct BodyState(Arc<AtomicBool>);

impl BodyState {
    /// Whether the connection ended before the body.
    pub fn is_broken(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A body, and a handle to its unread part.
pub fn held(body: Body) -> (Body, Unread) {
    let frames = Arc::new(tokio::sync::Mutex::new(body.into_data_stream()));
    let unread = Unread { frames: frames.clone(), coming: BodyState::default() };
    let coming = unread.coming.clone();
    let frames = futures::stream::unfold((frames, coming), |(frames, coming)| async {
        let frame = frames.lock().await.next().await;
        if let Some(Err(_)) = &frame {
            coming.0.store(true, Ordering::Relaxed);
        }
        frame.map(|frame| (frame, (frames, coming)))
    });
    (Body::from_stream(frames), unread)
}

impl Unread {
    pub fn coming(&self) -> BodyState {
        self.coming.clone()
    }

    /// Reads and discards what is left of a body within its own bounds.
    async fn finish(self) {
        let mut frames = self.frames.lock().await;
        while let Some(Ok(_)) = frames.next().await {}
    }

    /// Reads and discards the remainder, within bounds.
    pub async fn drain(self) {
        let mut frames = self.frames.lock().await;
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

/// The media type of a body, in lower case and without parameters.
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
    require_json(request.headers())?;
    let most = usize::try_from(service.limits.json_bytes).unwrap_or(usize::MAX);
    whole(service, request, most).await?.into_bytes().await
}

/// Refuses a body without the media type of JSON.
pub fn require_json(headers: &HeaderMap) -> ApiResult<()> {
    const JSON: &str = "application/json";
    let kind = content_type(headers);
    if kind == JSON { Ok(()) } else { Err(unsupported(&kind, JSON)) }
}

/// The document in a part of a form, with the size limit of a body.
pub async fn document(service: &Service, part: SpooledBody) -> ApiResult<Bytes> {
    match usize::try_from(service.limits.json_bytes) {
        Ok(most) if part.bytes > most as u64 => Err(too_large(most)),
        _ => part.into_bytes().await,
    }
}

/// The whole body of an upload.
pub async fn upload(service: &Service, request: Request) -> ApiResult<SpooledBody> {
    whole(service, request, service.config.upload_bytes).await
}

async fn whole(service: &Service, request: Request, most: usize) -> ApiResult<SpooledBody> {
    let held = begun(service, request.headers(), most)?;
    let digest = ContentDigest::of(request.headers())?;
    let bounds = Bounds { bytes: most, idle: service.config.body_idle, digest };
    let mut spool = Spool::new(service.ground(), held.clone());
    let mut frames = std::pin::pin!(bounded(request.into_body(), bounds, held));
    while let Some(frame) = frames.next().await {
        spool.push(&frame?).await?;
    }
    service.require_key().await?;
    spool.finish().await
}

/// Checks the headers of a body. Announced bytes count only as they arrive, so that a client which announces
/// much and sends nothing blocks nobody.
fn begun(service: &Service, headers: &HeaderMap, most: usize) -> ApiResult<Arc<ByteReservation>> {
    check_encoding(headers)?;
    let announced = announced(headers).unwrap_or(0);
    if announced > most as u64 {
        return Err(too_large(most));
    }
    let held = Arc::new(service.hold());
    held.check_available(announced)?;
    if announced > IN_MEMORY as u64 {
        service.ground().require(announced)?;
    }
    Ok(held)
}

/// The parts of a multipart body by their names, all of them within the bounds of one upload.
pub async fn parts(service: &Service, request: Request) -> ApiResult<Vec<(String, SpooledBody)>> {
    let most = service.config.upload_bytes;
    let held = begun(service, request.headers(), most)?;
    let digest = ContentDigest::of(request.headers())?;
    let is_digested = digest.is_some();
    let bounds = Bounds { bytes: most, idle: service.config.body_idle, digest };
    // The multipart reader wraps what it meets, so the reason for the end of the stream is kept beside it.
    let reason: Arc<Mutex<Option<ApiError>>> = Arc::default();
    let kept = reason.clone();
    let (head, body) = request.into_parts();
    let frames = bounded(body, bounds, held.clone()).map(move |frame| {
        frame.map_err(|error| {
            *kept.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            std::io::Error::other("the body ended early")
        })
    });
    let (body, unread) = self::held(Body::from_stream(frames.fuse()));
    let mut found = read_parts(Request::from_parts(head, body), service, held).await;
    if is_digested && found.is_ok() {
        // What follows the last part belongs to the digest.
        unread.finish().await;
    }
    if let Some(error) = reason.lock().unwrap_or_else(PoisonError::into_inner).take() {
        found = Err(error);
    }
    service.require_key().await?;
    found
}

async fn read_parts(
    request: Request,
    service: &Service,
    held: Arc<ByteReservation>,
) -> ApiResult<Vec<(String, SpooledBody)>> {
    let most = service.limits.multipart_parts as usize;
    let malformed = |detail: String| ApiError::new(ErrorCode::MalformedMultipart, detail);
    let mut multipart = Multipart::from_request(request, &())
        .await
        .map_err(|error| malformed(error.body_text()))?;
    let mut parts: Vec<(String, SpooledBody)> = Vec::new();
    let mut unread = 0;
    while let Some(mut part) =
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
        let mut spool = Spool::new(service.ground(), held.clone());
        while let Some(frame) = part.chunk().await.map_err(|error| malformed(error.body_text()))? {
            spool.push(&frame).await?;
        }
        parts.push((name, spool.finish().await?));
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

/// The announced length of a body.
fn announced(headers: &HeaderMap) -> Option<u64> {
    headers.get(header::CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

fn too_large(most: usize) -> ApiError {
    let detail = format!("the body has more than {most} bytes");
    Problem::new(ErrorCode::PayloadTooLarge, detail).with("limit", most).into()
}

/// The frames of a body until it ends, is too large, too slow or not that of its digest, or its client has too many bytes in flight.
fn bounded(
    body: Body,
    bounds: Bounds,
    held: Arc<ByteReservation>,
) -> impl Stream<Item = ApiResult<Bytes>> {
    let pace = Pace::new(bounds.idle);
    let incoming = Incoming { frames: body.into_data_stream(), bounds, held, pace, count: 0 };
    futures::stream::unfold(Some(incoming), |incoming| async move {
        let mut incoming = incoming?;
        match incoming.next().await {
            Ok(Some(frame)) => Some((Ok(frame), Some(incoming))),
            Ok(None) => None,
            Err(error) => Some((Err(error), None)),
        }
    })
}

/// An incoming body.
struct Incoming {
    frames: BodyDataStream,
    bounds: Bounds,
    held: Arc<ByteReservation>,
    pace: Pace,
    count: usize,
}

impl Incoming {
    async fn next(&mut self) -> ApiResult<Option<Bytes>> {
        let asked = Instant::now();
        let next = tokio::time::timeout(self.bounds.idle, self.frames.next()).await;
        let frame = match next {
            Err(_) => return Err(too_slow(self.count)),
            Ok(None) => {
                let digest = self.bounds.digest.take();
                return digest.map_or(Ok(None), |digest| digest.check().map(|()| None));
            }
            Ok(Some(Err(_))) => return Err(broken_off(self.count)),
            Ok(Some(Ok(frame))) => frame,
        };
        self.count += frame.len();
        if self.count > self.bounds.bytes {
            return Err(too_large(self.bounds.bytes));
        }
        if let Some(digest) = &mut self.bounds.digest {
            digest.push(&frame);
        }
        self.held.at_least(self.count as u64)?;
        // What is done with a frame does not count as time of the client's.
        match self.pace.keeps(frame.len(), asked.elapsed()) {
            true => Ok(Some(frame)),
            false => Err(too_slow(self.count)),
        }
    }
}

fn broken_off(count: usize) -> ApiError {
    let detail = format!("the body broke off after {count} bytes");
    ApiError::new(ErrorCode::MalformedRequest, detail)
}

/// Body of a request to the admin listener, with its patience.
pub fn moving(body: Body, idle: Duration) -> Body {
    let frames = body.into_data_stream();
    let frames = futures::stream::unfold(Some(frames), move |frames| async move {
        let mut frames = frames?;
        match tokio::time::timeout(idle, frames.next()).await {
            Ok(frame) => frame.map(|frame| (frame.map_err(BoxError::from), Some(frames))),
            Err(late) => Some((Err(BoxError::from(late)), None)),
        }
    });
    Body::from_stream(frames)
}

fn too_slow(count: usize) -> ApiError {
    ApiError::new(
        ErrorCode::RequestTimeout,
        format!("the body came too slowly: {count} bytes so far"),
    )
    .header(header::CONNECTION, HeaderValue::from_static("close"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::key_lookup::KeyLookup;

    #[tokio::test]
    async fn a_body_that_arrives_after_its_key_was_revoked_is_not_taken() {
        let folder = tempfile::tempdir().unwrap();
        let mut service = Service::example(folder.path(), &[]).await;
        let request = || {
            let request = Request::builder().header(header::CONTENT_TYPE, "application/json");
            request.body(Body::from("{}")).unwrap()
        };
        let form = || {
            let kind = "multipart/form-data; boundary=b";
            let part =
                "--b\r\nContent-Disposition: form-data; name=\"case\"\r\n\r\n{}\r\n--b--\r\n";
            let request = Request::builder().header(header::CONTENT_TYPE, kind);
            request.body(Body::from(part)).unwrap()
        };
        assert!(json(&service, request()).await.is_ok());
        assert!(parts(&service, form()).await.is_ok());
        // No such key is in force.
        let before = Instant::now() - Duration::from_secs(1);
        service.key_lookup = KeyLookup::of("000000000000".into(), before);
        let refused = [json(&service, request()).await.err(), parts(&service, form()).await.err()];
        for refused in refused {
            assert_eq!(refused.unwrap().problem.code, ErrorCode::Unauthorized);
        }
    }
}
