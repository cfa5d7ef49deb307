//! All resources of the service with their descriptions, scopes and audit classes.

use super::resources::Resources;

/// The address of the description for people.
pub(super) const PAGES: &[&str] = &["/docs", "/docs/", "/docs/{*rest}"];

/// The resources with their descriptions, without middleware.
pub(super) fn resources() -> Resources {
    Resources::new()
        .merge(super::health::router())
        .merge(super::about::router())
        .merge(super::error_page::router())
        .merge(super::packages::router())
        .merge(super::page::router())
        .merge(super::meshes::router())
        .merge(super::cases::router())
        .merge(super::plans::router())
        .merge(super::cohorts::router())
        .merge(super::jobs::router())
        .merge(super::events::router())
        .merge(super::results::router())
        .merge(super::report::router())
        .merge(super::responses::router())
        .merge(super::keys::router())
        .merge(super::audit::router())
        .pages(PAGES)
}
