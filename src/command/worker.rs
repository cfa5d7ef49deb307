//! `facies worker`: workers without an API, beside any number of others on any hosts.

use std::io::Write as _;
use std::net::SocketAddr;

use super::serve::{ServeError, admin_listener, keep_swept, stop_signal, workers};
use super::settings::Arguments;
use crate::config::Config;
use crate::jobs::fail_point;
use crate::jobs::library::Library;
use crate::jobs::worker::Workers;
use crate::schema::Limits;
use crate::store::Store;
use crate::{metrics, telemetry};

/// Works until the process is told to stop (SIGTERM or SIGINT).
pub fn run(arguments: &Arguments) -> Result<(), ServeError> {
    let given = arguments.given()?;
    let config = Config::without_listener(|name| given.get(name))?;
    config.places.check_shared()?;
    telemetry::start(&config.log)?;
    fail_point::check()?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let (workers, admin) = runtime.block_on(start(&config))?;
    // One line on standard output, for programs that started this one.
    println!("working with {} workers", config.workers);
    if let Some(address) = admin {
        // Whoever started this program may have stopped reading.
        let _ = writeln!(std::io::stdout(), "metrics on http://{address}/metrics");
    }
    runtime.block_on(stop_signal());
    tracing::info!("stopping");
    workers.stop(config.grace);
    runtime.shutdown_background();
    Ok(())
}

async fn start(config: &Config) -> Result<(Workers, Option<SocketAddr>), ServeError> {
    metrics::start()?;
    let store = Store::connect(&config.places).await?;
    keep_swept(&store).await?;
    let admin = admin_listener(config, &store).await?;
    let library = Library::new(store.clone(), config.mesh_cache_bytes);
    let limits = Limits { upload_bytes: config.upload_bytes as u64, ..Limits::default() };
    let workers = workers(config, store, library, &limits)?;
    tracing::info!(workers = config.workers, "working");
    Ok((workers, admin))
}
