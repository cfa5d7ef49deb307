//! `facies serve`: the API, with workers in the same process.

use std::fmt;
use std::io::Write as _;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::runtime::Handle;

use super::settings::Arguments;
use crate::api::{self, Service};
use crate::config::{Config, ConfigError};
use crate::library::meshes::Library;
use crate::metrics;
use crate::schema::Limits;
use crate::store::{Store, StoreError};
use crate::telemetry::{self, TelemetryError};
use crate::traces::{self, TracesError};
use crate::worker::fail_point::{self, FailPointError};
use crate::worker::process::protocol::Settings;
use crate::worker::process::{Program, SlotSettings, SlotWork, slot_bytes};
use crate::worker::slots::Workers;
use crate::worker::work::Work;

/// How long what was done may be out of the chain of the audit log.
const CHAIN_EVERY: Duration = Duration::from_secs(2);
/// How long what was erased may be in the files of an embedded database.
const WIPE_EVERY: Duration = Duration::from_secs(2);
/// How long the store may take to be closed.
const LAST_WORDS: Duration = Duration::from_secs(2);
/// How long the start waits for the store of blobs, and when it looks again for one that did not answer.
const BLOBS_WITHIN: Duration = Duration::from_secs(5);
const BLOBS_AGAIN: Duration = Duration::from_secs(5);
/// Between two garbage collections.
const SWEEP_EVERY: Duration = Duration::from_secs(3600);

