//! Stored cohorts: kept by their tenant, named by jobs, left by what is erased, and refused where nothing could be learned from
//! them.

use mechanics::mesh::{Frame, Vector};
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use super::learn::{after_beside, linear};
use super::tenants::Hospital;
use crate::helpers::{Answer, SMALL, Server, ask};

/// Operated blocks: their cases, and members of a cohort whose predictions compared.
pub struct Operated {
    cases: Vec<String>,
    members: Vec<Value>,
}

impl Operated {
    async fn on(server: &Server, count: usize) -> Operated {
        Operated::by(server, "", count).await
    }

    /// With a key, where the service asks for one.
    pub async fn by(server: &Server, key: &str, count: usize) -> Operated {
        let mut operated = Operated { cases: Vec::new(), members: Vec::new() };
        for number in 1..=count {
            let form = SMALL.form(&SMALL.case());
            let case = ask(with(server.post("/v1/cases"), key).multipart(form)).await;
            let case = id(&case.expect(StatusCode::CREATED));
            let file = after_beside(number, Vector::zeros(), Frame::Unspecified);
            let actual = uploaded(server, key, file).await;
            let mut spec = linear(&case, number as f64);
            spec["compare_to"] = json!({"actual": {"mesh": actual}});
            let job = with(server.post("/v1/jobs"), key).header("prefer", "wait=30").json(&spec);
            let job = id(&ask(job).await.expect(StatusCode::OK));
            let compared = json!({"linear": job});
            operated
                .members
                .push(json!({"prediction": job, "actual": actual, "comparisons": compared}));
            operated.cases.push(case);
        }
        operated
    }

    pub fn cohort(&self, members: &[usize]) -> Value {
        let members: Vec<&Value> = members.iter().map(|index| &self.members[*index]).collect();
        let consent = json!({"statement": "form 4", "uses": ["learn", "compare"]});
        json!({"name": "blocks", "consent": consent, "members": members})
    }
}

fn with(request: reqwest::RequestBuilder, key: &str) -> reqwest::RequestBuilder {
    if key.is_empty() { request } else { request.bearer_auth(key) }
}

fn id(answer: &Value) -> String {
    answer["id"].as_str().unwrap().to_owned()
}

async fn uploaded(server: &Server, key: &str, file: Vec<u8>) -> String {
    let request = with(server.post("/v1/meshes?allow_any_scale=true"), key);
    let request = request.header("content-type", "application/octet-stream").body(file);
    id(&ask(request).await.expect(StatusCode::CREATED))
}

async fn post(server: &Server, cohort: &Value) -> Answer {
    ask(server.post("/v1/cohorts").json(cohort)).await
}

async fn kept(server: &Server, cohort: &Value) -> String {
    id(&post(server, cohort).await.expect(StatusCode::CREATED))
}

async fn show(server: &Server, cohort: &str) -> Value {
    ask(server.get(&format!("/v1/cohorts/{cohort}"))).await.expect(StatusCode::OK)
}

async fn learned(server: &Server, cohort: &str) -> Value {
    let job = server.job(&json!({"kind": "learn", "cohort": cohort})).await;
    let job = job.expect(StatusCode::OK);
    assert_eq!(job["status"], "successful", "{job}");
    job
}

async fn erase(server: &Server, path: &str) {
    let erased = ask(server.delete(path).header("if-match", "*")).await;
    assert_eq!(erased.status, StatusCode::NO_CONTENT);
}

