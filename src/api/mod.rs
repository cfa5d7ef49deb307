//! HTTP: one file for each resource, each with its `router()`.

mod about;
mod access;
pub mod admin;
mod audit;
mod body;
mod caller;
mod case_draft;
mod cases;
mod client;
mod conditional;
pub mod connections;
mod deeds;
mod error;
mod events;
mod gone;
mod guard;
mod health;
mod idempotency;
mod job_input;
mod job_view;
mod jobs;
mod keys;
mod meshes;
mod openapi;
mod openapi_types;
mod origins;
mod paging;
mod parameters;
mod plans;
mod prefer;
mod rate;
mod report;
mod resources;
mod responses;
mod results;
mod streams;
mod time;

use std::sync::Arc;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use tokio::sync::Semaphore;
use tower_http::catch_panic::CatchPanicLayer;

use crate::config::Config;
use crate::library::meshes::Library;
use crate::library::responses::Responses;
use crate::schema::Limits;
use crate::store::Store;
use crate::worker::niceness::give_way;
use crate::worker::process::slot_bytes;

pub use openapi::document;
use resources::Resources;

/// Meshes that are parsed at the same time: each may take several times its size in memory.
const PARSED_AT_ONCE: usize = 2;

/// Where the description is shown to people.
const PAGES: &[&str] = &["/docs", "/docs/", "/docs/{*rest}"];

/// What every request may use.
#[derive(Clone)]
pub struct Service {
    pub config: Arc<Config>,
    pub limits: Arc<Limits>,
    pub store: Store,
    pub library: Library,
    pub responses: Responses,
    parsing: Arc<Semaphore>,
    rates: Arc<rate::Rates>,
    pub streams: streams::Streams,
}

/// The limits that these settings give.
pub fn limits(config: &Config) -> Limits {
    let mut limits = Limits {
        upload_bytes: config.upload_bytes as u64,
        requests_per_minute: config.requests_per_minute,
        event_streams: config.event_streams,
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
            streams: streams::Streams::new(limits.event_streams),
            parsing: Arc::new(Semaphore::new(PARSED_AT_ONCE)),
            rates: Arc::new(rate::Rates::new(limits.requests_per_minute)),
        }
    }

    /// The same service in the hand of a tenant.
    fn of_tenant(&self, tenant: &str) -> Service {
        Service {
            store: self.store.of_tenant(tenant),
            library: self.library.of_tenant(tenant),
            responses: self.responses.of_tenant(tenant),
            ..self.clone()
        }
    }

    /// Runs work that takes a processor for long, a few at a time, each on a thread of its own that gives way to those
    /// that answer.
    async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> error::ApiResult<T> {
        let permit = self.parsing.clone().acquire_owned().await;
        let _permit = permit.map_err(error::ApiError::internal)?;
        let (done, made) = tokio::sync::oneshot::channel();
        let patient = move || {
            give_way();
            // Nobody waits any more where the client has gone.
            let _ = done.send(work());
        };
        let thread = std::thread::Builder::new().name("parser".to_owned()).spawn(patient);
        thread.map_err(error::ApiError::internal)?;
        // A thread that panics drops its end.
        made.await.map_err(error::ApiError::internal)
    }
}

/// The resources with their descriptions, before anything is laid around them.
fn resources() -> Resources {
    Resources::new()
        .merge(health::router())
        .merge(about::router())
        .merge(meshes::router())
        .merge(cases::router())
        .merge(plans::router())
        .merge(jobs::router())
        .merge(events::router())
        .merge(results::router())
        .merge(report::router())
        .merge(responses::router())
        .merge(keys::router())
        .merge(audit::router())
        .pages(PAGES)
}

/// Everything that is served.
pub fn router(service: Service) -> Router {
    let Resources { router, declared } = resources();
    let resources: Router<Service> = router.into();
    let door = guard::Door { service: service.clone(), declared: declared.into() };
    let pages = utoipa_swagger_ui::SwaggerUi::new("/docs")
        .config(utoipa_swagger_ui::Config::from("/openapi.json"));
    let origins = origins::allowed(&service.config.allowed_origins);
    let router = resources
        .route_layer(from_fn_with_state(service.clone(), gone::tell))
        .merge(pages)
        .fallback(|| async { error::ApiError::not_found("resource") })
        .layer(DefaultBodyLimit::disable())
        .layer(CatchPanicLayer::custom(guard::after_panic))
        .layer(from_fn_with_state(door, guard::surround))
        .with_state(service);
    match origins {
        Some(origins) => router.layer(origins),
        None => router,
    }
}

/// An answer in JSON that no cache keeps.
fn json(status: StatusCode, body: &impl Serialize) -> Response {
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("application/json")),
        (header::CACHE_CONTROL, HeaderValue::from_static("private, no-store")),
    ];
    match serde_json::to_vec(body) {
        Ok(bytes) => (status, headers, bytes).into_response(),
        Err(error) => error::ApiError::internal(error).into_response(),
    }
}

/// The same answer with one more header.
fn with_header(mut response: Response, name: header::HeaderName, value: &str) -> Response {
    if let Ok(value) = HeaderValue::from_str(value) {
        response.headers_mut().insert(name, value);
    }
    response
}
