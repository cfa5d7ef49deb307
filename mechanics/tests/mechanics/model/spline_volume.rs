//! docs/verification.md#v20, docs/verification.md#v23, docs/verification.md#v46 and more: the dynamic volume spline at rest.

use std::sync::Arc;

use mechanics::mesh::half_head::half_head;
use mechanics::mesh::{CellShape, Vector, VolumeMesh, sample};
use mechanics::model::dofs::DofMap;
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::Dilatation;
use mechanics::model::spline::lattice::Lattice;
use mechanics::model::spline::stiffness::Assembly;
use mechanics::model::spline::tissue_points::tissue_points;
use mechanics::model::spline::{ControlPoints, Stiffness, VolumeSpline};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, Method, ModelError, Plan, Prediction, Scene, Settings, Sliding, SlidingNormal,
    SolverError, predict,
};
use mechanics::progress::Unobserved;
use mechanics::solver::half_matrix::HalfMatrix;
use nalgebra::{Matrix3, Rotation3};

use crate::prediction::elements::{at_skin_points, slab};
use crate::scenes::{apart, case_of, constraint, half_head_case, material, set, solve};

pub fn with(spline: VolumeSpline) -> Settings {
    let method = Method::VolumeSpline(spline);
    Settings { method, relative_residual: 1e-10, ..Settings::default() }
}

pub fn spaced(control_spacing: f64) -> VolumeSpline {
    VolumeSpline { control: ControlPoints::Spaced(control_spacing), ..VolumeSpline::default() }
}

fn number(prediction: &Prediction, code: &str, name: &str) -> Option<f64> {
    let warning = prediction.warnings.iter().find(|warning| warning.code == code)?;
    warning.numbers.iter().find(|(other, _)| *other == name).map(|(_, value)| *value)
}

