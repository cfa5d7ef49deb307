//! Estimates of the discretisation error against true errors, as the table of docs/estimates.md:
//! `cargo bench --bench estimates [-- SCENE …]`.
//!
//! One row for each scene and element: the mean and 95th percentile of the true error over the skin nodes, the effectivity
//! of both (estimate over true), what is left of the mean once the estimate is added, and the processor time of the
//! estimate as a share of that of assembly and solution. The truth is that of the row's last column. Scenes of the shared
//! data are left out, aloud, where they are not here.

mod measure;

use std::collections::BTreeMap;
use std::sync::Arc;

use measure::split::tetrahedra;
use measure::{face, process, shell};
use mechanics::boundary::NodeSelection;
use mechanics::material::LinearElastic;
use mechanics::mesh::refinement::refine;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::discretisation_error::Estimate;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Load, Method, Plan, Scene, Settings, predict,
};
use mechanics::progress::Unobserved;
use mechanics::study::StudyScene;
use mechanics::study::scenes::{half_head, slab, slab_hex, slab_wedge, sphere_of};

/// What is held for true of a row.
#[derive(Clone, Copy)]
struct Truth {
    /// How often every edge is halved.
    halved: u32,
    element: ElementChoice,
}

/// A case, the elements whose error is estimated, and the truth.
struct Row {
    name: String,
    case: Case,
    plan: Plan,
    elements: Vec<ElementChoice>,
    truth: Truth,
    method: Method,
}

/// A name, and what makes its rows.
type Entry = (&'static str, fn() -> Vec<Row>);

const SCENES: [Entry; 9] = [
    ("slab", slabs),
    ("half_head", half_heads),
    ("sphere", spheres),
    ("slab_cells", slabs_of_cells),
    ("layers", layers),
    ("face", faces),
    ("shell", shells),
    ("finite", at_finite_strain),
    ("pressed", pressed),
];

const TETRAHEDRA: [ElementChoice; 2] = [ElementChoice::Plain, ElementChoice::Stabilised];

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    println!(
        "| scene | elements | error mean / p95 mm | effectivity mean / p95 | mean left mm | share of cpu % | truth |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (name, rows) in SCENES {
        if asked.is_empty() || asked.iter().any(|asked| asked == name) {
            rows().iter().for_each(measure_row);
        }
    }
}

fn measure_row(row: &Row) {
    let Some(truth) = true_skin(row) else {
        return println!("| {} | has no truth: its cells are inverted |", row.name);
    };
    for &element in &row.elements {
        let settings = Settings { element, method: row.method.clone(), ..Settings::default() };
        let scene = Scene::new(&row.case, &row.plan, &settings).expect("the scene is held");
        let answer = match row.method == Method::FemNonlinear {
            true => answer_at_finite_strain(row, &scene),
            false => Some(linear_answer(&scene)),
        };
        let Some(Answer { solution, error, solve_s, estimate_s }) = answer else {
            println!("| {} | {} | has no answer |", row.name, scene.elements().join(", "));
            continue;
        };
        let nodes = scene.skin.nodes();
        let missing: Vec<Vector> = nodes.iter().map(|&node| error[node as usize]).collect();
        let lacks: Vec<Vector> =
            nodes.iter().zip(&truth).map(|(&node, u)| u - solution[node as usize]).collect();
        let left: Vec<Vector> = lacks.iter().zip(&missing).map(|(a, b)| a - b).collect();
        let (true_error, estimated) = (Measure::of(&lacks), Measure::of(&missing));
        println!(
            "| {} | {} | {:.4} / {:.4} | {:.2} / {:.2} | {:.4} | {:.0} | {:?} {}x |",
            row.name,
            scene.elements().join(", "),
            true_error.mean,
            true_error.p95,
            estimated.mean / true_error.mean,
            estimated.p95 / true_error.p95,
            Measure::of(&left).mean,
            100.0 * estimate_s / solve_s,
            row.truth.element,
            row.truth.halved,
        );
    }
}

/// Displacement, its estimated error, and processor time.
struct Answer {
    solution: Vec<Vector>,
    error: Vec<Vector>,
    solve_s: f64,
    estimate_s: f64,
}

