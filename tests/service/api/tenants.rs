//! Tenants do not know of each other: whatever a key asks for, it finds its own.

use reqwest::{Method, RequestBuilder, StatusCode};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::cohorts::Operated;
use crate::helpers::{Answer, SMALL, Server, ask, spec};

/// A service that asks for keys, and where it is run from.
pub struct Hospital {
    pub server: Server,
    admin_address: String,
}

impl Hospital {
    pub fn open() -> Hospital {
        Hospital::open_in(TempDir::new().unwrap())
    }

    /// One that has been open before.
    pub fn open_in(folder: TempDir) -> Hospital {
        Hospital::open_with(folder, &[])
    }

    pub fn open_with(folder: TempDir, settings: &[&str]) -> Hospital {
        let own = ["--ask-for-keys", "true", "--admin-bind", "127.0.0.1:0"];
        let mut server = Server::start_in(folder, &[&own, settings].concat());
        let line = server.second_line();
        let admin_address = line.strip_prefix("metrics on ").unwrap().trim_end_matches("/metrics");
        Hospital { admin_address: admin_address.to_owned(), server }
    }

    pub fn admin(&self, method: Method, path: &str) -> RequestBuilder {
        self.server.client.request(method, format!("{}{path}", self.admin_address))
    }

    pub fn admin_host(&self) -> &str {
        self.admin_address.strip_prefix("http://").unwrap()
    }

    /// A key of a tenant.
    pub async fn key(&self, tenant: &str, scopes: &[&str]) -> String {
        let wanted = json!({"label": "test", "scopes": scopes});
        let path = format!("/tenants/{tenant}/keys");
        let answer = ask(self.admin(Method::POST, &path).json(&wanted)).await;
        answer.expect(StatusCode::CREATED)["key"].as_str().unwrap().to_owned()
    }

    async fn send(&self, key: &str, method: Method, path: &str, body: Option<&Value>) -> Answer {
        let mut request =
            self.server.request(method, path).bearer_auth(key).header("if-match", "*");
        if let Some(body) = body {
            request = request.json(body);
        }
        ask(request).await
    }

    /// A number that is published now.
    pub async fn metric(&self, name: &str) -> f64 {
        let text = String::from_utf8(ask(self.admin(Method::GET, "/metrics")).await.bytes).unwrap();
        let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        value.map_or(0.0, |value| value.parse().unwrap())
    }

    pub async fn get(&self, key: &str, path: &str) -> Answer {
        self.send(key, Method::GET, path, None).await
    }

    pub async fn post(&self, key: &str, path: &str, body: &Value) -> Answer {
        self.send(key, Method::POST, path, Some(body)).await
    }
}

const ALL: [&str; 4] = ["read", "write", "run", "admin"];

/// What a tenant has, by the words that stand for it in routes.
struct Belongings {
    case: String,
    cohort: String,
    plan: String,
    job: String,
    mesh: String,
    key: String,
}

