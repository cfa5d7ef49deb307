//! Adaptive against uniform refinement, as the table of docs/estimates.md: `cargo bench --bench adaptive [-- SCENE …]`.
//!
//! For each scene and mesh: cells, unknowns, the true error of the skin that moves (`moving_points`) in the mean and at the 95th
//! percentile, the estimate over it, and processor seconds. Uniform meshes have every edge halved; adaptive ones are those of `predict_adaptively` at
//! bounds on their cells that double. The truth is quadratic tetrahedra on the finest adaptive mesh; its own error is how far
//! the same on the mesh before is from it. The slopes are those of error against unknowns over all meshes of a kind, and
//! *fewer* says how many times fewer unknowns adaptive meshes need for the error of the finest uniform one.

mod measure;

use std::collections::BTreeMap;
use std::sync::Arc;

use measure::face::{self, Face};
use measure::process;
use measure::split::tetrahedra;
use mechanics::mesh::Vector;
use mechanics::mesh::quality::DihedralAngles;
use mechanics::mesh::refinement::refine;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    AdaptivePrediction, Case, ElementChoice, Plan, RefinementGoal, Scene, Settings, predict,
    predict_adaptively,
};
use mechanics::progress::Unobserved;
use mechanics::study::scenes::{half_head, slab};

/// A name, a case, its plan, and how often it is refined uniformly.
struct Task {
    name: &'static str,
    case: Case,
    plan: Plan,
    uniform: u32,
    /// The most cells of an adaptive mesh that is held against the truth, and of that of the truth.
    most: usize,
    truth: usize,
}

/// One mesh, solved.
struct Row {
    kind: &'static str,
    cells: usize,
    unknowns: usize,
    displacement: Vec<Vector>,
    estimated_mm: f64,
    cpu_s: f64,
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let is_asked = |name: &str| asked.is_empty() || asked.iter().any(|own| name.starts_with(own));
    println!(
        "| scene | meshes | cells | unknowns | error mean / p95 mm | estimate over it | cpu s |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for task in [slab_task(), half_head_task()].into_iter().chain(faces()) {
        if is_asked(task.name) {
            measure_task(&task);
        }
    }
}

fn measure_task(task: &Task) {
    let scene = scene_of(&task.case, task, ElementChoice::Auto);
    let skin = Moving::of(&scene);
    let angle = DihedralAngles::of(&scene.mesh).map_or(0.0, |angles| angles.smallest.to_degrees());
    let mut rows = uniform_rows(task, &skin);
    let mut bound = 2 * scene.mesh.cells.len();
    let mut last = None;
    while bound <= task.most {
        let (row, adapted) = adaptive_row(&scene, bound);
        if rows.iter().all(|other| other.kind == "uniform" || other.cells < row.cells) {
            rows.push(row);
        }
        last = Some(adapted);
        bound *= 2;
    }
    let (truth, own) = truth_of(task, &scene, &skin);
    for row in &rows {
        let error = skin.apart(&row.displacement, &truth);
        println!(
            "| {} | {} | {} | {} | {:.4} / {:.4} | {:.2} | {:.1} |",
            task.name,
            row.kind,
            row.cells,
            row.unknowns,
            error.mean,
            error.p95,
            row.estimated_mm / error.mean,
            row.cpu_s,
        );
    }
    let slope = |kind: &str| slope(&points(&rows, kind, &skin, &truth));
    println!(
        "{}: slopes uniform {:.2}, adaptive {:.2}; fewer {:.1}; own error of the truth {:.4} mean, {:.4} p95; smallest angle {:.1} -> {:.1} degrees",
        task.name,
        slope("uniform"),
        slope("adaptive"),
        fewer(&points(&rows, "uniform", &skin, &truth), &points(&rows, "adaptive", &skin, &truth)),
        own.mean,
        own.p95,
        angle,
        last.and_then(|adapted| adapted.finest)
            .and_then(|finest| DihedralAngles::of(&finest.scene.mesh))
            .map_or(0.0, |angles| angles.smallest.to_degrees()),
    );
}

fn uniform_rows(task: &Task, skin: &Moving) -> Vec<Row> {
    let mut case = task.case.clone();
    let mut rows = Vec::new();
    for level in 0..=task.uniform {
        if level > 0 {
            case.volume = Arc::new(refine(&case.volume));
        }
        let begun = process::cpu_seconds();
        let scene = scene_of(&case, task, ElementChoice::Auto);
        let prediction = predict(&scene, &Unobserved).expect("it is solved");
        let missing = &prediction.numerical_error.as_ref().expect("it is estimated").missing;
        rows.push(Row {
            kind: "uniform",
            cells: scene.mesh.cells.len(),
            unknowns: prediction.solver.unknowns,
            estimated_mm: Measure::of(skin.nodes.iter().map(|&node| missing[node].norm())).mean,
            displacement: prediction.displacement,
            cpu_s: process::cpu_seconds() - begun,
        });
    }
    rows
}

fn adaptive_row(scene: &Scene, cells: usize) -> (Row, AdaptivePrediction) {
    let begun = process::cpu_seconds();
    let adapted = adapted(scene, cells);
    let level = adapted.levels.last().expect("a mesh is solved on");
    let row = Row {
        kind: "adaptive",
        cells: level.cells,
        unknowns: level.unknowns,
        estimated_mm: level.mean_mm,
        displacement: adapted.prediction.displacement.clone(),
        cpu_s: process::cpu_seconds() - begun,
    };
    (row, adapted)
}

