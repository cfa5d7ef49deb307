//! Factorisation and iterations against each other, and how they fail.

use mechanics::material::LinearElastic;
use mechanics::mesh::sample::{ThickSphere, block, thick_sphere_octant};
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::dofs::DofMap;
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::Dilatation;
use mechanics::progress::Unobserved;
use mechanics::solver::{
    SolverError, System, Tolerance, Unknowns, cholesky, conjugate_gradient, ordering, solve,
};

use crate::scenes::{StopsAfter, material};

const EXACT: Tolerance = Tolerance { relative_residual: 1e-12, memory_mb: 1000.0 };

/// A mesh of one material held at one of its node sets.
fn held_mesh(mesh: &VolumeMesh, set: &str, poisson_ratio: f64) -> System {
    let material_of_cell = vec![0; mesh.cells.len()];
    system_of(mesh, set, &[material(15.0, poisson_ratio)], &material_of_cell)
}

/// The matrix of a mesh held at one of its node sets.
pub fn system_of(
    mesh: &VolumeMesh,
    set: &str,
    materials: &[LinearElastic],
    material_of_cell: &[u16],
) -> System {
    let tissue = Tissue::isotropic(mesh, materials, material_of_cell, |_| Dilatation::Mean);
    let mut held = vec![false; mesh.nodes.len()];
    mesh.node_set(set).unwrap().iter().for_each(|&node| held[node as usize] = true);
    let dof_map = DofMap::new(mesh, &held);
    let matrix = tissue.assemble(&dof_map, &Unobserved).unwrap().unwrap();
    let positions = dof_map.by_row(&mesh.nodes);
    System { ordering: dof_map.ordering, matrix, partly_constrained: Vec::new(), positions }
}

fn clamped_block() -> System {
    let block = block(Vector::new(10.0, 8.0, 6.0), [6, 5, 4], CellShape::Hex8);
    held_mesh(&block, "x_min", 0.4)
}

fn sphere(cells_along: usize, cells_radial: usize) -> System {
    let sphere = ThickSphere { inner_radius: 60.0, outer_radius: 80.0, cells_radial, cells_along };
    held_mesh(&thick_sphere_octant(sphere, CellShape::Tet4), "inner", 0.46)
}

/// A force on every free unknown; each seed gives another.
pub fn forces(system: &System, seed: usize) -> Unknowns {
    let force = |i: usize| ((i * (7919 + 2 * seed)) % 101) as f64 - 50.0;
    (0..system.ordering.free).map(|row| std::array::from_fn(|c| force(3 * row + c))).collect()
}

pub fn largest_difference(a: &Unknowns, b: &Unknowns) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}

pub fn largest(a: &Unknowns) -> f64 {
    a.as_flattened().iter().fold(0.0, |largest, a| largest.max(a.abs()))
}

#[test]
fn cholesky_and_conjugate_gradients_agree() {
    let system = clamped_block();
    let right = [forces(&system, 0), forces(&system, 1)];
    let order = ordering::minimum_degree(&system);
    let direct = cholesky::solve(&system, &order, &right, &EXACT, &Unobserved).unwrap();
    let iterative = conjugate_gradient::solve(&system, &right, &EXACT, &Unobserved).unwrap();
    for (direct, iterative) in direct.iter().zip(&iterative) {
        let difference = largest_difference(&direct.unknowns, &iterative.unknowns);
        assert!(difference < 1e-9 * largest(&direct.unknowns));
        assert!(
            direct.report.relative_residual <= 1e-12 && iterative.report.relative_residual <= 1e-12
        );
    }
}

#[test]
fn right_hand_sides_solved_together_are_those_solved_alone() {
    let system = sphere(12, 4);
    let tolerance = Tolerance { relative_residual: 1e-10, ..EXACT };
    for count in [2, 5, 11] {
        let mut right: Vec<Unknowns> = (0..count).map(|seed| forces(&system, seed)).collect();
        right[1] = vec![[0.0; 3]; system.ordering.free];
        let together = conjugate_gradient::solve(&system, &right, &tolerance, &Unobserved).unwrap();
        assert_eq!(together.len(), count);
        for (right, solution) in right.into_iter().zip(&together) {
            let alone = conjugate_gradient::solve(&system, &[right], &tolerance, &Unobserved);
            let alone = &alone.unwrap()[0];
            let difference = largest_difference(&alone.unknowns, &solution.unknowns);
            assert!(difference <= 1e-8 * largest(&alone.unknowns), "{difference:.1e}");
            assert!(solution.report.relative_residual <= 1e-10);
        }
        assert!(together[1].unknowns.iter().all(|u| *u == [0.0; 3]), "nothing acts on the second");
    }
}