impl Belongings {
    async fn of(hospital: &Hospital, key: &str) -> Belongings {
        let server = &hospital.server;
        let id = |answer: Value| answer["id"].as_str().unwrap().to_owned();
        let form = server.post("/v1/cases").bearer_auth(key).multipart(SMALL.form(&SMALL.case()));
        let case = ask(form).await.expect(StatusCode::CREATED);
        let mesh = case["case"]["volume"].as_str().unwrap().to_owned();
        let case = id(case);
        let plan = json!({"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]});
        let plans = format!("/v1/cases/{case}/plans");
        let plan = id(hospital.post(key, &plans, &plan).await.expect(StatusCode::CREATED));
        let wait = |spec: Value| {
            server.post("/v1/jobs").bearer_auth(key).header("prefer", "wait=30").json(&spec)
        };
        let job = id(ask(wait(spec(&case, 1.0))).await.expect(StatusCode::OK));
        let response = json!({"kind": "response", "case": case, "segments": ["bone"]});
        ask(wait(response)).await.expect(StatusCode::OK);
        let members = Operated::by(server, key, 3).await.cohort(&[0, 1, 2]);
        let cohort =
            id(hospital.post(key, "/v1/cohorts", &members).await.expect(StatusCode::CREATED));
        let wanted = json!({"label": "another", "scopes": ["read"]});
        let key = id(hospital.post(key, "/v1/keys", &wanted).await.expect(StatusCode::CREATED));
        Belongings { case, cohort, plan, job, mesh, key }
    }

    /// A route with what its words stand for.
    fn address(&self, route: &str) -> String {
        let id = match route.split('/').nth(2) {
            Some("cases") => &self.case,
            Some("cohorts") => &self.cohort,
            Some("jobs") => &self.job,
            Some("meshes") => &self.mesh,
            Some("keys") => &self.key,
            other => panic!("whose id is it in {route}: {other:?}"),
        };
        route.replace("{id}", id).replace("{plan}", &self.plan).replace("{file}", "skin.vtp")
    }
}

/// A body that the operation would take.
fn body_of(route: &str, id: &str) -> Option<Value> {
    match route {
        _ if route.ends_with("/plans") || route.ends_with("/plans/{plan}") => {
            Some(json!({"segments": []}))
        }
        _ if route.ends_with("/check") => Some(json!({"kind": "predict", "case": id})),
        _ if route.ends_with("/apply") => {
            let moved = json!([{"name": "bone", "translation_mm": [1, 0, 0]}]);
            Some(json!({"plan": {"segments": moved}}))
        }
        // Reading and erasing a job ignore it; changing its tags asks for it.
        "/v1/jobs/{id}" => Some(json!({"tags": {"add": ["x"]}})),
        _ if route.ends_with("/rotation") => Some(json!({"overlap_h": 1})),
        _ => None,
    }
}

#[tokio::test]
async fn a_key_of_another_tenant_finds_nothing_at_any_address() {
    let hospital = Hospital::open();
    let (ours, theirs) = (hospital.key("a", &ALL).await, hospital.key("b", &ALL).await);
    let belongings = Belongings::of(&hospital, &ours).await;
    let description: Value = ask(hospital.server.get("/openapi.json")).await.json();
    let mut asked = 0;
    for (route, item) in description["paths"].as_object().unwrap() {
        // The packages of the clients are everybody's.
        if !route.contains('{')
            || ["/clients/", "/assets/"].iter().any(|open| route.starts_with(open))
        {
            continue;
        }
        let address = belongings.address(route);
        for method in item.as_object().unwrap().keys() {
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).unwrap();
            let body = body_of(route, &belongings.case);
            let met = hospital.send(&theirs, method.clone(), &address, body.as_ref()).await;
            assert_eq!(met.status, StatusCode::NOT_FOUND, "{method} {route}: {met:?}");
            if method == Method::GET && !route.ends_with("/report") {
                let own = hospital.get(&ours, &address).await;
                assert_eq!(own.status, StatusCode::OK, "{method} {route}: {own:?}");
            }
            asked += 1;
        }
    }
    assert!(asked >= 20, "{asked} operations");
    for list in ["/v1/cases", "/v1/cohorts", "/v1/jobs"] {
        let own = hospital.get(&ours, list).await.expect(StatusCode::OK);
        assert!(!own["items"].as_array().unwrap().is_empty(), "{list}");
        let met = hospital.get(&theirs, list).await.expect(StatusCode::OK);
        assert_eq!(met["items"], json!([]), "{list}");
    }

    // Nor does it find them by naming them in a document.
    let mut case = SMALL.case();
    case["volume"] = belongings.mesh.as_str().into();
    let plan = json!({"kind": "predict", "case": belongings.case, "plan_id": belongings.plan});
    let compare = json!({"kind": "compare", "prediction": {"job": belongings.job},
        "actual": {"mesh": belongings.mesh}});
    for (address, document, named) in [
        ("/v1/cases", &case, "unknown-mesh"),
        ("/v1/jobs", &plan, "unknown-case"),
        ("/v1/jobs", &compare, "unknown-mesh"),
    ] {
        let answer = hospital.post(&theirs, address, document).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{answer:?}");
        let text = String::from_utf8(answer.bytes).unwrap();
        assert!(text.contains(named), "{text}");
    }

    // What was erased was never there for others.
    let case = format!("/v1/cases/{}", belongings.case);
    let erased = hospital.send(&ours, Method::DELETE, &case, None).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
    hospital.get(&ours, &case).await.problem(410, "gone");
    hospital.get(&theirs, &case).await.problem(404, "not-found");
}

#[tokio::test]
async fn a_key_does_what_its_scopes_say() {
    let hospital = Hospital::open();
    let bytes = SMALL.vtu();
    for held in ALL {
        let key = hospital.key("a", &[held]).await;
        for needed in ALL {
            let server = &hospital.server;
            let request = match needed {
                "read" => server.get("/v1/cases"),
                "write" => server
                    .post("/v1/meshes?allow_any_scale=true")
                    .header("content-type", "application/octet-stream")
                    .body(bytes.clone()),
                "run" => server.post("/v1/jobs").json(&json!({"kind": "nothing"})),
                _ => server.get("/v1/keys"),
            };
            let answer = ask(request.bearer_auth(&key)).await;
            if held == needed {
                assert_ne!(answer.status, StatusCode::FORBIDDEN, "{held}: {answer:?}");
                continue;
            }
            assert_eq!(answer.problem(403, "forbidden-scope")["required_scope"], needed);
        }
    }
}

#[tokio::test]
async fn without_a_key_that_is_known_nobody_is_let_in() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &ALL).await;
    let (head, secret) = key.rsplit_once('_').unwrap();
    let flipped = if secret.ends_with('0') { "1" } else { "0" };
    let wrong = format!("{head}_{}{flipped}", &secret[..secret.len() - 1]);
    for given in ["", "fcs_", "fcs_000000000000_00", &wrong, &key.to_uppercase()] {
        let refused = hospital.get(given, "/v1/cases").await;
        refused.problem(401, "unauthorized");
        assert_eq!(refused.header("www-authenticate"), "Bearer");
    }
    ask(hospital.server.get("/v1/cases")).await.problem(401, "unauthorized");
    ask(hospital.server.get("/healthz")).await.expect(StatusCode::OK);

    // A key gives way to another, and a key that is ended is ended at once.
    let id = key.split('_').nth(1).unwrap();
    let rotation = format!("/v1/keys/{id}/rotation");
    let made = hospital.post(&key, &rotation, &json!({})).await.expect(StatusCode::CREATED);
    let next = made["key"].as_str().unwrap();
    hospital.get(&key, "/v1/cases").await.expect(StatusCode::OK);
    let ended = hospital.send(next, Method::DELETE, &format!("/v1/keys/{id}"), None).await;
    assert_eq!(ended.status, StatusCode::NO_CONTENT);
    hospital.get(&key, "/v1/cases").await.problem(401, "unauthorized");
    let listed = hospital.get(next, "/v1/keys").await.expect(StatusCode::OK);
    let listed = listed["items"].as_array().unwrap();
    assert_eq!(listed.len(), 2);
    assert!(listed[0]["revoked"].is_string() && listed[1].get("revoked").is_none());
    let text = serde_json::to_string(&listed).unwrap();
    assert!(!text.contains(secret) && !text.contains(next), "secrets are shown once");
}

