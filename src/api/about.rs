//! What the service is: its limits, its methods, its description.

use std::sync::Arc;

use axum::Extension;
use axum::http::StatusCode;
use axum::response::Response;
use utoipa_axum::routes;

use super::resources::Resources;
use super::{Service, json};
use crate::schema::Limits;
use crate::schema::key::Scope;
use crate::schema::methods::{MethodList, available_methods};

/// The description of the service, made once from all of its routes.
#[derive(Clone)]
pub struct Description(pub Arc<serde_json::Value>);

pub fn router() -> Resources {
    let router = Resources::new().looks(Scope::Read, routes!(limits));
    router.looks(Scope::Read, routes!(methods)).open(routes!(description)).json_only()
}

/// Every bound that is enforced.
#[utoipa::path(get, path = "/v1/limits", operation_id = "show_limits", tag = "about", responses((status = 200, description = "the limits", body = Limits)))]
async fn limits(service: Service) -> Response {
    json(StatusCode::OK, &*service.limits)
}

/// The ways of modelling that a spec may name.
#[utoipa::path(get, path = "/v1/methods", operation_id = "list_methods", tag = "about", responses((status = 200, description = "the methods", body = MethodList)))]
async fn methods() -> Response {
    json(StatusCode::OK, &available_methods())
}

/// This description.
#[utoipa::path(get, path = "/openapi.json", operation_id = "describe_service", tag = "about", responses((status = 200, description = "OpenAPI 3.1", body = serde_json::Value)))]
async fn description(Extension(description): Extension<Description>) -> Response {
    json(StatusCode::OK, &*description.0)
}
