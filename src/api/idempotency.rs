//! `Idempotency-Key` (draft-ietf-httpapi-idempotency-key-header-07): a request that is repeated, because its
//! response was lost, creates nothing twice. The first request with a key gives an id to its resource; the same
//! request with the same key creates or finds that.

use axum::http::HeaderMap;

use super::error::{ApiError, ApiResult};
use super::{Service, gone};
use crate::schema::ErrorCode;
use crate::schema::wire::canonical::sha256_hex;
use crate::schema::wire::problem::Problem;
use crate::store::Reserved;

const HEADER: &str = "idempotency-key";
const LONGEST: usize = 255;

/// The id of the resource of a request.
pub struct NewId {
    pub id: String,
    /// Whether an earlier request may have created it already.
    pub is_known: bool,
    /// Whether that request got an existing resource.
    pub was_found: bool,
    /// The hash of the key, if the request has one.
    key: Option<String>,
}

impl NewId {
    /// Records that this request got an existing resource: a repetition gets the same.
    pub async fn found(&self, service: &Service, resource: &str) -> ApiResult<()> {
        if let Some(key) = &self.key {
            service.store.remember_found(key, resource).await?;
        }
        Ok(())
    }
}

/// A request that may be a repetition.
pub struct KeyedRequest {
    id: String,
    /// The hashes of its key and of its content, if it has a key.
    key: Option<(String, String)>,
}

impl KeyedRequest {
    /// `route` is the pattern of its address; `content` is all else that determines what it makes, independent of its encoding.
    pub fn at(
        service: &Service,
        headers: &HeaderMap,
        route: &str,
        content: &[&[u8]],
    ) -> ApiResult<KeyedRequest> {
        let id = uuid::Uuid::now_v7().to_string();
        let Some(key) = key(headers)? else { return Ok(KeyedRequest { id, key: None }) };
        let key = sha256_hex(format!("{}\n{route}\n{key}", service.store.tenant()).as_bytes());
        let hashes: Vec<String> = content.iter().map(|part| sha256_hex(part)).collect();
        let fingerprint = sha256_hex(hashes.concat().as_bytes());
        Ok(KeyedRequest { id, key: Some((key, fingerprint)) })
    }

    /// The id of the resource of the first request with its key, if known. Read-only.
    pub async fn known(&self, service: &Service) -> ApiResult<Option<NewId>> {
        let Some((key, fingerprint)) = &self.key else { return Ok(None) };
        match service.store.reserved(key, fingerprint).await? {
            Some(reserved) => self.new_id(service, reserved).await.map(Some),
            None => Ok(None),
        }
    }

    /// The id of its resource: that of the first request with its key, else a new one.
    pub async fn reserve(&self, service: &Service) -> ApiResult<NewId> {
        let reserved = match &self.key {
            Some((key, fingerprint)) => service.store.reserve(key, fingerprint, &self.id).await?,
            None => Reserved::Fresh,
        };
        self.new_id(service, reserved).await
    }

    async fn new_id(&self, service: &Service, reserved: Reserved) -> ApiResult<NewId> {
        let key = self.key.as_ref().map(|(key, _)| key.clone());
        match reserved {
            Reserved::Fresh => {
                Ok(NewId { id: self.id.clone(), is_known: false, was_found: false, key })
            }
            Reserved::Again { id, found } => match service.store.erased(&id).await? {
                Some(erased) => Err(gone::gone(&id, erased)),
                None => Ok(NewId { id, is_known: true, was_found: found, key }),
            },
            Reserved::Other => {
                let detail = "another request was sent with this Idempotency-Key";
                Err(ApiError::new(ErrorCode::IdempotencyMismatch, detail))
            }
        }
    }
}

fn key(headers: &HeaderMap) -> ApiResult<Option<&str>> {
    let mut values = headers.get_all(HEADER).iter();
    let Some(value) = values.next() else { return Ok(None) };
    if values.next().is_some() {
        let detail = "the header Idempotency-Key is given more than once";
        return Err(ApiError::invalid_parameter("Idempotency-Key", detail));
    }
    let text = value.to_str().ok().filter(|text| (1..=LONGEST).contains(&text.len()));
    let detail = format!("an Idempotency-Key has 1 to {LONGEST} visible characters");
    let wrong =
        || Problem::new(ErrorCode::InvalidParameter, detail).with("parameter", "Idempotency-Key");
    text.map(Some).ok_or_else(|| wrong().into())
}