#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    #[error("{0}")]
    Config(#[from] ConfigError),
    #[error("{0}")]
    Telemetry(#[from] TelemetryError),
    #[error("{0}")]
    Store(#[from] StoreError),
    #[error("metrics: {0}")]
    Metrics(#[from] metrics_exporter_prometheus::BuildError),
    #[error("{address} cannot be listened on: {source}")]
    Listen { address: SocketAddr, source: std::io::Error },
    #[error("{0}")]
    Traces(#[from] TracesError),
    #[error("{0}")]
    FailPoint(#[from] FailPointError),
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

impl ServeError {
    /// Whether another setting, folder or program would help.
    pub fn is_setting(&self) -> bool {
        match self {
            ServeError::Io(_) => false,
            ServeError::Store(error) => error.is_setting() && !error.is_full(),
            _ => true,
        }
    }
}

/// Serves until the process is told to stop (SIGTERM or SIGINT).
pub fn run(arguments: &Arguments) -> Result<(), ServeError> {
    let given = arguments.given()?;
    let config = Config::new(|name| given.get(name))?;
    telemetry::start(&config.log)?;
    fail_point::check()?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let grace = config.grace;
    let server = runtime.block_on(Server::start(config))?;
    let store = server.service.store.clone();
    // One line on standard output, for programs that started this one with port 0.
    announce(format_args!("listening on http://{}", server.address));
    tell_admin(server.admin);
    let workers = runtime.block_on(server.run_until(stop_signal()))?;
    workers.stop(grace);
    // Both wait for others, and not one after the other.
    let closing = runtime.spawn(async move { close(&store).await });
    traces::stop();
    if let Err(error) = runtime.block_on(closing) {
        tracing::warn!(%error, "the database was not closed");
    }
    // Computations for abandoned requests end with the process.
    runtime.shutdown_background();
    Ok(())
}

/// Closes the store, so that its files hold nothing that was erased. Interrupted requests delay this by seconds at
/// most.
pub async fn close(store: &Store) {
    if tokio::time::timeout(LAST_WORDS, store.close()).await.is_err() {
        tracing::warn!("the database was not closed in time");
    }
    match store.wipe().await {
        Ok(true) => {}
        left => tracing::warn!(?left, "what was erased may be in the log of the database still"),
    }
}

/// A server that listens and whose workers work.
pub struct Server {
    pub address: SocketAddr,
    /// Address of the admin listener.
    pub admin: Option<SocketAddr>,
    listener: TcpListener,
    service: Service,
    workers: Workers,
}

impl Server {
    /// Opens the store, sweeps it, listens, and starts the workers.
    pub async fn start(config: Config) -> Result<Server, ServeError> {
        let store = open(&config).await?;
        let address = config.listen;
        let listener = TcpListener::bind(address)
            .await
            .map_err(|source| ServeError::Listen { address, source })?;
        let address = listener.local_addr()?;
        let admin = listen_for_admin(&config, &store).await?;
        let library = Library::new(store.clone(), config.mesh_cache_bytes);
        let service = Service::new(config.clone(), store.clone(), library.clone());
        let workers = start_workers(&config, store, library, &service.limits)?;
        tracing::info!(%address, workers = config.workers, "serving");
        Ok(Server { address, admin, listener, service, workers })
    }

    /// Answers requests until `stop` is done; the workers are still at work then.
    pub async fn run_until(
        self,
        stop: impl Future<Output = ()> + Send + 'static,
    ) -> Result<Workers, ServeError> {
        let deadline = self.service.config.grace;
        let (stopping, mut stopped) = tokio::sync::watch::channel(());
        let patience = self.service.config.body_idle;
        let streams = self.service.streams.clone();
        let store = self.service.store.clone();
        let answers = api::router(self.service);
        let served = api::server_loop::serve(self.listener, answers, patience, async move {
            stop.await;
            streams.stop();
            tracing::info!("stopping");
            drop(stopping);
        });
        let served = tokio::spawn(served);
        // The sender goes when it is time to stop.
        let _ = stopped.changed().await;
        // A client that never ends its request does not keep the process from ending.
        if tokio::time::timeout(deadline, served).await.is_err() {
            tracing::warn!("requests were cut off");
        }
        if let Err(error) = store.write_outcomes().await {
            tracing::error!(%error, "the outcomes of requests are not written to the audit log");
        }
        Ok(self.workers)
    }
}

/// Begins to count and to trace, opens the store and keeps it swept.
pub async fn open(config: &Config) -> Result<Store, ServeError> {
    metrics::start()?;
    traces::start(config.traces.as_deref())?;
    let store = Store::connect(&config.places).await?.with_key_limit(config.most_keys);
    match store.check_writable().await {
        Err(error) if error.is_setting() || error.is_damaged() => return Err(error.into()),
        // What is stored is served all the same.
        Err(error) => {
            tracing::warn!(%error, "the database takes no row: /readyz answers 503 until it does");
        }
        Ok(()) => {}
    }
    let has_blobs = match store.check_blobs_within(BLOBS_WITHIN).await {
        // What does not answer yet keeps the service unready, not from starting.
        Err(error) if error.is_setting() => return Err(error.into()),
        Err(error) => {
            tracing::warn!(%error, "the store of blobs does not answer: /readyz answers 503 until it does");
            false
        }
        Ok(()) => true,
    };
    start_garbage_collection(&store, has_blobs).await?;
    start_audit_chaining(&store);
    start_wiping(&store);
    Ok(store)
}

/// Starts the admin listener, where a setting names its address.
pub async fn listen_for_admin(
    config: &Config,
    store: &Store,
) -> Result<Option<SocketAddr>, ServeError> {
    let Some(address) = config.admin_listen else { return Ok(None) };
    let listening = api::admin::listen(address, config, store.clone()).await;
    Ok(Some(listening.map_err(|source| ServeError::Listen { address, source })?))
}

/// Prints the address of the admin listener, for programs that started this one with port 0.
pub fn tell_admin(admin: Option<SocketAddr>) {
    if let Some(address) = admin {
        announce(format_args!("metrics on http://{address}/metrics"));
    }
}

/// A line on standard output. A service goes on where nobody reads it, or its disk is full.
pub fn announce(line: fmt::Arguments) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Starts the workers of this process, each slot with a process of its own.
pub fn start_workers(
    config: &Config,
    store: Store,
    library: Library,
    limits: &Limits,
) -> Result<Workers, ServeError> {
    let runtime = Handle::current();
    let slots = Arc::new(SlotSettings {
        library,
        runtime: runtime.clone(),
        program: Program::this(&config.log.filter)?,
        settings: slot_settings(config, limits),
    });
    let work = || -> Box<dyn Work> { Box::new(SlotWork::new(slots.clone())) };
    Ok(Workers::start(store, config, &work, runtime)?)
}

/// Limits of the processes of slots. Cached meshes take a quarter of their memory at most.
fn slot_settings(config: &Config, limits: &Limits) -> Settings {
    let memory_bytes = slot_bytes(config);
    let share = config.mesh_cache_bytes / config.workers.max(1);
    Settings {
        limits: limits.clone(),
        memory_bytes,
        cache_bytes: share.min((memory_bytes / 4) as usize),
        threads: config.threads_per_job,
    }
}

/// Collects garbage of dead processes, as soon as blobs can be reached and then every hour.
async fn start_garbage_collection(store: &Store, has_blobs: bool) -> Result<(), StoreError> {
    match has_blobs {
        true => match collect_garbage_at_start(store).await {
            // What is stored is served all the same, and can be erased.
            Err(error) if error.is_full() => tracing::error!(%error, "nothing was swept"),
            swept => swept?,
        },
        false => drop(store.sweep_temporary()?),
    }
    let store = store.clone();
    tokio::spawn(async move {
        if !has_blobs && reach_blobs(&store).await {
            sweep(&store).await;
        }
        while store.is_open_after(SWEEP_EVERY).await {
            sweep(&store).await;
        }
    });
    Ok(())
}

/// Looks again and again for blobs that did not answer at the start; false where the store was closed before they did.
async fn reach_blobs(store: &Store) -> bool {
    while store.is_open_after(BLOBS_AGAIN).await {
        match store.check_blobs_within(BLOBS_WITHIN).await {
            Ok(()) => {
                tracing::info!("the store of blobs answers");
                return true;
            }
            Err(error) => tracing::warn!(%error, "the store of blobs does not answer yet"),
        }
    }
    false
}

async fn collect_garbage_at_start(store: &Store) -> Result<(), StoreError> {
    let erased = store.erase_old().await?;
    tell_doubt(store).await?;
    let swept = store.sweep().await?;
    tracing::info!(erased, blobs = swept.blobs, temporary = swept.temporary, "swept");
    Ok(())
}

/// Wipes erased data from the files of an embedded database, soon after.
fn start_wiping(store: &Store) {
    let store = store.clone();
    tokio::spawn(async move {
        while store.is_open_after(WIPE_EVERY).await {
            match store.wipe().await {
                // A store that is being closed is wiped there.
                Err(error) if !store.is_closing() => {
                    tracing::warn!(%error, "what was erased is in the log of the database still");
                }
                _ => {}
            }
        }
    });
}

/// Extends the chain of the audit log by ended actions: changes of chained rows show.
fn start_audit_chaining(store: &Store) {
    let store = store.clone();
    tokio::spawn(async move {
        while store.is_open_after(CHAIN_EVERY).await {
            match chain(&store).await {
                // What was done last is taken into it by the next start.
                Err(error) if !store.is_closing() => {
                    tracing::warn!(%error, "the audit log is not up to date");
                }
                _ => {}
            }
        }
    });
}

async fn chain(store: &Store) -> Result<(), StoreError> {
    store.write_outcomes().await?;
    store.chain_actions().await?;
    Ok(())
}

/// Erases what is older than its tenant keeps it, and bytes that nothing refers to.
async fn sweep(store: &Store) {
    match store.erase_old().await {
        Ok(0) => {}
        Ok(erased) => tracing::info!(erased, "erased what is older than its tenant keeps it"),
        Err(error) => tracing::warn!(%error, "retention was broken off"),
    }
    if let Err(error) = tell_doubt(store).await {
        tracing::warn!(%error, "whether the clock is in doubt is not known");
    }
    match store.sweep_old_blobs().await {
        Ok(blobs) => tracing::debug!(blobs, "swept"),
        Err(error) => tracing::warn!(%error, "the sweep was broken off"),
    }
}

/// Tells that retention erases nothing because the clock is far off.
async fn tell_doubt(store: &Store) -> Result<(), StoreError> {
    let doubt = store.clock_doubt().await?;
    metrics::retention_withheld(doubt.is_some());
    if let Some(doubt) = doubt {
        tracing::error!(
            "retention erases nothing: {doubt}; `facies admin clock --trust` confirms it"
        );
    }
    Ok(())
}

/// Done when the process is told to stop: SIGTERM or SIGINT.
pub async fn stop_signal() {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = match signal(SignalKind::terminate()) {
        Ok(signal) => signal,
        Err(error) => {
            tracing::error!(%error, "SIGTERM is not listened to");
            return std::future::pending().await;
        }
    };
    tokio::select! {
        _ = terminate.recv() => {}
        _ = tokio::signal::ctrl_c() => {}
    }
}
