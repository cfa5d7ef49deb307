//! The start and the end of the process.

use std::process::{Command, Output};

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::helpers::{SMALL, Server, ask, serve, spec};

fn run(command: &mut Command) -> Output {
    command.stderr(std::process::Stdio::piped()).output().unwrap()
}

/// The one line that a start with these arguments ends with, and its exit code.
fn refused(arguments: &[&str]) -> (Option<i32>, String) {
    let folder = TempDir::new().unwrap();
    let output = run(serve(folder.path()).args(arguments));
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(output.stdout.is_empty());
    (output.status.code(), text)
}

#[test]
fn a_wrong_setting_stops_the_start_with_one_line_and_78() {
    for (arguments, named) in [
        (["--workers", "many"], "workers"),
        (["--upload-mib", "0"], "upload-mib"),
        (["--heartbeat-s", "60"], "heartbeat-s"),
        (["--log-format", "xml"], "log-format"),
        (["--log-level", "=="], "log-level"),
        (["--log-level", "warning"], "log-level"),
        (["--log-level", ""], "log-level"),
        (["--log-level", "facies=loud"], "log-level"),
        (["--api-key", "short"], "api-key"),
        (["--traces", "collector:4318"], "traces"),
    ] {
        let (code, line) = refused(&arguments);
        assert_eq!(code, Some(78), "{line}");
        assert!(line.contains(named), "{line}");
    }
}

#[test]
fn config_refuses_what_a_start_refuses_without_a_connection() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let below = file.join("data");
    let [file, below] = [&file, &below].map(|path| path.to_str().unwrap());
    let config = |setting: &str, value: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
        run(command.args(["config", setting, value]))
    };
    for (setting, value) in [
        ("--log-level", "inof"),
        ("--database", "postgres://a:secret@h:99999/d"),
        ("--database", "postgres://a:secret@h/d?sslmode=foo"),
        ("--database", "postgres://a:sec/ret@h/d"),
        ("--database", "postgres://a:1/secret@h/d"),
        ("--database", "postgres://a:x?secret@h/d"),
        ("--admin-bind", "127.0.0.1:8080"),
        ("--data", file),
        ("--data", below),
        ("--blobs", file),
        ("--blobs", below),
    ] {
        let output = config(setting, value);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(78), "{setting} {value}: {told}");
        assert!(told.contains(&setting[2..]) && told.lines().count() == 1, "{told}");
        assert!(!told.contains("secret") && output.stdout.is_empty(), "{told}");
    }
    let new = folder.path().join("new/data");
    assert!(config("--data", new.to_str().unwrap()).status.success() && !new.exists());
}

#[test]
fn a_setting_is_taken_from_the_environment_too() {
    let folder = TempDir::new().unwrap();
    let output = run(serve(folder.path()).env("FACIES_WORKERS", "-1"));
    assert_eq!(output.status.code(), Some(78));
    assert!(String::from_utf8(output.stderr).unwrap().contains("workers is `-1`"));
}

#[test]
fn a_port_that_is_taken_and_a_folder_that_is_served_are_reported() {
    let server = Server::start();
    let folder = TempDir::new().unwrap();
    let mut taken = Command::new(env!("CARGO_BIN_EXE_facies"));
    taken.args(["serve", "--bind", server.host(), "--data"]).arg(folder.path());
    let output = run(&mut taken);
    assert_eq!(output.status.code(), Some(78));
    assert!(String::from_utf8(output.stderr).unwrap().contains(server.host()));
    let output = run(&mut serve(server.path()));
    assert_eq!(output.status.code(), Some(78));
    assert!(String::from_utf8(output.stderr).unwrap().contains("another facies"));
}

/// Without a terminal a bind to all interfaces is refused before anything listens.
fn all_interfaces(folder: &TempDir) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    command.args(["serve", "--bind", "0.0.0.0:0", "--data"]).arg(folder.path());
    command
}

#[test]
fn an_address_that_others_reach_needs_a_key() {
    let folder = TempDir::new().unwrap();
    let output = run(&mut all_interfaces(&folder));
    assert_eq!(output.status.code(), Some(78));
    assert!(String::from_utf8(output.stderr).unwrap().contains("api-key"));
}

#[tokio::test]
async fn a_key_is_asked_for_on_everything_but_health_and_documentation() {
    const KEY: &str = "0123456789abcdef";
    let server = Server::start_with(&["--api-key", KEY]);
    for path in ["/healthz", "/readyz", "/docs/", "/openapi.json"] {
        assert_eq!(ask(server.get(path)).await.status, StatusCode::OK, "{path}");
    }
    let with = |value: &str| server.get("/v1/limits").header("authorization", value);
    for request in [
        server.get("/v1/limits"),
        server.get(&format!("/v1/limits?api_key={KEY}")),
        server.get("/documents"),
        server.get("/nothing"),
        with("Bearer wrong-wrong-wrong"),
        with(&format!("Basic {KEY}")),
        with(KEY),
    ] {
        let answer = ask(request).await;
        answer.problem(401, "unauthorized");
        assert_eq!(answer.header("www-authenticate"), "Bearer");
    }
    let allowed = ask(with(&format!("bearer {KEY}"))).await;
    assert_eq!(allowed.status, StatusCode::OK);
}