#[tokio::test]
async fn who_runs_the_service_sees_what_was_done() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &ALL).await;
    let belongings = Belongings::of(&hospital, &key).await;
    let reader = hospital.key("a", &["read"]).await;
    hospital.post(&reader, "/v1/jobs", &json!({})).await.problem(403, "forbidden-scope");
    let runner = hospital.key("a", &["run"]).await;
    hospital.get(&runner, "/v1/cases").await.problem(403, "forbidden-scope");
    let log = hospital.get(&key, "/v1/audit?limit=200").await.expect(StatusCode::OK);
    let actions: Vec<(String, String, String)> = log["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| {
            let text = |name: &str| row[name].as_str().unwrap().to_owned();
            assert_eq!(row["tenant"], "a");
            (text("action"), text("object"), text("outcome"))
        })
        .collect();
    for (action, object, outcome) in [
        ("POST /v1/cases", belongings.case.as_str(), "201"),
        ("POST /v1/cases/{id}/plans", belongings.plan.as_str(), "201"),
        ("POST /v1/keys", belongings.key.as_str(), "201"),
        ("POST /v1/jobs", "", "403"),
        ("GET /v1/cases", "", "403"),
    ] {
        let wanted = (action.to_owned(), object.to_owned(), outcome.to_owned());
        assert!(actions.contains(&wanted), "{wanted:?} is not in {actions:?}");
    }
    let check = ask(hospital.admin(Method::GET, "/audit/check")).await.expect(StatusCode::OK);
    assert_eq!(check["status"], "whole");
    for path in ["/audit/check", "/audit", "/tenants", "/tenants/a/keys", "/lost-jobs"] {
        let misspelt = ask(hospital.admin(Method::GET, &format!("{path}?afer=1"))).await;
        assert_eq!(misspelt.problem(400, "invalid-parameter")["parameter"], "afer", "{path}");
    }
    let all = ask(hospital.admin(Method::GET, "/audit?limit=200")).await.expect(StatusCode::OK);
    assert_eq!(json!(all["items"].as_array().unwrap().len()), check["rows"]);
    ask(hospital.admin(Method::POST, "/lost-jobs/nothing/requeue")).await.problem(404, "not-found");
    assert_eq!(ask(hospital.admin(Method::GET, "/lost-jobs")).await.json(), json!([]));
    // What is wrong with a document is told as clients are told it.
    let wanted = json!({"label": "test", "scopes": ["read"], "colour": "red"});
    let refused = ask(hospital.admin(Method::POST, "/tenants/a/keys").json(&wanted)).await;
    let problem = refused.problem(422, "validation-failed");
    assert_eq!(problem["errors"][0]["code"], "unknown-field", "{problem}");
    ask(hospital.admin(Method::PUT, "/tenants/a").body("{}"))
        .await
        .problem(415, "unsupported-media-type");
}

