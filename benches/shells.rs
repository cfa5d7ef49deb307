//! Whole predictions on the face-like shells of the shared data: time of each phase and peak memory.
//!
//! `cargo bench --bench shells [-- SIZE …]` prints one row for each size and material; each runs in a
//! process of its own, so that its peak memory is its own. Without the data it says so and ends.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use facies::boundary::NodeSelection;
use facies::format::{Mesh, ReadLimits, read};
use facies::material::LinearElastic;
use facies::mesh::{Vector, VolumeMesh};
use facies::plan::{PlannedSegment, RigidMovement};
use facies::prediction::{
    Case, CaseSegment, Phase, Plan, Progress, RegionNames, Scene, Settings, predict,
};

fn main() {
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    if let [size, material, "run"] = arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        return run(size, material);
    }
    let sizes: Vec<&str> = match arguments.is_empty() {
        true => vec!["30k", "100k", "300k"],
        false => arguments.iter().map(String::as_str).collect(),
    };
    println!(
        "| shell | material | unknowns | read s | check s | assemble s | solve s | measures s | iterations | residual | peak MB |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for size in sizes {
        for material in ["a", "b", "c", "d"] {
            let program = std::env::current_exe().expect("this program has a path");
            let status = Command::new(program).args([size, material, "run"]).status();
            if !status.is_ok_and(|status| status.success()) {
                println!("| {size} | {material} | failed |");
            }
        }
    }
}

fn run(size: &str, material: &str) {
    let root = std::env::var_os("FACIES_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = root.join(format!("data/shell/{size}.vtu"));
    let Ok(bytes) = std::fs::read(&path) else {
        println!("skipped: {} is not here", path.display());
        return;
    };
    let clock = Clock::default();
    let read = read(&bytes, &ReadLimits::default()).expect("the shells are valid");
    let Mesh::Volume(mesh) = read.mesh else { panic!("a shell is a volume mesh") };
    clock.lap("read");
    let (case, plan) = standard_load(mesh, material);
    let scene = Scene::new(&case, &plan, &Settings::default()).expect("the standard load is valid");
    clock.lap("check");
    let answer = predict(&scene, &clock).expect("the standard load converges");
    clock.lap("measures");
    let laps = clock.laps.lock().expect("nobody panicked with the laps").1.clone();
    let seconds =
        |name: &str| laps.iter().filter(|(lap, _)| *lap == name).map(|(_, s)| s).sum::<f64>();
    println!(
        "| {size} | {material} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {} {} | {:.1e} | {:.0} |",
        answer.solver.unknowns,
        seconds("read"),
        seconds("check"),
        seconds("assemble"),
        seconds("solve"),
        seconds("measures"),
        answer.solver.iterations,
        answer.solver.name,
        answer.solver.relative_residual,
        peak_megabytes()
    );
}

/// The standard load of the shells, as their README states it.
fn standard_load(mesh: VolumeMesh, material: &str) -> (Case, Plan) {
    let label = |value| NodeSelection::Label { array: "tag".to_owned(), value };
    let elastic = |e, nu| LinearElastic::new(e, nu, 1.0).expect("within the ranges");
    let (soft, stiff) = match material {
        "a" => (elastic(15.0, 0.46), None),
        "b" => (elastic(3.0, 0.46), Some(elastic(790.0, 0.43))),
        "c" => (elastic(15.0, 0.49), None),
        _ => (elastic(15.0, 0.499), None),
    };
    let mut materials = BTreeMap::from([("*".to_owned(), soft)]);
    materials.extend(stiff.map(|stiff| ("stiff".to_owned(), stiff)));
    let names = BTreeMap::from([(1, "stiff".to_owned())]);
    let segment = |name: &str, value| CaseSegment { name: name.to_owned(), nodes: label(value) };
    let case = Case {
        volume: Arc::new(mesh),
        regions: Some(RegionNames { array: "band".to_owned(), names }),
        skin: Some(label(5)),
        segments: vec![segment("maxilla", 2), segment("mandible", 3)],
        fixed: vec![label(1), label(4)],
        materials,
        ..Case::default()
    };
    let turn = 3.0_f64.to_radians();
    let moved = |name: &str, axis: Vector, pivot: Vector, along: Vector| PlannedSegment {
        name: name.to_owned(),
        movement: RigidMovement::about_pivot(axis * turn, pivot, along.normalize() * 8.0),
    };
    let segments = vec![
        moved("maxilla", Vector::x(), Vector::new(0.0, 50.0, -10.0), Vector::new(0.0, 7.0, -4.0)),
        moved("mandible", Vector::z(), Vector::new(0.0, 40.0, -50.0), Vector::new(0.0, -7.0, 4.0)),
    ];
    (case, Plan { segments, ..Plan::default() })
}

/// Seconds between laps; the phases of a prediction are laps of their own.
struct Clock {
    laps: Mutex<(Instant, Vec<(&'static str, f64)>)>,
    phase: Mutex<&'static str>,
}

impl Default for Clock {
    fn default() -> Self {
        Clock { laps: Mutex::new((Instant::now(), Vec::new())), phase: Mutex::new("check") }
    }
}

impl Clock {
    fn lap(&self, name: &'static str) {
        let mut laps = self.laps.lock().expect("nobody panicked with the laps");
        let seconds = laps.0.elapsed().as_secs_f64();
        laps.1.push((name, seconds));
        laps.0 = Instant::now();
    }
}

impl Progress for Clock {
    fn phase(&self, phase: Phase) {
        let mut current = self.phase.lock().expect("nobody panicked with the phase");
        self.lap(std::mem::replace(&mut *current, phase.name()));
    }

    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}

    fn is_cancelled(&self) -> bool {
        false
    }
}

/// The largest resident size of this process so far, where the system tells it.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.unwrap_or(f64::NAN) / 1024.0
}
