//! Whole predictions on the face-like shells of the shared data: time of each phase and peak memory.
//!
//! `cargo bench --bench shells [-- SIZE … --materials abcd --element plain --repeats 5 --columns --json FILE
//! --displacement FILE]` prints one row for each size and material, and appends it to FILE as a line of
//! JSON. Each row is the median of several runs, after one that warms up, in a process of its own, so that
//! its peak memory is its own. Wall time is from mesh in memory to displacement in memory: check, assembly,
//! setup and solve. "Products" divide it by one plain f64 product on one thread in the same process.
//! `RAYON_NUM_THREADS` sets the threads. `--columns` solves for the 24 columns of a plan response instead of
//! the standard load. `--displacement` writes (column, node, component) as little-endian f64. Without the
//! data it says so and ends. A size with a `+` at its end is that shell with every edge halved.

mod measure;

use std::io::Write;
use std::process::Command;
use std::sync::Mutex;
use std::time::Instant;

use measure::yardstick::PlainBlocks;
use measure::{median, process, shell};
use mechanics::boundary::NodeClass;
use mechanics::mesh::Vector;
use mechanics::model::fem::displacement::Problem;
use mechanics::model::problem::LoadCase;
use mechanics::prediction::{Case, ElementChoice, Plan, Scene, Settings, predict};
use mechanics::progress::{Phase, Progress};
use mechanics::solver::SolveReport;
use mechanics::solver::Tolerance;
use serde_json::{Value, json};

const HEAD: &str = "| shell | material | element | threads | unknowns | wall s | check s | assemble s | \
    solve s | cpu s | products | iterations | residual | added MB |\n\
    | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |";

struct Options {
    sizes: Vec<String>,
    materials: String,
    element: String,
    repeats: usize,
    columns: bool,
    json: Option<String>,
    displacement: Option<String>,
    /// In this process, the only size and material.
    here: bool,
}

fn main() {
    let options = options();
    if options.here {
        return run(&options, &options.sizes[0]);
    }
    println!("{HEAD}");
    let program = std::env::current_exe().expect("this program has a path");
    for size in &options.sizes {
        for material in options.materials.chars() {
            let mut child = Command::new(&program);
            child.args(std::env::args().skip(1).filter(|given| !options.sizes.contains(given)));
            child.args([size, "--materials", &material.to_string(), "--here"]);
            if !child.status().is_ok_and(|status| status.success()) {
                println!("| {size} | {material} | failed |");
            }
        }
    }
}

fn options() -> Options {
    let mut options = Options {
        sizes: Vec::new(),
        materials: "abcd".to_owned(),
        element: "plain".to_owned(),
        repeats: 5,
        columns: false,
        json: None,
        displacement: None,
        here: false,
    };
    let mut given = std::env::args().skip(1);
    while let Some(argument) = given.next() {
        let mut value = || given.next().unwrap_or_else(|| panic!("{argument} needs a value"));
        match argument.as_str() {
            "--bench" => {} // cargo says so to every bench
            "--materials" => options.materials = value(),
            "--element" => options.element = value(),
            "--repeats" => options.repeats = value().parse().expect("--repeats is a number"),
            "--json" => options.json = Some(value()),
            "--displacement" => options.displacement = Some(value()),
            "--columns" => options.columns = true,
            "--here" => options.here = true,
            size => options.sizes.push(size.to_owned()),
        }
    }
    if options.sizes.is_empty() {
        options.sizes = ["30k", "100k", "300k"].map(str::to_owned).to_vec();
    }
    options
}

/// The element that documents call so.
fn element(name: &str) -> ElementChoice {
    match name {
        "auto" => ElementChoice::Auto,
        "plain" => ElementChoice::Plain,
        "mean_dilatation" => ElementChoice::MeanDilatation,
        "stabilised" => ElementChoice::Stabilised,
        "quadratic" => ElementChoice::Quadratic,
        other => panic!("no element {other:?}"),
    }
}

