//! Plan response: how long its columns take to build, and to add up.
//!
//! `cargo bench --bench response [-- SIZE …]` adds up 24 columns of 14 000 nodes on one thread, and the 300 of second order
//! in sixteen bits on all, then builds the response of the half head of the demo and of the shells of the shared data that
//! are named, to order 1 and 2.

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
use mechanics::response::quadratic_form::pairs;
use mechanics::response::{
    Columns, QuadraticForm, Response, ResponseOrder, ResponseSegment, build_to,
};

const NODES: usize = 14_000;
const REPEATS: usize = 2001;

fn main() {
    let sizes: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    println!(
        "| response, order | skin nodes | columns | build s | apply ms, median | p99 | GB/s |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    row("made up, 1", None, &made_up(), None);
    row("made up, 2", None, &made_up(), Some(&made_up_form()));
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
        inner: Vec::new(),
        segments: vec![segment("maxilla"), segment("mandible")],
        nodes: (0..NODES as u32).collect(),
        columns: (0..24 * 3 * NODES).map(wave).collect(),
    }
}

/// The second order of columns of that size.
fn made_up_form() -> QuadraticForm {
    let count = pairs(24).count();
    let wave = |index: usize| ((index as f32 * 0.37).sin() * 32767.0) as i16;
    QuadraticForm {
        numbers: 24,
        values: (0..count * 3 * NODES).map(wave).collect(),
        scales: vec![1e-5; count],
        third: vec![[1e-4; 6]; 2],
        coupling: vec![[1e-5; 24]; 364],
    }
}

fn built(name: &str, case: &Case) {
    let scene = Scene::new(case, &Plan::default(), &Settings::default()).expect("a valid case");
    for (order, label) in [(ResponseOrder::First, 1), (ResponseOrder::Second, 2)] {
        let started = Instant::now();
        let built = build_to(&scene, &[], order, &Unobserved);
        let columns: Columns = built.expect("the columns converge");
        let seconds = started.elapsed().as_secs_f64();
        let response = columns.to_response();
        let name = format!("{name}, {label}");
        row(&name, Some(seconds), &response, columns.second_order.as_ref());
    }
}

fn row(name: &str, build_s: Option<f64>, response: &Response, second: Option<&QuadraticForm>) {
    let mut times = Vec::with_capacity(REPEATS);
    let mut checksum = 0.0;
    for repeat in 0..REPEATS {
        let angles = Vector::new(0.1, 0.2, 0.3) * (1.0 + repeat as f64 * 1e-3);
        let movement = RigidMovement::about_pivot(angles, Vector::x(), Vector::y());
        let movements = vec![movement; response.segments.len()];
        let started = Instant::now();
        let mut moved = response.apply(&movements);
        if let Some(form) = second {
            form.apply(&response.segments, &movements, &mut moved);
        }
        times.push(started.elapsed().as_secs_f64() * 1e3);
        checksum += moved[repeat % moved.len()].x;
    }
    assert!(checksum.is_finite());
    times.sort_by(f64::total_cmp);
    let median = times[REPEATS / 2];
    let second_bytes = second.map_or(0.0, |form| form.values.len() as f64 * 2.0);
    let gigabytes = (response.columns.len() as f64 * 4.0 + second_bytes) / 1e9;
    let columns = response.columns.len() / (3 * response.nodes.len());
    let columns = columns + second.map_or(0, |form| form.scales.len());
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
