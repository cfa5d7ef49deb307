//! Measured accuracy, as the tables of docs/accuracy.md: `cargo bench --bench accuracy`.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use mechanics::boundary::NodeSelection;
use mechanics::format::{Mesh, ReadLimits, read};
use mechanics::material::LinearElastic;
use mechanics::mesh::sample::{ThickSphere, thick_sphere_octant};
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Plan, Prescribed, Scene, Settings, predict,
};
use mechanics::progress::Unobserved;

fn main() {
    thick_sphere();
    faces();
}

fn set(name: &str) -> NodeSelection {
    NodeSelection::NodeSet(name.to_owned())
}

fn elastic(young_modulus: f64, poisson_ratio: f64) -> LinearElastic {
    LinearElastic::new(young_modulus, poisson_ratio, 1.0).expect("within the ranges")
}

/// docs/verification.md#v7: u = A r + B / r² with 3 K A = 4 mu B / b³ and u(a) = d.
fn thick_sphere() {
    println!(
        "Thick sphere, inner radius 60 mm displaced by 2 mm, outer radius 72 mm, cells of 3 mm: outer displacement, mm\n"
    );
    println!(
        "| nu | closed form | hex8 mean dilatation | wedge6 mean dilatation | hex8 plain | tet4 plain |"
    );
    println!("| --- | --- | --- | --- | --- | --- |");
    for nu in [0.0, 0.3, 0.43, 0.46, 0.49, 0.499, 0.4999] {
        let material = elastic(15.0, nu);
        let (bulk, mu) = (material.bulk_modulus(), material.shear_modulus());
        let (a, b) = (60.0_f64, 72.0_f64);
        let ratio = 3.0 * bulk * b.powi(3) / (4.0 * mu);
        let slope = 2.0 / (a + ratio / (a * a));
        let exact = slope * b + slope * ratio / (b * b);
        let found = [
            (CellShape::Hex8, ElementChoice::MeanDilatation),
            (CellShape::Wedge6, ElementChoice::MeanDilatation),
            (CellShape::Hex8, ElementChoice::Plain),
            (CellShape::Tet4, ElementChoice::Plain),
        ]
        .map(|(shape, element)| outer_displacement(shape, element, material));
        let cells: Vec<String> =
            found.iter().map(|u| format!("{u:.5} ({:+.2} %)", (u / exact - 1.0) * 100.0)).collect();
        println!("| {nu} | {exact:.5} | {} |", cells.join(" | "));
    }
    println!();
}

fn outer_displacement(shape: CellShape, element: ElementChoice, material: LinearElastic) -> f64 {
    let sphere =
        ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 4, cells_along: 16 };
    let mut mesh = thick_sphere_octant(sphere, shape);
    let radial = mesh.nodes.iter().map(|x| x.normalize() * 2.0).collect();
    mesh.node_vectors.insert("radial".to_owned(), radial);
    let plane = |name: &str, axis: usize| {
        let mut displacement = [None; 3];
        displacement[axis] = Some(0.0);
        Prescribed::Uniform { nodes: set(name), displacement }
    };
    let inner = Prescribed::FromArray { nodes: set("inner"), array: "radial".to_owned() };
    let prescribed = vec![inner, plane("x_min", 0), plane("y_min", 1), plane("z_min", 2)];
    let materials = BTreeMap::from([("*".to_owned(), material)]);
    let case = Case { volume: Arc::new(mesh), materials, ..Case::default() };
    let settings = Settings { element, ..Settings::default() };
    let plan = Plan { prescribed, ..Plan::default() };
    let scene = Scene::new(&case, &plan, &settings).expect("the sphere is held");
    let answer = predict(&scene, &Unobserved).expect("the sphere converges");
    let outer = case.volume.node_set("outer").expect("the sphere has an outer surface");
    let along = |&node: &u32| {
        answer.displacement[node as usize].dot(&case.volume.nodes[node as usize].normalize())
    };
    outer.iter().map(along).sum::<f64>() / outer.len() as f64
}

/// The real faces with the jaw moved 5 mm forward, E 15 kPa, nu 0.45.
fn faces() {
    println!("Real faces, jaw 5 mm forward: largest and mean displacement of the outer skin, mm\n");
    println!("| face | element | largest | mean | independent code |");
    println!("| --- | --- | --- | --- | --- |");
    let subject = ("subject", "jaw_attached", "skull_fixed_orig", -Vector::x());
    let template = ("template", "mandible_fixed", "skull_nose_fixed", Vector::y());
    let references = [
        (
            subject,
            [
                (ElementChoice::MeanDilatation, "4.749, 1.743"),
                (ElementChoice::Plain, "4.773, 1.750"),
            ],
        ),
        (
            template,
            [
                (ElementChoice::MeanDilatation, "4.904, 1.843"),
                (ElementChoice::Plain, "4.930, 1.828"),
            ],
        ),
    ];
    for ((name, jaw, skull, forward), elements) in references {
        let Some(mesh) = face(name) else { continue };
        let case = Case {
            volume: Arc::new(mesh),
            skin: Some(set("outer_skin")),
            segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set(jaw) }],
            fixed: vec![set(skull)],
            materials: BTreeMap::from([("*".to_owned(), elastic(15.0, 0.45))]),
            ..Case::default()
        };
        let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), forward * 5.0);
        let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
        let plan = Plan { segments, ..Plan::default() };
        for (element, reference) in elements {
            let settings = Settings { element, ..Settings::default() };
            let scene = Scene::new(&case, &plan, &settings).expect("the face is held");
            let answer = predict(&scene, &Unobserved).expect("the face converges");
            let moved =
                scene.skin.nodes().iter().map(|&node| answer.displacement[node as usize].norm());
            let moved: Vec<f64> = moved.collect();
            let largest = moved.iter().copied().fold(0.0, f64::max);
            let mean = moved.iter().sum::<f64>() / moved.len() as f64;
            println!("| {name} | {element:?} | {largest:.3} | {mean:.3} | {reference} |");
        }
    }
}

fn face(name: &str) -> Option<VolumeMesh> {
    let root = std::env::var_os("FACIES_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"),
        PathBuf::from,
    );
    let path = root.join(format!("data/face/{name}_face.vtu"));
    let Ok(bytes) = std::fs::read(&path) else {
        println!("skipped: {} is not here", path.display());
        return None;
    };
    match read(&bytes, &ReadLimits::default()).expect("the faces are valid").mesh {
        Mesh::Volume(mesh) => Some(mesh),
        _ => None,
    }
}