pub fn largest_difference(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Calls `check` with the lattice and the Galerkin stiffness of a mesh.
fn galerkin(
    mesh: &VolumeMesh,
    spacing: f64,
    check: impl FnOnce(&Lattice, &DofMap, &HalfMatrix<f64, 3>),
) {
    let materials = [material(15.0, 0.3)];
    let material_of_cell = vec![0; mesh.cells.len()];
    let dilatation = |_| Dilatation::Pointwise;
    let tissue = Tissue::isotropic(mesh, &materials, &material_of_cell, dilatation);
    let points = tissue_points(mesh).unwrap();
    let lattice = Lattice::fit(mesh, &points, [3; 3], ControlPoints::Spaced(spacing));
    let free = vec![false; lattice.points.len()];
    let dof_map = DofMap::of(&lattice.connectivity, &lattice.points, &free);
    let assembly = Assembly::new(&lattice, &dof_map, &tissue, &points);
    let stiffness = assembly.galerkin(&Unobserved).unwrap();
    check(&lattice, &dof_map, &stiffness);
}

/// K d for displacements of control points.
fn forces(dof_map: &DofMap, k: &HalfMatrix<f64, 3>, d: &[Vector]) -> Vec<Vector> {
    let by_row: Vec<_> = dof_map.by_row(d).iter().map(|d| [[d.x], [d.y], [d.z]]).collect();
    let mut product = by_row.clone();
    k.multiply(&dof_map.ordering, &by_row, &mut product);
    let place = dof_map.ordering.place.iter();
    place.map(|&row| Vector::from(product[row as usize].map(|[value]| value))).collect()
}

fn affine() -> Matrix3<f64> {
    Matrix3::new(0.01, 0.02, -0.01, 0.005, -0.02, 0.03, 0.015, -0.01, 0.01)
}

/// V.20. Coordinates are some 60 mm: 1e-13 is their rounding times a few sums.
#[test]
fn an_affine_map_of_the_control_points_is_that_map_of_the_volume() {
    let mesh = half_head(1).mesh;
    let points = tissue_points(&mesh).unwrap();
    let lattice = Lattice::fit(&mesh, &points, [3; 3], ControlPoints::Spaced(15.0));
    let control: Vec<Vector> = lattice.points.iter().map(|x| affine() * x).collect();
    for node in &mesh.nodes {
        let local = lattice.frame.local(node);
        let u = lattice.displacement(&lattice.place(&local).unwrap(), &control);
        assert!((u - affine() * local).norm() < 1e-13);
    }
}

/// V.23: with control points on the faces where an affine field puts them, those inside are in balance.
#[test]
fn a_block_of_one_cubic_patch_passes_the_patch_test() {
    let mesh = sample::block(Vector::new(10.0, 10.0, 10.0), [2, 2, 2], CellShape::Hex8);
    galerkin(&mesh, 10.0, |lattice, dof_map, k| {
        assert_eq!(lattice.points.len(), 64);
        let field: Vec<Vector> = lattice.points.iter().map(|x| affine() * x).collect();
        let forces = forces(dof_map, k, &field);
        let scale = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let inner = |index: &[u32; 3]| index.iter().all(|k| *k == 1 || *k == 2);
        for (force, index) in forces.iter().zip(&lattice.indices) {
            // Two Gauss points a cell integrate the gradient of a cubic exactly.
            assert!(!inner(index) || force.norm() < 1e-10 * scale, "{index:?}: {force}");
        }
        // The energy is that of a constant strain in 1000 mm³.
        let strain = (affine() + affine().transpose()) * 0.5;
        let m = material(15.0, 0.3);
        let exact = 500.0
            * (m.lambda() * strain.trace().powi(2)
                + 2.0 * m.shear_modulus() * strain.component_mul(&strain).sum());
        let energy = 0.5 * forces.iter().zip(&field).map(|(f, d)| f.dot(d)).sum::<f64>();
        assert!((energy / exact - 1.0).abs() < 1e-12, "{energy} {exact}");
    });
}

/// V.23: against the energy of a stretch of the same size; on tissue that cuts the spans of its lattice.
#[test]
fn a_small_rotation_takes_no_energy_with_galerkin_stiffness_and_some_with_links() {
    let mesh = half_head(1).mesh;
    galerkin(&mesh, 12.0, |lattice, dof_map, k| {
        let energy = |gradient: Matrix3<f64>| {
            let field: Vec<Vector> = lattice.points.iter().map(|x| gradient * x).collect();
            let forces = forces(dof_map, k, &field);
            forces.iter().zip(&field).map(|(f, d)| f.dot(d)).sum::<f64>()
        };
        let spin = Matrix3::new(0.0, -0.3, 0.2, 0.3, 0.0, -0.1, -0.2, 0.1, 0.0);
        let stretch = spin.map(f64::abs);
        assert!(energy(spin).abs() < 1e-14 * energy(stretch), "{}", energy(spin));
    });

    let (case, plan) = bent();
    let links = VolumeSpline { stiffness: Stiffness::Lattice(80.0), ..spaced(10.0) };
    let answer = solve(&case, &plan, &with(links.clone()));
    let resisted = number(&answer, "rotation-resisted", "energy_mn_mm").unwrap();
    assert!(resisted > 1.0, "{resisted} mN mm");
    let stiffer = VolumeSpline { stiffness: Stiffness::Lattice(160.0), ..links };
    let twice = number(&solve(&case, &plan, &with(stiffer)), "rotation-resisted", "energy_mn_mm");
    assert!((twice.unwrap() / resisted - 2.0).abs() < 1e-12);
}

/// A block that is fixed at one end and bent at the other.
pub fn bent() -> (Case, Plan) {
    let mesh = sample::block(Vector::new(40.0, 20.0, 12.0), [8, 4, 3], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed.push(set("x_min"));
    let prescribed = vec![constraint("x_max", [Some(0.5), None, Some(3.0)])];
    (case, Plan { prescribed, ..Plan::default() })
}

/// Hexahedra of 2.5 mm with mean dilatation and control points 5 mm apart: bending of a slender block, where
/// both err by some tenths of a per cent, and the springs of the holds give by one over their weight.
#[test]
fn close_control_points_come_to_the_answer_of_finite_elements() {
    let mesh = sample::block(Vector::new(40.0, 20.0, 10.0), [16, 8, 4], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed.push(set("x_min"));
    let prescribed = vec![constraint("x_max", [Some(0.5), Some(0.0), Some(3.0)])];
    let plan = Plan { prescribed, ..Plan::default() };
    let finite = solve(&case, &plan, &Settings::default());
    let error = |spacing: f64| {
        let spline = VolumeSpline { hold_weight: 1e3, ..spaced(spacing) };
        let answer = solve(&case, &plan, &with(spline));
        let errors = answer.displacement.iter().zip(&finite.displacement);
        errors.map(|(a, b)| (a - b).norm()).sum::<f64>() / finite.displacement.len() as f64
    };
    let (coarse, fine) = (error(20.0), error(5.0));
    println!("{coarse} {fine}");
    assert!(fine < 0.015 && fine < coarse, "{coarse} and {fine} mm of 3 mm");
}

#[test]
fn holding_harder_brings_held_nodes_home_and_takes_freedom_from_the_skin() {
    let (case, plan) = slab(3.0, 0.46);
    let reference = {
        let element = mechanics::prediction::ElementChoice::Quadratic;
        at_skin_points(&case, &solve(&case, &plan, &Settings { element, ..Settings::default() }))
    };
    let found = |hold_weight: f64| {
        let answer = solve(&case, &plan, &with(VolumeSpline { hold_weight, ..spaced(6.0) }));
        let skin = at_skin_points(&case, &answer);
        let error = skin.iter().zip(&reference).map(|(a, b)| (a - b).norm()).sum::<f64>() / 45.0;
        let missed = ["mean_mm", "max_mm"].map(|name| number(&answer, "held-nodes-missed", name));
        println!("hold weight {hold_weight}: skin {error:.4} mm, missed {missed:?}");
        (error, missed)
    };
    let ((loose, [mean, max]), (tight, [none, _])) = (found(5.0), found(1e5));
    // Measured: 0.14 and 0.92 mm of a movement of 8.9 mm; finite elements on this mesh err by 0.075 mm.
    assert!(loose < 0.2 && tight > 0.6, "{loose} {tight}");
    assert!(mean.unwrap() < 0.2 && max.unwrap() > mean.unwrap());
    assert_eq!(none, None, "nothing is missed by 0.01 mm");
}

#[test]
fn the_same_bits_come_out_of_any_number_of_threads() {
    let (case, plan) = slab(6.0, 0.46);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&case, &plan, &with(VolumeSpline::default())).displacement)
    };
    let one = on(1);
    assert!(on(2) == one && on(3) == one);
}

