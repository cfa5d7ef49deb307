//! Elements against each other, as tables of docs/accuracy.md: `cargo bench --bench elements`.
//!
//! The slab of six tetrahedra a cell against quadratic cells of 2 mm, then the face-like shell of the shared
//! data against quadratic elements on the same mesh, then the time of a larger shell. Time is that of a whole
//! prediction after its check, the least of three for the larger shell.

#[path = "measure/shell.rs"]
mod measured;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use mechanics::boundary::NodeSelection;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::prediction::{
    Case, ElementChoice, Plan, Prediction, Prescribed, Scene, Settings, predict,
};
use mechanics::progress::Unobserved;

fn main() {
    slabs();
    if let Some(mesh) = measured::load("30k") {
        shell(&mesh);
    }
    for size in ["100k", "300k"] {
        if let Some(mesh) = measured::load(size) {
            times(size, &mesh);
        }
    }
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

fn slab(
    (shape, element): (CellShape, ElementChoice),
    h: f64,
    nu: f64,
) -> (SkinPoints, Prediction, f64) {
    let cells = [60.0, 30.0, 12.0].map(|size: f64| (size / h).round() as usize);
    let mut mesh = block(Vector::new(60.0, 30.0, 12.0), cells, shape);
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
    let materials = measured::homogeneous(nu);
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
        let (tet4, hex8) = (CellShape::Tet4, CellShape::Hex8);
        let (reference, ..) = slab((tet4, ElementChoice::Quadratic), 2.0, nu);
        for (shape, element, h) in [
            (tet4, ElementChoice::Plain, 3.0),
            (tet4, ElementChoice::Plain, 1.5),
            (tet4, ElementChoice::Stabilised, 3.0),
            (tet4, ElementChoice::Stabilised, 1.5),
            (tet4, ElementChoice::Quadratic, 6.0),
            (tet4, ElementChoice::Quadratic, 3.0),
            (hex8, ElementChoice::MeanDilatation, 3.0),
            (hex8, ElementChoice::MeanDilatation, 1.5),
        ] {
            let (found, answer, seconds) = slab((shape, element), h, nu);
            let error = found.iter().map(|(place, u)| (u - reference[place]).norm()).sum::<f64>()
                / found.len() as f64;
            println!(
                "| {nu} | {} | {h} | {} | {error:.4} | {} | {seconds:.3} |",
                answer.elements[0], answer.solver.unknowns, answer.solver.iterations
            );
        }
    }
    println!();
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
        let (case, plan) = measured::standard_load(mesh, measured::homogeneous(nu));
        let runs = [(); 3].map(|()| run(&case, &plan, element));
        let seconds = runs.iter().map(|(_, seconds)| *seconds).fold(f64::INFINITY, f64::min);
        let answer = &runs[0].0;
        let ratio = seconds / *plain.get_or_insert(seconds);
        println!(
            "| nu {nu} | {} | {} | {} | {seconds:.3} | {ratio:.2} |",
            answer.elements[0], answer.solver.unknowns, answer.solver.iterations
        );
    }
    println!();
}

fn shell(mesh: &Arc<VolumeMesh>) {
    println!("Shell 30k: difference of the skin to quadratic elements on the same mesh, mm\n");
    println!("| material | element | unknowns | mean | largest | iterations | s |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    let same = [0.3, 0.46, 0.49, 0.499, 0.4999];
    let same = same.map(|nu| (format!("nu {nu}"), measured::homogeneous(nu)));
    let bands = ("stiff bands".to_owned(), measured::materials("b"));
    for (name, materials) in same.into_iter().chain([bands]) {
        let (case, plan) = measured::standard_load(mesh, materials);
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
                answer.elements[0], answer.solver.unknowns, answer.solver.iterations
            );
        };
        for element in [ElementChoice::Plain, ElementChoice::Stabilised] {
            report(&run(&case, &plan, element));
        }
        report(&quadratic);
    }
    println!();
}
