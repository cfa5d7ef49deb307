//! Many processes on one PostgreSQL and one store of objects, and what happens when one of them goes.

use std::io::BufRead;
use std::process::{Command, Output, Stdio};

use facies::config::DatabaseLocation;
use facies::store::Store;
use reqwest::StatusCode;
use serde_json::json;
use tempfile::TempDir;

use crate::deployments::{Cluster, Deployment};
use crate::helpers::{Block, SMALL, Server, ask, serve_shared, spec};
use crate::invariants::{MEDIUM, accepted, tagged};
use crate::partition::Way;
use crate::processes::{signal, stopped_slot, until};
use crate::support::external::Missing;
use crate::support::trials::trials;
use crate::workers::Worker;

trials! {
    on_shared {
        a_job_that_one_host_accepts_is_solved_by_another_and_served_by_a_third
        a_worker_tells_what_it_counts_and_that_it_lives
        a_job_whose_host_is_killed_is_solved_by_another
        a_worker_cut_off_from_the_database_loses_its_job_to_another_and_changes_nothing
        a_store_of_blobs_that_does_not_answer_is_reported_as_503
        a_deployment_is_checked_and_mended_by_command
        a_service_moves_from_sqlite_to_postgresql_by_command
        an_export_from_a_server_needs_no_stop_of_it
    }
    alone {
        a_restart_of_postgresql_loses_nothing_and_is_reported_as_503
        a_database_that_was_not_prepared_is_refused_with_78_until_it_is
        a_wrong_password_or_address_stops_the_start_with_78
    }
}

/// Takes a while to store.
const LARGE: Block = Block { cells: [44, 44, 30] };
/// The slot of a job stands still until it is told to go on.
const STANDS_STILL: &str = "solve:begin:1:stop:attempt=1:tag=slow";

fn api(on: &Deployment) -> Server {
    let mut command = serve_shared(on);
    command.args(["--workers", "0"]);
    Server::start_command(command, TempDir::new().unwrap())
}

fn facies(arguments: &[&str], on: &Deployment) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    command.args(arguments);
    on.bring(&mut command);
    command.stdin(Stdio::null()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

async fn a_job_that_one_host_accepts_is_solved_by_another_and_served_by_a_third(on: Deployment) {
    let (first, second) = (api(&on), api(&on));
    let case = first.case(&SMALL).await;
    let accepted = ask(first.post("/v1/jobs").json(&spec(&case, 1.0))).await;
    let id = accepted.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
    let _worker = Worker::start(&on);
    let job = second.ended(&id).await;
    assert_eq!(job["status"], "successful");
    for file in job["results"]["files"].as_array().unwrap() {
        let name = file["name"].as_str().unwrap();
        let answer = ask(second.get(&format!("/v1/jobs/{id}/results/{name}"))).await;
        let found = facies::schema::wire::canonical::sha256_hex(&answer.bytes);
        assert_eq!(found, file["sha256"].as_str().unwrap());
    }
    // Who watches sees all of it, wherever it happened.
    let told = text(&ask(first.get(&format!("/v1/jobs/{id}/events"))).await.bytes);
    for status in ["accepted", "running", "successful"] {
        assert!(told.contains(&format!("\"status\":\"{status}\"")), "{told}");
    }
    let known = ask(second.post("/v1/jobs").json(&spec(&case, 1.0))).await;
    assert_eq!(known.expect(StatusCode::OK)["deduplicated"], true);
}

async fn a_worker_tells_what_it_counts_and_that_it_lives(on: Deployment) {
    let (_worker, mut said) = Worker::start_with(&on, &["--admin-bind", "127.0.0.1:0"]);
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let metrics = line.trim().strip_prefix("metrics on ").unwrap();
    let api = api(&on);
    let case = api.case(&SMALL).await;
    api.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    // It counts once the result is there for all.
    let counted = "facies_attempts_total{kind=\"predict\",status=\"successful\"} 1";
    until("that the attempt is counted", async || {
        text(&ask(api.client.get(metrics)).await.bytes).contains(counted).then_some(())
    })
    .await;
    let healthz = metrics.replace("/metrics", "/healthz");
    assert_eq!(ask(api.client.get(&healthz)).await.status, StatusCode::OK);
}

async fn a_job_whose_host_is_killed_is_solved_by_another(on: Deployment) {
    let api = api(&on);
    let case = api.case(&MEDIUM).await;
    let id = accepted(&api, &spec(&case, 2.0)).await;
    let mut command = Worker::command(&on);
    command.env("FACIES_FAULT", "solve:iteration:3:hold");
    let (first, _) = Worker::start_command(command);
    assert_eq!(api.started(&id).await["status"], "running");
    drop(first);
    let _second = Worker::start(&on);
    let job = api.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&json!("successful"), &json!(2)));
}