/// V.46. The lattice lies along the principal axes of the tissue and turns with it.
#[test]
fn a_turned_scene_has_the_turned_answer() {
    let (mut case, _) = bent();
    let slope = |x: &Vector| Vector::new(0.02 * x.z, 0.0, 0.002 * x.x * x.x);
    let answer = |case: &mut Case, turn: &Rotation3<f64>, back: &dyn Fn(&Vector) -> Vector| {
        let mesh = Arc::make_mut(&mut case.volume);
        let field = mesh.nodes.iter().map(|x| turn * slope(&back(x))).collect();
        mesh.node_vectors.insert("field".to_owned(), field);
        let prescribed = mechanics::prediction::Prescribed::FromArray {
            nodes: set("x_max"),
            array: "field".to_owned(),
        };
        let plan = Plan { prescribed: vec![prescribed], ..Plan::default() };
        solve(case, &plan, &with(spaced(8.0))).displacement
    };
    let straight = answer(&mut case, &Rotation3::identity(), &|x| *x);
    let turn = Rotation3::new(Vector::new(0.4, -1.1, 0.7));
    let shift = Vector::new(30.0, -70.0, 10.0);
    Arc::make_mut(&mut case.volume).nodes.iter_mut().for_each(|x| *x = turn * *x + shift);
    let turned = answer(&mut case, &turn, &|x| turn.inverse() * (x - shift));
    let back: Vec<Vector> = turned.iter().map(|u| turn.inverse() * u).collect();
    let difference = largest_difference(&back, &straight);
    assert!(difference < 1e-8, "{difference}");
}

