//! `facies worker`: workers without an API, beside any number of others on any hosts.

use std::net::SocketAddr;

use super::serve::{
    ServeError, announce, listen_for_admin, open, start_workers, stop_signal, tell_admin,
};
use super::settings::Arguments;
use crate::api;
use crate::config::Config;
use crate::library::meshes::Library;
use crate::telemetry;
use crate::traces;
use crate::worker::fail_point;
use crate::worker::slots::Workers;

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
    announce(format_args!("working with {} workers", config.workers));
    tell_admin(admin);
    runtime.block_on(stop_signal());
    tracing::info!("stopping");
    workers.stop(config.grace);
    traces::stop();
    runtime.shutdown_background();
    Ok(())
}

async fn start(config: &Config) -> Result<(Workers, Option<SocketAddr>), ServeError> {
    let store = open(config).await?;
    let admin = listen_for_admin(config, &store).await?;
    let library = Library::new(store.clone(), config.mesh_cache_bytes);
    let workers = start_workers(config, store, library, &api::limits(config))?;
    tracing::info!(workers = config.workers, "working");
    Ok((workers, admin))
}
