//! Admin listener for operators: metrics, liveness, and administration across tenants. It has a separate address,
//! which clients do not reach.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::{MatchedPath, Path, Request, State};
use axum::handler::Handler;
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodFilter, MethodRouter, on};
use bytes::Bytes;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use tokio::{net::TcpListener, time::timeout};
use utoipa::IntoParams;

use super::access::{Access, Audit, Declared, RouteAccess};
use super::audit::{self, AuditParameters};
use super::audited::{audited_admin_action, carry_out, erased};
use super::body::BodyState;
use super::caller::bearer;
use super::content_digest::ContentDigest;
use super::error::{ApiError, ApiResult};
use super::hosts::{Hosts, check_named_once};
use super::key_lookup::unauthorized;
use super::known_parameters::KnownParameters;
use super::middleware::{check_transfer_coding, named};
use super::paging::PageParameters;
use super::parameters::Parameters;
use super::{body, json, keys, server_loop, time};
use crate::config::{Config, Secret};
use crate::metrics::{self, QueueCounts};
use crate::schema::Limits;
use crate::schema::key::{
    KeyDocument, RETENTION_DAYS, RotationDocument, Scope, TENANT_NAMES, is_key_id, is_tenant,
};
use crate::schema::wire::strict;
use crate::store::{AuditedAction, Chain, LostRow, QueueRow, Store, StoreError, TenantRow};
use crate::worker::process::memory::usage;

const PROMETHEUS: &str = "text/plain; version=0.0.4; charset=utf-8";
/// How long a scrape waits for the database; Prometheus waits for 10 s.
const QUEUE_WITHIN: Duration = Duration::from_secs(5);

/// Shared state of the admin listener.
#[derive(Clone)]
struct AdminListener {
    store: Store,
    /// Key for all routes except metrics.
    key: Option<Arc<Secret>>,
    is_loopback: bool,
    /// Trusted hosts, if there is no key and all requests on loopback are served.
    hosts: Option<Arc<Hosts>>,
    /// How long a client may stall.
    patience: Duration,
}

/// Listens on an address and serves until the process ends; returns the address with its port.
pub async fn listen(
    address: SocketAddr,
    config: &Config,
    store: Store,
) -> std::io::Result<SocketAddr> {
    let listener = TcpListener::bind(address).await?;
    let address = listener.local_addr()?;
    let key = config.admin_key.clone().map(Arc::new);
    let is_loopback = address.ip().is_loopback();
    let hosts =
        (key.is_none() && is_loopback).then(|| Arc::new(Hosts::new(&config.allowed_hosts, &[])));
    let patience = config.body_idle;
    let admin = AdminListener { store, key, is_loopback, hosts, patience };
    // It answers for as long as the process lives.
    let never = std::future::pending();
    tokio::spawn(server_loop::serve(listener, router(admin), patience, never));
    tracing::info!(%address, "the admin listener answers");
    Ok(address)
}

fn router(admin: AdminListener) -> Router {
    let AdminRoutes { router, declared } = admin_routes();
    let door = AdminGuardState { admin: admin.clone(), declared: declared.into() };
    router.layer(from_fn_with_state(door, middleware)).with_state(admin)
}

/// All routes of this listener.
pub(super) fn admin_routes() -> AdminRoutes {
    AdminRoutes::default()
        .open("/metrics", counted)
        .open("/healthz", async || "ok\n")
        .open("/errors", async || super::error_page::page())
        .lists::<PageParameters, _>("/tenants", tenants)
        .changes(Method::PUT, "/tenants/{tenant}", set_tenant)
        .lists::<PageParameters, _>("/tenants/{tenant}/keys", list_keys)
        .changes(Method::POST, "/tenants/{tenant}/keys", create_key)
        .changes(Method::DELETE, "/tenants/{tenant}/keys/{id}", revoke_key)
        .changes(Method::POST, "/tenants/{tenant}/keys/{id}/rotation", rotate_key)
        .lists::<AuditParameters, _>("/audit", list_audit)
        .reads("/audit/check", check_audit)
        .lists::<PageParameters, _>("/lost-jobs", lost_jobs)
        .changes(Method::POST, "/lost-jobs/{id}/requeue", requeue)
}

/// Routes of the listener and their access requirements.
#[derive(Default)]
pub(super) struct AdminRoutes {
    router: Router<AdminListener>,
    pub(super) declared: Declared,
}

