//! The description of the service (OpenAPI 3.1), generated from the code.

use axum::http::Method;
use serde_json::json;
use std::collections::BTreeMap;
use utoipa::ToSchema as _;
use utoipa::openapi::path::Operation;
use utoipa::openapi::security::{Http, HttpAuthScheme, SecurityRequirement, SecurityScheme};
use utoipa::openapi::{
    ContentBuilder, InfoBuilder, OpenApi, OpenApiBuilder, PathItem, Ref, RefOr, ResponseBuilder,
};

use super::access::Access;
use super::resources::Resources;
use super::routes::resources;
use super::{examples, openapi_types};
use crate::schema::ProblemDocument;
use crate::schema::job::JobEvent;
use crate::schema::job_document::JobKind;

/// Problems of every operation: faults of the head of the request, and
/// failures of the service.
const ALWAYS: [(&str, &str); 11] = [
    ("400", "a parameter or a header is not valid"),
    ("401", "the service requires a key"),
    ("403", "the key does not allow it, or the request is from a page of another site"),
    ("406", "the header Accept does not allow the response"),
    ("414", "the address is too long"),
    ("421", "the service requires no key and the host name is not one of its machine"),
    (
        "429",
        "a rate limit or quota of the client is exceeded; the header Retry-After has the delay",
    ),
    ("431", "the headers are too large"),
    ("500", "the service failed"),
    ("503", "the service is busy; the header Retry-After says when to retry"),
    ("507", "the disk of the service is full"),
];
/// The name of a client's key in the description.
const KEY: &str = "key";
const NO_SCOPES: [&str; 0] = [];

const WITH_PATH: [(&str, &str); 2] = [("404", "it does not exist"), ("410", "it was erased")];
const WITH_BODY: [(&str, &str); 5] = [
    ("409", "a resource that it refers to changed meanwhile"),
    ("408", "the body came too slowly"),
    ("413", "the body is too large"),
    ("415", "the body has an unsupported media type"),
    ("422", "the body was understood and is refused; `code` and `errors` say why"),
];

/// The description as served and as stored in `openapi/openapi.json`.
pub fn document() -> serde_json::Value {
    let described = serde_json::to_value(described()).unwrap_or_default();
    let mut document = openapi_types::typed(described);
    describe_check(&mut document["components"]["schemas"]);
    document["paths"]["/v1/cases/{id}/check"]["post"]["requestBody"]["required"] = false.into();
    describe_kinds(&mut document["components"]["schemas"]["JobDocument"]);
    examples::add(&mut document["paths"]);
    document
}

/// The body of a check has the members of a prediction, all optional.
fn describe_check(schemas: &mut serde_json::Value) {
    let mut members = schemas["PredictDocument"].clone();
    members["description"] = schemas["CheckRequest"]["description"].clone();
    if let Some(members) = members.as_object_mut() {
        members.remove("required");
    }
    schemas["CheckRequest"] = members;
}

/// The mapping of kinds of jobs to documents.
fn describe_kinds(document: &mut serde_json::Value) {
    let reference = |kind: &JobKind| format!("#/components/schemas/{}", kind.document());
    let mapping: BTreeMap<&str, String> =
        JobKind::ALL.iter().map(|kind| (kind.name(), reference(kind))).collect();
    document["discriminator"] = json!({ "propertyName": "kind", "mapping": mapping });
}

/// The description derived from the handlers and documents.
fn described() -> OpenApi {
    let info = InfoBuilder::new()
        .title("facies")
        .version(env!("CARGO_PKG_VERSION"))
        .description(Some(
            "Predicts how a face will look after the bones under it are moved. Not a medical device. \
             Lengths are mm, angles degrees, stresses kPa, forces mN. \
             Any body may be sent with `Content-Digest` (RFC 9530, `sha-256` or `sha-512`), and is refused with 400 if it is another. \
             Every error is application/problem+json (RFC 9457) with a stable `code`.",
        ))
        .build();
    let Resources { router, declared } = resources();
    let mut api = router.into_openapi();
    let mut components = api.components.take().unwrap_or_default();
    add_schema::<ProblemDocument>(&mut components.schemas);
    add_schema::<JobEvent>(&mut components.schemas);
    let scheme = SecurityScheme::Http(Http::new(HttpAuthScheme::Bearer));
    components.add_security_scheme(KEY, scheme);
    let mut document = OpenApiBuilder::new().info(info).components(Some(components)).build();
    document.paths = api.paths;
    for (path, item) in &mut document.paths.paths {
        for (method, operation) in operations(item) {
            add_problems(path, operation);
            if declared.access(path, &method) != Some(Access::Open) {
                operation.security = Some(vec![SecurityRequirement::new(KEY, NO_SCOPES)]);
            }
        }
    }
    document
}

fn add_schema<T: utoipa::ToSchema>(schemas: &mut BTreeMap<String, RefOr<utoipa::openapi::Schema>>) {
    let mut found = Vec::new();
    T::schemas(&mut found);
    schemas.extend(found);
    schemas.insert(T::name().into_owned(), T::schema());
}

fn operations(item: &mut PathItem) -> impl Iterator<Item = (Method, &mut Operation)> {
    let operations = [
        (Method::GET, &mut item.get),
        (Method::PUT, &mut item.put),
        (Method::PATCH, &mut item.patch),
        (Method::POST, &mut item.post),
        (Method::DELETE, &mut item.delete),
    ];
    operations.into_iter().filter_map(|(method, operation)| Some((method, operation.as_mut()?)))
}

/// Adds the responses of the middleware, and the body of all problems.
fn add_problems(path: &str, operation: &mut Operation) {
    let mut problems = ALWAYS.to_vec();
    if path.contains('{') {
        problems.extend(WITH_PATH);
    }
    if operation.request_body.is_some() {
        problems.extend(WITH_BODY);
    }
    let told = &mut operation.responses.responses;
    for (status, description) in problems {
        told.entry(status.to_owned())
            .or_insert_with(|| RefOr::T(ResponseBuilder::new().description(description).build()));
    }
    for (status, response) in told.iter_mut() {
        let RefOr::T(response) = response else { continue };
        if status.starts_with(['4', '5']) {
            let schema = Ref::from_schema_name(ProblemDocument::name());
            let content = RefOr::T(ContentBuilder::new().schema(Some(schema)).build());
            response.content = [("application/problem+json".to_owned(), content)].into();
        }
    }
}