async fn a_worker_cut_off_from_the_database_loses_its_job_to_another_and_changes_nothing(
    on: Deployment,
) {
    let DatabaseLocation::Server { address, .. } = &on.places.database else {
        panic!("it is shared")
    };
    let way = Way::to(address.reveal());
    let api = api(&on);
    let case = api.case(&SMALL).await;
    let id = accepted(&api, &tagged(&case, 3.0, "slow")).await;
    let mut command = Worker::command(&on);
    command.args(["--database", &way.address]).env("FACIES_FAULT", STANDS_STILL);
    let (cut_off, _) = Worker::start_command(command);
    let slot = stopped_slot(cut_off.process()).await;
    way.cut();
    // It solves the job, and nobody hears of it.
    signal(slot, "CONT");
    let other = Worker::start(&on);
    let job = api.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&json!("successful"), &json!(2)));
    drop(other);
    way.mend();
    // The first one is back when it has done something else; what it had done before is not there.
    let next = api.ended(&accepted(&api, &spec(&case, 4.0)).await).await;
    assert_eq!((&next["status"], &next["attempt"]), (&json!("successful"), &json!(1)));
    assert_eq!(ask(api.get(&format!("/v1/jobs/{id}"))).await.json(), job);
}

async fn a_restart_of_postgresql_loses_nothing_and_is_reported_as_503() -> Result<(), Missing> {
    let cluster = Cluster::start()?;
    let on = Deployment::on(&cluster.database().await);
    Store::migrate(&on.places).await.unwrap();
    let mut command = serve_shared(&on);
    command.args(["--workers", "1"]).env("FACIES_FAULT", STANDS_STILL);
    let server = Server::start_command(command, TempDir::new().unwrap());
    let case = server.case(&SMALL).await;
    let id = accepted(&server, &tagged(&case, 2.0, "slow")).await;
    let slot = stopped_slot(server.process()).await;

    cluster.control(&["-m", "immediate", "stop"]);
    let answer = ask(server.get(&format!("/v1/jobs/{id}"))).await;
    answer.problem(503, "not-ready");
    assert!(!answer.header("retry-after").is_empty());
    ask(server.post("/v1/jobs").json(&spec(&case, 3.0))).await.problem(503, "not-ready");
    ask(server.get("/readyz")).await.problem(503, "not-ready");
    assert_eq!(ask(server.get("/healthz")).await.status, StatusCode::OK);

    signal(slot, "CONT");
    cluster.control(&["start"]);
    assert_eq!(server.ended(&id).await["status"], "successful");
    let jobs = ask(server.get("/v1/jobs")).await.expect(StatusCode::OK);
    assert_eq!(jobs["items"].as_array().unwrap().len(), 1);
    let next = server.job(&spec(&case, 3.0)).await;
    assert!(next.status.is_success());
    Ok(())
}

async fn a_store_of_blobs_that_does_not_answer_is_reported_as_503(on: Deployment) {
    let case = api(&on).case(&SMALL).await;
    let mut command = serve_shared(&on);
    command.env("AWS_ENDPOINT_URL", "http://127.0.0.1:1");
    let server = Server::start_command(command, TempDir::new().unwrap());
    let answer = server.upload(LARGE.vtu()).await;
    answer.problem(503, "not-ready");
    assert!(!answer.header("retry-after").is_empty());
    let meshes = on.texts("SELECT id FROM meshes").await;
    assert_eq!(meshes.len(), 1, "no half mesh");
    let unfinished = on.texts("SELECT id FROM unfinished_blobs").await;
    assert_eq!(unfinished.len(), 1, "what may have come is looked for later");
    ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await.problem(503, "not-ready");
    ask(server.get("/readyz")).await.problem(503, "not-ready");
}

