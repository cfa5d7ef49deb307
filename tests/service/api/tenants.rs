//! Tenants do not know of each other: whatever a key asks for, it finds its own.

use facies::schema::key::{KeyDocument, Scope};
use facies::store::{Dismissal, Enqueued, Store};
use reqwest::{Method, RequestBuilder, StatusCode};
use serde_json::{Value, json};

use crate::deployments::{Deployment, on_both};
use crate::helpers::{Answer, SMALL, Server, ask, spec};
use crate::store::queue::{LEASE, enqueue, file, new_job, result};
use crate::store::storage::mesh;

on_both! {
    tenants_take_turns_and_studies_come_last
    what_is_older_than_its_tenant_keeps_it_is_erased
    a_job_that_was_lost_is_accepted_again_when_somebody_says_so
    equal_things_of_two_tenants_are_two_things
    a_key_that_was_ended_is_not_let_in
}

/// A service that asks for keys, and where it is run from.
pub struct Hospital {
    pub server: Server,
    office: String,
}

impl Hospital {
    pub fn open() -> Hospital {
        let mut server =
            Server::start_with(&["--ask-for-keys", "true", "--admin-bind", "127.0.0.1:0"]);
        let line = server.second_line();
        let office = line.strip_prefix("metrics on ").unwrap().trim_end_matches("/metrics");
        Hospital { office: office.to_owned(), server }
    }

    fn admin(&self, method: Method, path: &str) -> RequestBuilder {
        self.server.client.request(method, format!("{}{path}", self.office))
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

    pub async fn get(&self, key: &str, path: &str) -> Answer {
        self.send(key, Method::GET, path, None).await
    }

    async fn post(&self, key: &str, path: &str, body: &Value) -> Answer {
        self.send(key, Method::POST, path, Some(body)).await
    }
}

const ALL: [&str; 4] = ["read", "write", "run", "admin"];

/// What a tenant has, by the words that stand for it in routes.
struct Belongings {
    case: String,
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
        let wanted = json!({"label": "another", "scopes": ["read"]});
        let key = id(hospital.post(key, "/v1/keys", &wanted).await.expect(StatusCode::CREATED));
        Belongings { case, plan, job, mesh, key }
    }