fn adapted(scene: &Scene, cells: usize) -> AdaptivePrediction {
    let wanted = RefinementGoal {
        skin_mm: 1e-6,
        regions_mm: BTreeMap::new(),
        landmarks_mm: BTreeMap::new(),
        cells,
        is_of_answer: false,
        time_s: f64::INFINITY,
    };
    predict_adaptively(scene, &wanted, &|| 0.0, &Unobserved).expect("it is solved")
}

/// Quadratic tetrahedra on two adaptive meshes; the finer one, and how far the coarser is from it.
fn truth_of(task: &Task, scene: &Scene, skin: &Moving) -> (Vec<Vector>, Measure) {
    let quadratic = scene_of(&task.case, task, ElementChoice::Quadratic);
    let on = |cells: usize| {
        let finest = adapted(scene, cells).finest;
        let finer =
            finest.map(|own| quadratic.on(&own.bisection).expect("no loads act between nodes"));
        finer.as_ref().unwrap_or(&quadratic).solve(&Unobserved).expect("it is solved").displacement
    };
    let (coarse, fine) = (on(task.truth / 4), on(task.truth));
    let own = skin.apart(&coarse, &fine);
    (fine, own)
}

fn scene_of(case: &Case, task: &Task, element: ElementChoice) -> Scene {
    let settings = Settings { element, memory_mb: 12_000.0, ..Settings::default() };
    Scene::new(case, &task.plan, &settings).expect("the scene is held")
}

/// The skin nodes of a scene that move on its own mesh, which are those of a `Level`.
struct Moving {
    nodes: Vec<usize>,
}

impl Moving {
    fn of(scene: &Scene) -> Self {
        let moved = predict(scene, &Unobserved).expect("it is solved").displacement;
        let nodes = scene.skin.nodes();
        let points = scene.skin.moving_points(&moved).into_iter();
        Moving { nodes: points.map(|point| nodes[point as usize] as usize).collect() }
    }

    fn apart(&self, found: &[Vector], truth: &[Vector]) -> Measure {
        Measure::of(self.nodes.iter().map(|&node| (found[node] - truth[node]).norm()))
    }
}

/// Of lengths in mm.
struct Measure {
    mean: f64,
    p95: f64,
}

impl Measure {
    fn of(lengths: impl Iterator<Item = f64>) -> Self {
        let mut lengths: Vec<f64> = lengths.collect();
        lengths.sort_by(f64::total_cmp);
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        Measure { mean, p95: lengths[(lengths.len() * 95).div_ceil(100) - 1] }
    }
}

/// Logarithms of unknowns and mean error of the rows of a kind.
fn points(rows: &[Row], kind: &str, skin: &Moving, truth: &[Vector]) -> Vec<[f64; 2]> {
    let own = rows.iter().filter(|row| row.kind == kind);
    own.map(|row| {
        let error = skin.apart(&row.displacement, truth).mean;
        [(row.unknowns as f64).ln(), error.ln()]
    })
    .collect()
}

/// Of the line of least squares.
fn slope(points: &[[f64; 2]]) -> f64 {
    let count = points.len() as f64;
    let [x, y] = points.iter().fold([0.0; 2], |[x, y], p| [x + p[0] / count, y + p[1] / count]);
    let up: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    up / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>()
}

/// How many times fewer unknowns the second line needs for the last error of the first; NaN where it does not come so far.
fn fewer(uniform: &[[f64; 2]], adaptive: &[[f64; 2]]) -> f64 {
    let Some(&[unknowns, error]) = uniform.last() else { return f64::NAN };
    let reached = adaptive.windows(2).find(|pair| pair[1][1] <= error);
    reached.map_or(f64::NAN, |pair| {
        let share = (pair[0][1] - error) / (pair[0][1] - pair[1][1]);
        let at = pair[0][0] + share.clamp(0.0, 1.0) * (pair[1][0] - pair[0][0]);
        (unknowns - at).exp()
    })
}

fn slab_task() -> Task {
    let scene = slab();
    let materials = scene.materials[0].by_region.clone();
    let case = Case { materials, ..scene.case };
    Task {
        name: "slab",
        case,
        plan: scene.plans[0].1.clone(),
        uniform: 2,
        most: 200_000,
        truth: 150_000,
    }
}

fn half_head_task() -> Task {
    let scene = half_head();
    let (_, plan) = scene.plans.last().expect("it has plans").clone();
    Task { name: "half_head", case: scene.case, plan, uniform: 2, most: 500_000, truth: 200_000 }
}

/// The faces in tetrahedra: the jaw 5 mm forward.
fn faces() -> Vec<Task> {
    let face = |face: Face| {
        let mesh = tetrahedra(&face.load()?);
        let by = face.forward * 5.0;
        let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), by);
        let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
        let plan = Plan { segments, ..Plan::default() };
        let (name, case) = (face.name, face.case(mesh, 0.49));
        Some(Task { name, case, plan, uniform: 1, most: 700_000, truth: 330_000 })
    };
    face::faces().into_iter().filter_map(face).collect()
}