fn run(options: &Options, size: &str) {
    let material = options.materials.as_str();
    let Some(mesh) = shell::load(size) else { return };
    let (case, plan) = shell::standard_load(&mesh, shell::materials(material));
    let settings = Settings { element: element(&options.element), ..Settings::default() };
    process::reset_peak();
    let base_mb = process::resident_mb();
    let solve = if options.columns { columns } else { standard };
    let mut runs = Vec::new();
    for _ in 0..=options.repeats {
        runs.push(solve(&case, &plan, &settings));
    }
    let added_mb = process::peak_mb() - base_mb;
    runs.remove(0);
    runs.sort_by(|a, b| a.wall().total_cmp(&b.wall()));
    let cpu = median(runs.iter().map(|run| run.cpu).collect());
    let run = runs.swap_remove(runs.len() / 2);
    let product = product_seconds(&case, &plan, &settings);
    let row = json!({
        "size": size,
        "material": material,
        "element": options.element,
        "threads": rayon::current_num_threads(),
        "columns": run.displacements.len(),
        "unknowns": run.unknowns,
        "wall_s": run.wall(),
        "check_s": run.check,
        "assemble_s": run.assemble,
        "solve_s": run.solve,
        "cpu_s": cpu,
        "product_s": product,
        "products": run.wall() / product,
        "iterations": run.iterations,
        "method": run.method,
        "residual": run.residual,
        "added_mb": added_mb,
    });
    report(options, &row, &run.displacements);
}

/// One prediction, or one set of columns: seconds of each phase, and what came out.
struct Run {
    check: f64,
    assemble: f64,
    solve: f64,
    cpu: f64,
    unknowns: usize,
    iterations: usize,
    method: &'static str,
    residual: f64,
    displacements: Vec<Vec<Vector>>,
}

impl Run {
    fn wall(&self) -> f64 {
        self.check + self.assemble + self.solve
    }
}

fn standard(case: &Case, plan: &Plan, settings: &Settings) -> Run {
    let clock = Clock::default();
    let scene = Scene::new(case, plan, settings).expect("the standard load is valid");
    let answer = predict(&scene, &clock).expect("the standard load converges");
    let laps = clock.finished();
    Run {
        check: laps.seconds("check"),
        assemble: laps.seconds("assemble"),
        solve: laps.seconds("solve"),
        cpu: laps.cpu,
        unknowns: answer.solver.unknowns,
        iterations: answer.solver.iterations,
        method: answer.solver.method,
        residual: answer.solver.relative_residual,
        displacements: vec![answer.displacement],
    }
}

/// The columns of a plan response, all at once.
fn columns(case: &Case, plan: &Plan, settings: &Settings) -> Run {
    let clock = Clock::default();
    let scene = Scene::new(case, plan, settings).expect("the standard load is valid");
    let problem = Problem {
        tissue: scene.tissue(),
        constraints: &scene.conditions.constraints,
        forces: &scene.forces,
        tolerance: Tolerance {
            relative_residual: settings.relative_residual,
            memory_mb: settings.memory_mb,
        },
    };
    let cases = response_cases(&scene);
    let equilibria = problem.solve_cases(&cases, &clock).expect("the columns converge");
    clock.phase(Phase::Surface);
    let laps = clock.finished();
    let worst = |value: fn(&SolveReport) -> f64| {
        equilibria.iter().map(|one| value(&one.solver)).fold(0.0, f64::max)
    };
    Run {
        check: laps.seconds("check"),
        assemble: laps.seconds("assemble"),
        solve: laps.seconds("solve"),
        cpu: laps.cpu,
        unknowns: equilibria[0].solver.unknowns,
        iterations: worst(|solution| solution.iterations as f64) as usize,
        method: equilibria[0].solver.method,
        residual: worst(|solution| solution.relative_residual),
        displacements: equilibria.into_iter().map(|one| one.displacement).collect(),
    }
}