#[test]
fn one_thread_and_three_give_the_same_bits() {
    let system = sphere(24, 6);
    assert!(system.ordering.parts.len() > 1, "parts for threads are what is tested");
    let tolerance = Tolerance { relative_residual: 1e-8, ..EXACT };
    let right = [forces(&system, 0)];
    let with_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| conjugate_gradient::solve(&system, &right, &tolerance, &Unobserved))
            .unwrap()
            .remove(0)
    };
    let (one, three) = (with_threads(1), with_threads(3));
    assert_eq!(one.report.iterations, three.report.iterations);
    assert_eq!(one.unknowns, three.unknowns);
}

#[test]
fn a_residual_nobody_can_reach_ends_with_the_history_and_not_with_an_answer() {
    let system = clamped_block();
    let right = [forces(&system, 0)];
    let tolerance = Tolerance { relative_residual: 1e-30, ..EXACT };
    for result in [
        solve(&system, &right, &tolerance, &Unobserved),
        conjugate_gradient::solve(&system, &right, &tolerance, &Unobserved),
    ] {
        let Err(SolverError::NotConverged { history, residual, .. }) = result else {
            panic!("{result:?}");
        };
        assert!(!history.is_empty() && residual > 1e-30);
    }
}

#[test]
fn a_solver_stops_when_it_is_asked_to() {
    let system = clamped_block();
    let right = [forces(&system, 0)];
    let stopped = conjugate_gradient::solve(&system, &right, &EXACT, &StopsAfter::iterations(3));
    assert_eq!(stopped.unwrap_err(), SolverError::Stopped);
}

#[test]
fn a_singular_matrix_is_refused_by_the_factorisation() {
    let mut mesh = block(Vector::new(10.0, 8.0, 6.0), [6, 5, 4], CellShape::Hex8);
    mesh.node_sets.insert("nothing".to_owned(), Vec::new());
    let system = held_mesh(&mesh, "nothing", 0.4);
    let result = solve(&system, &[forces(&system, 0)], &EXACT, &Unobserved);
    assert!(result.is_err(), "{result:?}");
}

#[test]
fn a_matrix_larger_than_the_memory_is_refused_with_both_numbers() {
    let system = clamped_block();
    let tolerance = Tolerance { memory_mb: 0.1, ..EXACT };
    let result = solve(&system, &[forces(&system, 0)], &tolerance, &Unobserved).unwrap_err();
    assert!(
        matches!(result, SolverError::OverBudget { allowed_mb: 0.1, needed_mb } if needed_mb > 0.1)
    );
}

#[test]
fn values_that_are_not_finite_are_refused() {
    let system = clamped_block();
    let mut right = forces(&system, 0);
    right[30][1] = f64::NAN;
    assert_eq!(solve(&system, &[right], &EXACT, &Unobserved).unwrap_err(), SolverError::NotFinite);
}

#[test]
fn iterations_hardly_grow_with_the_mesh() {
    let iterations = |cells_along: usize, cells_radial: usize| {
        let system = sphere(cells_along, cells_radial);
        let tolerance = Tolerance { relative_residual: 1e-8, ..EXACT };
        let right = [forces(&system, 0)];
        conjugate_gradient::solve(&system, &right, &tolerance, &Unobserved).unwrap()[0]
            .report
            .iterations
    };
    let (coarse, fine) = (iterations(10, 3), iterations(20, 6));
    assert!(fine < 50, "{fine} iterations for eight times the cells of {coarse}");
    assert!(fine as f64 <= 1.5 * coarse as f64, "{coarse} and {fine} iterations");
}

#[test]
fn right_hand_sides_whose_squares_vanish_or_overflow_are_solved_all_the_same() {
    let system = clamped_block();
    let usual = forces(&system, 1);
    let known = solve(&system, std::slice::from_ref(&usual), &EXACT, &Unobserved).unwrap();
    for power in [-600, 600] {
        let factor = 2.0_f64.powi(power);
        let scaled: Unknowns = usual.iter().map(|f| f.map(|value| value * factor)).collect();
        let sides = [scaled, usual.clone()];
        let ordering = ordering::minimum_degree(&system);
        let both = [
            cholesky::solve(&system, &ordering, &sides, &EXACT, &Unobserved).unwrap(),
            conjugate_gradient::solve(&system, &sides, &EXACT, &Unobserved).unwrap(),
        ];
        for solutions in both {
            let back: Unknowns =
                solutions[0].unknowns.iter().map(|x| x.map(|value| value / factor)).collect();
            let scale =
                known[0].unknowns.as_flattened().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            assert!(largest_difference(&back, &known[0].unknowns) < 1e-9 * scale, "2^{power}");
            assert!(largest_difference(&back, &solutions[1].unknowns) < 1e-9 * scale, "2^{power}");
        }
    }
}
