//! The listener for those who run the service: what it counts, and whether the process lives. It has an address of its own, which clients
//! do not reach.

use std::net::SocketAddr;

use axum::Router;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use tokio::net::TcpListener;

use crate::metrics;
use crate::store::Store;

const PROMETHEUS: &str = "text/plain; version=0.0.4; charset=utf-8";

/// Listens on an address and answers until the process ends; the address with its port.
pub async fn listen(address: SocketAddr, store: Store) -> std::io::Result<SocketAddr> {
    let listener = TcpListener::bind(address).await?;
    let address = listener.local_addr()?;
    tokio::spawn(async move {
        if let Err(error) = axum::serve(listener, router(store)).await {
            tracing::error!(%error, "the admin listener ended");
        }
    });
    tracing::info!(%address, "the admin listener answers");
    Ok(address)
}

fn router(store: Store) -> Router {
    Router::new()
        .route("/metrics", get(counted))
        .route("/healthz", get(async || "ok\n"))
        .with_state(store)
}

/// What was counted, with the queue as it is at this moment.
async fn counted(State(store): State<Store>) -> Response {
    match store.queue().await {
        Ok(queue) => metrics::queue(queue.waiting, queue.running, queue.oldest_ms),
        Err(error) => tracing::warn!(%error, "the queue was not counted"),
    }
    ([(header::CONTENT_TYPE, PROMETHEUS)], metrics::render()).into_response()
}
