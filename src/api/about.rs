//! Description of the service: its entry point, limits, methods and OpenAPI description.

use std::collections::BTreeMap;
use std::sync::Arc;

use axum::Extension;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::Response;
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::routes;

use super::error::ApiResult;
use super::middleware::preferred;
use super::resources::Resources;
use super::{Service, json, with_header};
use crate::schema::Limits;
use crate::schema::case::preset::MaterialList;
use crate::schema::key::Scope;
use crate::schema::methods::{MethodList, available_methods};

/// The OpenAPI description of the service, built once from all routes.
#[derive(Clone)]
pub struct Description(pub Arc<serde_json::Value>);

pub fn router() -> Resources {
    let router = Resources::new().reads(Scope::Read, routes!(limits));
    let router = router.reads(Scope::Read, routes!(materials));
    let router = router.reads(Scope::Read, routes!(methods)).open(routes!(description));
    router.open(routes!(versions)).json_only().open(routes!(entrance))
}

/// The entry point of the service.
#[derive(Serialize, ToSchema)]
struct Entrance {
    /// `facies`.
    name: &'static str,
    version: &'static str,
    /// Not a medical device.
    notice: &'static str,
    /// Addresses of resources on this service, by name.
    links: BTreeMap<&'static str, &'static str>,
}

const LINKS: [(&str, &str); 10] = [
    ("cases", "/v1/cases"),
    ("description", "/openapi.json"),
    ("documentation", "/docs/"),
    ("health", "/healthz"),
    ("jobs", "/v1/jobs"),
    ("limits", "/v1/limits"),
    ("materials", "/v1/materials"),
    ("meshes", "/v1/meshes"),
    ("methods", "/v1/methods"),
    ("readiness", "/readyz"),
];

fn first_answer() -> Response {
    let notice =
        "Predicts how a face will look after the bones under it are moved. Not a medical device.";
    let version = env!("CARGO_PKG_VERSION");
    json(StatusCode::OK, &Entrance { name: "facies", version, notice, links: LINKS.into() })
}

/// Entry point: a page for people, the addresses of all resources for programs.
#[utoipa::path(get, path = "/", operation_id = "show_entrance", tag = "about", responses((status = 200, description = "the entry point", content(
    (Entrance = "application/json"), (String = "text/html")))))]
async fn entrance(headers: HeaderMap) -> ApiResult {
    if preferred(&headers, &["application/json", "text/html"])? == 0 {
        return Ok(with_header(first_answer(), header::VARY, "Accept"));
    }
    Ok(with_header(super::page::page(), header::VARY, "Accept"))
}

/// The available version of the API, and its addresses.
#[utoipa::path(get, path = "/v1", operation_id = "show_version", tag = "about", responses((status = 200, description = "the entry point", body = Entrance)))]
async fn versions() -> Response {
    first_answer()
}

/// Every enforced bound.
#[utoipa::path(get, path = "/v1/limits", operation_id = "show_limits", tag = "about", responses((status = 200, description = "the limits", body = Limits)))]
async fn limits(service: Service) -> Response {
    json(StatusCode::OK, &*service.limits)
}

/// The models that a spec may name.
#[utoipa::path(get, path = "/v1/methods", operation_id = "list_methods", tag = "about", responses((status = 200, description = "the methods", body = MethodList)))]
async fn methods() -> Response {
    json(StatusCode::OK, &available_methods())
}

/// The materials of the literature that a material may name, with source, state and objections.
#[utoipa::path(get, path = "/v1/materials", operation_id = "list_materials", tag = "about", responses((status = 200, description = "the materials", body = MaterialList)))]
async fn materials() -> Response {
    json(StatusCode::OK, &MaterialList::all())
}

/// This OpenAPI description.
#[utoipa::path(get, path = "/openapi.json", operation_id = "describe_service", tag = "about", responses((status = 200, description = "OpenAPI 3.1", body = serde_json::Value)))]
async fn description(Extension(description): Extension<Description>) -> Response {
    json(StatusCode::OK, &*description.0)
}
