use std::collections::BTreeSet;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::Request;
use axum::http::StatusCode;
use axum::middleware::from_fn_with_state;
use axum::routing::get;
use tower::ServiceExt as _;

use super::*;
use crate::api::middleware::{self, MiddlewareState};
use crate::api::{Service, admin, document};

/// Every route: its scope, and whether it is audited.
const SERVICE: &str = "
    GET     /                                   open
    GET     /assets/{file}                      open
    GET     /clients                            open
    GET     /clients/{file}                     open
    GET     /docs                               open
    GET     /docs/                              open
    GET     /docs/{*rest}                       open
    GET     /errors                             open
    GET     /healthz                            open
    GET     /openapi.json                       open
    GET     /readyz                             open
    GET     /v1                                 open
    GET     /v1/audit                           admin  -
    GET     /v1/cases                           read   -
    POST    /v1/cases                           write  noted
    DELETE  /v1/cases/{id}                      write  noted
    GET     /v1/cases/{id}                      read   -
    POST    /v1/cases/{id}/check                run    -
    GET     /v1/cases/{id}/plans                read   -
    POST    /v1/cases/{id}/plans                write  noted
    DELETE  /v1/cases/{id}/plans/{plan}         write  noted
    GET     /v1/cases/{id}/plans/{plan}         read   -
    PUT     /v1/cases/{id}/plans/{plan}         write  noted
    GET     /v1/cases/{id}/response             read   -
    POST    /v1/cases/{id}/response/apply       run    -
    GET     /v1/cohorts                         read   -
    POST    /v1/cohorts                         write  noted
    DELETE  /v1/cohorts/{id}                    write  noted
    GET     /v1/cohorts/{id}                    read   -
    GET     /v1/jobs                            read   -
    POST    /v1/jobs                            run    noted
    DELETE  /v1/jobs/{id}                       run    noted
    GET     /v1/jobs/{id}                       read   -
    PATCH   /v1/jobs/{id}                       run    noted
    GET     /v1/jobs/{id}/events                read   -
    GET     /v1/jobs/{id}/report                read   -
    GET     /v1/jobs/{id}/results               read   -
    GET     /v1/jobs/{id}/results/{file}        read   -
    GET     /v1/keys                            admin  -
    POST    /v1/keys                            admin  noted
    DELETE  /v1/keys/{id}                       admin  noted
    POST    /v1/keys/{id}/rotation              admin  noted
    GET     /v1/limits                          read   -
    GET     /v1/materials                       read   -
    POST    /v1/meshes                          write  noted
    DELETE  /v1/meshes/{id}                     write  noted
    GET     /v1/meshes/{id}                     read   -
    GET     /v1/meshes/{id}/content             read   -
    GET     /v1/methods                         read   -
";

/// The same of the admin listener.
const ADMINISTRATION: &str = "
    GET     /audit                              admin  -
    GET     /audit/check                        admin  -
    GET     /errors                             open
    GET     /healthz                            open
    GET     /lost-jobs                          admin  -
    POST    /lost-jobs/{id}/requeue             admin  noted
    GET     /metrics                            open
    GET     /tenants                            admin  -
    PUT     /tenants/{tenant}                   admin  noted
    GET     /tenants/{tenant}/keys              admin  -
    POST    /tenants/{tenant}/keys              admin  noted
    DELETE  /tenants/{tenant}/keys/{id}         admin  noted
    POST    /tenants/{tenant}/keys/{id}/rotation admin noted
";

/// The lines of a table, with words separated by single spaces.
fn lines(table: &str) -> BTreeSet<String> {
    let line = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    table.lines().map(line).filter(|line| !line.is_empty()).collect()
}

/// The declarations, as such lines.
fn told(declared: &Declared) -> BTreeSet<String> {
    let routes = declared.0.iter();
    let all = routes.flat_map(|(route, methods)| {
        methods.iter().map(move |(method, access)| match access {
            Access::Open => format!("{method} {route} open"),
            Access::Key { scope, audit: Audit::Noted } => {
                format!("{method} {route} {} noted", scope.name())
            }
            Access::Key { scope, audit: Audit::Unnoted } => {
                format!("{method} {route} {} -", scope.name())
            }
        })
    });
    all.collect()
}

