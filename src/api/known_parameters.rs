//! Refusal of query parameters that the description of an operation does not have: one that is ignored would be a silent
//! default.

use std::collections::HashMap;
use std::sync::Arc;

use axum::extract::{Query, Request, State};
use axum::http::{Method, Uri};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::MethodRouter;
use utoipa::IntoParams;
use utoipa::openapi::RefOr;
use utoipa::openapi::path::{Operation, Parameter, ParameterIn};

use super::error::{ApiError, ApiResult};

/// The query parameters of a route, by method.
#[derive(Default)]
pub struct KnownParameters(HashMap<Method, Vec<String>>);

impl KnownParameters {
    /// The parameters of a route without a description, for GET.
    pub fn of<P: IntoParams>() -> KnownParameters {
        let names = P::into_params(|| Some(ParameterIn::Query));
        KnownParameters([(Method::GET, names.into_iter().map(|own| own.name).collect())].into())
    }

    /// Takes the parameters of an operation from its description.
    pub fn add(&mut self, method: Method, operation: &Operation) {
        let of_query = |parameter: &RefOr<Parameter>| match parameter {
            RefOr::T(parameter) if parameter.parameter_in == ParameterIn::Query => {
                Some(parameter.name.clone())
            }
            RefOr::T(_) | RefOr::Ref(_) => None,
        };
        let all = operation.parameters.iter().flatten();
        self.0.insert(method, all.filter_map(of_query).collect());
    }

    /// A route that refuses other parameters.
    pub fn guard<S: Clone + Send + Sync + 'static>(
        self,
        route: MethodRouter<S>,
    ) -> MethodRouter<S> {
        route.route_layer(from_fn_with_state(Arc::new(self), refuse_unknown))
    }

    fn check(&self, method: &Method, uri: &Uri) -> ApiResult<()> {
        // Who answers GET answers HEAD.
        let method = if method == Method::HEAD { &Method::GET } else { method };
        let known = self.0.get(method).map(Vec::as_slice).unwrap_or_default();
        let given = Query::<Vec<(String, String)>>::try_from_uri(uri);
        let Query(given) =
            given.map_err(|error| ApiError::invalid_parameter("query", error.body_text()))?;
        let Some((name, _)) = given.iter().find(|(name, _)| !known.contains(name)) else {
            return Ok(());
        };
        let known = match known {
            [] => "none".to_owned(),
            known => known.join(", "),
        };
        let detail = format!("unknown parameter {name:?}: this request has {known}");
        Err(ApiError::invalid_parameter(name, detail))
    }
}

async fn refuse_unknown(
    State(known): State<Arc<KnownParameters>>,
    request: Request,
    next: Next,
) -> Response {
    match known.check(request.method(), request.uri()) {
        Ok(()) => next.run(request).await,
        Err(error) => error.into_response(),
    }
}
