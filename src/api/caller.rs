//! Who calls, on whose behalf, and what the key allows. The seam for tokens of an identity provider: whatever a request
//! carries becomes a [`Caller`] here, and nothing behind it asks where that came from.

use std::collections::BTreeSet;
use std::net::SocketAddr;
use std::sync::Arc;

use axum::extract::{ConnectInfo, FromRequestParts, MatchedPath, Request};
use axum::http::request::Parts;
use axum::http::{Extensions, HeaderMap, HeaderValue, Method, header};

use super::Service;
use super::client::Client;
use super::error::{ApiError, ApiResult};
use crate::schema::key::{Key, Scope, scopes_of};
use crate::schema::wire::canonical::sha256_hex;
use crate::schema::wire::problem::Problem;
use crate::store::DEFAULT_TENANT;

/// Who calls.
#[derive(Clone, Debug)]
pub struct Caller {
    pub tenant: Arc<str>,
    /// The id of the key, `setting` for the key of the settings, `-` where none is asked for and none was sent.
    pub key: Arc<str>,
    scopes: BTreeSet<Scope>,
}

const NO_KEY: &str = "-";
const KEY_OF_SETTINGS: &str = "setting";

impl Caller {
    /// One who needs no key, or has that of the settings.
    fn of_default_tenant(key: &str) -> Caller {
        Caller { tenant: DEFAULT_TENANT.into(), key: key.into(), scopes: Scope::ALL.into() }
    }

    pub fn require(&self, scope: Scope) -> ApiResult<()> {
        if self.scopes.contains(&scope) {
            return Ok(());
        }
        let detail = format!("the key does not allow `{}`", scope.name());
        Err(Problem::new("forbidden-scope", detail).with("required_scope", scope.name()).into())
    }

    /// Whom bounds for each client are counted for: with a key the one who has it, without keys the address that the
    /// request comes from.
    pub fn client(&self, extensions: &Extensions) -> Client {
        if &*self.key != NO_KEY {
            return Client::named(&self.key);
        }
        let address = extensions.get::<ConnectInfo<SocketAddr>>();
        Client::named(&address.map_or_else(String::new, |ConnectInfo(at)| at.ip().to_string()))
    }
}

/// The service in the hand of the caller's tenant: what handlers work with. A request that came around the guard is
/// nobody's.
impl FromRequestParts<Service> for Service {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, service: &Service) -> ApiResult<Self> {
        match parts.extensions.get::<Caller>() {
            Some(caller) => Ok(service.of_tenant(&caller.tenant)),
            None if is_open(parts.uri.path()) => Ok(service.clone()),
            None => Err(ApiError::internal("a request without a caller")),
        }
    }
}

impl FromRequestParts<Service> for Caller {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &Service) -> ApiResult<Self> {
        let caller = parts.extensions.get::<Caller>().cloned();
        caller.ok_or_else(|| ApiError::internal("a request without a caller"))
    }
}

/// The caller of a request; none for probes and pages, which are open to all.
pub async fn identify(
    service: &Service,
    path: &str,
    headers: &HeaderMap,
) -> ApiResult<Option<Caller>> {
    if is_open(path) {
        return Ok(None);
    }
    match bearer(headers) {
        None if !service.config.asks_for_keys => Ok(Some(Caller::of_default_tenant(NO_KEY))),
        None => Err(unauthorized("send a key as `Authorization: Bearer KEY`")),
        Some(given) => known(service, given).await.map(Some),
    }
}

async fn known(service: &Service, given: &str) -> ApiResult<Caller> {
    if service.config.api_key.as_ref().is_some_and(|key| key.matches(given)) {
        return Ok(Caller::of_default_tenant(KEY_OF_SETTINGS));
    }
    let refused = || unauthorized("this key is not known, or it was revoked or has expired");
    let key = Key::parse(given).ok_or_else(refused)?;
    let row = service.store.key_in_force(&key.id).await?.ok_or_else(refused)?;
    // How long comparing takes tells about the hash of what was sent, from which no key follows.
    if row.hash != sha256_hex(key.text.as_bytes()) {
        return Err(refused());
    }
    let scopes = scopes_of(&row.scopes).map_err(ApiError::internal)?;
    Ok(Caller { tenant: row.tenant.into(), key: row.id.into(), scopes })
}

/// The refusal of one who is not known.
pub fn unauthorized(detail: &str) -> ApiError {
    let error = ApiError::new("unauthorized", detail);
    error.header(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"))
}

/// The key that a request carries.
pub fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    let (scheme, given) = value.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| given.trim())
}

/// What a request takes: keys and the audit log `admin`; looking `read`; jobs, and what is computed at once, `run`;
/// everything else that changes something `write`.
pub fn scope_of(request: &Request) -> Scope {
    let path = request.extensions().get::<MatchedPath>().map_or("", MatchedPath::as_str);
    if path.starts_with("/v1/keys") || path.starts_with("/v1/audit") {
        return Scope::Admin;
    }
    match *request.method() {
        Method::GET | Method::HEAD | Method::OPTIONS => Scope::Read,
        _ if path.starts_with("/v1/jobs") || is_computed_at_once(path) => Scope::Run,
        _ => Scope::Write,
    }
}

/// Routes that answer to POST and change nothing.
pub fn is_computed_at_once(route: &str) -> bool {
    route.ends_with("/apply") || route.ends_with("/check")
}

/// Probes carry no key, and a browser cannot send one for the documentation, which holds no data.
pub fn is_open(path: &str) -> bool {
    matches!(path, "/healthz" | "/readyz" | "/openapi.json" | "/docs") || path.starts_with("/docs/")
}
