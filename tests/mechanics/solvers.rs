//! Factorisation and iterations against each other, and how they fail.

use facies::mesh::sample::block;
use facies::mesh::{CellShape, Vector};
use facies::model::assembly::Tissue;
use facies::model::stiffness::Dilatation;
use facies::solver::{
    BlockMatrix, LinearSystem, SolverError, Tolerance, cholesky, conjugate_gradient, ordering,
    solve,
};

use crate::scenes::material;

const EXACT: Tolerance = Tolerance { relative_residual: 1e-12, memory_mb: 1000.0 };

/// A clamped block and a force on every free unknown.
fn clamped_block() -> (BlockMatrix, Vec<bool>, Vec<f64>) {
    let mesh = block(Vector::new(10.0, 8.0, 6.0), [6, 5, 4], CellShape::Hex8);
    let materials = [material(15.0, 0.4)];
    let material_of_cell = vec![0; mesh.cells.len()];
    let tissue = Tissue {
        mesh: &mesh,
        materials: &materials,
        material_of_cell: &material_of_cell,
        dilatation: |_| Dilatation::Mean,
    };
    let matrix = tissue.assemble(&|| true).unwrap().unwrap();
    let held: Vec<bool> = mesh.nodes.iter().flat_map(|x| [x.x == 0.0; 3]).collect();
    let force = |i: usize| {
        if held[i] { 0.0 } else { ((i * 7919) % 101) as f64 - 50.0 }
    };
    let forces = (0..held.len()).map(force).collect();
    (matrix, held, forces)
}

#[test]
fn cholesky_and_conjugate_gradients_agree() {
    let (matrix, held, forces) = clamped_block();
    let system = LinearSystem { matrix: &matrix, held: &held, right_hand_side: &forces };
    let go_on = |_, _| true;
    let order = ordering::minimum_degree(&matrix);
    let direct = cholesky::solve(&system, &order, &EXACT, &go_on, String::new()).unwrap();
    let iterative = conjugate_gradient::solve(&system, &EXACT, &go_on, String::new()).unwrap();
    let largest = direct.unknowns.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (a, b) in direct.unknowns.iter().zip(&iterative.unknowns) {
        assert!((a - b).abs() < 1e-9 * largest);
    }
    for solution in [&direct, &iterative] {
        assert!(solution.relative_residual <= 1e-12);
        assert!(held.iter().zip(&solution.unknowns).all(|(held, x)| !held || *x == 0.0));
    }
}

#[test]
fn a_residual_nobody_can_reach_ends_with_the_history_and_not_with_an_answer() {
    let (matrix, held, forces) = clamped_block();
    let system = LinearSystem { matrix: &matrix, held: &held, right_hand_side: &forces };
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
    let (matrix, held, forces) = clamped_block();
    let system = LinearSystem { matrix: &matrix, held: &held, right_hand_side: &forces };
    let stopped =
        conjugate_gradient::solve(&system, &EXACT, &|iteration, _| iteration < 3, String::new());
    assert_eq!(stopped.unwrap_err(), SolverError::Stopped);
}

#[test]
fn a_singular_matrix_is_refused_by_the_factorisation() {
    let (matrix, held, forces) = clamped_block();
    let free = vec![false; held.len()];
    let system = LinearSystem { matrix: &matrix, held: &free, right_hand_side: &forces };
    let result = solve(&system, &EXACT, &|_, _| true);
    assert!(result.is_err(), "{result:?}");
}

#[test]
fn a_matrix_larger_than_the_memory_is_refused_with_both_numbers() {
    let (matrix, held, forces) = clamped_block();
    let system = LinearSystem { matrix: &matrix, held: &held, right_hand_side: &forces };
    let tolerance = Tolerance { memory_mb: 0.1, ..EXACT };
    let result = solve(&system, &tolerance, &|_, _| true).unwrap_err();
    assert!(
        matches!(result, SolverError::OverBudget { allowed_mb: 0.1, needed_mb } if needed_mb > 0.1)
    );
}

#[test]
fn values_that_are_not_finite_are_refused() {
    let (matrix, held, mut forces) = clamped_block();
    forces[100] = f64::NAN;
    let system = LinearSystem { matrix: &matrix, held: &held, right_hand_side: &forces };
    assert_eq!(solve(&system, &EXACT, &|_, _| true).unwrap_err(), SolverError::NotFinite);
}
