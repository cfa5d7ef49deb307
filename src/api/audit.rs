//! The audit log of a tenant.

use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::routes;

use super::error::{ApiError, ApiResult};
use super::paging::checked_limit;
use super::parameters::Parameters;
use super::resources::Resources;
use super::{Service, json, time};
use crate::schema::key::Scope;
use crate::store::{AuditRow, Store};

pub fn router() -> Resources {
    Resources::new().reads(Scope::Admin, routes!(list)).json_only()
}

/// An audited action.
#[derive(Serialize, ToSchema)]
pub struct AuditView {
    pub number: i64,
    /// When it began; RFC 3339, UTC.
    pub at: String,
    pub tenant: String,
    /// The id of the key; `setting` for the key in the settings, `-` without a key, `admin` on the admin listener,
    /// `command` on the command line, `retention` for expired resources.
    pub actor: String,
    /// Method and route.
    pub action: String,
    /// The id of the changed resource; empty without one.
    pub object: String,
    /// The HTTP status; `done` or `failed` without a request; `unknown` if the process ended before the
    /// outcome was stored.
    pub outcome: String,
    /// The id of the request.
    pub request: String,
    /// SHA-256 of this row and of the hash of the previous row, of any tenant.
    pub hash: String,
}

#[derive(Serialize, ToSchema)]
pub struct AuditList {
    pub items: Vec<AuditView>,
}

#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct AuditParameters {
    /// Rows with a larger number; default: 0.
    #[param(minimum = 0)]
    after: Option<u64>,
    /// Default: 50.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
}

impl AuditView {
    fn of(row: AuditRow) -> AuditView {
        let AuditRow { number, at, audited, outcome, hash } = row;
        AuditView {
            number,
            at: time::rfc3339(at),
            tenant: audited.tenant,
            actor: audited.actor,
            action: audited.action,
            object: audited.object,
            outcome,
            request: audited.request,
            hash,
        }
    }
}

/// A page of rows, of a tenant or, if that is empty, of all.
pub async fn page(store: &Store, tenant: &str, parameters: &AuditParameters) -> ApiResult {
    let limit = checked_limit(parameters.limit)?;
    let after = i64::try_from(parameters.after.unwrap_or(0))
        .map_err(|_| ApiError::invalid_parameter("after", "there is no row of such a number"))?;
    let rows = store.audit(after, tenant, i64::from(limit)).await?;
    let items = rows.into_iter().map(AuditView::of).collect();
    Ok(json(StatusCode::OK, &AuditList { items }))
}

/// Audited actions, oldest first; the next page begins after the last number of this one.
#[utoipa::path(get, path = "/v1/audit", operation_id = "list_audit", tag = "keys", params(AuditParameters), responses((status = 200, description = "a page of it", body = AuditList)))]
async fn list(service: Service, Parameters(parameters): Parameters<AuditParameters>) -> ApiResult {
    page(&service.store, service.store.tenant(), &parameters).await
}
