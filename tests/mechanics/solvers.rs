//! Factorisation and iterations against each other, and how they fail.

use std::collections::BTreeMap;

use facies::mesh::sample::{ThickSphere, block, thick_sphere_octant};
use facies::mesh::{CellShape, Vector, VolumeMesh};
use facies::model::assembly::Tissue;
use facies::model::stiffness::Dilatation;
use facies::solver::{
    BlockMatrix, LinearSystem, SolverError, Tolerance, cholesky, conjugate_gradient, ordering,
    solve,
};
use nalgebra::Matrix3;

use crate::scenes::material;

const EXACT: Tolerance = Tolerance { relative_residual: 1e-12, memory_mb: 1000.0 };

/// A matrix, what is held, what acts, and where its rows stand.
struct Clamped {
    matrix: BlockMatrix,
    held: Vec<bool>,
    forces: Vec<f64>,
    mesh: VolumeMesh,
    axes: BTreeMap<usize, Matrix3<f64>>,
}

impl Clamped {
    /// A mesh held at one of its node sets, with a force on every free unknown.
    fn new(mesh: VolumeMesh, set: &str, poisson_ratio: f64) -> Self {
        let materials = [material(15.0, poisson_ratio)];
        let material_of_cell = vec![0; mesh.cells.len()];
        let tissue = Tissue {
            mesh: &mesh,
            materials: &materials,
            material_of_cell: &material_of_cell,
            dilatation: |_| Dilatation::Mean,
        };
        let matrix = tissue.assemble(&|| true).unwrap().unwrap();
        let mut held = vec![false; 3 * mesh.nodes.len()];
        for &node in mesh.node_set(set).unwrap() {
            held[3 * node as usize..3 * node as usize + 3].fill(true);
        }
        let force = |i: usize| if held[i] { 0.0 } else { ((i * 7919) % 101) as f64 - 50.0 };
        let forces = (0..held.len()).map(force).collect();
        Clamped { matrix, held, forces, mesh, axes: BTreeMap::new() }
    }

    fn block() -> Self {
        Clamped::new(block(Vector::new(10.0, 8.0, 6.0), [6, 5, 4], CellShape::Hex8), "x_min", 0.4)
    }

    fn system(&self) -> LinearSystem<'_> {
        LinearSystem {
            matrix: &self.matrix,
            held: &self.held,
            right_hand_side: &self.forces,
            positions: &self.mesh.nodes,
            axes: &self.axes,
        }
    }
}

#[test]
fn cholesky_and_conjugate_gradients_agree() {
    let clamped = Clamped::block();
    let system = clamped.system();
    let go_on = |_, _| true;
    let order = ordering::minimum_degree(&clamped.matrix);
    let direct = cholesky::solve(&system, &order, &EXACT, &go_on, String::new()).unwrap();
    let iterative = conjugate_gradient::solve(&system, &EXACT, &go_on, String::new()).unwrap();
    let largest = direct.unknowns.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (a, b) in direct.unknowns.iter().zip(&iterative.unknowns) {
        assert!((a - b).abs() < 1e-9 * largest);
    }
    for solution in [&direct, &iterative] {
        assert!(solution.relative_residual <= 1e-12);
        assert!(clamped.held.iter().zip(&solution.unknowns).all(|(held, x)| !held || *x == 0.0));
    }
}

#[test]
fn a_residual_nobody_can_reach_ends_with_the_history_and_not_with_an_answer() {
    let clamped = Clamped::block();
    let system = clamped.system();
    let tolerance = Tolerance { relative_residual: 1e-30, ..EXACT };
    for result in [
        solve(&system, &tolerance, &|_, _| true),
        conjugate_gradient::solve(&system, &tolerance, &|_, _| true, String::new()),
    ] {
        let Err(SolverError::NotConverged { history, residual, .. }) = result else {
            panic!("{result:?}");
        };
        assert!(!history.is_empty() && residual > 1e-30);
    }
}

#[test]
fn a_solver_stops_when_it_is_asked_to() {
    let clamped = Clamped::block();
    let system = clamped.system();
    let stopped =
        conjugate_gradient::solve(&system, &EXACT, &|iteration, _| iteration < 3, String::new());
    assert_eq!(stopped.unwrap_err(), SolverError::Stopped);
}

#[test]
fn a_singular_matrix_is_refused_by_the_factorisation() {
    let clamped = Clamped::block();
    let free = vec![false; clamped.held.len()];
    let system = LinearSystem { held: &free, ..clamped.system() };
    let result = solve(&system, &EXACT, &|_, _| true);
    assert!(result.is_err(), "{result:?}");
}

#[test]
fn a_matrix_larger_than_the_memory_is_refused_with_both_numbers() {
    let clamped = Clamped::block();
    let system = clamped.system();
    let tolerance = Tolerance { memory_mb: 0.1, ..EXACT };
    let result = solve(&system, &tolerance, &|_, _| true).unwrap_err();
    assert!(
        matches!(result, SolverError::OverBudget { allowed_mb: 0.1, needed_mb } if needed_mb > 0.1)
    );
}

#[test]
fn values_that_are_not_finite_are_refused() {
    let mut clamped = Clamped::block();
    clamped.forces[100] = f64::NAN;
    assert_eq!(solve(&clamped.system(), &EXACT, &|_, _| true).unwrap_err(), SolverError::NotFinite);
}

#[test]
fn iterations_hardly_grow_with_the_mesh() {
    let iterations = |cells_along: usize, cells_radial: usize| {
        let sphere =
            ThickSphere { inner_radius: 60.0, outer_radius: 80.0, cells_radial, cells_along };
        let clamped = Clamped::new(thick_sphere_octant(sphere, CellShape::Tet4), "inner", 0.46);
        let tolerance = Tolerance { relative_residual: 1e-8, memory_mb: 1000.0 };
        let watch = |_, _| true;
        conjugate_gradient::solve(&clamped.system(), &tolerance, &watch, String::new())
            .unwrap()
            .iterations
    };
    let (coarse, fine) = (iterations(10, 3), iterations(20, 6));
    assert!(fine < 50, "{fine} iterations for eight times the cells of {coarse}");
    assert!(fine as f64 <= 1.5 * coarse as f64, "{coarse} and {fine} iterations");
}