/// Column 12 s + 4 i + j multiplies (R - I)_ij (j < 3) or t_i (j = 3) of segment s, about the mean of its nodes.
fn response_cases(scene: &Scene) -> Vec<LoadCase> {
    let mut cases = Vec::new();
    for name in shell::SEGMENTS {
        let joined = scene.segment(name).map(|number| NodeClass::Joined(number as u32));
        let is_joined = |node: usize| Some(scene.conditions.classes[node]) == joined;
        let nodes: Vec<usize> = (0..scene.mesh.nodes.len()).filter(|&n| is_joined(n)).collect();
        let sum: Vector = nodes.iter().map(|&node| scene.mesh.nodes[node]).sum();
        let centre = sum / nodes.len() as f64;
        for column in 0..12 {
            let of_node = |node: usize| {
                let x = scene.mesh.nodes[node] - centre;
                let factor = if column % 4 < 3 { x[column % 4] } else { 1.0 };
                Vector::from_fn(|i, _| if i == column / 4 { factor } else { 0.0 })
            };
            let held = scene.conditions.constraints.iter().map(|hold| {
                match is_joined(hold.node as usize) {
                    true => of_node(hold.node as usize),
                    false => Vector::zeros(),
                }
            });
            cases.push(LoadCase {
                held: held.collect(),
                forces: scene.forces.clone(),
                ..LoadCase::default()
            });
        }
    }
    cases
}

/// One plain product over the free nodes, on one thread.
fn product_seconds(case: &Case, plan: &Plan, settings: &Settings) -> f64 {
    let scene = Scene::new(case, plan, settings).expect("the standard load is valid");
    let is_free = |node: usize| scene.conditions.classes[node] == NodeClass::Free;
    PlainBlocks::new(&scene.mesh, is_free).seconds(1)
}

fn report(options: &Options, row: &Value, displacements: &[Vec<Vector>]) {
    let text = |name: &str| row[name].as_str().unwrap_or_default().to_owned();
    let number = |name: &str| row[name].as_f64().unwrap_or(f64::NAN);
    println!(
        "| {} | {} | {} | {} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.0} | {} {} | {:.1e} | {:.0} |",
        text("size"),
        text("material"),
        text("element"),
        row["threads"],
        row["unknowns"],
        number("wall_s"),
        number("check_s"),
        number("assemble_s"),
        number("solve_s"),
        number("cpu_s"),
        number("products"),
        row["iterations"],
        text("method"),
        number("residual"),
        number("added_mb"),
    );
    if let Some(path) = &options.json {
        let file = std::fs::File::options().create(true).append(true).open(path);
        let written = file.and_then(|mut file| writeln!(file, "{row}"));
        written.expect("the JSON file can be written");
    }
    if let Some(path) = &options.displacement {
        let values = displacements.iter().flatten().flatten();
        let bytes: Vec<u8> = values.flat_map(|value| value.to_le_bytes()).collect();
        std::fs::write(path, bytes).expect("the displacement file can be written");
    }
}

/// Seconds between laps; the phases of a prediction are laps of their own.
struct Clock(Mutex<Laps>);

struct Laps {
    begin: Instant,
    current: &'static str,
    laps: Vec<(&'static str, f64)>,
    cpu: f64,
}

impl Laps {
    fn seconds(&self, name: &str) -> f64 {
        self.laps.iter().filter(|(lap, _)| *lap == name).map(|(_, seconds)| seconds).sum()
    }
}

impl Default for Clock {
    fn default() -> Self {
        let (laps, cpu) = (Vec::new(), process::cpu_seconds());
        Clock(Mutex::new(Laps { begin: Instant::now(), current: "check", laps, cpu }))
    }
}

impl Clock {
    fn finished(self) -> Laps {
        self.0.into_inner().expect("nobody panicked with the laps")
    }
}

impl Progress for Clock {
    fn phase(&self, phase: Phase) {
        let mut laps = self.0.lock().expect("nobody panicked with the laps");
        let name = std::mem::replace(&mut laps.current, phase.name());
        let seconds = laps.begin.elapsed().as_secs_f64();
        laps.laps.push((name, seconds));
        if phase == Phase::Surface {
            // Displacement is in memory; what follows is not part of the time.
            laps.cpu = process::cpu_seconds() - laps.cpu;
        }
        laps.begin = Instant::now();
    }

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        false
    }
}