#[tokio::test]
async fn administration_asks_for_its_key() {
    const KEY: &str = "0123456789abcdef-admin";
    let mut server = Server::start_with(&["--admin-bind", "127.0.0.1:0", "--admin-key", KEY]);
    let line = server.second_line();
    let metrics = line.strip_prefix("metrics on ").unwrap();
    ask(server.client.get(metrics)).await;
    let tenants = metrics.replace("/metrics", "/tenants");
    ask(server.client.get(&tenants)).await.problem(401, "unauthorized");
    let set = server.client.put(format!("{tenants}/a")).json(&json!({"retention_days": 30}));
    ask(set.bearer_auth(KEY)).await.expect(StatusCode::OK);
    let told = ask(server.client.get(&tenants).bearer_auth(KEY)).await.expect(StatusCode::OK);
    assert_eq!(told, json!([{"name": "a", "retention_days": 30}]));
    let set = server.client.put(format!("{tenants}/A%20b")).json(&json!({}));
    ask(set.bearer_auth(KEY)).await.problem(400, "invalid-parameter");
}

#[tokio::test]
async fn keys_above_the_limit_are_refused_with_the_numbers() {
    let folder = TempDir::new().unwrap();
    let hospital = Hospital::open_with(folder, &["--keys", "1"]);
    let key = hospital.key("a", &ALL).await;
    let limits = hospital.get(&key, "/v1/limits").await.expect(StatusCode::OK);
    assert_eq!(limits["keys"], 1);
    let wanted = json!({"label": "another", "scopes": ["read"]});
    let by_admin = hospital.admin(Method::POST, "/tenants/a/keys").json(&wanted);
    for refused in [hospital.post(&key, "/v1/keys", &wanted).await, ask(by_admin).await] {
        let problem = refused.problem(409, "too-many-keys");
        assert_eq!((&problem["keys"], &problem["limit"]), (&json!(1), &json!(1)));
    }
}

#[tokio::test]
async fn a_change_of_administration_with_an_unknown_parameter_changes_nothing() {
    let hospital = Hospital::open();
    let key = hospital.key("a", &["read"]).await;
    let id = key.split('_').nth(1).unwrap();
    for (method, path) in [
        (Method::POST, "/tenants/a/keys?days=1".to_owned()),
        (Method::PUT, "/tenants/a?retention_days=5".to_owned()),
        (Method::POST, format!("/tenants/a/keys/{id}/rotation?overlap_h=48")),
        (Method::DELETE, format!("/tenants/a/keys/{id}?dry_run=true")),
    ] {
        let wanted = json!({"label": "test", "scopes": ["read"]});
        ask(hospital.admin(method, &path).json(&wanted)).await.problem(400, "invalid-parameter");
    }
    hospital.get(&key, "/v1/cases").await.expect(StatusCode::OK);
}

#[tokio::test]
async fn who_only_looks_at_administration_is_not_noted() {
    let hospital = Hospital::open();
    ask(hospital.admin(Method::HEAD, "/tenants")).await;
    ask(hospital.admin(Method::GET, "/tenants")).await.expect(StatusCode::OK);
    let set = hospital.admin(Method::PUT, "/tenants/a").json(&json!({}));
    ask(set).await.expect(StatusCode::OK);
    let all = ask(hospital.admin(Method::GET, "/audit")).await.expect(StatusCode::OK);
    let actions: Vec<_> =
        all["items"].as_array().unwrap().iter().map(|row| &row["action"]).collect();
    assert_eq!(actions, ["PUT /tenants/{tenant}"]);
}