impl AdminRoutes {
    /// Open GET routes.
    fn open<T: 'static>(self, path: &str, handler: impl Handler<T, AdminListener>) -> AdminRoutes {
        self.with(Method::GET, path, Access::Open, on(MethodFilter::GET, handler))
    }

    /// Read-only GET routes without parameters.
    fn reads<T: 'static>(self, path: &str, handler: impl Handler<T, AdminListener>) -> AdminRoutes {
        let route = KnownParameters::default().guard(on(MethodFilter::GET, handler));
        self.with(Method::GET, path, Access::reads(Scope::Admin), route)
    }

    /// Read-only GET routes with parameters.
    fn lists<P: IntoParams, T: 'static>(
        self,
        path: &str,
        handler: impl Handler<T, AdminListener>,
    ) -> AdminRoutes {
        let route = KnownParameters::of::<P>().guard(on(MethodFilter::GET, handler));
        self.with(Method::GET, path, Access::reads(Scope::Admin), route)
    }

    /// What is to change stands in the path and the body.
    fn changes<T: 'static>(
        self,
        method: Method,
        path: &str,
        handler: impl Handler<T, AdminListener>,
    ) -> AdminRoutes {
        // A method that the router does not know gets no route.
        let Ok(filter) = MethodFilter::try_from(method.clone()) else { return self };
        let route = KnownParameters::default().guard(on(filter, handler));
        self.with(method, path, Access::changes(Scope::Admin), route)
    }

    fn with(
        mut self,
        method: Method,
        path: &str,
        access: Access,
        route: MethodRouter<AdminListener>,
    ) -> AdminRoutes {
        self.router = self.router.route(path, route);
        self.declared.add(path, method, access);
        self
    }
}

/// Shared state of the middleware.
#[derive(Clone)]
struct AdminGuardState {
    admin: AdminListener,
    declared: Arc<Declared>,
}

/// Requires the key, or a local client if there is none; audits changes.
async fn middleware(State(door): State<AdminGuardState>, request: Request, next: Next) -> Response {
    let id = uuid::Uuid::now_v7().to_string();
    if let Err(error) = door.admin.is_meant(&request) {
        return named(error.into_response(), &id);
    }
    let route = request.extensions().get::<MatchedPath>().map(MatchedPath::as_str);
    let audit = match door.declared.find(route, request.method()) {
        Ok(RouteAccess { access: Access::Open, .. }) => return named(next.run(request).await, &id),
        Ok(RouteAccess { access: Access::Key { audit, .. }, .. }) => audit,
        Err(error) => return named(error.into_response(), &id),
    };
    let admin = door.admin;
    if !admin.is_authorised(&request) {
        let error =
            unauthorized("administration needs the admin-key, as `Authorization: Bearer KEY`");
        return named(error.into_response(), &id);
    }
    let request = request.map(|body| body::moving(body, admin.patience));
    let audited = (audit == Audit::Noted).then(|| audited_admin_action(&request, &id)).flatten();
    let response = match audited {
        Some(audited) => noted(&admin.store, audited, request, next).await,
        None => next.run(request).await,
    };
    named(response, &id)
}

/// Response to a change by an operator, which is audited at once.
async fn noted(store: &Store, audited: AuditedAction, request: Request, next: Next) -> Response {
    let erases = request.method() == Method::DELETE;
    let intent = store.audit_intent(audited);
    let begun = intent.clone();
    let run = async move {
        match begun.begin().await {
            Ok(()) => next.run(request).await,
            Err(error) => ApiError::from(error).into_response(),
        }
    };
    match erases {
        true => carry_out(intent, BodyState::default(), erased(store.clone(), run)).await,
        false => carry_out(intent, BodyState::default(), run).await,
    }
}

/// A document, read like those of clients, so that each error is reported with its place.
fn document<T: DeserializeOwned>(headers: &HeaderMap, body: &Bytes) -> ApiResult<T> {
    body::require_json(headers)?;
    if let Some(mut digest) = ContentDigest::of(headers)? {
        digest.push(body);
        digest.check()?;
    }
    Ok(strict::parse(body, &Limits::default())?)
}

/// The metrics, with the present queue as far as the database tells it in time.
async fn counted(State(admin): State<AdminListener>) -> Response {
    let late = |_| Err(StoreError::Interrupted);
    let queue = match timeout(QUEUE_WITHIN, admin.store.queue()).await.unwrap_or_else(late) {
        Ok(QueueRow { waiting, running, oldest_ms }) => {
            Some(QueueCounts { waiting, running, oldest_ms })
        }
        Err(error) => {
            if !admin.store.is_closing() {
                tracing::warn!(%error, "the queue was not counted");
            }
            None
        }
    };
    if let Some(usage) = usage("self") {
        metrics::process_memory(usage.now_bytes);
    }
    ([(header::CONTENT_TYPE, PROMETHEUS)], metrics::render(queue)).into_response()
}

impl AdminListener {
    /// Refuses a request for an untrusted host name.
    fn is_meant(&self, request: &Request) -> ApiResult<()> {
        check_named_once(request)?;
        check_transfer_coding(request.headers())?;
        self.hosts.as_ref().map_or(Ok(()), |hosts| hosts.check(request))
    }

    fn is_authorised(&self, request: &Request) -> bool {
        match &self.key {
            Some(key) => bearer(request.headers()).is_some_and(|given| key.matches(given)),
            None => self.is_loopback,
        }
    }

