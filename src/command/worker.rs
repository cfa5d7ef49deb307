//! `facies worker`: workers without an API, beside any number of others on any hosts.

use std::sync::Arc;

use tokio::runtime::Handle;

use super::serve::{ServeError, keep_swept, stop_signal};
use super::settings::Arguments;
use crate::config::Config;
use crate::jobs::library::Library;
use crate::jobs::numerics::Numerics;
use crate::jobs::worker::Workers;
use crate::schema::Limits;
use crate::store::Store;
use crate::telemetry;

/// Works until the process is told to stop (SIGTERM or SIGINT).
pub fn run(arguments: &Arguments) -> Result<(), ServeError> {
    let given = arguments.given()?;
    let config = Config::without_listener(|name| given.get(name))?;
    config.places.check_shared()?;
    telemetry::start(&config.log)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let workers = runtime.block_on(start(&config))?;
    // One line on standard output, for programs that started this one.
    println!("working with {} workers", config.workers);
    runtime.block_on(stop_signal());
    tracing::info!("stopping");
    workers.stop(config.grace);
    runtime.shutdown_background();
    Ok(())
}

async fn start(config: &Config) -> Result<Workers, ServeError> {
    let store = Store::connect(&config.places).await?;
    keep_swept(&store).await?;
    let library = Library::new(store.clone(), config.mesh_cache_bytes);
    let runtime = Handle::current();
    let source = library.source(runtime.clone(), Default::default());
    let limits = Limits { upload_bytes: config.upload_bytes as u64, ..Limits::default() };
    let workers = Workers::start(store, config, Arc::new(Numerics { source, limits }), runtime)?;
    tracing::info!(workers = config.workers, "working");
    Ok(workers)
}
