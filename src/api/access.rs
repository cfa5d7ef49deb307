//! Scope and audit class of each request, declared where its route is registered; nothing is parsed from
//! the text of a path.

use std::collections::{BTreeMap, HashMap};

use axum::http::Method;

use super::error::{ApiError, ApiResult};
use crate::schema::key::Scope;

/// Whether a request is audited. One that its key does not allow always is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Audit {
    Noted,
    Unnoted,
}

/// The access requirements of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// No key: for probes, and for pages without data, for which a browser cannot send one. Not audited.
    Open,
    /// A key with this scope.
    Key { scope: Scope, audit: Audit },
}

impl Access {
    /// For read-only routes.
    pub const fn reads(scope: Scope) -> Access {
        Access::Key { scope, audit: Audit::Unnoted }
    }

    pub const fn changes(scope: Scope) -> Access {
        Access::Key { scope, audit: Audit::Noted }
    }
}

/// The access requirements of each route, by the pattern of its path and by method.
#[derive(Clone, Debug, Default)]
pub struct Declared(BTreeMap<String, HashMap<Method, Access>>);

/// The declared access of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RouteAccess {
    pub access: Access,
    /// False if there is no handler, so that the response is 404 or 405.
    pub is_answered: bool,
}

impl Declared {
    pub fn add(&mut self, route: &str, method: Method, access: Access) {
        self.0.entry(route.to_owned()).or_default().insert(method, access);
    }

    pub fn join(&mut self, other: Declared) {
        for (route, methods) in other.0 {
            self.0.entry(route).or_default().extend(methods);
        }
    }

    pub fn access(&self, route: &str, method: &Method) -> Option<Access> {
        // Who answers GET answers HEAD.
        let method = if method == Method::HEAD { &Method::GET } else { method };
        self.0.get(route)?.get(method).copied()
    }

    /// The access requirements of a request; `route` is the pattern that it matches, if any. A route without declaration is
    /// closed to all.
    pub fn find(&self, route: Option<&str>, method: &Method) -> ApiResult<RouteAccess> {
        let Some(route) = route else {
            return Ok(RouteAccess { access: for_unknown_route(method), is_answered: false });
        };
        if let Some(access) = self.access(route, method) {
            return Ok(RouteAccess { access, is_answered: true });
        }
        let methods = self.0.get(route).ok_or_else(|| {
            ApiError::internal(format!("no scope is declared for {method} {route}"))
        })?;
        let is_open = methods.values().all(|access| *access == Access::Open);
        let access = if is_open { Access::Open } else { for_unknown_route(method) };
        Ok(RouteAccess { access, is_answered: false })
    }
}

/// The access requirements of a request without a handler: it has no effect, and attempted changes are audited.
fn for_unknown_route(method: &Method) -> Access {
    match *method {
        Method::GET | Method::HEAD | Method::OPTIONS => Access::reads(Scope::Read),
        _ => Access::changes(Scope::Write),
    }
}

#[cfg(test)]
#[path = "access_tests.rs"]
mod tests;