fn assert_same(there: &BTreeSet<String>, table: &BTreeSet<String>) {
    let strays: Vec<_> = there.symmetric_difference(table).collect();
    assert!(strays.is_empty(), "only in one of the two: {strays:#?}");
}

#[test]
fn every_route_takes_the_scope_and_is_noted_as_the_table_says() {
    assert_same(&told(&crate::api::routes::resources().declared), &lines(SERVICE));
    assert_same(&told(&admin::admin_routes().declared), &lines(ADMINISTRATION));
}

#[test]
fn every_operation_of_the_description_is_in_the_table() {
    let document = document();
    let paths = document["paths"].as_object().unwrap().iter();
    let described: BTreeSet<String> = paths
        .flat_map(|(path, item)| {
            let methods = item.as_object().unwrap().keys();
            methods.map(move |method| format!("{} {path}", method.to_uppercase()))
        })
        .collect();
    let table = lines(SERVICE).into_iter().filter(|line| !line.starts_with("GET /docs"));
    let asked = |line: String| line.splitn(3, ' ').take(2).collect::<Vec<_>>().join(" ");
    assert_same(&described, &table.map(asked).collect());
}

#[test]
fn a_request_that_no_handler_answers_looks_or_changes_by_its_method() {
    let mut declared = Declared::default();
    declared.add("/v1/keys", Method::GET, Access::reads(Scope::Admin));
    declared.add("/healthz", Method::GET, Access::Open);
    let find = |route, method| {
        let found = declared.find(route, &method).unwrap();
        (found.access, found.is_answered)
    };
    assert_eq!(find(Some("/v1/keys"), Method::HEAD), (Access::reads(Scope::Admin), true));
    assert_eq!(find(Some("/v1/keys"), Method::PUT), (Access::changes(Scope::Write), false));
    assert_eq!(find(Some("/v1/keys"), Method::OPTIONS), (Access::reads(Scope::Read), false));
    assert_eq!(find(Some("/healthz"), Method::POST), (Access::Open, false));
    assert_eq!(find(None, Method::GET), (Access::reads(Scope::Read), false));
    assert_eq!(find(None, Method::DELETE), (Access::changes(Scope::Write), false));
}

/// The response of a service whose routes were not registered by `Resources`.
async fn answer(declared: Declared, method: Method, path: &str) -> (StatusCode, String) {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::example(folder.path(), &[]).await;
    let door = MiddlewareState { service: service.clone(), declared: declared.into() };
    let router = Router::new()
        .route("/v1/new", get(async |_: Service| "looked").put(async |_: Service| "changed"))
        .route("/v1/newer", get(async || "looked"))
        .layer(from_fn_with_state(door, middleware::surround))
        .with_state(service);
    let request = Request::builder().method(method).uri(path).header("host", "localhost");
    let request = request.body(Body::empty()).unwrap();
    let response = router.oneshot(request).await.unwrap();
    let status = response.status();
    let body = to_bytes(response.into_body(), 1 << 16).await.unwrap();
    (status, String::from_utf8(body.to_vec()).unwrap())
}

#[tokio::test]
async fn a_route_of_which_nothing_was_declared_is_closed() {
    let mut declared = Declared::default();
    declared.add("/v1/new", Method::GET, Access::reads(Scope::Read));
    let (status, body) = answer(declared.clone(), Method::GET, "/v1/new").await;
    assert_eq!((status, body.as_str()), (StatusCode::OK, "looked"));
    for (method, path) in [(Method::PUT, "/v1/new"), (Method::GET, "/v1/newer")] {
        let (status, body) = answer(declared.clone(), method, path).await;
        assert_eq!(status, StatusCode::INTERNAL_SERVER_ERROR, "{path}: {body}");
        assert!(body.contains(r#""code":"internal""#), "{body}");
    }
}