async fn a_database_that_was_not_prepared_is_refused_with_78_until_it_is() -> Result<(), Missing> {
    let on = Deployment::empty().await?;
    let refused = facies(&["serve", "--bind", "127.0.0.1:0"], &on);
    assert_eq!(refused.status.code(), Some(78));
    assert!(text(&refused.stderr).contains("facies migrate"), "{}", text(&refused.stderr));
    let done = facies(&["migrate"], &on);
    assert!(done.status.success() && text(&done.stdout).contains("from schema step 0 to"));
    let nothing = facies(&["migrate"], &on);
    assert!(nothing.status.success() && !text(&nothing.stdout).contains("from"));
    let server = api(&on);
    assert_eq!(ask(server.get("/readyz")).await.status, StatusCode::OK);
    Ok(())
}

async fn a_deployment_is_checked_and_mended_by_command(on: Deployment) {
    let server = api(&on);
    server.case(&SMALL).await;
    let clean = facies(&["admin", "fsck", "--read-all"], &on);
    assert!(clean.status.success(), "{clean:?}");
    let object = on.objects().pop().unwrap();
    let orphan = object.with_file_name("0".repeat(64));
    std::fs::copy(&object, &orphan).unwrap();
    let found = facies(&["admin", "fsck"], &on);
    assert_eq!(found.status.code(), Some(1));
    assert!(text(&found.stdout).starts_with("known to no row: "), "{found:?}");
    let mended = facies(&["admin", "fsck", "--repair"], &on);
    assert!(mended.status.success() && !orphan.exists());
    std::fs::remove_file(&object).unwrap();
    let lost = facies(&["admin", "fsck", "--repair"], &on);
    assert_eq!(lost.status.code(), Some(1));
    assert!(text(&lost.stdout).starts_with("lost or damaged: blob "), "{lost:?}");
}

async fn a_service_moves_from_sqlite_to_postgresql_by_command(on: Deployment) {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = server.job(&spec(&case, 1.0)).await.expect(StatusCode::OK);
    let (folder, _) = server.terminate();
    let export = on.folder().join("export");
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    command.args(["admin", "export", "--data"]).arg(folder.path()).arg("--to").arg(&export);
    assert!(command.output().unwrap().status.success());
    let imported = facies(&["admin", "import", "--from", export.to_str().unwrap()], &on);
    assert!(imported.status.success(), "{imported:?}");

    let server = api(&on);
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let moved = ask(server.get(&path)).await.expect(StatusCode::OK);
    assert_eq!(moved["results"], job["results"]);
    let known = ask(server.post("/v1/jobs").json(&spec(&case, 1.0))).await;
    assert_eq!(known.expect(StatusCode::OK)["id"], job["id"]);
    let skin = ask(server.get(&format!("{path}/results/skin.vtp"))).await;
    assert_eq!(skin.status, StatusCode::OK);
}

async fn an_export_from_a_server_needs_no_stop_of_it(on: Deployment) {
    let server = api(&on);
    server.case(&SMALL).await;
    let export = on.folder().join("export");
    let done = facies(&["admin", "export", "--to", export.to_str().unwrap()], &on);
    assert!(done.status.success(), "{done:?}");
    let again = facies(&["admin", "export", "--to", export.to_str().unwrap()], &on);
    assert_eq!(again.status.code(), Some(2), "nothing is overwritten");
    let error = String::from_utf8_lossy(&again.stderr);
    let named = error.contains(export.to_str().unwrap()) && error.contains("a new folder");
    assert!(named, "{error}");
}

async fn a_wrong_password_or_address_stops_the_start_with_78() -> Result<(), Missing> {
    let folder = TempDir::new().unwrap();
    let start = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
        command.args(["serve", "--bind", "127.0.0.1:0", "--data"]).arg(folder.path());
        command.args(arguments).output().unwrap()
    };
    let refused = start(&["--database", "mysql://root:secret@h/x"]);
    assert_eq!(refused.status.code(), Some(78));
    assert!(!text(&refused.stderr).contains("secret"));
    let on = Deployment::empty().await?;
    let mut command = Command::new("unused");
    on.bring(&mut command);
    let address = command.get_args().find(|argument| argument.to_string_lossy().contains("://"));
    let address = address.unwrap().to_string_lossy().into_owned();
    let nobody = address.replace("postgres@", "no_such_role:secret@");
    let refused = start(&["--database", &nobody]);
    assert_eq!(refused.status.code(), Some(78), "{refused:?}");
    let line = text(&refused.stderr);
    assert!(line.lines().count() == 1 && !line.contains("secret"), "{line}");
    let nowhere = "postgres://postgres@127.0.0.1:1/x";
    assert_eq!(start(&["--database", nowhere]).status.code(), Some(3));
    Ok(())
}