fn linear_answer(scene: &Scene) -> Answer {
    let begin = process::cpu_seconds();
    let system = scene.assemble(&Unobserved).expect("sound cells").expect("first order");
    let mut solved = system.solve(&[scene.load_case()], &Unobserved).expect("it converges");
    let between = process::cpu_seconds();
    let estimate = Estimate {
        tissue: scene.tissue(),
        system: &system,
        boundary: &scene.boundary,
        loads: &scene.distributed,
    };
    let error = estimate.of(&solved[0], &Unobserved).expect("an estimate").missing;
    let (solve_s, estimate_s) = (between - begin, process::cpu_seconds() - between);
    Answer { solution: solved.remove(0).equilibrium.displacement, error, solve_s, estimate_s }
}

/// The time of the estimate is that of a prediction with it less that of one without.
fn answer_at_finite_strain(row: &Row, scene: &Scene) -> Option<Answer> {
    let settings = Settings { estimate: false, ..scene.settings.clone() };
    let without = Scene::new(&row.case, &row.plan, &settings).expect("the scene is held");
    let begin = process::cpu_seconds();
    predict(&without, &Unobserved).ok()?;
    let between = process::cpu_seconds();
    let found = predict(scene, &Unobserved).ok()?;
    let (solve_s, both_s) = (between - begin, process::cpu_seconds() - between);
    let (solution, estimate_s) = (found.displacement, both_s - solve_s);
    Some(Answer { solution, error: found.numerical_error.ok()?.missing, solve_s, estimate_s })
}

/// Of lengths of vectors, in mm.
struct Measure {
    mean: f64,
    p95: f64,
}

impl Measure {
    fn of(vectors: &[Vector]) -> Self {
        let mut lengths: Vec<f64> = vectors.iter().map(Vector::norm).collect();
        lengths.sort_by(f64::total_cmp);
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        Measure { mean, p95: lengths[(lengths.len() * 95).div_ceil(100) - 1] }
    }
}

/// The displacement of the skin nodes of the row's mesh, which keep their numbers when edges are halved.
fn true_skin(row: &Row) -> Option<Vec<Vector>> {
    let nodes = Scene::new(&row.case, &row.plan, &Settings::default()).expect("it is held");
    let mut case = row.case.clone();
    for _ in 0..row.truth.halved {
        case.volume = Arc::new(refine(&case.volume));
    }
    let element = row.truth.element;
    let (method, estimate) = (row.method.clone(), false);
    let settings =
        Settings { element, method, estimate, memory_mb: 12_000.0, ..Settings::default() };
    let scene = Scene::new(&case, &row.plan, &settings).ok()?;
    let solved = scene.solve(&Unobserved).ok()?.displacement;
    Some(nodes.skin.nodes().iter().map(|&node| solved[node as usize]).collect())
}

fn nodes_where(mesh: &VolumeMesh, is_in: impl Fn(&Vector) -> bool) -> Vec<u32> {
    let nodes = (0..).zip(&mesh.nodes);
    nodes.filter(|(_, x)| is_in(x)).map(|(node, _)| node).collect()
}

fn slabs() -> Vec<Row> {
    let scene = slab();
    let row = |materials: &mechanics::study::Materials| Row {
        name: format!("slab, {}", materials.name),
        case: Case { materials: materials.by_region.clone(), ..scene.case.clone() },
        plan: scene.plans[0].1.clone(),
        elements: TETRAHEDRA.to_vec(),
        truth: Truth { halved: 2, element: ElementChoice::Quadratic },
        method: Method::FemLinear,
    };
    scene.materials.iter().map(row).collect()
}

fn half_heads() -> Vec<Row> {
    let scene = half_head();
    let plans = scene.plans.iter().filter(|(name, _)| name.contains("4 mm"));
    let row = |(name, plan): &(String, Plan)| Row {
        name: format!("half head, {name}"),
        case: scene.case.clone(),
        plan: plan.clone(),
        elements: TETRAHEDRA.to_vec(),
        truth: Truth { halved: 1, element: ElementChoice::Quadratic },
        method: Method::FemLinear,
    };
    plans.map(row).collect()
}

