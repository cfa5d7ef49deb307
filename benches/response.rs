//! Plan response: how long its columns take to build, and to add up.
//!
//! `cargo bench --bench response [-- SIZE …]` adds up 24 columns of 14 000 nodes on one thread, then builds the
//! response of the half head of the demo and of the shells of the shared data that are named.

#[path = "measure/shell.rs"]
mod measured;

use std::sync::Arc;
use std::time::Instant;

use mechanics::boundary::NodeSelection;
use mechanics::mesh::half_head::{STANDARD_FINENESS, half_head};
use mechanics::mesh::{Vector, VolumeMesh};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{Case, CaseSegment, Plan, Scene, Settings};
use mechanics::progress::Unobserved;
use mechanics::response::{Columns, Response, ResponseSegment, build};

const NODES: usize = 14_000;
const REPEATS: usize = 2001;

fn main() {
    let sizes: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    println!("| response | skin nodes | columns | build s | apply ms, median | p99 | GB/s |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    row("made up", None, &made_up());
    let head = half_head(STANDARD_FINENESS).mesh;
    built("half head of the demo", &half_head_case(head));
    for size in sizes {
        if let Some(mesh) = measured::load(&size) {
            let (case, _) = measured::standard_load(&mesh, measured::materials("a"));
            built(&format!("shell {size}"), &case);
        }
    }
}

/// Columns of the size of a face, with numbers of no meaning.
fn made_up() -> Response {
    let segment = |name: &str| ResponseSegment { name: name.to_owned(), centre: Vector::zeros() };
    let wave = |index: usize| (index as f32 * 0.37).sin() * 40.0;
    Response {
        segments: vec![segment("maxilla"), segment("mandible")],
        nodes: (0..NODES as u32).collect(),
        columns: (0..24 * 3 * NODES).map(wave).collect(),
    }
}

fn built(name: &str, case: &Case) {
    let scene = Scene::new(case, &Plan::default(), &Settings::default()).expect("a valid case");
    let started = Instant::now();
    let columns: Columns = build(&scene, &[], &Unobserved).expect("the columns converge");
    let seconds = started.elapsed().as_secs_f64();
    row(name, Some(seconds), &columns.to_response());
}

fn row(name: &str, build_s: Option<f64>, response: &Response) {
    let mut times = Vec::with_capacity(REPEATS);
    let mut checksum = 0.0;
    for repeat in 0..REPEATS {
        let angles = Vector::new(0.1, 0.2, 0.3) * (1.0 + repeat as f64 * 1e-3);
        let movement = RigidMovement::about_pivot(angles, Vector::x(), Vector::y());
        let movements = vec![movement; response.segments.len()];
        let started = Instant::now();
        let moved = response.apply(&movements);
        times.push(started.elapsed().as_secs_f64() * 1e3);
        checksum += moved[repeat % moved.len()].x;
    }
    assert!(checksum.is_finite());
    times.sort_by(f64::total_cmp);
    let median = times[REPEATS / 2];
    let gigabytes = response.columns.len() as f64 * 4.0 / 1e9;
    let columns = response.columns.len() / (3 * response.nodes.len());
    println!(
        "| {name} | {} | {columns} | {} | {median:.3} | {:.3} | {:.1} |",
        response.nodes.len(),
        build_s.map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.2}")),
        times[REPEATS * 99 / 100],
        gigabytes / (median * 1e-3)
    );
}

fn half_head_case(mesh: VolumeMesh) -> Case {
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let segment = |name: &str| CaseSegment { name: name.to_owned(), nodes: set(name) };
    Case {
        skin: Some(set("skin")),
        segments: vec![segment("maxilla"), segment("mandible")],
        fixed: vec![set("skull"), set("rim")],
        volume: Arc::new(mesh),
        materials: measured::homogeneous(0.45),
        ..Case::default()
    }
}
