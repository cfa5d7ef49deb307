//! Liveness and readiness of the process.

use std::time::Duration;

use axum::http::StatusCode;
use axum::response::Response;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::routes;

use super::error::{ApiError, ApiResult};
use super::resources::Resources;
use super::{Service, json};
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;
use crate::store::{StorageFault, StoreError};

/// The longest wait that is still useful to a request.
const READY_WITHIN: Duration = Duration::from_secs(2);

#[derive(Serialize, Deserialize, ToSchema)]
pub struct Health {
    /// `ok`.
    pub status: String,
}

pub fn router() -> Resources {
    Resources::new().open(routes!(healthz)).open(routes!(readyz)).json_only()
}

/// Liveness of the process, without other checks.
#[utoipa::path(get, path = "/healthz", tag = "health", responses((status = 200, description = "alive", body = Health)))]
async fn healthz() -> Response {
    json(StatusCode::OK, &Health { status: "ok".into() })
}

/// Readiness for requests: the database answers and took a row within the last second, in less than two; the
/// folder takes a file; there is space for uploads and for erasures. A tenant beyond its share of permits gets
/// 503 `busy` from a service that is ready.
#[utoipa::path(get, path = "/readyz", tag = "health", responses((status = 200, description = "ready", body = Health)))]
async fn readyz(service: Service) -> ApiResult {
    let mut failing: Vec<String> = Vec::new();
    let mut remedy = String::new();
    let floor = service.config.free_space_floor_bytes;
    let (database, storage) =
        tokio::join!(in_time(service.store.ping()), service.store.storage_faults(floor));
    if let Err(error) = database {
        tracing::warn!(%error, "the database does not answer");
        if matches!(error, StoreError::DatabaseFile(_)) {
            remedy = format!("; {error}");
        }
        failing.push("database".into());
    }
    for StorageFault { check, reason } in storage {
        tracing::warn!(check, %reason, "the storage fails");
        failing.push(check.into());
    }
    if failing.is_empty() {
        return Ok(json(StatusCode::OK, &Health { status: "ok".into() }));
    }
    let detail = format!("failing: {}{remedy}", failing.join(", "));
    Err(ApiError::from(Problem::new(ErrorCode::NotReady, detail).with("checks", failing)))
}

async fn in_time(check: impl Future<Output = Result<(), StoreError>>) -> Result<(), StoreError> {
    let late = |_| Err(StoreError::Files(std::io::ErrorKind::TimedOut.into()));
    tokio::time::timeout(READY_WITHIN, check).await.unwrap_or_else(late)
}
