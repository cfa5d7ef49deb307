//! `facies demo`: the main job from end to end, through the API of a service in this process.

mod client;
mod report;
mod scene;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use bytes::Bytes;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::Value;

use super::serve::{ServeError, Server, stop_signal};
use crate::config::Config;
use crate::jobs::JobError;
use crate::jobs::result::folder;
use crate::telemetry;
use crate::worker::slots::Workers;
use client::{Client, ClientError, Part};
use mechanics::format::{self, FormatError, Mesh, ReadLimits, WriteError};
use mechanics::mesh::generic_face::{FaceSettings, Lips, generic_face};
use mechanics::mesh::half_head::{STANDARD_FINENESS, half_head};
use mechanics::mesh::refinement::refine;
use mechanics::mesh::{CellShape, TriangleSurface};
use report::Report;

/// The folder of the face that smiles, within that of the results.
const FACE: &str = "face";
const RESULT: &str = "result.json";

/// How often the state of a job is asked for.
const LOOK: Duration = Duration::from_millis(100);

#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Leave the service running afterwards and print its addresses
    #[arg(long)]
    serve: bool,
    /// Folder for the results
    #[arg(long, visible_alias = "output", value_name = "DIR", default_value = "facies-demo")]
    out: PathBuf,
    /// Address of the service, such as 127.0.0.1:8080 [default: a free port of this machine]
    #[arg(long, value_name = "ADDRESS", env = "FACIES_BIND")]
    bind: Option<String>,
    /// Folder of the service's database and files [default: OUT/service]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    #[error("{0}")]
    Serve(#[from] ServeError),
    #[error("{0}")]
    Client(#[from] ClientError),
    #[error("{0}")]
    Write(#[from] WriteError),
    #[error("the predicted skin: {0}")]
    Skin(#[from] FormatError),
    #[error(transparent)]
    Folder(#[from] JobError),
    #[error("{path}: {source}")]
    File { path: PathBuf, source: std::io::Error },
    #[error("job {job} is {status}: {detail}")]
    Job { job: String, status: String, detail: String },
    #[error("the answer to {what} lacks `{member}`")]
    Answer { what: &'static str, member: &'static str },
}

impl DemoError {
    /// Whether another setting would help.
    pub fn is_setting(&self) -> bool {
        matches!(self, DemoError::Serve(error) if error.is_setting())
    }

    /// Whether its folder has files that it did not write.
    pub fn is_refused(&self) -> bool {
        matches!(self, DemoError::Folder(JobError::Refused(_)))
    }

    /// Whether everything works and a job failed nevertheless.
    pub fn is_failed_job(&self) -> bool {
        matches!(self, DemoError::Job { .. })
    }
}

/// Runs the demo; with `--serve` it returns when the process is told to stop.
pub fn run(arguments: &Arguments) -> Result<(), DemoError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(ServeError::from)?;
    let (workers, done) = runtime.block_on(with_own_service(arguments))?;
    workers.stop(Duration::ZERO);
    runtime.shutdown_background();
    done
}

/// Starts the service, on a free port of this machine where no address is given, runs the demo, and ends the service.
async fn with_own_service(
    arguments: &Arguments,
) -> Result<(Workers, Result<(), DemoError>), DemoError> {
    let face = arguments.out.join(FACE);
    for (folder, names) in [(&arguments.out, &scene::FILES[..]), (&face, &scene::FACE_FILES[..])] {
        folder::refuse_foreign(folder, names.iter().copied().chain([RESULT]))?;
    }
    let data = arguments.data.clone().unwrap_or_else(|| arguments.out.join("service"));
    let config = Config::new(|name| setting(name, arguments.bind.as_deref(), &data))
        .map_err(ServeError::from)?;
    telemetry::start(&config.log).map_err(ServeError::from)?;
    let server = Server::start(config).await?;
    let client = Client { address: server.address };
    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let serving = tokio::spawn(server.run_until(async {
        // Whether it is sent or dropped, the demo is over.
        let _ = stopped.await;
    }));
    println!("service on http://{}, its data in {}", client.address, data.display());
    let done = show(arguments, client).await;
    if let (true, Ok(jobs)) = (arguments.serve, &done) {
        println!("\nlistening on http://{} (stop with Ctrl-C)", client.address);
        println!("  {:<20}http://{}{}", "plan it yourself", client.address, jobs[0].page());
        println!("  {:<20}http://{}{}", "a face with muscles", client.address, jobs[3].page());
        println!("  {:<20}http://{}/docs", "the API", client.address);
        for job in jobs {
            println!("  {:<20}http://{}{}", job.name, client.address, job.path());
        }
        stop_signal().await;
    }
    drop(stop);
    let workers = serving.await.map_err(|error| ServeError::Io(error.into()))??;
    Ok((workers, done.map(|_| ())))
}

async fn show(arguments: &Arguments, client: Client) -> Result<[FinishedJob; 4], DemoError> {
    let started = Instant::now();

    // 1. The half head, its plan, and what becomes of its skin.
    let head = half_head(STANDARD_FINENESS);
    let form = scene::case_form(&head, &head.mesh, "half head")?;
    let predicted = |case: &str| scene::prediction_of(case, &scene::FILES);
    let coarse = predict(&client, &form, "half head", predicted).await?;
    let mut files = fetch_files(&client, &coarse, &scene::FILES, &arguments.out).await?;

    // 2. The same with every edge halved, and how far the two are apart.
    let finer = refine(&head.mesh);
    let form = scene::case_form(&head, &finer, "every edge halved")?;
    let predicted = |case: &str| scene::prediction_of(case, &["skin.vtp"]);
    let fine = predict(&client, &form, "every edge halved", predicted).await?;
    let fine_skin = client.bytes(&fine.file("skin.vtp")).await?;
    let compared = compare(&client, &coarse, &fine_skin).await?;
    let skins = [client.bytes(&coarse.file("skin.vtp")).await?, fine_skin];

    // 3. A face with muscles, which smiles.
    let settings = FaceSettings { lips: Lips::Closed, fineness: 1, shape: CellShape::Hex8 };
    let face = generic_face(settings);
    let form = scene::face_form(&face)?;
    let smile = predict(&client, &form, "face that smiles", scene::smile_of).await?;
    let folder = arguments.out.join(FACE);
    files.extend(fetch_files(&client, &smile, &scene::FACE_FILES, &folder).await?);

    // 4. What came out.
    let report = Report {
        coarse: &coarse.results,
        fine: &fine.results,
        comparison: &compared.results,
        smile: &smile.results,
        node_wise: node_wise_distances(&skins)?,
        upload_s: [coarse.upload_s, fine.upload_s, compared.upload_s],
    };
    println!("\n{}", report.table());
    println!("files");
    for file in &files {
        println!("  {}", file.display());
    }
    println!("\n{:.1} s in all", started.elapsed().as_secs_f64());
    Ok([coarse, fine, compared, smile])
}

/// The settings of the service in the demo; the others keep their defaults.
fn setting(name: &str, bind: Option<&str>, data: &Path) -> Option<String> {
    match name {
        "bind" => Some(bind.unwrap_or("127.0.0.1:0").to_owned()),
        "data" => Some(data.display().to_string()),
        // One job at a time gets all processors.
        "threads-per-job" => {
            let processors = std::thread::available_parallelism().map_or(1, usize::from);
            Some(processors.min(64).to_string())
        }
        "log-format" => Some("text".to_owned()),
        "log-level" => Some("warn".to_owned()),
        _ => None,
    }
}

/// A job that is done.
struct FinishedJob {
    name: String,
    id: String,
    /// The case that it is about.
    case: String,
    /// From the start of the encoding to the answer about the meshes.
    upload_s: f64,
    results: Value,
}

impl FinishedJob {
    fn path(&self) -> String {
        format!("/v1/jobs/{}", self.id)
    }

    /// Where the page plans on the case.
    fn page(&self) -> String {
        format!("/#/case/{}/plan", self.case)
    }

    fn file(&self, name: &str) -> String {
        format!("{}/results/{name}", self.path())
    }
}

/// Two calls, as a planner makes them: the case with its meshes, and the job with its plan.
async fn predict(
    client: &Client,
    form: &[Part],
    name: &str,
    prediction: impl Fn(&str) -> Value,
) -> Result<FinishedJob, DemoError> {
    let bar = progress_bar(name);
    bar.set_message("upload");
    let started = Instant::now();
    let case = client.form("/v1/cases", form).await?;
    let case = text(&case, "POST /v1/cases", "id")?;
    let upload_s = started.elapsed().as_secs_f64();
    let done = run_job(client, name, &prediction(&case), bar).await?;
    Ok(FinishedJob { upload_s, ..done })
}

async fn compare(
    client: &Client,
    coarse: &FinishedJob,
    skin: &Bytes,
) -> Result<FinishedJob, DemoError> {
    let name = "comparison";
    let bar = progress_bar(name);
    let started = Instant::now();
    let path = "/v1/meshes?units=mm&frame=LPS&role=skin";
    let mesh = client.upload(path, "application/vnd.vtk.xml", skin.clone()).await?;
    let mesh = text(&mesh, "POST /v1/meshes", "id")?;
    let upload_s = started.elapsed().as_secs_f64();
    let done = run_job(client, name, &scene::comparison_of(&coarse.id, &mesh), bar).await?;
    Ok(FinishedJob { upload_s, ..done })
}

/// Posts a job and follows it to its end.
async fn run_job(
    client: &Client,
    name: &str,
    document: &Value,
    bar: ProgressBar,
) -> Result<FinishedJob, DemoError> {
    let mut state = client.post("/v1/jobs", document).await?;
    let id = text(&state, "POST /v1/jobs", "id")?;
    let known = state["deduplicated"].as_bool().unwrap_or(false);
    loop {
        let status = text(&state, "GET /v1/jobs/{id}", "status")?;
        bar.set_position(state["progress"].as_u64().unwrap_or(0));
        bar.set_message(doing(&state));
        match status.as_str() {
            "successful" => break,
            "accepted" | "running" => tokio::time::sleep(LOOK).await,
            _ => {
                bar.abandon();
                let error = &state["error"];
                let detail = error["detail"].as_str().unwrap_or("no reason given").to_owned();
                return Err(DemoError::Job { job: id, status, detail });
            }
        }
        state = client.get(&format!("/v1/jobs/{id}")).await?;
    }
    bar.finish_and_clear();
    let results = client.get(&format!("/v1/jobs/{id}/results")).await?;
    let known = if known { ", known from an earlier run" } else { "" };
    println!("{name}: {:.1} s{known}", bar.elapsed().as_secs_f64());
    let case = text(&state, "GET /v1/jobs/{id}", "case")?;
    Ok(FinishedJob { name: name.to_owned(), id, case, upload_s: 0.0, results })
}

fn doing(state: &Value) -> String {
    let phase = state["phase"].as_str().or(state["status"].as_str()).unwrap_or_default();
    match (state["iteration"].as_u64(), state["residual"].as_f64()) {
        (Some(iteration), Some(residual)) => {
            format!("{phase}, iteration {iteration}, residual {residual:.1e}")
        }
        _ => phase.to_owned(),
    }
}

fn progress_bar(name: &str) -> ProgressBar {
    let bar = ProgressBar::new(100);
    let style = ProgressStyle::with_template("{prefix:29} [{bar:30}] {percent:>3} %  {wide_msg}");
    if let Ok(style) = style {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_prefix(name.to_owned());
    bar
}

fn text(document: &Value, what: &'static str, member: &'static str) -> Result<String, DemoError> {
    let value = document[member].as_str();
    value.map(str::to_owned).ok_or(DemoError::Answer { what, member })
}

/// Writes the files of a job into a folder and tells where they are.
async fn fetch_files(
    client: &Client,
    job: &FinishedJob,
    names: &[&str],
    folder: &Path,
) -> Result<Vec<PathBuf>, DemoError> {
    std::fs::create_dir_all(folder)
        .map_err(|source| DemoError::File { path: folder.to_owned(), source })?;
    let mut written = Vec::new();
    for &name in names.iter().chain(&[RESULT]) {
        let bytes = client.bytes(&job.file(name)).await?;
        folder::put(folder, name, &bytes)?;
        written.push(folder.join(name));
    }
    Ok(written)
}

/// How far the same node is from itself in the two predictions, in mm: refinement keeps the numbers.
fn node_wise_distances(skins: &[Bytes; 2]) -> Result<Vec<f64>, DemoError> {
    let mut surfaces: Vec<TriangleSurface> = Vec::new();
    for bytes in skins {
        match format::read(bytes, &ReadLimits::default())?.mesh {
            Mesh::Surface(surface) => surfaces.push(surface),
            Mesh::Volume(_) | Mesh::Image(_) => {
                return Err(DemoError::Answer { what: "skin.vtp", member: "triangles" });
            }
        }
    }
    let [coarse, fine] = [&surfaces[0], &surfaces[1]];
    let [Some(ours), Some(theirs)] = [coarse, fine].map(|surface| surface.node_ids.as_ref()) else {
        return Err(DemoError::Answer { what: "skin.vtp", member: "node_id" });
    };
    let distance = |(point, node): (usize, &u32)| {
        let other = theirs.binary_search(node).ok()?;
        Some((fine.points[other] - coarse.points[point]).norm())
    };
    Ok(ours.iter().enumerate().filter_map(distance).collect())
}
