//! Scope and audit class of each request: each route says it where it is registered, and nothing is read from
//! the text of a path.

use std::collections::{BTreeMap, HashMap};

use axum::http::Method;

use super::error::{ApiError, ApiResult};
use crate::schema::key::Scope;

/// Whether a request goes into the audit log. One that its key does not allow always does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Audit {
    Noted,
    Unnoted,
}

/// What a request takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// No key: for probes, and for pages without data, for which a browser cannot send one. Not noted.
    Open,
    /// A key with this scope.
    Key { scope: Scope, audit: Audit },
}

impl Access {
    /// For routes that change nothing.
    pub const fn reads(scope: Scope) -> Access {
        Access::Key { scope, audit: Audit::Unnoted }
    }

    pub const fn changes(scope: Scope) -> Access {
        Access::Key { scope, audit: Audit::Noted }
    }
}

/// What was declared of each route, by the pattern of its path and by method.
#[derive(Clone, Debug, Default)]
pub struct Declared(BTreeMap<String, HashMap<Method, Access>>);

/// What was found for a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RouteAccess {
    pub access: Access,
    /// False where there is no handler, so that the answer is 404 or 405.
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

    /// What a request takes; `route` is the pattern that it matches, if any. A route of which nothing was declared is
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

/// What a request takes that no handler answers: nothing comes of it, and who tries to change something is noted.
fn for_unknown_route(method: &Method) -> Access {
    match *method {
        Method::GET | Method::HEAD | Method::OPTIONS => Access::reads(Scope::Read),
        _ => Access::changes(Scope::Write),
    }
}

#[cfg(test)]
#[path = "access_tests.rs"]
mod tests;
