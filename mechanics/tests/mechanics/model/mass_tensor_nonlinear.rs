//! The nonlinear mass-tensor against the same tetrahedra of Saint Venant-Kirchhoff tissue: forces, answers, turning, ends.

use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::point::Point;
use mechanics::material::hyperelastic::{Law, SaintVenantKirchhoff};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::mass_tensor::MassTensorSettings;
use mechanics::model::fem::mass_tensor_nonlinear::MassTensors;
use mechanics::model::fem::strain::gradient_at_centre;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, Load, Method, ModelError, Plan, Scene, Settings, SolverError, predict,
};
use mechanics::progress::Unobserved;
use mechanics::solver::Tolerance;
use nalgebra::{Matrix3, Rotation3};

use crate::scenes::{StopsAfter, case_of, constraint, largest_error, material, set, solve};

fn kirchhoff(tissue: &LinearElastic) -> Law {
    let (lambda, mu) = (tissue.lambda(), tissue.shear_modulus());
    Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu })
}

/// V P(F) g of each cell, summed at its corners, with g from the inverse of the edges.
fn forces_of_cells(mesh: &VolumeMesh, law: &Law, u: &[Vector]) -> Vec<Vector> {
    let mut forces = vec![Vector::zeros(); u.len()];
    for (cell, (_, nodes)) in mesh.cells.iter().enumerate() {
        let x: Vec<Vector> = mesh.corners(cell).collect();
        let edges = Matrix3::from_columns(&[x[1] - x[0], x[2] - x[0], x[3] - x[0]]);
        let rows = edges.try_inverse().unwrap();
        let f = Matrix3::identity() + gradient_at_centre(mesh, u, cell);
        let stress = Point::new(law, None, f).stress() * (edges.determinant() / 6.0);
        for k in 0..3 {
            let force = stress * rows.row(k).transpose();
            forces[nodes[k + 1] as usize] += force;
            forces[nodes[0] as usize] -= force;
        }
    }
    forces
}

#[test]
fn the_polynomial_of_the_tensors_is_the_force_of_saint_venant_kirchhoff_tetrahedra() {
    let mesh = block(Vector::new(9.0, 7.0, 5.0), [3, 3, 2], CellShape::Tet4);
    let tissue = material(15.0, 0.46);
    let tensors = MassTensors {
        mesh: &mesh,
        materials: &[tissue],
        material_of_cell: &vec![0; mesh.cells.len()],
        constraints: &[],
        tolerance: Tolerance { relative_residual: 1e-8, memory_mb: 100.0 },
    };
    // Displacements as large as the cells, some of them turned inside out: the polynomial does not care.
    let wave = |x: &Vector| {
        Vector::new((1.3 * x.y).sin() + 0.4 * x.z, (0.9 * x.z + x.x).cos(), (0.7 * x.x).sin() * x.y)
            * 1.5
    };
    let u: Vec<Vector> = mesh.nodes.iter().map(wave).collect();
    let expected = forces_of_cells(&mesh, &kirchhoff(&tissue), &u);
    let found = tensors.forces(&u).unwrap();
    let largest = expected.iter().map(Vector::norm).fold(0.0, f64::max);
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).norm() < 1e-10 * largest, "{found} {expected}");
    }
}

fn settings(method: Method) -> Settings {
    Settings { method, relative_residual: 1e-11, ..Settings::default() }
}

/// A block on bone that is bent by its end, pressed by its own weight, and slides along one side.
fn bent(tissue: LinearElastic) -> (Case, Plan) {
    let mesh = block(Vector::new(30.0, 12.0, 10.0), [8, 4, 3], CellShape::Tet4);
    let mut case = case_of(mesh, tissue);
    case.fixed.push(set("x_min"));
    let plan = Plan {
        prescribed: vec![
            constraint("x_max", [Some(2.0), Some(0.0), Some(6.0)]),
            constraint("y_min", [None, Some(0.0), None]),
        ],
        loads: vec![Load::Gravity { acceleration: Vector::new(0.0, 0.0, -0.01) }],
        ..Plan::default()
    };
    (case, plan)
}