    /// The store scoped to a tenant, which need not exist yet.
    fn of(&self, tenant: &str) -> ApiResult<Store> {
        match is_tenant(tenant) {
            true => Ok(self.store.of_tenant(tenant)),
            false => Err(ApiError::invalid_parameter("tenant", TENANT_NAMES)),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TenantDocument {
    #[serde(default, skip_deserializing)]
    name: String,
    /// Retention of unchanged resources in days; absent: until they are erased.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    retention_days: Option<i64>,
}

async fn tenants(
    State(admin): State<AdminListener>,
    Parameters(parameters): Parameters<PageParameters>,
) -> ApiResult {
    let page = parameters.page_by(is_tenant)?;
    let mut rows = admin.store.tenants(page.after.as_deref(), page.rows()).await?;
    let next = page.cut(&mut rows, |row| &row.name);
    let view =
        |row: TenantRow| TenantDocument { name: row.name, retention_days: row.retention_days };
    let items: Vec<_> = rows.into_iter().map(view).collect();
    Ok(page.linked(json(StatusCode::OK, &items), "/tenants", next))
}

async fn set_tenant(
    State(admin): State<AdminListener>,
    Path(tenant): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> ApiResult {
    let wanted: TenantDocument = document(&headers, &body)?;
    if wanted.retention_days.is_some_and(|days| !RETENTION_DAYS.contains(&days)) {
        let detail = "retention_days has to be 1 to 36500";
        return Err(ApiError::invalid_parameter("retention_days", detail));
    }
    admin.of(&tenant)?.retain(wanted.retention_days).await?;
    Ok(json(StatusCode::OK, &TenantDocument { name: tenant, ..wanted }))
}

async fn list_keys(
    State(admin): State<AdminListener>,
    Path(tenant): Path<String>,
    Parameters(parameters): Parameters<PageParameters>,
) -> ApiResult {
    keys::listed(&admin.of(&tenant)?, &parameters).await
}

async fn create_key(
    State(admin): State<AdminListener>,
    Path(tenant): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> ApiResult {
    let wanted: KeyDocument = document(&headers, &body)?;
    wanted.check()?;
    Ok(keys::shown(admin.of(&tenant)?.make_key(&wanted).await?))
}

async fn revoke_key(
    State(admin): State<AdminListener>,
    Path((tenant, id)): Path<(String, String)>,
) -> ApiResult {
    keys::revoked(&admin.of(&tenant)?, key_id(&id)?).await
}

async fn rotate_key(
    State(admin): State<AdminListener>,
    Path((tenant, id)): Path<(String, String)>,
    headers: HeaderMap,
    body: Bytes,
) -> ApiResult {
    let rotation: RotationDocument = document(&headers, &body)?;
    keys::rotated(&admin.of(&tenant)?, key_id(&id)?, rotation).await
}

fn key_id(text: &str) -> ApiResult<&str> {
    is_key_id(text).then_some(text).ok_or_else(|| ApiError::not_found("key"))
}

async fn list_audit(
    State(admin): State<AdminListener>,
    Parameters(parameters): Parameters<AuditParameters>,
) -> ApiResult {
    audit::page(&admin.store, "", &parameters).await
}

/// Whether the log is intact, and the hash of its last row.
async fn check_audit(State(admin): State<AdminListener>) -> ApiResult {
    let found = match admin.store.check_audit().await? {
        Chain::Whole { rows, hash } => {
            serde_json::json!({"status": "whole", "rows": rows, "hash": hash})
        }
        Chain::Broken { at } => serde_json::json!({"status": "broken", "at": at}),
    };
    Ok(json(StatusCode::OK, &found))
}

#[derive(Serialize)]
struct LostJob {
    id: String,
    tenant: String,
    kind: String,
    attempts: i64,
    finished: String,
    error: serde_json::Value,
}

/// Jobs that failed by infrastructure, oldest first.
async fn lost_jobs(
    State(admin): State<AdminListener>,
    Parameters(parameters): Parameters<PageParameters>,
) -> ApiResult {
    let page = parameters.page()?;
    let mut rows = admin.store.lost_jobs(page.after.as_deref(), page.rows()).await?;
    let next = page.cut(&mut rows, |row| &row.id);
    let view = |LostRow { id, tenant, kind, attempt, finished, error }| -> ApiResult<LostJob> {
        let error = serde_json::from_str(&error).map_err(ApiError::unreadable("job", &id))?;
        let finished = time::rfc3339(finished);
        Ok(LostJob { id, tenant, kind, attempts: attempt, finished, error })
    };
    let items = rows.into_iter().map(view).collect::<ApiResult<Vec<_>>>()?;
    Ok(page.linked(json(StatusCode::OK, &items), "/lost-jobs", next))
}

async fn requeue(State(admin): State<AdminListener>, Path(id): Path<String>) -> ApiResult {
    match admin.store.requeue(&id).await? {
        true => Ok(StatusCode::NO_CONTENT.into_response()),
        false => Err(ApiError::not_found("job that was lost")),
    }
}