fn spheres() -> Vec<Row> {
    let row = |(shape, elements, truth): (CellShape, Vec<ElementChoice>, Truth)| {
        let scene = sphere_of(2, 8, shape);
        Row {
            name: format!("sphere {}", shape.name()),
            case: scene.case,
            plan: scene.plans[0].1.clone(),
            elements,
            truth,
            method: Method::FemLinear,
        }
    };
    let finer = |halved, element| Truth { halved, element };
    let mean = ElementChoice::MeanDilatation;
    vec![
        row((CellShape::Tet4, TETRAHEDRA.to_vec(), finer(1, ElementChoice::Quadratic))),
        row((CellShape::Hex8, vec![mean], finer(2, mean))),
        row((CellShape::Wedge6, vec![mean], finer(2, mean))),
    ]
}

fn slabs_of_cells() -> Vec<Row> {
    let rows = |scene: StudyScene| {
        let row = |materials: &mechanics::study::Materials| Row {
            name: format!("{}, {}", scene.name, materials.name),
            case: Case { materials: materials.by_region.clone(), ..scene.case.clone() },
            plan: scene.plans[0].1.clone(),
            elements: vec![ElementChoice::Plain, ElementChoice::MeanDilatation],
            truth: Truth { halved: 3, element: ElementChoice::MeanDilatation },
            method: Method::FemLinear,
        };
        scene.materials.iter().map(row).collect::<Vec<_>>()
    };
    [slab_hex(), slab_wedge()].into_iter().flat_map(rows).collect()
}

/// Flat cells in layers over a bone that moves beside a fixed one, and beams that bend under a load at their end.
fn layers() -> Vec<Row> {
    let shapes = [CellShape::Hex8, CellShape::Wedge6];
    let slabs =
        shapes.into_iter().flat_map(|shape| [1, 2, 3, 6].map(|count| layered(shape, count)));
    let beams = [([6, 1, 1], 0.3), ([6, 2, 2], 0.3), ([6, 2, 2], 0.46), ([12, 2, 2], 0.46)];
    let beams =
        shapes.into_iter().flat_map(|shape| beams.map(|(cells, nu)| beam(shape, cells, nu)));
    slabs.chain(beams).collect()
}

fn layered(shape: CellShape, layers: usize) -> Row {
    let mut mesh = block(Vector::new(60.0, 60.0, 9.0), [6, 6, layers], shape);
    let base = |x: &Vector| x.z < 1e-6;
    let sets = [
        ("moved", nodes_where(&mesh, |x| base(x) && x.x < 25.0)),
        ("fixed", nodes_where(&mesh, |x| base(x) && x.x > 25.0)),
    ];
    mesh.node_sets.extend(sets.map(|(name, nodes)| (name.to_owned(), nodes)));
    let by = Vector::new(2.0, 0.0, 2.0);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), by);
    let case = Case {
        segments: vec![CaseSegment { name: "moved".to_owned(), nodes: set("moved") }],
        fixed: vec![set("fixed")],
        ..bare(mesh, 0.46)
    };
    let segments = vec![PlannedSegment { name: "moved".to_owned(), movement }];
    Row {
        name: format!("{layers} layers of {}, 10 x 10 x {} mm", shape.name(), 9.0 / layers as f64),
        case,
        plan: Plan { segments, ..Plan::default() },
        elements: vec![ElementChoice::MeanDilatation],
        truth: Truth {
            halved: if layers > 3 { 2 } else { 3 },
            element: ElementChoice::MeanDilatation,
        },
        method: Method::FemLinear,
    }
}

fn beam(shape: CellShape, cells: [usize; 3], nu: f64) -> Row {
    let mesh = block(Vector::new(60.0, 10.0, 10.0), cells, shape);
    let traction = Vector::new(0.0, 0.0, -0.05);
    let loads = vec![Load::Traction { faces: set("x_max"), traction }];
    Row {
        name: format!("beam of {cells:?} {}, nu {nu}", shape.name()),
        case: Case { fixed: vec![set("x_min")], ..bare(mesh, nu) },
        plan: Plan { loads, ..Plan::default() },
        elements: vec![ElementChoice::MeanDilatation],
        truth: Truth { halved: 3, element: ElementChoice::MeanDilatation },
        method: Method::FemLinear,
    }
}

/// Tissue of 15 kPa under a skin at the top.
fn bare(mesh: VolumeMesh, nu: f64) -> Case {
    let tissue = LinearElastic::new(15.0, nu, 1.0).expect("constants of tissue");
    Case {
        skin: Some(set("z_max")),
        materials: BTreeMap::from([("*".to_owned(), tissue)]),
        volume: Arc::new(mesh),
        ..Case::default()
    }
}

