//! Shared state of request handlers, scoped to the tenant of the caller.

use super::budget::{Budget, ByteLimits, ByteReservation, Owner};
use super::client::Client;
use super::error::{ApiError, ApiResult};
use super::hosts::Hosts;
use super::key_lookup::KeyLookup;
use super::permits::{FairSemaphore, Permit};
use super::spool::Ground;
use crate::config::Config;
use crate::library::meshes::Library;
use crate::library::pictures::Pictures;
use crate::library::responses::Responses;
use crate::schema::Limits;
use crate::store::{AuditIntent, Store};
use crate::worker::process::slot_bytes;
use std::sync::Arc;
use std::time::Duration;

/// Meshes parsed concurrently, and jobs checked; one tenant has one permit less of each. A posted case keeps that of its meshes while it
/// is checked, so that what holds of checks has to hold of both.
const PARSED_AT_ONCE: usize = 3;
const CHECKED_AT_ONCE: usize = 3;
/// Pages of jobs read and serialised concurrently.
const LISTED_AT_ONCE: usize = 2;
/// How long a list of jobs waits for its permit, equal to the wait for a database connection.
const LIST_PATIENCE: Duration = Duration::from_millis(2500);

/// State shared by all requests.
#[derive(Clone)]
pub struct Service {
    pub config: Arc<Config>,
    pub limits: Arc<Limits>,
    pub store: Store,
    pub library: Library,
    pub responses: Responses,
    pub pictures: Pictures,
    parsing: FairSemaphore,
    checking: FairSemaphore,
    listing: FairSemaphore,
    budget: Budget,
    /// The client, for limits on each client.
    client: Client,
    /// Of the key of the request.
    pub(super) key_lookup: KeyLookup,
    /// Of a request that may change something.
    intent: Option<AuditIntent>,
    pub(super) rates: Arc<super::rate::Rates>,
    /// Trusted hosts, if no key is required.
    pub(super) hosts: Option<Arc<Hosts>>,
    pub streams: super::streams::Streams,
}

/// The limits in these settings.
pub fn limits(config: &Config) -> Limits {
    let mut limits = Limits {
        upload_bytes: config.upload_bytes as u64,
        requests_per_minute: config.requests_per_minute,
        event_streams: config.event_streams,
        keys: config.most_keys,
        waiting_requests: config.waiting_requests,
        check_s: config.check.as_secs_f64(),
        // One body of the largest size always fits.
        client_bodies_bytes: config.client_bodies_bytes.max(config.upload_bytes as u64),
        ..Limits::default()
    };
    // A process without slots knows the slot memory of others only from its settings.
    if config.workers > 0 || config.slot_memory_bytes.is_some() {
        limits.slot_memory_mb = slot_bytes(config) as f64 / 1e6;
    }
    limits
}

impl Service {
    pub fn new(config: Config, store: Store, library: Library) -> Self {
        let limits = limits(&config);
        let waiting = limits.waiting_requests as usize;
        let hosts = || Arc::new(Hosts::new(&config.allowed_hosts, &config.allowed_origins));
        Service {
            hosts: (!config.requires_keys).then(hosts),
            responses: Responses::new(store.clone(), config.response_cache_bytes),
            pictures: Pictures::default(),
            limits: Arc::new(limits.clone()),
            store: store.with_waiting_limit(limits.waiting_requests),
            library,
            streams: super::streams::Streams::new(limits.event_streams),
            parsing: FairSemaphore::keeping_one("parse", PARSED_AT_ONCE, waiting),
            checking: FairSemaphore::keeping_one("check", CHECKED_AT_ONCE, waiting),
            listing: FairSemaphore::new("list", LISTED_AT_ONCE, waiting),
            budget: Budget::new(ByteLimits {
                of_process: config.bodies_bytes.max(limits.client_bodies_bytes),
                of_client: limits.client_bodies_bytes,
            }),
            client: Client::named(""),
            key_lookup: KeyLookup::of_no_row(),
            intent: None,
            rates: Arc::new(super::rate::Rates::new(limits.requests_per_minute)),
            config: Arc::new(config),
        }
    }

    /// A service on a folder, with these settings and the usual ones.
    #[cfg(test)]
    pub async fn example(folder: &std::path::Path, settings: &[(&str, &str)]) -> Service {
        let store = Store::open(folder).await.unwrap();
        let own = |name: &str| settings.iter().find(|(own, _)| *own == name);
        let config = Config::new(|name| own(name).map(|(_, value)| (*value).to_owned())).unwrap();
        Service::new(config, store.clone(), Library::new(store, 0))
    }

    /// The same service scoped to a tenant, for a request of one of its clients; changes are audited.
    pub(super) fn scoped_to(
        &self,
        tenant: &str,
        client: Client,
        key_lookup: KeyLookup,
        intent: Option<AuditIntent>,
    ) -> Service {
        Service {
            store: self.store.asked_by(tenant, intent.as_ref()),
            library: self.library.of_tenant(tenant),
            responses: self.responses.of_tenant(tenant),
            client,
            intent,
            key_lookup,
            ..self.clone()
        }
    }

    /// The permit of this request to parse or write a mesh: each may take several times its size in memory, which is
    /// held until the permit is released.
    pub(super) async fn parse_permit(&self) -> ApiResult<Permit> {
        self.parsing.acquire(self.store.tenant()).await
    }

    /// Permit of this request to check a job or a case, with parsed meshes or small ones.
    pub(super) async fn check_permit(&self) -> ApiResult<Permit> {
        self.checking.acquire(self.store.tenant()).await
    }

    /// Permit of this request to list jobs, whose positions are counted over the whole queue: frequent lists must not
    /// take the database and the processors from others. If the database is slow, the client gets
    /// `Retry-After`.
    pub(super) async fn list_permit(&self) -> ApiResult<Permit> {
        let permit = self.listing.acquire(self.store.tenant());
        tokio::time::timeout(LIST_PATIENCE, permit)
            .await
            .unwrap_or_else(|_| Err(ApiError::unavailable()))
    }

    /// Waits until the client of a request with changes disconnects; any other request ends with its client.
    pub(super) async fn client_disconnected(&self) {
        match &self.intent {
            Some(intent) => intent.left().await,
            None => std::future::pending().await,
        }
    }

    /// Refuses a request whose key was revoked or has expired while its body arrived.
    pub(super) async fn require_key(&self) -> ApiResult<()> {
        self.key_lookup.require_if_old(&self.store).await
    }

    /// The bytes of a request, none so far.
    pub(super) fn hold(&self) -> ByteReservation {
        let tenant = self.store.tenant().into();
        self.budget.hold(Owner { tenant, client: self.client.clone() })
    }

    /// The place of bodies and copies.
    pub(super) fn ground(&self) -> Ground {
        let floor_bytes = self.config.free_space_floor_bytes;
        Ground { store: self.store.clone(), floor_bytes }
    }
}
