//! Starts the service on a free port with a folder of its own; makes small scenes.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Frame, Vector, sample};
use reqwest::multipart::{Form, Part};
use reqwest::{Client, Method, RequestBuilder, Response, StatusCode};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::deployments::Deployment;

/// A service in a process of its own. It is killed when the test ends.
pub struct Server {
    child: Child,
    stdout: BufReader<ChildStdout>,
    address: String,
    pub client: Client,
    folder: TempDir,
}

/// Leases that a worker keeps on a machine where it does not get to run for some seconds; one that is lost is noticed after
/// as many.
pub const LEASES: [&str; 4] = ["--lease-s", "5", "--heartbeat-s", "0.2"];

/// The command that serves from a folder.
pub fn serve(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    command
        .arg("serve")
        .args(["--bind", "127.0.0.1:0", "--data"])
        .arg(folder)
        .args(LEASES)
        .args(["--free-space-floor-mib", "0"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    command
}

/// The command that serves a deployment that others share.
pub fn serve_shared(on: &Deployment) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
    command.arg("serve").args(["--bind", "127.0.0.1:0"]);
    on.bring(&mut command);
    command
        .args(LEASES)
        .args(["--free-space-floor-mib", "0"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    command
}

impl Server {
    pub fn start() -> Server {
        Server::start_with(&[])
    }

    pub fn start_with(arguments: &[&str]) -> Server {
        Server::start_in(TempDir::new().unwrap(), arguments)
    }

    pub fn start_in(folder: TempDir, arguments: &[&str]) -> Server {
        let mut command = serve(folder.path());
        command.args(arguments);
        Server::start_command(command, folder)
    }

    pub fn start_command(mut command: Command, folder: TempDir) -> Server {
        let mut child = command.spawn().unwrap();
        let mut line = String::new();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        stdout.read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("listening on ");
        let address = address.unwrap_or_else(|| panic!("the server said {line:?}")).to_owned();
        // The client of tests and the store's client of S3 are one crate, which wants to be told.
        let _ = rustls::crypto::ring::default_provider().install_default();
        Server { child, stdout, address, client: Client::new(), folder }
    }

    /// What the process says after where it listens.
    pub fn second_line(&mut self) -> String {
        let mut line = String::new();
        self.stdout.read_line(&mut line).unwrap();
        line.trim().to_owned()
    }

    /// The other end of its standard error, where that is a pipe.
    pub fn standard_error(&mut self) -> ChildStderr {
        self.child.stderr.take().unwrap()
    }

    pub fn process(&self) -> u32 {
        self.child.id()
    }

    /// Waits for a process that ends by itself; the folder stays.
    pub fn dies(mut self) -> TempDir {
        self.child.wait().unwrap();
        let empty = TempDir::new().unwrap();
        std::mem::replace(&mut self.folder, empty)
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// SIGKILL, as by a power cut; the folder stays.
    pub fn kill(mut self) -> TempDir {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        let empty = TempDir::new().unwrap();
        std::mem::replace(&mut self.folder, empty)
    }

    /// SIGTERM, as by a rolling update; true when the process ended well.
    pub fn terminate(mut self) -> (TempDir, bool) {
        let process = self.child.id().to_string();
        let told = Command::new("kill").args(["-TERM", &process]).status().unwrap();
        assert!(told.success());
        let ended = self.child.wait().unwrap().success();
        let empty = TempDir::new().unwrap();
        (std::mem::replace(&mut self.folder, empty), ended)
    }

    /// The same, with the most that the process may take to end.
    pub fn terminate_within(mut self, most: Duration) -> bool {
        let process = self.child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &process]).status().unwrap().success());
        let until = Instant::now() + most;
        while Instant::now() < until {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status.success();
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        false
    }

    pub fn host(&self) -> &str {
        self.address.strip_prefix("http://").unwrap()
    }

    pub fn request(&self, method: Method, path: &str) -> RequestBuilder {
        self.client.request(method, format!("{}{path}", self.address))
    }

    pub fn get(&self, path: &str) -> RequestBuilder {
        self.request(Method::GET, path)
    }

    pub fn post(&self, path: &str) -> RequestBuilder {
        self.request(Method::POST, path)
    }

    pub fn delete(&self, path: &str) -> RequestBuilder {
        self.request(Method::DELETE, path)
    }

    /// Uploads bytes, any scale allowed.
    pub async fn upload(&self, bytes: impl Into<reqwest::Body>) -> Answer {
        let request = self.post("/v1/meshes?allow_any_scale=true");
        ask(request.header("content-type", "application/octet-stream").body(bytes)).await
    }

    /// Keeps a case with the block as its volume, in one request; its id.
    pub async fn case(&self, block: &Block) -> String {
        let answer = ask(self.post("/v1/cases").multipart(block.form(&block.case()))).await;
        answer.expect(StatusCode::CREATED)["id"].as_str().unwrap().to_owned()
    }

    /// Posts a job and waits for its end.
    pub async fn job(&self, spec: &Value) -> Answer {
        ask(self.post("/v1/jobs").header("prefer", "wait=30").json(spec)).await
    }

    /// The state of a job once it has ended.
    pub async fn ended(&self, id: &str) -> Value {
        loop {
            let request = self.get(&format!("/v1/jobs/{id}")).header("prefer", "wait=30");
            let state = ask(request).await.expect(StatusCode::OK);
            if !matches!(state["status"].as_str(), Some("accepted" | "running")) {
                return state;
            }
        }
    }

    /// The state of a job once a worker has claimed it.
    pub async fn started(&self, id: &str) -> Value {
        loop {
            let state = ask(self.get(&format!("/v1/jobs/{id}"))).await.expect(StatusCode::OK);
            if state["status"] != "accepted" {
                return state;
            }
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// An answer that was read to its end.
#[derive(Debug)]
pub struct Answer {
    pub status: StatusCode,
    pub headers: reqwest::header::HeaderMap,
    pub bytes: Vec<u8>,
}

pub async fn ask(request: RequestBuilder) -> Answer {
    read(request.send().await.unwrap()).await
}

pub async fn read(response: Response) -> Answer {
    Answer {
        status: response.status(),
        headers: response.headers().clone(),
        bytes: response.bytes().await.unwrap().to_vec(),
    }
}

impl Answer {
    pub fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |value| value.to_str().unwrap())
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.bytes)
            .unwrap_or_else(|error| panic!("{error}: {:?}", String::from_utf8_lossy(&self.bytes)))
    }

    /// The body, when the status is the one expected.
    #[track_caller]
    pub fn expect(&self, status: StatusCode) -> Value {
        let text = String::from_utf8_lossy(&self.bytes);
        assert_eq!(self.status, status, "{text}");
        if self.bytes.is_empty() { Value::Null } else { self.json() }
    }

    /// The problem, when it has this status and this code and everything a problem has to have.
    #[track_caller]
    pub fn problem(&self, status: u16, code: &str) -> Value {
        self.problem_of(code, status, code)
    }

    /// The same with a name for the message.
    #[track_caller]
    pub fn problem_of(&self, name: &str, status: u16, code: &str) -> Value {
        let text = String::from_utf8_lossy(&self.bytes);
        assert_eq!(self.status.as_u16(), status, "{name}: {text}");
        assert_eq!(self.header("content-type"), "application/problem+json", "{name}");
        let problem = self.json();
        assert_eq!(problem["code"], code, "{name}: {text}");
        assert_eq!(problem["status"], status, "{name}: {text}");
        assert_eq!(problem["instance"], self.header("x-request-id"), "{name}: {text}");
        assert!(problem["type"].as_str().unwrap().ends_with(code), "{name}: {text}");
        assert!(!problem["detail"].as_str().unwrap().is_empty(), "{name}: {text}");
        problem
    }
}

/// A block of 60 x 60 x 30 mm, fixed at its top, with a segment `bone` at its bottom.
pub struct Block {
    pub cells: [usize; 3],
}

/// A few dozen cells: solved in milliseconds.
pub const SMALL: Block = Block { cells: [4, 4, 4] };

impl Block {
    pub fn vtu(&self) -> Vec<u8> {
        let size = Vector::new(60.0, 60.0, 30.0);
        let mesh = sample::block(size, self.cells, CellShape::Hex8);
        vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap()
    }

    /// The document, for a form with the mesh in the part `block`.
    pub fn case(&self) -> Value {
        json!({
            "schema": 1, "units": "mm", "volume": "block", "tags": ["test"],
            "segments": [{"name": "bone", "nodes": {"node_set": "z_min"}}],
            "fixed": [{"node_set": "z_max"}],
            "landmarks": {"middle": [30, 60, 15]},
        })
    }

    pub fn form(&self, case: &Value) -> Form {
        Form::new()
            .part("case", Part::text(case.to_string()))
            .part("block", Part::bytes(self.vtu()))
    }
}

/// A prediction that moves the bone by `x` mm along x.
pub fn spec(case: &str, x: f64) -> Value {
    json!({
        "kind": "predict", "case": case,
        "plan": {"segments": [{"name": "bone", "translation_mm": [x, 0, 0]}]},
    })
}