#[test]
fn its_answer_is_that_of_finite_elements_of_the_same_law() {
    let tissue = material(15.0, 0.4);
    let followed = LinearElastic::of_law(kirchhoff(&tissue), 1.0).unwrap();
    let (case, plan) = bent(tissue);
    let tensors = solve(&case, &plan, &settings(Method::MassTensorNonlinear));
    let (case, plan) = bent(followed);
    let elements = solve(&case, &plan, &settings(Method::FemNonlinear));
    for (own, other) in tensors.displacement.iter().zip(&elements.displacement) {
        assert!((own - other).norm() < 1e-7, "{own} {other}");
    }
    for (name, force) in &tensors.reactions {
        assert!((force - elements.reactions[name]).norm() < 1e-4 * (1.0 + force.norm()), "{name}");
    }
    assert_eq!(tensors.elements, ["tet4 plain"]);
    assert!(tensors.solver.history.last().unwrap() <= &1e-11);
    // Small strain is another answer.
    let (case, plan) = bent(material(15.0, 0.4));
    let linear =
        solve(&case, &plan, &settings(Method::MassTensorTransverse(MassTensorSettings::default())));
    let pairs = tensors.displacement.iter().zip(&linear.displacement);
    assert!(pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) > 0.1);
}

#[test]
fn its_mesh_leaves_out_what_that_of_finite_elements_of_the_same_law_does() {
    let tissue = material(15.0, 0.4);
    let followed = LinearElastic::of_law(kirchhoff(&tissue), 1.0).unwrap();
    let missing = |tissue: LinearElastic, method: Method| {
        let (case, plan) = bent(tissue);
        solve(&case, &plan, &settings(method)).numerical_error.unwrap().missing
    };
    let own = missing(tissue, Method::MassTensorNonlinear);
    let expected = missing(followed, Method::FemNonlinear);
    let largest = expected.iter().map(Vector::norm).fold(0.0, f64::max);
    let apart = own.iter().zip(&expected).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    println!("{apart:.2e} apart of {largest:.3} mm");
    assert!(largest > 0.05 && apart < 0.05 * largest, "{apart} of {largest}");
    // At small strain it is another one.
    let linear = missing(tissue, Method::FemLinear);
    let off = own.iter().zip(&linear).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(off > 4.0 * apart, "{off}");
}

#[test]
fn tissue_on_one_bone_turns_with_it() {
    let turn = Rotation3::from_axis_angle(&Vector::y_axis(), 0.7).into_inner();
    let movement = RigidMovement::new(turn, Vector::new(4.0, -2.0, 1.0)).unwrap();
    let mesh = block(Vector::repeat(8.0), [3, 3, 3], CellShape::Tet4);
    let mut case = case_of(mesh, material(15.0, 0.46));
    case.segments = vec![CaseSegment { name: "jaw".to_owned(), nodes: set("z_min") }];
    case.allow_unfixed = true;
    let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let moved = solve(&case, &plan, &settings(Method::MassTensorNonlinear));
    let error = largest_error(&case.volume, &moved.displacement, |x| movement.displacement(x));
    assert!(error < 1e-6, "{error}");
}

#[test]
fn nothing_that_moves_is_rest_at_once() {
    let (case, _) = bent(material(15.0, 0.4));
    let still = solve(&case, &Plan::default(), &settings(Method::MassTensorNonlinear));
    assert!(still.displacement.iter().all(|u| *u == Vector::zeros()));
}

#[test]
fn a_movement_that_the_law_cannot_bear_ends_with_a_word_and_one_that_is_stopped_stops() {
    let mesh = block(Vector::new(40.0, 40.0, 6.0), [10, 10, 2], CellShape::Tet4);
    let mut case = case_of(mesh, material(15.0, 0.46));
    case.fixed.push(set("z_min"));
    let ways = [Some(0.0), Some(0.0), Some(-5.5)];
    let plan = Plan { prescribed: vec![constraint("z_max", ways)], ..Plan::default() };
    let scene = |tolerance| {
        let settings =
            Settings { relative_residual: tolerance, ..settings(Method::MassTensorNonlinear) };
        Scene::new(&case, &plan, &settings).unwrap()
    };
    match predict(&scene(1e-8), &Unobserved) {
        Err(error) => assert!(["no-equilibrium", "solver-diverged"].contains(&error.code())),
        Ok(found) => {
            let told = found.warnings.iter().any(|warning| warning.code == "cells-inverted");
            assert!(told || found.deformation.iter().all(|cell| cell.det_f > 0.0));
        }
    }
    let stopped = predict(&scene(1e-8), &StopsAfter::iterations(2)).unwrap_err();
    assert_eq!(stopped, ModelError::Solver(SolverError::Stopped));
}