fn set(name: &str) -> NodeSelection {
    NodeSelection::NodeSet(name.to_owned())
}

fn shells() -> Vec<Row> {
    let Some(mesh) = shell::load("30k") else { return Vec::new() };
    let row = |material: &str| {
        let (case, plan) = shell::standard_load(&mesh, shell::materials(material));
        Row {
            name: format!("shell 30k ({material})"),
            case,
            plan,
            elements: TETRAHEDRA.to_vec(),
            truth: Truth { halved: 0, element: ElementChoice::Quadratic },
            method: Method::FemLinear,
        }
    };
    ["a", "c", "d", "b"].into_iter().map(row).collect()
}

/// Movements of 10 mm at finite strain; the truth is the same with every edge halved.
fn at_finite_strain() -> Vec<Row> {
    let finite = |mut row: Row, halved: u32| {
        let moved: Vec<PlannedSegment> = row.plan.segments.iter().map(ten_millimetres).collect();
        row.name = format!("{}, 10 mm at finite strain", row.name);
        row.plan = Plan { segments: moved, ..row.plan.clone() };
        row.method = Method::FemNonlinear;
        row.truth.halved = halved;
        row.truth.element = match row.elements[0] {
            ElementChoice::Plain if row.elements.len() > 1 => ElementChoice::Stabilised,
            _ => ElementChoice::MeanDilatation,
        };
        row
    };
    let whole = |row: &Row| !row.name.contains("split");
    let slabs = slabs().into_iter().map(|row| finite(row, 2));
    let cells = slabs_of_cells().into_iter().map(|row| finite(row, 2));
    let heads = half_heads().into_iter().map(|row| finite(row, 1));
    let faces = faces().into_iter().filter(whole).map(|row| finite(row, 1));
    slabs.chain(cells).chain(heads).chain(faces).collect()
}

/// Both faces at finite strain, the jaw moved by 10 mm so that cells of the lips all but collapse (not in the subject's last row).
fn pressed() -> Vec<Row> {
    let (x, y, z) = (Vector::x(), Vector::y(), Vector::z());
    let mut rows = Vec::new();
    for row in faces().into_iter().filter(|row| !row.name.contains("split")) {
        let axes = if row.name == "subject" { [x, -z, z] } else { [x, y, z] };
        rows.extend(axes.map(|axis| {
            let movement =
                RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), axis * 10.0);
            let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
            let [along_x, along_y, along_z] = [axis.x, axis.y, axis.z].map(|own| own * 10.0);
            Row {
                name: format!("face of {}, {along_x} {along_y} {along_z} mm", row.name),
                case: row.case.clone(),
                plan: Plan { segments, ..Plan::default() },
                elements: row.elements.clone(),
                truth: row.truth,
                method: Method::FemNonlinear,
            }
        }));
    }
    rows
}

/// The same direction, 10 mm long.
fn ten_millimetres(segment: &PlannedSegment) -> PlannedSegment {
    let along = segment.movement.translation() * (10.0 / segment.movement.translation().norm());
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), along);
    PlannedSegment { name: segment.name.clone(), movement }
}

/// The subject's and the template's face, whole and split into tetrahedra: the jaw 5 mm forward.
fn faces() -> Vec<Row> {
    let mut rows = Vec::new();
    for face in face::faces() {
        let Some(mesh) = face.load() else { continue };
        let (mean, name) = (ElementChoice::MeanDilatation, face.name);
        let split = tetrahedra(&mesh);
        let whole = Truth { halved: 1, element: mean };
        let quadratic = Truth { halved: 0, element: ElementChoice::Quadratic };
        for (name, mesh, elements, truth) in [
            (name.to_owned(), mesh, vec![mean], whole),
            (format!("{name}, split"), split, TETRAHEDRA.to_vec(), quadratic),
        ] {
            let by = face.forward * 5.0;
            let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), by);
            let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
            let plan = Plan { segments, ..Plan::default() };
            let (case, method) = (face.case(mesh, 0.49), Method::FemLinear);
            rows.push(Row { name, case, plan, elements, truth, method });
        }
    }
    rows
}