#[tokio::test]
async fn health_tells_that_the_process_lives_and_that_it_can_work() {
    let server = Server::start();
    assert_eq!(ask(server.get("/healthz")).await.expect(StatusCode::OK)["status"], "ok");
    assert_eq!(ask(server.get("/readyz")).await.expect(StatusCode::OK)["status"], "ok");
    let mut asked = Command::new(env!("CARGO_BIN_EXE_facies"));
    assert!(run(asked.args(["health", "--bind", server.host()])).status.success());
    let full = Server::start_with(&["--free-space-floor-mib", "1048576"]);
    let answer = ask(full.get("/readyz")).await;
    let problem = answer.problem(503, "not-ready");
    assert_eq!(problem["checks"], serde_json::json!(["free-space"]));
    assert!(!answer.header("retry-after").is_empty());
    let gone = server.host().to_owned();
    drop(server);
    let mut asked = Command::new(env!("CARGO_BIN_EXE_facies"));
    assert_eq!(run(asked.args(["health", "--bind", &gone])).status.code(), Some(3));
}

#[tokio::test]
async fn logs_name_the_request_and_the_job_and_no_patient() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log");
    let mut command = serve(&folder.path().join("data"));
    command.stderr(std::fs::File::create(&log).unwrap());
    let server = Server::start_command(command, TempDir::new().unwrap());
    let mut case = SMALL.case();
    case["name"] = "Jane Roe".into();
    let stored = ask(server.post("/v1/cases").multipart(SMALL.form(&case))).await;
    let case = stored.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned();
    let request = server.post("/v1/jobs").header("prefer", "wait=30").json(&spec(&case, 1.0));
    let job = ask(request.header("x-request-id", "my-request")).await.expect(StatusCode::OK);
    let (_, ended) = server.terminate();
    assert!(ended);
    let text = std::fs::read_to_string(&log).unwrap();
    let lines: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let id = job["id"].as_str().unwrap();
    assert!(lines.iter().any(|line| line["span"]["job.id"] == id && line["duration_ms"].is_f64()));
    assert!(lines.iter().any(|line| line["span"]["request.id"] == "my-request"));
    assert!(!text.contains("Jane"), "{text}");
    assert!(!text.contains("/v1/cases/0"), "paths with ids are not logged");
}

#[test]
fn settings_come_from_flags_before_variables_before_a_file() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("facies.toml");
    let text = "workers = 3\nattempts = 4\ngrace-s = 1.5\napi-key = \"0123456789abcdef\"\n\
        database = \"postgres://facies:secret@db/facies\"\n";
    std::fs::write(&file, text).unwrap();
    let config = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
        command.args(["config", "--config"]).arg(&file).args(["--workers", "5"]);
        command.env("FACIES_ATTEMPTS", "6").env("FACIES_WORKERS", "7");
        command
    };
    let printed = String::from_utf8(run(&mut config()).stdout).unwrap();
    for line in [
        "workers = \"5\"  # --workers",
        "attempts = \"6\"  # FACIES_ATTEMPTS",
        "grace-s = \"1.5\"  # file",
        "lease-s = \"15\"  # default",
        "api-key = \"…\"  # file",
        "database = \"postgres://facies:…@db/facies\"  # file",
    ] {
        assert!(printed.lines().any(|printed| printed == line), "{line}\n{printed}");
    }
    assert!(!printed.contains("secret") && !printed.contains("0123"));

    // What is printed is a file of settings.
    std::fs::write(&file, printed.replace('…', "0123456789abcdef")).unwrap();
    assert!(run(&mut config()).status.success());

    for (text, said) in [("worker = 3", "no setting `worker`"), ("workers = [", "line 1")] {
        std::fs::write(&file, text).unwrap();
        let output = run(&mut config());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(78), "{error}");
        assert!(error.contains(said) && error.lines().count() == 1, "{error}");
    }
}

#[test]
fn a_worker_of_its_own_wants_what_others_reach() {
    let folder = TempDir::new().unwrap();
    let worker = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
        command.args(["worker", "--data"]).arg(folder.path()).args(arguments);
        let output = run(&mut command);
        assert_eq!(output.status.code(), Some(78));
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(worker(&[]).contains("database is not set"));
    assert!(worker(&["--database", "postgres://h/d"]).contains("blobs is not set"));
}

#[test]
fn every_setting_is_documented_with_its_default() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/configuration.md");
    let text = std::fs::read_to_string(path).unwrap();
    for setting in facies::config::SETTINGS {
        let default = match setting.default {
            "" => "none".to_owned(),
            default => format!("`{default}`"),
        };
        let row = format!("| `{}` | {default} | ", setting.name);
        assert!(text.contains(&row), "docs/configuration.md lacks the row {row}");
    }
}