#[test]
fn sliding_nodes_are_held_across_and_nothing_pulls_them_along() {
    let (mut case, plan) = bent();
    let normal = Vector::new(0.3, 1.0, 0.2);
    let sliding =
        Sliding { nodes: set("y_max"), normal: SlidingNormal::Direction(normal), segment: None };
    case.sliding.push(sliding);
    let settings = with(VolumeSpline { hold_weight: 1e5, ..spaced(10.0) });
    let answer = solve(&case, &plan, &settings);
    let across = normal.normalize();
    let scene = Scene::new(&case, &plan, &settings).unwrap();
    let mut along: f64 = 0.0;
    for constraint in
        scene.conditions.constraints.iter().filter(|constraint| constraint.count() == 1)
    {
        let u = answer.displacement[constraint.node as usize];
        assert!(u.dot(&across).abs() < 1e-2, "node {}: {u}", constraint.node);
        along = along.max(u.norm());
    }
    assert!(along > 0.5, "they slide: {along}");
    let reaction = answer.reactions["sliding"];
    assert!(reaction.cross(&across).norm() < 1e-9 * reaction.norm().max(1.0), "{reaction}");
}

/// Holds and nothing else act: their forces add up to nothing.
#[test]
fn the_reactions_balance() {
    let (case, plan) = bent();
    let answer = solve(&case, &plan, &with(spaced(10.0)));
    let (sum, largest) = answer
        .reactions
        .values()
        .fold((Vector::zeros(), 0.0_f64), |(sum, l), r| (sum + r, l.max(r.norm())));
    assert!(sum.norm() < 1e-8 * largest, "{sum} of {largest}");
}

#[test]
fn control_points_that_do_not_fit_the_memory_are_refused_before_they_are_made() {
    let (case, plan) = bent();
    let settings = Settings { memory_mb: 50.0, ..with(spaced(0.5)) };
    let refused = predict(&Scene::new(&case, &plan, &settings).unwrap(), &Unobserved);
    let Err(ModelError::Solver(SolverError::OverBudget { needed_mb, allowed_mb })) = refused else {
        panic!("{refused:?}");
    };
    assert!(needed_mb > 50.0 && allowed_mb == 50.0);
}

pub fn moved(name: &str, translation: Vector) -> PlannedSegment {
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), translation);
    PlannedSegment { name: name.to_owned(), movement }
}

/// Measured: 0.24 mm in the mean and 0.59 mm at the 95th percentile with 990 control points.
#[test]
fn the_half_head_moves_much_as_finite_elements_say() {
    let case = half_head_case(0.46);
    let segments = vec![
        moved("mandible", Vector::new(0.0, -5.0, 0.0)),
        moved("maxilla", Vector::new(0.0, -3.0, 2.0)),
    ];
    let plan = Plan { segments, ..Plan::default() };
    let finite = solve(&case, &plan, &Settings::default());
    let spline = solve(&case, &plan, &with(VolumeSpline::default()));
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let [mean, p95] = apart(&scene, &finite, &spline);
    println!("{mean} {p95}");
    assert!(mean < 0.3 && p95 < 0.75, "{mean} {p95}");
    assert_eq!(spline.elements, ["B-spline degree 3 galerkin"]);
}
