//! What every request may use, scoped to the tenant of its caller.

use crate::config::Config;
use crate::library::meshes::Library;
use crate::library::responses::Responses;
use crate::schema::Limits;
use crate::store::Store;
use crate::worker::niceness::give_way;
use crate::worker::process::slot_bytes;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Meshes that are parsed at the same time: each may take several times its size in memory.
pub(super) const PARSED_AT_ONCE: usize = 2;

/// What every request may use.
#[derive(Clone)]
pub struct Service {
    pub config: Arc<Config>,
    pub limits: Arc<Limits>,
    pub store: Store,
    pub library: Library,
    pub responses: Responses,
    pub(super) parsing: Arc<Semaphore>,
    pub(super) rates: Arc<super::rate::Rates>,
    pub streams: super::streams::Streams,
}

/// The limits that these settings give.
pub fn limits(config: &Config) -> Limits {
    let mut limits = Limits {
        upload_bytes: config.upload_bytes as u64,
        requests_per_minute: config.requests_per_minute,
        event_streams: config.event_streams,
        keys: config.most_keys,
        ..Limits::default()
    };
    // Who has no slots does not know the memory of those of other processes, unless it is told.
    if config.workers > 0 || config.slot_memory_bytes.is_some() {
        limits.slot_memory_mb = slot_bytes(config) as f64 / 1e6;
    }
    limits
}

impl Service {
    pub fn new(config: Config, store: Store, library: Library) -> Self {
        let limits = limits(&config);
        Service {
            responses: Responses::new(store.clone(), config.response_cache_bytes),
            config: Arc::new(config),
            limits: Arc::new(limits.clone()),
            store,
            library,
            streams: super::streams::Streams::new(limits.event_streams),
            parsing: Arc::new(Semaphore::new(PARSED_AT_ONCE)),
            rates: Arc::new(super::rate::Rates::new(limits.requests_per_minute)),
        }
    }

    /// The same service in the hand of a tenant.
    pub(super) fn of_tenant(&self, tenant: &str) -> Service {
        Service {
            store: self.store.of_tenant(tenant),
            library: self.library.of_tenant(tenant),
            responses: self.responses.of_tenant(tenant),
            ..self.clone()
        }
    }

    /// Runs work that takes a processor for long, a few at a time, each on a thread of its own that gives way to those
    /// that answer.
    pub(super) async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> super::error::ApiResult<T> {
        let permit = self.parsing.clone().acquire_owned().await;
        let _permit = permit.map_err(super::error::ApiError::internal)?;
        let (done, made) = tokio::sync::oneshot::channel();
        let patient = move || {
            give_way();
            // Nobody waits any more where the client has gone.
            let _ = done.send(work());
        };
        let thread = std::thread::Builder::new().name("parser".to_owned()).spawn(patient);
        thread.map_err(super::error::ApiError::internal)?;
        // A thread that panics drops its end.
        made.await.map_err(super::error::ApiError::internal)
    }
}
