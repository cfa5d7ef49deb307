//! Caller of a request, and the scopes of its key. The seam for tokens of an identity provider: the credentials of a request
//! become a [`Caller`] here, and later code does not depend on their kind.

use std::collections::BTreeSet;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Instant;

use axum::extract::{ConnectInfo, FromRequestParts, Request};
use axum::http::request::Parts;
use axum::http::{Extensions, HeaderMap, header};

use super::Service;
use super::access::Access;
use super::client::Client;
use super::error::{ApiError, ApiResult};
use super::foreseen::{self, ResponseLookup};
use super::key_lookup::{KeyLookup, not_in_force, unauthorized};
use crate::schema::ErrorCode;
use crate::schema::key::{Key, Scope, scopes_of};
use crate::schema::wire::canonical::sha256_hex;
use crate::schema::wire::problem::Problem;
use crate::store::{AuditIntent, DEFAULT_TENANT};

/// The caller of a request.
#[derive(Clone, Debug)]
pub struct Caller {
    pub tenant: Arc<str>,
    /// The id of the key, `setting` for the key in the settings, `-` if none is required and none was sent.
    pub key: Arc<str>,
    scopes: BTreeSet<Scope>,
    pub lookup: KeyLookup,
}

const NO_KEY: &str = "-";
const KEY_OF_SETTINGS: &str = "setting";

impl Caller {
    /// A caller that needs no key, or has that of the settings.
    fn of_default_tenant(key: &str) -> Caller {
        Caller {
            tenant: DEFAULT_TENANT.into(),
            key: key.into(),
            scopes: Scope::ALL.into(),
            lookup: KeyLookup::of_no_row(),
        }
    }

    pub fn require(&self, scope: Scope) -> ApiResult<()> {
        if self.scopes.contains(&scope) {
            return Ok(());
        }
        let detail = format!("the key does not allow `{}`", scope.name());
        Err(Problem::new(ErrorCode::ForbiddenScope, detail)
            .with("required_scope", scope.name())
            .into())
    }

    /// Identity for limits on each client: the key, or without keys the address of the request.
    pub fn client(&self, extensions: &Extensions) -> Client {
        if &*self.key != NO_KEY {
            return Client::named(&self.key);
        }
        let address = extensions.get::<ConnectInfo<SocketAddr>>();
        Client::named(&address.map_or_else(String::new, |ConnectInfo(at)| at.ip().to_string()))
    }
}

/// The service scoped to the caller's tenant, for handlers. A request that bypassed the middleware, or whose route has
/// no declared scope, is refused.
impl FromRequestParts<Service> for Service {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, service: &Service) -> ApiResult<Self> {
        if let Some(Access::Open) = parts.extensions.get() {
            return Ok(service.clone());
        }
        let caller = Caller::from_request_parts(parts, service).await?;
        let intent = parts.extensions.get::<AuditIntent>().cloned();
        let client = caller.client(&parts.extensions);
        Ok(service.scoped_to(&caller.tenant, client, caller.lookup, intent))
    }
}

impl FromRequestParts<Service> for Caller {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &Service) -> ApiResult<Self> {
        let caller = parts.extensions.get::<Caller>();
        match (parts.extensions.get::<Access>(), caller) {
            (Some(Access::Key { .. }), Some(caller)) => Ok(caller.clone()),
            (Some(Access::Key { .. }), None) | (Some(Access::Open) | None, _) => {
                Err(ApiError::internal("a request whose caller was not established"))
            }
        }
    }
}

/// The sender of a request, and the data looked up with its key.
pub struct Identified {
    pub caller: Caller,
    pub foreseen: Option<ResponseLookup>,
}

impl Identified {
    fn of_default_tenant(key: &str) -> Identified {
        Identified { caller: Caller::of_default_tenant(key), foreseen: None }
    }
}

/// The caller of a request. The future does not borrow the request, whose body threads cannot share.
pub fn identify<'a>(
    service: &'a Service,
    request: &Request,
) -> impl Future<Output = ApiResult<Identified>> + Send + use<'a> {
    let given = bearer(request.headers()).map(str::to_owned);
    let case = foreseen::case_of(request);
    async move {
        match given {
            None if !service.config.requires_keys => Ok(Identified::of_default_tenant(NO_KEY)),
            None => Err(unauthorized("send a key as `Authorization: Bearer KEY`")),
            Some(given) => known(service, &given, case).await,
        }
    }
}

async fn known(service: &Service, given: &str, case: Option<String>) -> ApiResult<Identified> {
    if service.config.api_key.as_ref().is_some_and(|key| key.matches(given)) {
        return Ok(Identified::of_default_tenant(KEY_OF_SETTINGS));
    }
    let at = Instant::now();
    let key = Key::parse(given).ok_or_else(not_in_force)?;
    let (row, foreseen) = match case {
        Some(case) => {
            let found = service.store.key_and_responses(&key.id, &case).await?;
            let (row, responses) = found.ok_or_else(not_in_force)?;
            (row, Some(ResponseLookup::now(responses)))
        }
        None => (service.store.key_in_force(&key.id).await?.ok_or_else(not_in_force)?, None),
    };
    // How long comparing takes tells about the hash of what was sent, from which no key follows.
    if row.hash != sha256_hex(key.text.as_bytes()) {
        return Err(not_in_force());
    }
    let scopes = scopes_of(&row.scopes).map_err(ApiError::unreadable("key", &row.id))?;
    let key: Arc<str> = row.id.into();
    let lookup = KeyLookup::of(key.clone(), at);
    let caller = Caller { tenant: row.tenant.into(), key, scopes, lookup };
    Ok(Identified { caller, foreseen })
}

/// The key in a request.
pub fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    let (scheme, given) = value.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| given.trim())
}
