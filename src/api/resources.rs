//! Routes of the service, each with its scope and audit class.

use axum::http::Method;
use axum::middleware::from_fn;
use utoipa::openapi::PathItem;
use utoipa::openapi::path::Operation;
use utoipa_axum::router::{OpenApiRouter, UtoipaMethodRouter};

use super::Service;
use super::access::{Access, Declared};
use super::known_parameters::KnownParameters;
use super::middleware;
use crate::schema::key::Scope;

/// Where the addresses of the interface begin; others are pages and probes.
const INTERFACE: &str = "/v1";

/// Routes with their descriptions and access requirements.
pub struct Resources {
    pub router: OpenApiRouter<Service>,
    pub declared: Declared,
}

impl Resources {
    pub fn new() -> Resources {
        Resources { router: OpenApiRouter::new(), declared: Declared::default() }
    }

    /// Routes without a key.
    pub fn open(self, routes: UtoipaMethodRouter<Service>) -> Resources {
        self.with(Access::Open, routes)
    }

    /// Read-only routes.
    pub fn reads(self, scope: Scope, routes: UtoipaMethodRouter<Service>) -> Resources {
        self.with(Access::reads(scope), routes)
    }

    /// Routes with changes.
    pub fn changes(self, scope: Scope, routes: UtoipaMethodRouter<Service>) -> Resources {
        self.with(Access::changes(scope), routes)
    }

    /// Declares open routes of a library.
    pub fn pages(mut self, routes: &[&str]) -> Resources {
        for route in routes {
            self.declared.add(route, Method::GET, Access::Open);
        }
        self
    }

    fn with(mut self, access: Access, routes: UtoipaMethodRouter<Service>) -> Resources {
        let (schemas, paths, mut handlers) = routes;
        for (path, item) in &paths.paths {
            let mut known = KnownParameters::default();
            for (method, operation) in operations(item) {
                known.add(method.clone(), operation);
                self.declared.add(path, method, access);
            }
            if path.starts_with(INTERFACE) {
                handlers = known.guard(handlers);
            }
        }
        let router = self.router.routes((schemas, paths, handlers));
        Resources { router, declared: self.declared }
    }

    /// The same routes, which produce JSON only.
    pub fn json_only(self) -> Resources {
        let router = self.router.route_layer(from_fn(middleware::accepts_json));
        Resources { router, ..self }
    }

    pub fn merge(mut self, other: Resources) -> Resources {
        self.declared.join(other.declared);
        Resources { router: self.router.merge(other.router), declared: self.declared }
    }
}

/// The operations of a path.
fn operations(item: &PathItem) -> impl Iterator<Item = (Method, &Operation)> {
    let operations = [
        (Method::GET, &item.get),
        (Method::PUT, &item.put),
        (Method::POST, &item.post),
        (Method::DELETE, &item.delete),
        (Method::OPTIONS, &item.options),
        (Method::HEAD, &item.head),
        (Method::PATCH, &item.patch),
        (Method::TRACE, &item.trace),
    ];
    operations.into_iter().filter_map(|(method, operation)| Some((method, operation.as_ref()?)))
}
