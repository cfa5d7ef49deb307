//! Cases and plans that several tests build on.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mechanics::boundary::NodeSelection;
use mechanics::material::LinearElastic;
use mechanics::mesh::half_head::half_head;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::prediction::{
    Case, CaseSegment, Plan, Prediction, Prescribed, Scene, Settings, predict,
};
use mechanics::progress::{Phase, Progress, Unobserved};

pub const SHAPES: [CellShape; 3] = [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6];

pub fn set(name: &str) -> NodeSelection {
    NodeSelection::NodeSet(name.to_owned())
}

pub fn material(young_modulus: f64, poisson_ratio: f64) -> LinearElastic {
    LinearElastic::new(young_modulus, poisson_ratio, 1.0).unwrap()
}

/// A case of one material and nothing else.
pub fn case_of(mesh: VolumeMesh, material: LinearElastic) -> Case {
    let materials = BTreeMap::from([("*".to_owned(), material)]);
    Case { volume: Arc::new(mesh), materials, ..Case::default() }
}

/// The half head of the demo in one material of 15 kPa, with both jaws as segments.
pub fn half_head_case(poisson_ratio: f64) -> Case {
    let segment = |name: &str| CaseSegment { name: name.to_owned(), nodes: set(name) };
    Case {
        skin: Some(set("skin")),
        segments: vec![segment("maxilla"), segment("mandible")],
        fixed: vec![set("skull"), set("rim")],
        ..case_of(half_head(2).mesh, material(15.0, poisson_ratio))
    }
}

/// Settings tight enough for facts that hold to rounding.
pub fn exact() -> Settings {
    Settings { relative_residual: 1e-13, ..Settings::default() }
}

pub fn solve(case: &Case, plan: &Plan, settings: &Settings) -> Prediction {
    let scene = Scene::new(case, plan, settings).unwrap();
    predict(&scene, &Unobserved).unwrap()
}

/// Prescribes a displacement field at all boundary nodes, through an array of the mesh.
pub fn on_the_boundary(mesh: &mut VolumeMesh, field: impl Fn(&Vector) -> Vector) -> Plan {
    let mut boundary: Vec<u32> =
        mesh.boundary_faces().iter().flat_map(|face| face.nodes().to_vec()).collect();
    boundary.sort_unstable();
    boundary.dedup();
    mesh.node_sets.insert("boundary".to_owned(), boundary);
    mesh.node_vectors.insert("field".to_owned(), mesh.nodes.iter().map(field).collect());
    let prescribed = Prescribed::FromArray { nodes: set("boundary"), array: "field".to_owned() };
    Plan { prescribed: vec![prescribed], ..Plan::default() }
}

/// Prescribes some components of a node set.
pub fn constraint(name: &str, displacement: [Option<f64>; 3]) -> Prescribed {
    Prescribed::Uniform { nodes: set(name), displacement }
}

/// The largest distance between a nodal field and a given one.
pub fn largest_error(
    mesh: &VolumeMesh,
    displacement: &[Vector],
    field: impl Fn(&Vector) -> Vector,
) -> f64 {
    let errors = mesh.nodes.iter().zip(displacement).map(|(x, u)| (u - field(x)).norm());
    errors.fold(0.0, f64::max)
}

/// Stops work once it has told so many iterations; with none, at once.
pub struct StopsAfter {
    most: usize,
    told: AtomicUsize,
}

impl StopsAfter {
    pub fn iterations(most: usize) -> Self {
        StopsAfter { most, told: AtomicUsize::new(0) }
    }
}

impl Progress for StopsAfter {
    fn phase(&self, _phase: Phase) {}

    fn iteration(&self, iteration: usize, _relative_residual: f64, _wanted: f64) {
        self.told.store(iteration, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.told.load(Ordering::Relaxed) >= self.most
    }
}

/// How far apart two predictions of a scene are on its skin, in mm: in the mean and at the 95th percentile.
pub fn apart(scene: &Scene, a: &Prediction, b: &Prediction) -> [f64; 2] {
    let at = |&node: &u32| (a.displacement[node as usize] - b.displacement[node as usize]).norm();
    let mut distances: Vec<f64> = scene.skin.nodes().iter().map(at).collect();
    distances.sort_by(f64::total_cmp);
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    [mean, distances[distances.len() * 95 / 100]]
}

/// A column of cells that are askew but on its outside and where it is flat at a height.
pub fn askew_column(
    size: Vector,
    cells: [usize; 3],
    shape: CellShape,
    is_flat: impl Fn(f64) -> bool,
) -> VolumeMesh {
    let mut mesh = block(size, cells, shape);
    let is_inner = |x: &Vector| (0..3).all(|k| x[k] > 0.1 && x[k] < size[k] - 0.1);
    for x in mesh.nodes.iter_mut().filter(|x| is_inner(x) && !is_flat(x.z)) {
        *x += Vector::new((2.0 * x.y).sin(), (1.7 * x.z).cos(), (2.3 * x.x).sin()) * 0.4;
    }
    mesh
}

/// Smooth walls around a column, and a top that is moved.
pub fn confined(top: f64) -> Vec<Prescribed> {
    let zero = Some(0.0);
    let walls = [
        ("x_min", [zero, None, None]),
        ("x_max", [zero, None, None]),
        ("y_min", [None, zero, None]),
        ("y_max", [None, zero, None]),
        ("z_max", [None, None, Some(top)]),
    ];
    walls.map(|(set, held)| constraint(set, held)).to_vec()
}

/// Adds a mesh to another; nodes of both at one place are made one where that is wanted.
pub fn join(mesh: &mut VolumeMesh, other: &VolumeMesh, is_one: impl Fn(&Vector) -> bool) {
    let own = mesh.nodes.clone();
    let number = |node: &Vector| {
        let same = own.iter().position(|own| (own - node).norm() < 1e-9);
        let added = || {
            mesh.nodes.push(*node);
            mesh.nodes.len() - 1
        };
        same.filter(|_| is_one(node)).unwrap_or_else(added) as u32
    };
    let numbers: Vec<u32> = other.nodes.iter().map(number).collect();
    for (shape, nodes) in other.cells.iter() {
        let nodes: Vec<u32> = nodes.iter().map(|&node| numbers[node as usize]).collect();
        mesh.cells.push(shape, &nodes);
    }
}
