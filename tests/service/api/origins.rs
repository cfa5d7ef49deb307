//! Pages of other origins.

use reqwest::{Method, StatusCode};

use crate::helpers::{Server, ask};

const OURS: &str = "https://planning.example";

#[tokio::test]
async fn a_page_of_an_origin_that_a_setting_names_is_let_in_and_no_other() {
    let server =
        Server::start_with(&["--allowed-origins", "https://planning.example, http://x:8080"]);
    let preflight = |origin: &str| {
        let request = server.request(Method::OPTIONS, "/v1/jobs").header("origin", origin);
        let request = request.header("access-control-request-method", "POST");
        ask(request
            .header("access-control-request-headers", "authorization,prefer,idempotency-key"))
    };
    let ours = preflight(OURS).await;
    assert_eq!(ours.status, StatusCode::OK);
    assert_eq!(ours.header("access-control-allow-origin"), OURS);
    assert!(ours.header("access-control-allow-headers").contains("idempotency-key"));
    assert_eq!(
        preflight("https://elsewhere.example").await.header("access-control-allow-origin"),
        ""
    );
    let read = ask(server.get("/v1/limits").header("origin", OURS)).await;
    assert_eq!(read.header("access-control-allow-origin"), OURS);
    let exposed = read.header("access-control-expose-headers");
    for name in ["etag", "facies-warning", "facies-not-measured"] {
        assert!(exposed.contains(name), "{name}");
    }
    assert!(read.header("vary").contains("origin"));
    // Refusals can be read as well.
    let refused = ask(server.get("/v1/nothing").header("origin", OURS)).await;
    refused.problem(404, "not-found");
    assert_eq!(refused.header("access-control-allow-origin"), OURS);
}