#[tokio::test]
async fn a_job_that_keeps_meshes_takes_a_key_that_may_write() {
    let hospital = Hospital::open();
    let (owner, runner) = (hospital.key("a", &ALL).await, hospital.key("a", &["run"]).await);
    let form = hospital.server.post("/v1/cases").bearer_auth(&owner);
    let case = ask(form.multipart(SMALL.form(&SMALL.case()))).await.expect(StatusCode::CREATED);
    let mut job = spec(case["id"].as_str().unwrap(), 1.0);
    hospital.post(&runner, "/v1/jobs", &job).await.expect(StatusCode::CREATED);
    job["keep"] = json!(["skin"]);
    let refused = hospital.post(&runner, "/v1/jobs", &job).await;
    assert_eq!(refused.problem(403, "forbidden-scope")["required_scope"], "write");
    hospital.post(&owner, "/v1/jobs", &job).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn a_job_that_has_ended_is_erased_by_a_key_that_may_write() {
    let hospital = Hospital::open();
    let (owner, runner) = (hospital.key("a", &ALL).await, hospital.key("a", &["run"]).await);
    let writer = hospital.key("a", &["run", "write"]).await;
    let form = hospital.server.post("/v1/cases").bearer_auth(&owner);
    let case = ask(form.multipart(SMALL.form(&SMALL.case()))).await.expect(StatusCode::CREATED);
    let document = spec(case["id"].as_str().unwrap(), 1.0);
    let request = hospital.server.post("/v1/jobs").bearer_auth(&owner).header("prefer", "wait=30");
    let done = ask(request.json(&document)).await.expect(StatusCode::OK);
    let known = hospital.post(&runner, "/v1/jobs", &document).await.expect(StatusCode::OK);
    assert_eq!(known["id"], done["id"]);
    let path = format!("/v1/jobs/{}", done["id"].as_str().unwrap());
    let refused = hospital.send(&runner, Method::DELETE, &path, None).await;
    assert_eq!(refused.problem(403, "forbidden-scope")["required_scope"], "write");
    let skin = hospital.get(&owner, &format!("{path}/results/skin.vtp")).await;
    assert_eq!(skin.status, StatusCode::OK);
    let nowhere = format!("/v1/jobs/{}", uuid::Uuid::now_v7());
    hospital.send(&runner, Method::DELETE, &nowhere, None).await.problem(404, "no-such-job");
    let erased = hospital.send(&writer, Method::DELETE, &path, None).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
}

#[tokio::test]
async fn a_job_that_has_not_ended_is_dismissed_by_a_key_that_may_run() {
    let hospital = Hospital::open_with(TempDir::new().unwrap(), &["--workers", "0"]);
    let (owner, runner) = (hospital.key("a", &ALL).await, hospital.key("a", &["run"]).await);
    let form = hospital.server.post("/v1/cases").bearer_auth(&owner);
    let case = ask(form.multipart(SMALL.form(&SMALL.case()))).await.expect(StatusCode::CREATED);
    let document = spec(case["id"].as_str().unwrap(), 1.0);
    let job = hospital.post(&owner, "/v1/jobs", &document).await.expect(StatusCode::CREATED);
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let dismissed = hospital.send(&runner, Method::DELETE, &path, None).await;
    assert_eq!(dismissed.expect(StatusCode::OK)["status"], "dismissed");
    hospital.send(&runner, Method::DELETE, &path, None).await.problem(403, "forbidden-scope");
}

#[tokio::test]
async fn a_plan_is_applied_by_the_tenant_of_its_case_until_the_key_is_revoked() {
    let hospital = Hospital::open();
    let (key, other) = (hospital.key("a", &ALL).await, hospital.key("b", &ALL).await);
    let form = hospital.server.post("/v1/cases").bearer_auth(&key);
    let case = ask(form.multipart(SMALL.form(&SMALL.case()))).await.expect(StatusCode::CREATED);
    let case = case["id"].as_str().unwrap();
    let path = format!("/v1/cases/{case}/response/apply");
    let plan = json!({"plan": {"segments": [{"name": "bone", "translation_mm": [1, 0, 0]}]}});
    hospital.post(&key, &path, &plan).await.problem(404, "response-not-built");
    let job = hospital.server.post("/v1/jobs").bearer_auth(&key).header("prefer", "wait=30");
    let job = ask(job.json(&json!({"kind": "response", "case": case}))).await;
    let job = job.expect(StatusCode::OK);
    let applied = hospital.post(&key, &path, &plan).await;
    assert_eq!(applied.expect(StatusCode::OK)["job"], job["id"]);
    assert_eq!(hospital.post(&other, &path, &plan).await.status, StatusCode::NOT_FOUND);
    let id = key.split('_').nth(1).unwrap();
    let revoked = hospital.send(&key, Method::DELETE, &format!("/v1/keys/{id}"), None).await;
    assert!(revoked.status.is_success());
    hospital.post(&key, &path, &plan).await.problem(401, "unauthorized");
}
