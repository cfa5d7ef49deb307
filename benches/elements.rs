//! Elements against each other, as tables of docs/accuracy.md: `cargo bench --bench elements`.
//!
//! The slab of six tetrahedra a cell against quadratic cells of 2 mm, then the face-like shell of the shared
//! data against quadratic elements on the same mesh, then the time of a larger shell. Time is that of a whole
//! prediction after its check, the least of three for the larger shell.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use facies::boundary::NodeSelection;
use facies::format::{Mesh, ReadLimits, read};
use facies::material::LinearElastic;
use facies::mesh::sample::block;
use facies::mesh::{CellShape, Vector, VolumeMesh};
use facies::plan::{PlannedSegment, RigidMovement};
use facies::prediction::{
    Case, CaseSegment, ElementChoice, Plan, Prediction, Prescribed, RegionNames, Scene, Settings,
    Unobserved, predict,
};

fn main() {
    slabs();
    if let Some(mesh) = mesh_of("30k") {
        shell(&mesh);
    }
    for size in ["100k", "300k"] {
        if let Some(mesh) = mesh_of(size) {
            times(size, &mesh);
        }
    }
}

fn elastic(young_modulus: f64, poisson_ratio: f64) -> LinearElastic {
    LinearElastic::new(young_modulus, poisson_ratio, 1.0).expect("within the ranges")
}

fn run(case: &Case, plan: &Plan, element: ElementChoice) -> (Prediction, f64) {
    let settings = Settings { element, ..Settings::default() };
    let scene = Scene::new(case, plan, &settings).expect("the scene is held");
    let start = Instant::now();
    let answer = predict(&scene, &Unobserved).expect("the scene converges");
    (answer, start.elapsed().as_secs_f64())
}

/// The skin points of the slab by their place on the 6 mm grid.
type SkinPoints = BTreeMap<[i32; 2], Vector>;

fn slab(h: f64, nu: f64, element: ElementChoice) -> (SkinPoints, Prediction, f64) {
    let cells = [60.0, 30.0, 12.0].map(|size: f64| (size / h).round() as usize);
    let mut mesh = block(Vector::new(60.0, 30.0, 12.0), cells, CellShape::Tet4);
    mesh.nodes.iter_mut().for_each(|x| x.x -= 30.0);
    let select = |inside: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        let nodes = mesh.nodes.iter().enumerate().filter(|(_, x)| x.z < 1e-9 && inside(x));
        nodes.map(|(node, _)| node as u32).collect()
    };
    let patch = select(&|x| x.x.abs() < 12.1 && x.y < 12.1);
    let far = select(&|x| x.x.abs() > 23.9 || x.y > 23.9);
    mesh.node_sets.extend([("patch".to_owned(), patch), ("far".to_owned(), far)]);
    let hold = |name: &str, displacement| Prescribed::Uniform {
        nodes: NodeSelection::NodeSet(name.to_owned()),
        displacement,
    };
    let prescribed = vec![
        hold("patch", [Some(4.0), Some(0.0), Some(8.0)]),
        hold("far", [Some(0.0); 3]),
        hold("y_min", [None, Some(0.0), None]),
    ];
    let materials = BTreeMap::from([("*".to_owned(), elastic(15.0, nu))]);
    let case = Case { volume: Arc::new(mesh), materials, ..Case::default() };
    let (answer, seconds) = run(&case, &Plan { prescribed, ..Plan::default() }, element);
    let mut points = SkinPoints::new();
    for (x, u) in case.volume.nodes.iter().zip(&answer.displacement) {
        let place = [x.x / 6.0, x.y / 6.0];
        let on_grid = place.iter().all(|c| (c - c.round()).abs() < 1e-9);
        if on_grid && x.z > 11.9 && x.x.abs() < 24.1 && x.y < 24.1 {
            points.insert(place.map(|c| c.round() as i32), *u);
        }
    }
    (points, answer, seconds)
}

fn slabs() {
    println!("Slab, 45 skin points: mean error in mm against quadratic cells of 2 mm\n");
    println!("| nu | element | h mm | unknowns | error | iterations | s |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for nu in [0.3, 0.46, 0.49, 0.499] {
        let (reference, ..) = slab(2.0, nu, ElementChoice::Quadratic);
        for (element, h) in [
            (ElementChoice::Plain, 3.0),
            (ElementChoice::Plain, 1.5),
            (ElementChoice::Stabilised, 3.0),
            (ElementChoice::Stabilised, 1.5),
            (ElementChoice::Quadratic, 6.0),
            (ElementChoice::Quadratic, 3.0),
        ] {
            let (found, answer, seconds) = slab(h, nu, element);
            let error = found.iter().map(|(place, u)| (u - reference[place]).norm()).sum::<f64>()
                / found.len() as f64;
            println!(
                "| {nu} | {} | {h} | {} | {error:.4} | {} | {seconds:.3} |",
                answer.solver.elements[0], answer.solver.unknowns, answer.solver.iterations
            );
        }
    }
    println!();
}

