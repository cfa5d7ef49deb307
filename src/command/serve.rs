//! `facies serve`: the API, with workers in the same process.

use std::io::Write as _;
use std::net::SocketAddr;
use std::sync::Arc;

use axum::serve::ListenerExt as _;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use tokio::net::TcpListener;
use tokio::runtime::Handle;

use crate::api::{self, Service};
use crate::config::{Config, ConfigError, SETTINGS};
use crate::jobs::fail_point::{self, FailPointError};
use crate::jobs::library::Library;
use crate::jobs::slot::protocol::Settings;
use crate::jobs::slot::{Program, SlotSettings, SlotWork, slot_bytes};
use crate::jobs::worker::{Work, Workers};
use crate::metrics;
use crate::store::{Store, StoreError};
use crate::telemetry::{self, TelemetryError};

#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    #[error("{0}")]
    Config(#[from] ConfigError),
    #[error("{0}")]
    Telemetry(#[from] TelemetryError),
    #[error("data folder: {0}")]
    Store(#[from] StoreError),
    #[error("metrics: {0}")]
    Metrics(#[from] metrics_exporter_prometheus::BuildError),
    #[error("{address} cannot be listened on: {source}")]
    Listen { address: SocketAddr, source: std::io::Error },
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
            ServeError::Store(error) => matches!(
                error,
                StoreError::InUse
                    | StoreError::Files(_)
                    | StoreError::SchemaTooNew { .. }
                    | StoreError::Schema(_)
            ),
            _ => true,
        }
    }
}

/// The settings as flags; each may as well be an environment variable.
#[derive(Clone, Debug, Default)]
pub struct Arguments {
    given: Vec<(&'static str, String)>,
}

impl Arguments {
    /// What was given for a setting: by its flag, else by its variable.
    pub fn get(&self, name: &str) -> Option<String> {
        let flag = self.given.iter().find(|(given, _)| *given == name);
        flag.map(|(_, value)| value.clone()).or_else(|| {
            let setting = SETTINGS.iter().find(|setting| setting.name == name)?;
            let value = std::env::var_os(setting.variable())?;
            Some(value.to_string_lossy().into_owned())
        })
    }
}

impl Args for Arguments {
    fn augment_args(command: Command) -> Command {
        // Given twice, the last one counts, as it does in shells and container files.
        SETTINGS.iter().fold(command.args_override_self(true), |command, setting| {
            let default = match setting.default {
                "" => String::new(),
                default => format!(" [default: {default}]"),
            };
            let argument = Arg::new(setting.name)
                .long(setting.name)
                .value_name("VALUE")
                .allow_hyphen_values(true)
                .help(format!("{} [env: {}]{default}", setting.about, setting.variable()));
            command.arg(argument)
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Arguments {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let value = |name: &'static str| {
            let value = matches.get_one::<String>(name)?;
            Some((name, value.clone()))
        };
        let given = SETTINGS.iter().filter_map(|setting| value(setting.name)).collect();
        Ok(Arguments { given })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Serves until the process is told to stop (SIGTERM or SIGINT).
pub fn run(arguments: &Arguments) -> Result<(), ServeError> {
    let config = Config::new(|name| arguments.get(name))?;
    telemetry::start(&config.log)?;
    fail_point::check()?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let grace = config.grace;
    let server = runtime.block_on(Server::start(config))?;
    // One line on standard output, for programs that started this one with port 0.
    println!("listening on http://{}", server.address);
    if let Some(address) = server.admin {
        // Whoever started this program may have stopped reading.
        let _ = writeln!(std::io::stdout(), "metrics on http://{address}/metrics");
    }
    let workers = runtime.block_on(server.run_until(stop_signal()))?;
    workers.stop(grace);
    // What still computes for a request that nobody waits for ends with the process.
    runtime.shutdown_background();
    Ok(())
}

/// A server that listens and whose workers work.
pub struct Server {
    pub address: SocketAddr,
    /// Where those who run the service look.
    pub admin: Option<SocketAddr>,
    listener: TcpListener,
    service: Service,
    workers: Workers,
}

impl Server {
    /// Opens the store, sweeps it, listens, and starts the workers.
    pub async fn start(config: Config) -> Result<Server, ServeError> {
        metrics::start()?;
        let store = Store::open(&config.data_dir).await?;
        let swept = store.sweep().await?;
        tracing::info!(blobs = swept.blobs, temporary = swept.temporary, "swept");
        let address = config.listen;
        let listener = TcpListener::bind(address)
            .await
            .map_err(|source| ServeError::Listen { address, source })?;
        let address = listener.local_addr()?;
        let admin = match config.admin_listen {
            Some(address) => Some(
                api::admin::listen(address, store.clone())
                    .await
                    .map_err(|source| ServeError::Listen { address, source })?,
            ),
            None => None,
        };
        let library = Library::new(store.clone(), config.mesh_cache_bytes);
        let runtime = Handle::current();
        let service = Service::new(config.clone(), store.clone(), library.clone());
        let slots = Arc::new(SlotSettings {
            library,
            runtime: runtime.clone(),
            program: Program::this(&config.log.filter)?,
            settings: slot_settings(&config, &service),
        });
        let work = || -> Box<dyn Work> { Box::new(SlotWork::new(slots.clone())) };
        let workers = Workers::start(store, &config, &work, runtime)?;
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
        // The last piece of an answer is not held back until the client has confirmed the ones before it.
        let listener = self.listener.tap_io(|stream| {
            if let Err(error) = stream.set_nodelay(true) {
                tracing::debug!(%error, "TCP_NODELAY");
            }
        });
        let streams = self.service.streams.clone();
        let answers = api::router(self.service).into_make_service_with_connect_info::<SocketAddr>();
        let served = axum::serve(listener, answers).with_graceful_shutdown(async move {
            stop.await;
            streams.stop();
            tracing::info!("stopping");
            drop(stopping);
        });
        let served = tokio::spawn(served.into_future());
        // The sender goes when it is time to stop.
        let _ = stopped.changed().await;
        // A client that never ends its request does not keep the process from ending.
        if tokio::time::timeout(deadline, served).await.is_err() {
            tracing::warn!("requests were cut off");
        }
        Ok(self.workers)
    }
}

/// What the processes of the slots keep to. Meshes that they keep take a quarter of their memory at most.
fn slot_settings(config: &Config, service: &Service) -> Settings {
    let memory_bytes = slot_bytes(config);
    let share = config.mesh_cache_bytes / config.workers.max(1);
    Settings {
        limits: (*service.limits).clone(),
        memory_bytes,
        cache_bytes: share.min((memory_bytes / 4) as usize),
        threads: config.threads_per_job,
    }
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