    /// A route with what its words stand for.
    fn address(&self, route: &str) -> String {
        let id = match route.split('/').nth(2) {
            Some("cases") => &self.case,
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
        if !route.contains('{') {
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
    for list in ["/v1/cases", "/v1/jobs"] {
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
    let deeds: Vec<(String, String, String)> = log["items"]
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
        assert!(deeds.contains(&wanted), "{wanted:?} is not in {deeds:?}");
    }
    let check = ask(hospital.admin(Method::GET, "/audit/check")).await.expect(StatusCode::OK);
    assert_eq!(check["status"], "whole");
    let all = ask(hospital.admin(Method::GET, "/audit?limit=200")).await.expect(StatusCode::OK);
    assert_eq!(json!(all["items"].as_array().unwrap().len()), check["rows"]);
    ask(hospital.admin(Method::POST, "/lost-jobs/nothing/requeue")).await.problem(404, "not-found");
    assert_eq!(ask(hospital.admin(Method::GET, "/lost-jobs")).await.json(), json!([]));
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

async fn claimed(store: &Store) -> String {
    store.claim(LEASE).await.unwrap().unwrap().lease.job
}

async fn tenants_take_turns_and_studies_come_last(on: Deployment) {
    let store = on.open().await;
    let (greedy, modest) = (store.of_tenant("greedy"), store.of_tenant("modest"));
    let mut study = new_job("{}", "study");
    study.priority = 1;
    assert_eq!(greedy.enqueue(&study, 100).await.unwrap(), Enqueued::Accepted);
    let mut many = Vec::new();
    for number in 0..4 {
        many.push(enqueue(&greedy, &format!("job {number}")).await);
    }
    assert_eq!(claimed(&store).await, many[0], "a study waits for what somebody waits for");
    let few = [enqueue(&modest, "job 0").await, enqueue(&modest, "job 1").await];
    for wanted in [&few[0], &many[1], &few[1], &many[2], &many[3], &study.id] {
        assert_eq!(claimed(&store).await, *wanted);
    }
    assert!(store.claim(LEASE).await.unwrap().is_none());
    let full = modest.enqueue(&new_job("{}", "job 3"), 0).await.unwrap();
    assert_eq!(full, Enqueued::QueueFull);
}

async fn what_is_older_than_its_tenant_keeps_it_is_erased(on: Deployment) {
    let store = on.open().await;
    let tenants = ["keeps", "erases"].map(|name| store.of_tenant(name));
    let mut jobs = Vec::new();
    for tenant in &tenants {
        let old = enqueue(tenant, "old").await;
        let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
        assert!(store.publish(&lease, result("{}", &[file("a result")])).await.unwrap());
        let waiting = enqueue(tenant, "waits").await;
        let mesh = mesh("alone", "units=mm");
        assert!(tenant.add_mesh(&mesh).await.unwrap());
        jobs.push([old, waiting, mesh.id]);
    }
    tenants[1].retain(Some(30)).await.unwrap();
    assert_eq!(store.erase_old().await.unwrap(), 0);
    on.execute("UPDATE jobs SET created = 1, updated = 1, finished = 1 WHERE finished IS NOT NULL")
        .await;
    on.execute("UPDATE meshes SET created = 1").await;
    assert_eq!(store.erase_old().await.unwrap(), 2);
    let there = async |tenant: &Store, ids: &[String; 3]| {
        [
            tenant.job(&ids[0]).await.unwrap().is_some(),
            tenant.job(&ids[1]).await.unwrap().is_some(),
            tenant.mesh(&ids[2]).await.unwrap().is_some(),
        ]
    };
    assert_eq!(there(&tenants[0], &jobs[0]).await, [true, true, true]);
    assert_eq!(there(&tenants[1], &jobs[1]).await, [false, true, false]);
    assert!(tenants[1].erased(&jobs[1][0]).await.unwrap().is_some());
    assert!(tenants[0].erased(&jobs[1][0]).await.unwrap().is_none());
}

async fn a_job_that_was_lost_is_accepted_again_when_somebody_says_so(on: Deployment) {
    let store = on.open().await;
    let own = store.of_tenant("a");
    let (lost, wrong) = (enqueue(&own, "lost").await, enqueue(&own, "wrong").await);
    let error = |class: &str| json!({"type": "worker-lost", "class": class}).to_string();
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.lose(&lease, 1, &error("infrastructure")).await.unwrap());
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.fail(&lease, &error("numerical")).await.unwrap());
    let listed = store.lost_jobs().await.unwrap();
    assert_eq!(listed.iter().map(|row| &row.id).collect::<Vec<_>>(), [&lost]);
    assert_eq!(listed[0].tenant, "a");
    assert!(!store.requeue(&wrong).await.unwrap());
    assert!(store.requeue(&lost).await.unwrap());
    assert!(!store.requeue(&lost).await.unwrap());
    let claim = store.claim(LEASE).await.unwrap().unwrap();
    assert_eq!((claim.lease.job, claim.lease.attempt), (lost, 2));
}

async fn equal_things_of_two_tenants_are_two_things(on: Deployment) {
    let store = on.open().await;
    let (a, b) = (store.of_tenant("a"), store.of_tenant("b"));
    let (first, second) = (mesh("same", "units=mm"), mesh("same", "units=mm"));
    assert!(a.add_mesh(&first).await.unwrap() && b.add_mesh(&second).await.unwrap());
    let again = mesh("same", "units=mm");
    assert!(!a.add_mesh(&again).await.unwrap(), "within a tenant they are one");
    let found = b.mesh_by_content(&second.sha256, &second.options).await.unwrap().unwrap();
    assert_eq!(found.id, second.id);
    let (one, other) = (enqueue(&a, "same").await, enqueue(&b, "same").await);
    assert_eq!(a.enqueue(&new_job("{}", "same"), 9).await.unwrap(), Enqueued::Known(one.clone()));
    assert_eq!(b.job(&other).await.unwrap().unwrap().spec_hash, "same");
    assert_eq!(b.dismiss(&one).await.unwrap(), Dismissal::NotFound);
    assert!(b.job(&one).await.unwrap().is_none());
    // The bytes are stored once, and stay while one of the two is there.
    a.delete_mesh(&first.id).await.unwrap();
    assert!(store.read_blob(&second.blob).await.is_ok());
}

async fn a_key_that_was_ended_is_not_let_in(on: Deployment) {
    let store = on.open().await;
    let (a, b) = (store.of_tenant("a"), store.of_tenant("b"));
    let wanted = KeyDocument { label: "test".into(), scopes: [Scope::Read].into(), days: Some(1) };
    let key = a.make_key(&wanted).await.unwrap();
    let row = store.key_in_force(&key.id).await.unwrap().unwrap();
    assert_eq!((row.tenant.as_str(), row.scopes.as_str()), ("a", "read"));
    assert_eq!(row.expires, Some(row.created + 24 * 3600 * 1000));
    assert!(!row.hash.contains(&key.text));
    assert!(b.rotate_key(&key.id, 0).await.unwrap().is_none(), "it is none of theirs");
    assert!(!b.revoke_key(&key.id).await.unwrap());
    let next = a.rotate_key(&key.id, 0).await.unwrap().unwrap();
    assert!(store.key_in_force(&key.id).await.unwrap().is_none(), "it has given way");
    assert!(a.revoke_key(&next.id).await.unwrap());
    assert!(store.key_in_force(&next.id).await.unwrap().is_none());
    assert!(!a.revoke_key(&next.id).await.unwrap());
}