fn mesh_of(size: &str) -> Option<Arc<VolumeMesh>> {
    let root = std::env::var_os("FACIES_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = root.join(format!("data/shell/{size}.vtu"));
    let Ok(bytes) = std::fs::read(&path) else {
        println!("skipped: {} is not here", path.display());
        return None;
    };
    let read = read(&bytes, &ReadLimits::default()).expect("the shells are valid");
    let Mesh::Volume(mesh) = read.mesh else { panic!("a shell is a volume mesh") };
    Some(Arc::new(mesh))
}

fn times(size: &str, mesh: &Arc<VolumeMesh>) {
    println!("Shell {size}: time\n");
    println!("| material | element | unknowns | iterations | s | times plain at nu 0.46 |");
    println!("| --- | --- | --- | --- | --- | --- |");
    let mut plain = None;
    for (element, nu) in [
        (ElementChoice::Plain, 0.46),
        (ElementChoice::Stabilised, 0.3),
        (ElementChoice::Stabilised, 0.46),
        (ElementChoice::Stabilised, 0.499),
        (ElementChoice::Stabilised, 0.4999),
    ] {
        let (case, plan) = standard_load(mesh, elastic(15.0, nu), None);
        let runs = [(); 3].map(|()| run(&case, &plan, element));
        let seconds = runs.iter().map(|(_, seconds)| *seconds).fold(f64::INFINITY, f64::min);
        let solver = &runs[0].0.solver;
        let ratio = seconds / *plain.get_or_insert(seconds);
        println!(
            "| nu {nu} | {} | {} | {} | {seconds:.3} | {ratio:.2} |",
            solver.elements[0], solver.unknowns, solver.iterations
        );
    }
    println!();
}

fn shell(mesh: &Arc<VolumeMesh>) {
    println!("Shell 30k: difference of the skin to quadratic elements on the same mesh, mm\n");
    println!("| material | element | unknowns | mean | largest | iterations | s |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (name, soft, stiff) in [
        ("nu 0.3", elastic(15.0, 0.3), None),
        ("nu 0.46", elastic(15.0, 0.46), None),
        ("nu 0.49", elastic(15.0, 0.49), None),
        ("nu 0.499", elastic(15.0, 0.499), None),
        ("nu 0.4999", elastic(15.0, 0.4999), None),
        ("stiff bands", elastic(3.0, 0.46), Some(elastic(790.0, 0.43))),
    ] {
        let (case, plan) = standard_load(mesh, soft, stiff);
        let settings = Settings { element: ElementChoice::Quadratic, ..Settings::default() };
        let scene = Scene::new(&case, &plan, &settings).expect("the standard load is valid");
        let quadratic = run(&case, &plan, ElementChoice::Quadratic);
        let report = |(answer, seconds): &(Prediction, f64)| {
            let moved = |node: &u32| {
                (answer.displacement[*node as usize] - quadratic.0.displacement[*node as usize])
                    .norm()
            };
            let differences: Vec<f64> = scene.skin.nodes().iter().map(moved).collect();
            let mean = differences.iter().sum::<f64>() / differences.len() as f64;
            let largest = differences.iter().copied().fold(0.0, f64::max);
            println!(
                "| {name} | {} | {} | {mean:.3} | {largest:.2} | {} | {seconds:.3} |",
                answer.solver.elements[0], answer.solver.unknowns, answer.solver.iterations
            );
        };
        for element in [ElementChoice::Plain, ElementChoice::Stabilised] {
            report(&run(&case, &plan, element));
        }
        report(&quadratic);
    }
    println!();
}

/// The standard load of the shells, as their README states it.
fn standard_load(
    mesh: &Arc<VolumeMesh>,
    soft: LinearElastic,
    stiff: Option<LinearElastic>,
) -> (Case, Plan) {
    let label = |value| NodeSelection::Label { array: "tag".to_owned(), value };
    let mut materials = BTreeMap::from([("*".to_owned(), soft)]);
    materials.extend(stiff.map(|stiff| ("stiff".to_owned(), stiff)));
    let names = BTreeMap::from([(1, "stiff".to_owned())]);
    let segment = |name: &str, value| CaseSegment { name: name.to_owned(), nodes: label(value) };
    let case = Case {
        volume: mesh.clone(),
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
