//! Keys of a tenant: create, list, rotate, revoke. The key itself is only in the response to its creation.

use axum::extract::Request;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::routes;

use super::error::{ApiError, ApiResult};
use super::paging::PageParameters;
use super::parameters::{KeyId, Parameters};
use super::resources::Resources;
use super::{Service, body, json, time, with_header};
use crate::schema::key::{Key, KeyDocument, RotationDocument, Scope, is_key_id, scopes_of};
use crate::schema::wire::strict;
use crate::store::{KeyRow, Store};

pub fn router() -> Resources {
    Resources::new()
        .reads(Scope::Admin, routes!(list))
        .changes(Scope::Admin, routes!(create))
        .changes(Scope::Admin, routes!(revoke))
        .changes(Scope::Admin, routes!(rotate))
        .json_only()
}

/// A key without its secret.
#[derive(Serialize, ToSchema)]
pub struct KeyView {
    pub id: String,
    pub label: String,
    pub scopes: Vec<Scope>,
    /// RFC 3339, UTC.
    pub created: String,
    /// When it expires.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub expires: Option<String>,
    /// When it was revoked.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub revoked: Option<String>,
}

#[derive(Serialize, ToSchema)]
pub struct KeyList {
    pub items: Vec<KeyView>,
    /// The cursor of the next page; absent on the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    next: Option<String>,
}

/// A key, shown only this once.
#[derive(Serialize, ToSchema)]
pub struct NewKey {
    pub id: String,
    /// To be sent as `Authorization: Bearer KEY`. It cannot be shown again.
    pub key: String,
}

impl KeyView {
    fn of(row: &KeyRow) -> ApiResult<KeyView> {
        let scopes = scopes_of(&row.scopes).map_err(ApiError::unreadable("key", &row.id))?;
        Ok(KeyView {
            id: row.id.clone(),
            label: row.label.clone(),
            scopes: scopes.into_iter().collect(),
            created: time::rfc3339(row.created),
            expires: row.expires.map(time::rfc3339),
            revoked: row.revoked.map(time::rfc3339),
        })
    }
}

/// A page of the keys of a tenant.
pub async fn listed(store: &Store, parameters: &PageParameters) -> ApiResult {
    let page = parameters.page_by(is_key_id)?;
    let mut rows = store.keys(page.after.as_deref(), page.rows()).await?;
    let next = page.cut(&mut rows, |row| &row.id);
    let items = rows.iter().map(KeyView::of).collect::<ApiResult<_>>()?;
    Ok(json(StatusCode::OK, &KeyList { items, next }))
}

/// The response with a key.
pub fn shown(key: Key) -> Response {
    let place = format!("/v1/keys/{}", key.id);
    let new = NewKey { id: key.id, key: key.text };
    with_header(json(StatusCode::CREATED, &new), header::LOCATION, &place)
}

/// Revokes a key of a tenant.
pub async fn revoked(store: &Store, id: &str) -> ApiResult {
    match store.revoke_key(id).await? {
        true => Ok(StatusCode::NO_CONTENT.into_response()),
        false => Err(no_such_key()),
    }
}

/// Creates a key to replace another of its tenant.
pub async fn rotated(store: &Store, id: &str, rotation: RotationDocument) -> ApiResult {
    rotation.check()?;
    let key = store.rotate_key(id, rotation.overlap_h).await?;
    key.map(shown).ok_or_else(no_such_key)
}

fn no_such_key() -> ApiError {
    ApiError::not_found("key that is in force")
}

/// The keys of the tenant, oldest first, including invalid ones.
#[utoipa::path(get, path = "/v1/keys", operation_id = "list_keys", tag = "keys", params(PageParameters), responses((status = 200, description = "a page of them", body = KeyList)))]
async fn list(service: Service, Parameters(parameters): Parameters<PageParameters>) -> ApiResult {
    listed(&service.store, &parameters).await
}

/// Creates a key.
#[utoipa::path(
    post, path = "/v1/keys", operation_id = "create_key", tag = "keys", request_body = KeyDocument,
    responses((status = 201, description = "the key, this once", body = NewKey, headers(("Location" = String, description = "the key"))))
)]
async fn create(service: Service, request: Request) -> ApiResult {
    let bytes = body::json(&service, request).await?;
    let wanted: KeyDocument = strict::parse(&bytes, &service.limits)?;
    wanted.check()?;
    Ok(shown(service.store.make_key(&wanted).await?))
}

/// Revokes a key at once.
#[utoipa::path(
    delete, path = "/v1/keys/{id}", operation_id = "revoke_key", tag = "keys", params(("id" = String, Path, description = "the middle part of the key")),
    responses((status = 204, description = "requests with it are refused"))
)]
async fn revoke(service: Service, KeyId(id): KeyId) -> ApiResult {
    revoked(&service.store, &id).await
}

/// Creates a key with the same scopes, and lets the old one expire after a while.
#[utoipa::path(
    post, path = "/v1/keys/{id}/rotation", operation_id = "rotate_key", tag = "keys", params(("id" = String, Path, description = "the middle part of the key")),
    request_body = RotationDocument,
    responses((status = 201, description = "the new key, this once", body = NewKey, headers(("Location" = String, description = "the key"))))
)]
async fn rotate(service: Service, KeyId(id): KeyId, request: Request) -> ApiResult {
    let bytes = body::json(&service, request).await?;
    rotated(&service.store, &id, strict::parse(&bytes, &service.limits)?).await
}
