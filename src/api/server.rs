//! Router of the service: the resources and the middleware around them.

use super::resources::Resources;
use super::routes::resources;
use super::service::Service;
use axum::extract::DefaultBodyLimit;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::{Extension, Router};
use tower_http::catch_panic::CatchPanicLayer;

/// The whole router.
pub fn router(service: Service) -> Router {
    let Resources { router, declared } = resources();
    let resources: Router<Service> = router.into();
    let door =
        super::middleware::MiddlewareState { service: service.clone(), declared: declared.into() };
    let pages = utoipa_swagger_ui::SwaggerUi::new("/docs")
        .config(utoipa_swagger_ui::Config::from("/openapi.json").validator_url("none"));
    let pages: Router<Service> = Router::from(pages).layer(from_fn(super::headers::of_pages));
    let origins = super::origins::allowed(&service.config.allowed_origins);
    let router = resources
        .route_layer(from_fn_with_state(service.clone(), super::gone::tell))
        .merge(pages)
        .fallback(|| async { super::error::ApiError::not_found("resource") })
        .layer(DefaultBodyLimit::disable())
        .layer(CatchPanicLayer::custom(super::middleware::after_panic))
        .layer(from_fn_with_state(door, super::middleware::surround))
        .layer(Extension(super::about::Description(super::openapi::document().into())))
        .with_state(service);
    match origins {
        Some(origins) => router.layer(origins),
        None => router,
    }
}