#[tokio::test]
async fn jobs_name_a_cohort_in_place_of_its_members_and_say_which_version_they_learned_from() {
    let server = Server::start();
    let operated = Operated::on(&server, 3).await;
    let document = operated.cohort(&[0, 1, 2]);
    let send = || server.post("/v1/cohorts").header("idempotency-key", "k").json(&document);
    let first = ask(send()).await;
    let cohort = id(&first.expect(StatusCode::CREATED));
    assert_eq!(first.header("location"), format!("/v1/cohorts/{cohort}"));
    assert_eq!(ask(send()).await.expect(StatusCode::CREATED)["id"], cohort.as_str());

    let view = show(&server, &cohort).await;
    assert_eq!(view["consent"], document["consent"]);
    for (index, member) in view["members"].as_array().unwrap().iter().enumerate() {
        assert_eq!(member["member"], document["members"][index]);
        assert_eq!(member["case"], operated.cases[index].as_str());
    }
    let listed = ask(server.get("/v1/cohorts")).await.expect(StatusCode::OK);
    let items = listed["items"].as_array().unwrap();
    assert_eq!((items.len(), &items[0]["members"]), (1, &json!(3)));

    // The same numbers as from the members themselves, with their provenance.
    let model = learned(&server, &cohort).await;
    let version = json!({"id": cohort, "version": 1});
    assert_eq!(model["results"]["learning"]["cohort"], version);
    let strip =
        |member: &Value| json!({"prediction": member["prediction"], "actual": member["actual"]});
    let cases: Vec<Value> = operated.members.iter().map(strip).collect();
    let plain = server.job(&json!({"kind": "learn", "cases": cases})).await.expect(StatusCode::OK);
    assert_ne!(plain["id"], model["id"], "its provenance is another");
    assert_eq!(plain["results"]["learning"]["table"], model["results"]["learning"]["table"]);
    let file = format!("/v1/jobs/{}/results/model.json", id(&model));
    assert_eq!(ask(server.get(&file)).await.json()["cohort"], version);

    let compared = server.job(&json!({"kind": "cohort", "cohort": cohort})).await;
    let compared = compared.expect(StatusCode::OK);
    let found = &compared["results"]["cohort"];
    assert_eq!(found["cohort"], version);
    assert_eq!(found["groups"][0]["name"], "linear");
    assert_eq!(found["groups"][0]["rows"].as_array().unwrap().len(), 3);

    // What is learned is told, and goes out of the list when it is removed.
    let told = json!([{"job": model["id"], "version": 1, "state": "current"}]);
    assert_eq!(show(&server, &cohort).await["models"], told);
    erase(&server, &format!("/v1/jobs/{}", id(&model))).await;
    assert_eq!(show(&server, &cohort).await["models"], json!([]));

    // A cohort goes without what was learned from it.
    let model = learned(&server, &cohort).await;
    let path = format!("/v1/cohorts/{cohort}");
    ask(server.delete(&path)).await.problem(428, "precondition-required");
    ask(server.delete(&path).header("if-match", "\"2\"")).await.problem(412, "precondition-failed");
    erase(&server, &path).await;
    ask(server.get(&path)).await.problem(410, "gone");
    ask(server.get(&format!("/v1/jobs/{}", id(&model)))).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn a_member_leaves_with_its_case_or_its_prediction_and_the_cohort_says_what_is_stale() {
    let server = Server::start();
    let operated = Operated::on(&server, 5).await;
    let cohort = kept(&server, &operated.cohort(&[0, 1, 2, 3, 4])).await;
    let other = kept(&server, &operated.cohort(&[1, 2, 3])).await;
    let first = learned(&server, &cohort).await;
    let untouched = learned(&server, &other).await;

    // Erasing a case takes it out, and its models with it: numbers of the patient are in them.
    erase(&server, &format!("/v1/cases/{}", operated.cases[0])).await;
    let view = show(&server, &cohort).await;
    let numbers: Vec<&Value> =
        view["members"].as_array().unwrap().iter().map(|member| &member["number"]).collect();
    assert_eq!(
        (&view["version"], numbers),
        (&json!(2), vec![&json!(2), &json!(3), &json!(4), &json!(5)])
    );
    assert_eq!(view["left"], json!([{"case": operated.cases[0], "version": 2}]));
    let erased =
        json!({"job": first["id"], "version": 1, "state": "erased", "left": [operated.cases[0]]});
    assert_eq!(view["models"], json!([erased]));
    ask(server.get(&format!("/v1/jobs/{}", id(&first)))).await.problem(410, "gone");
    let view = show(&server, &other).await;
    let current = json!([{"job": untouched["id"], "version": 1, "state": "current"}]);
    assert_eq!((&view["version"], &view["models"]), (&json!(1), &current));

    // It is learned again from those who are left, by their names from before.
    let second = learned(&server, &cohort).await;
    assert_ne!(second["id"], first["id"]);
    let learning = &second["results"]["learning"];
    assert_eq!(learning["cohort"]["version"], 2);
    assert_eq!(learning["table"][0]["cases"][0]["name"], "2");

    // A prediction that is removed leaves its models, which are stale.
    let prediction = operated.members[1]["prediction"].as_str().unwrap();
    erase(&server, &format!("/v1/jobs/{prediction}")).await;
    let view = show(&server, &cohort).await;
    let stale =
        json!({"job": second["id"], "version": 2, "state": "stale", "left": [operated.cases[1]]});
    let both = [operated.cases[0].as_str(), &operated.cases[1]];
    let erased = json!({"job": first["id"], "version": 1, "state": "erased", "left": both});
    assert_eq!((&view["version"], &view["models"]), (&json!(3), &json!([stale, erased])));
    ask(server.get(&format!("/v1/jobs/{}", id(&second)))).await.expect(StatusCode::OK);

    let mut spec = linear(&operated.cases[2], 2.2);
    spec["correction"] = json!({"model": second["id"]});
    refused("stale", &server.job(&spec).await, "/correction/model", "model-stale");

    // Two are too few.
    let learn = server.job(&json!({"kind": "learn", "cohort": other})).await;
    refused("two", &learn, "/cohort/members", "out-of-range");
}

#[tokio::test]
async fn a_member_leaves_with_the_case_whose_model_corrected_its_prediction() {
    let server = Server::start();
    let mut operated = Operated::on(&server, 5).await;
    let cohort = kept(&server, &operated.cohort(&[0, 1, 2])).await;
    let mut spec = linear(&operated.cases[3], 2.2);
    spec["correction"] = json!({"model": learned(&server, &cohort).await["id"]});
    let corrected = server.job(&spec).await.expect(StatusCode::OK);
    operated.members[3] =
        json!({"prediction": corrected["id"], "actual": operated.members[3]["actual"]});
    for member in &mut operated.members {
        member.as_object_mut().unwrap().remove("comparisons");
    }
    let other = kept(&server, &operated.cohort(&[1, 3, 4])).await;
    erase(&server, &format!("/v1/cases/{}", operated.cases[0])).await;
    let view = show(&server, &other).await;
    assert_eq!(view["left"], json!([{"case": operated.cases[3], "version": 2}]));
    assert_eq!(view["members"].as_array().unwrap().len(), 2);

    // A patient whom a model was learned from is not to be predicted with it.
    let rest = kept(&server, &operated.cohort(&[1, 2, 4])).await;
    let mut spec = linear(&operated.cases[1], 2.2);
    spec["correction"] = json!({"model": learned(&server, &rest).await["id"]});
    refused("own", &server.job(&spec).await, "/correction/model", "duplicate-name");
}

#[tokio::test]
async fn what_was_measured_in_another_place_is_registered_before_it_is_learned_from() {
    let server = Server::start();
    let operated = Operated::on(&server, 3).await;
    let mut document = operated.cohort(&[0, 1, 2]);
    let straight = learned(&server, &kept(&server, &document).await).await;
    let beside = after_beside(2, Vector::new(7.0, -3.0, 2.0), Frame::Unspecified);
    document["members"][1]["actual"] = uploaded(&server, "", beside).await.into();
    document["members"][1]["matrix4x4"] = json!([1, 0, 0, -7, 0, 1, 0, 3, 0, 0, 1, -2, 0, 0, 0, 1]);
    let registered = learned(&server, &kept(&server, &document).await).await;
    let means = |job: &Value| -> Vec<f64> {
        let table = job["results"]["learning"]["table"].as_array().unwrap();
        table.iter().map(|column| column["mean"].as_f64().unwrap()).collect()
    };
    for (one, other) in means(&straight).iter().zip(means(&registered)) {
        assert!((one - other).abs() < 1e-5, "{one} {other}");
    }
    assert_eq!(means(&straight).len(), 12);
}

/// A document with another value at a place of it.
fn set(document: &Value, pointer: &str, value: Value) -> Value {
    let mut changed = document.clone();
    *changed.pointer_mut(pointer).unwrap() = value;
    changed
}

/// Refused, first of all for what is at this place.
fn refused(name: &str, answer: &Answer, pointer: &str, code: &str) {
    let problem = answer.json();
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{name}: {problem}");
    let told = &problem["errors"][0];
    let told = (told["pointer"].as_str().unwrap(), told["code"].as_str().unwrap());
    assert_eq!(told, (pointer, code), "{name}: {problem}");
}

#[tokio::test]
async fn a_cohort_that_is_wrong_in_itself_is_refused_with_the_place() {
    let server = Server::start();
    let operated = Operated::on(&server, 3).await;
    let good = operated.cohort(&[0, 1, 2]);
    let one = &operated.members[0];
    let mut silent = good.clone();
    silent.as_object_mut().unwrap().remove("consent");
    let mut flat = good.clone();
    flat["members"][1]["matrix4x4"] = json!([2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    let mut named = good.clone();
    named["members"][2]["name"] = "1".into();
    let twice = |member: &str| {
        let place = format!("/members/2/{member}");
        (set(&good, &place, one[member].clone()), place)
    };
    let [(job_twice, job), (mesh_twice, mesh)] = ["prediction", "actual"].map(twice);
    let other = set(&good, "/members/1/comparisons", json!({"mtm": one["prediction"]}));
    let uses = set(&good, "/consent/uses", json!(["sell"]));
    for (name, document, pointer, code) in [
        ("n of 1", set(&good, "/members", json!([one])), "/members", "out-of-range"),
        ("nobody", set(&good, "/members", json!([])), "/members", "out-of-range"),
        ("a prediction twice", job_twice, &job, "duplicate-name"),
        ("a mesh twice", mesh_twice, &mesh, "duplicate-name"),
        ("a name that is a number", named, "/members/2/name", "duplicate-name"),
        ("no consent", silent, "/members/0/consent", "missing-field"),
        ("a use without a name", uses, "/consent/uses/0", "unknown-word"),
        ("not rigid", flat, "/members/1/matrix4x4", "plan-not-rigid"),
        ("other methods", other, "/members/1/comparisons", "out-of-range"),
    ] {
        refused(name, &post(&server, &document).await, pointer, code);
    }
}

#[tokio::test]
async fn a_cohort_of_what_does_not_belong_together_is_refused_with_the_place() {
    let server = Server::start();
    let operated = Operated::on(&server, 3).await;
    let good = operated.cohort(&[0, 1, 2]);
    let second = server.job(&linear(&operated.cases[0], 1.5)).await.expect(StatusCode::OK);
    let mut turned = SMALL.case();
    turned["frame"] = "RAS".into();
    let turned = ask(server.post("/v1/cases").multipart(SMALL.form(&turned))).await;
    let turned = linear(&id(&turned.expect(StatusCode::CREATED)), 1.0);
    let turned = server.job(&turned).await.expect(StatusCode::OK);
    let marked = uploaded(&server, "", after_beside(3, Vector::zeros(), Frame::Ras)).await;
    let learning = learned(&server, &kept(&server, &good).await).await;
    let nobody = json!(uuid::Uuid::now_v7());
    let first = operated.members[0]["prediction"].clone();
    let comparison = "/members/1/comparisons/linear";
    for (name, place, value, code) in [
        ("a case twice", "/members/2/prediction", second["id"].clone(), "duplicate-name"),
        ("mixed frames", "/members/2/prediction", turned["id"].clone(), "frame-conflict"),
        ("a mesh in another frame", "/members/2/actual", json!(marked), "frame-conflict"),
        ("the comparison of another", comparison, first, "other-case"),
        ("no comparison", comparison, learning["id"].clone(), "no-such-output"),
        ("no such job", "/members/1/prediction", nobody.clone(), "unknown-job"),
        ("no prediction", "/members/1/prediction", learning["id"].clone(), "no-such-output"),
        ("no such mesh", "/members/1/actual", nobody.clone(), "unknown-mesh"),
    ] {
        refused(name, &post(&server, &set(&good, place, value)).await, place, code);
    }
}

#[tokio::test]
async fn a_job_uses_no_member_that_is_not_to_be_used_so() {
    let server = Server::start();
    let operated = Operated::on(&server, 3).await;
    let mut document = operated.cohort(&[0, 1, 2]);
    document["members"][1]["consent"] = json!({"statement": "errors only", "uses": ["compare"]});
    let cohort = kept(&server, &document).await;
    server.job(&json!({"kind": "cohort", "cohort": cohort})).await.expect(StatusCode::OK);
    let both = json!({"kind": "learn", "cohort": cohort, "virtual": {"patients": 3}});
    let groups = json!({"a": [operated.members[0]["prediction"]]});
    let nobody = uuid::Uuid::now_v7();
    // And the other way round: what may be learned from is not yet to be compared.
    document["members"][1]["consent"] = json!({"statement": "models only", "uses": ["learn"]});
    let learning = kept(&server, &document).await;
    learned(&server, &learning).await;
    let view = show(&server, &learning).await;
    assert_eq!(view["members"][1]["member"]["consent"], document["members"][1]["consent"]);
    for (name, job, pointer, code) in [
        ("not compared", json!({"kind": "cohort", "cohort": learning}), "/cohort", "not-consented"),
        ("not asked", json!({"kind": "learn", "cohort": cohort}), "/cohort", "not-consented"),
        ("no such cohort", json!({"kind": "learn", "cohort": nobody}), "/cohort", "unknown-cohort"),
        ("two", both, "", "one-of"),
        ("groups too", json!({"kind": "cohort", "cohort": cohort, "groups": groups}), "", "one-of"),
    ] {
        refused(name, &server.job(&job).await, pointer, code);
    }
}

#[tokio::test]
async fn the_service_takes_the_cohort_of_its_description() {
    let server = Server::start();
    let operated = Operated::on(&server, 3).await;
    let examples = facies::api::document();
    let content = &examples["paths"]["/v1/cohorts"]["post"]["requestBody"]["content"];
    let example = &content["application/json"]["examples"]["cohort"]["value"];
    let mut text = example.to_string();
    for (index, member) in operated.members.iter().enumerate() {
        for (group, of) in [(1, "prediction"), (2, "actual"), (3, "prediction")] {
            let example = format!("0199d3a0-0000-7000-8000-0000000000{group}{}", index + 1);
            text = text.replace(&example, member[of].as_str().unwrap());
        }
    }
    kept(&server, &serde_json::from_str(&text).unwrap()).await;
}

#[tokio::test]
async fn a_cohort_is_there_again_when_the_service_is() {
    let server = Server::start();
    let operated = Operated::on(&server, 4).await;
    let cohort = kept(&server, &operated.cohort(&[0, 1, 2, 3])).await;
    learned(&server, &cohort).await;
    erase(&server, &format!("/v1/cases/{}", operated.cases[3])).await;
    let before = show(&server, &cohort).await;
    let server = Server::start_in(server.kill(), &[]);
    assert_eq!(show(&server, &cohort).await, before);
    assert_eq!(learned(&server, &cohort).await["results"]["learning"]["cohort"]["version"], 2);
    let states: Vec<Value> = show(&server, &cohort).await["models"]
        .as_array()
        .unwrap()
        .iter()
        .map(|model| model["state"].clone())
        .collect();
    assert_eq!(states, ["current", "erased"]);
}

#[tokio::test]
async fn a_cohort_is_its_tenants_and_what_is_done_to_it_is_noted() {
    let hospital = Hospital::open();
    let all = ["read", "write", "run", "admin"];
    let (ours, theirs) = (hospital.key("a", &all).await, hospital.key("b", &all).await);
    let operated = Operated::by(&hospital.server, &ours, 3).await;
    let document = operated.cohort(&[0, 1, 2]);
    let reader = hospital.key("a", &["read"]).await;
    hospital.post(&reader, "/v1/cohorts", &document).await.problem(403, "forbidden-scope");
    let foreign = hospital.post(&theirs, "/v1/cohorts", &document).await;
    let foreign = foreign.problem(422, "validation-failed");
    assert_eq!(foreign["errors"][0]["code"], "unknown-job");
    let cohort = hospital.post(&ours, "/v1/cohorts", &document).await;
    let cohort = id(&cohort.expect(StatusCode::CREATED));

    let path = format!("/v1/cohorts/{cohort}");
    hospital.get(&reader, &path).await.expect(StatusCode::OK);
    hospital.get(&theirs, &path).await.problem(404, "not-found");
    let listed = hospital.get(&theirs, "/v1/cohorts").await.expect(StatusCode::OK);
    assert_eq!(listed["items"], json!([]));
    for kind in ["learn", "cohort"] {
        let job = json!({"kind": kind, "cohort": cohort});
        let problem =
            hospital.post(&theirs, "/v1/jobs", &job).await.problem(422, "validation-failed");
        assert_eq!(problem["errors"][0]["code"], "unknown-cohort");
    }
    let delete = |key: &str| {
        let request = hospital.server.request(Method::DELETE, &path).bearer_auth(key);
        ask(request.header("if-match", "*"))
    };
    delete(&theirs).await.problem(404, "not-found");
    assert_eq!(delete(&ours).await.status, StatusCode::NO_CONTENT);

    let log = hospital.get(&ours, "/v1/audit?limit=200").await.expect(StatusCode::OK);
    let actions: Vec<[&str; 3]> = log["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| ["action", "object", "outcome"].map(|name| row[name].as_str().unwrap()))
        .collect();
    for wanted in [
        ["POST /v1/cohorts", "", "403"],
        ["POST /v1/cohorts", cohort.as_str(), "201"],
        ["DELETE /v1/cohorts/{id}", cohort.as_str(), "204"],
    ] {
        assert!(actions.contains(&wanted), "{wanted:?} is not in {actions:?}");
    }
}

/// A job of a key, ended.
async fn waited(hospital: &Hospital, key: &str, spec: Value) -> Answer {
    let request = hospital.server.post("/v1/jobs").bearer_auth(key);
    ask(request.header("prefer", "wait=30").json(&spec)).await
}

/// Three cohorts of four cases, and models of each rule, of cohorts and of cases by themselves: those of the last cohort, made
/// last, know nothing of the first case.
async fn models_of(
    hospital: &Hospital,
    key: &str,
    operated: &Operated,
) -> (Vec<String>, Vec<String>) {
    let mut cohorts = Vec::new();
    for members in [&[0, 1, 2][..], &[0, 1, 3], &[1, 2, 3]] {
        let cohort = hospital.post(key, "/v1/cohorts", &operated.cohort(members)).await;
        cohorts.push(id(&cohort.expect(StatusCode::CREATED)));
    }
    let member = |index: usize| {
        let own = &operated.members[index];
        json!({"prediction": own["prediction"], "actual": own["actual"]})
    };
    let specs = [
        json!({"kind": "learn", "cohort": cohorts[0]}),
        json!({"kind": "learn", "cohort": cohorts[0], "learner": "deformation_model"}),
        json!({"kind": "learn", "cohort": cohorts[1], "target": "displacement"}),
        json!({"kind": "learn", "cases": [member(0), member(2), member(3)]}),
        json!({"kind": "learn", "cohort": cohorts[2]}),
    ];
    let mut models = Vec::new();
    for spec in specs {
        let learned = waited(hospital, key, spec).await.expect(StatusCode::OK);
        assert_eq!(learned["status"], "successful", "{learned}");
        models.push(id(&learned));
    }
    (cohorts, models)
}

#[tokio::test]
async fn a_case_goes_out_of_every_model_and_the_log_says_who_learned_and_who_erased() {
    let hospital = Hospital::open();
    let all = ["read", "write", "run", "admin"];
    let (learner, eraser) = (hospital.key("a", &all).await, hospital.key("a", &all).await);
    let theirs = hospital.key("b", &all).await;
    let operated = Operated::by(&hospital.server, &learner, 4).await;
    let (cohorts, models) = models_of(&hospital, &learner, &operated).await;
    let [last, gone @ ..] = [4, 0, 1, 2, 3].map(|index: usize| models[index].as_str());

    // A model is its tenant's, and so is what it would correct.
    let foreign = Operated::by(&hospital.server, &theirs, 1).await;
    let mut spec = linear(&foreign.cases[0], 2.2);
    spec["correction"] = json!({"model": last});
    let corrected = waited(&hospital, &theirs, spec).await;
    refused("theirs", &corrected, "/correction/model", "unknown-job");

    let path = format!("/v1/cases/{}", operated.cases[0]);
    let erased = hospital.server.delete(&path).bearer_auth(&eraser).header("if-match", "*");
    assert_eq!(ask(erased).await.status, StatusCode::NO_CONTENT);
    for model in gone {
        hospital.get(&learner, &format!("/v1/jobs/{model}")).await.problem(410, "gone");
    }
    hospital.get(&learner, &format!("/v1/jobs/{last}")).await.expect(StatusCode::OK);
    let erased = |model: &str| json!({"job": model, "version": 1, "state": "erased", "left": [operated.cases[0]]});
    for (cohort, version, models) in [
        (&cohorts[0], 2, vec![erased(gone[1]), erased(gone[0])]),
        (&cohorts[1], 2, vec![erased(gone[2])]),
        (&cohorts[2], 1, vec![json!({"job": last, "version": 1, "state": "current"})]),
    ] {
        let view = hospital.get(&learner, &format!("/v1/cohorts/{cohort}")).await;
        let view = view.expect(StatusCode::OK);
        assert_eq!((&view["version"], &view["models"]), (&json!(version), &json!(models)));
    }

    let log = hospital.get(&learner, "/v1/audit?limit=200").await.expect(StatusCode::OK);
    let rows = log["items"].as_array().unwrap();
    let of = |action: &str, object: &str| {
        let is = |row: &&Value| row["action"] == action && row["object"] == object;
        rows.iter().find(is).unwrap_or_else(|| panic!("{action} of {object:?} in {rows:?}"))
    };
    let keeper = &of("POST /v1/cohorts", &cohorts[0])["actor"];
    for model in &models {
        let learned = of("POST /v1/jobs", model);
        assert_eq!((&learned["actor"], &learned["tenant"]), (keeper, &json!("a")));
    }
    let erased = of("DELETE /v1/cases/{id}", &operated.cases[0]);
    assert_eq!(erased["outcome"], "204");
    assert_ne!(&erased["actor"], keeper, "another key");
    // Nothing of it is in the log of another tenant.
    let log = hospital.get(&theirs, "/v1/audit?limit=200").await.expect(StatusCode::OK);
    let rows = log["items"].as_array().unwrap();
    assert!(!rows.is_empty(), "their own requests are in it");
    assert!(rows.iter().all(|row| models.iter().all(|model| row["object"] != model.as_str())));
}
