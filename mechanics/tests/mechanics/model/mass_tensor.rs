//! docs/verification.md#v14: the mass-tensor model is plain linear tetrahedra, and how its own iterations fare.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::dofs::DofMap;
use mechanics::model::fem::assembly::Tissue;
use mechanics::model::fem::cell_stiffness::Dilatation;
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{
    Case, ElementChoice, Load, Method, ModelError, Plan, RegionNames, Scene, Settings, Sliding,
    SlidingNormal, predict,
};
use mechanics::progress::Unobserved;
use mechanics::solver::stationary::{self, Iteration, Stationary, largest_eigenvalue};
use mechanics::solver::{SolverError, System, Tolerance, Unknowns, cholesky, ordering};
use nalgebra::Matrix3;

use crate::scenes::{StopsAfter, case_of, constraint, material, set, solve};
use crate::solver::solvers::{forces, largest, largest_difference, system_of};

const TIGHT: Tolerance = Tolerance { relative_residual: 1e-12, memory_mb: 1000.0 };

/// 6144 tetrahedra, 60 x 60 x 12 mm, held at the bottom.
fn paper_block(poisson_ratio: f64) -> System {
    let mesh = block(Vector::new(60.0, 60.0, 12.0), [16, 16, 4], CellShape::Tet4);
    system_of(&mesh, "z_min", &[material(15.0, poisson_ratio)], &vec![0; mesh.cells.len()])
}

fn plain(iteration: Iteration) -> Stationary {
    Stationary { iteration, relative_change: None, most_iterations: 50_000 }
}

fn factorised(system: &System, right: &Unknowns, tolerance: &Tolerance) -> Unknowns {
    let order = ordering::minimum_degree(system);
    let right = std::slice::from_ref(right);
    cholesky::solve(system, &order, right, tolerance, &Unobserved).unwrap().remove(0).unknowns
}

/// The smallest eigenvalue of D^-1 K: power iteration on K^-1 D.
fn smallest_eigenvalue(system: &System) -> f64 {
    let mut x = forces(system, 0);
    let mut inverse = 0.0;
    // Near nu = 1/2 a factorisation has no more digits; the modes behind the first are gone after 20.
    let enough = Tolerance { relative_residual: 1e-10, ..TIGHT };
    for _ in 0..20 {
        let weighted: Unknowns = x
            .iter()
            .zip(&system.matrix.diagonal)
            .map(|(x, d)| (Matrix3::from_fn(|i, j| d[i][j]) * Vector::from(*x)).into())
            .collect();
        let dot = |a: &Unknowns, b: &Unknowns| -> f64 {
            a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
        };
        let next = factorised(system, &weighted, &enough);
        inverse = dot(&next, &weighted) / dot(&x, &weighted);
        let scale = 1.0 / largest(&next);
        x = next.iter().map(|u| u.map(|u| u * scale)).collect();
    }
    1.0 / inverse
}

#[test]
fn plain_jacobi_cannot_converge_and_the_limit_of_omega_is_known() {
    // Published with four digits from an independent script.
    for (nu, lambda_max, limit) in [(0.46, 2.771, 0.722), (0.499, 3.405, 0.587)] {
        let found = largest_eigenvalue(&paper_block(nu), 1e-9).unwrap();
        assert!((found - lambda_max).abs() < 6e-4, "nu {nu}: {found}");
        assert!((2.0 / found - limit).abs() < 6e-4, "nu {nu}: {}", 2.0 / found);
        assert!(found - 1.0 > 1.0, "the factor of plain Jacobi is lambda_max - 1");
    }
}

#[test]
fn the_condition_number_grows_as_tissue_becomes_incompressible() {
    for (nu, lambda_max, condition) in [(0.46, 2.771, 5.0e2), (0.499, 3.405, 1.9e4)] {
        let found = lambda_max / smallest_eigenvalue(&paper_block(nu));
        // Published with two digits: half a unit of the second is 2.7 % of 1.9e4.
        assert!((found / condition - 1.0).abs() < 0.027, "nu {nu}: {found:.3e}");
    }
}

#[test]
fn jacobi_diverges_with_its_history_and_its_growth_and_is_never_an_answer() {
    let system = paper_block(0.46);
    let right = forces(&system, 0);
    let failed = stationary::solve(&system, &right, &plain(Iteration::Jacobi), &TIGHT, &Unobserved);
    let Err(SolverError::Diverged { iterations, growth, residual, history }) = failed else {
        panic!("{failed:?}");
    };
    assert_eq!(history.len(), iterations);
    assert_eq!(history[iterations - 1], residual);
    // The growth comes up to lambda_max - 1 from below as other modes are left behind.
    assert!(growth > 1.74 && growth < 1.772, "{growth}");
}

#[test]
fn gauss_seidel_and_damped_jacobi_equal_the_factorisation() {
    let system = paper_block(0.46);
    let right = forces(&system, 0);
    let exact = factorised(&system, &right, &TIGHT);
    for iteration in [Iteration::GaussSeidel, Iteration::DampedJacobi] {
        let found =
            stationary::solve(&system, &right, &plain(iteration), &TIGHT, &Unobserved).unwrap();
        let difference = largest_difference(&found.unknowns, &exact) / largest(&exact);
        assert!(difference < 1e-8, "{iteration:?}: {difference:.1e}");
        assert_eq!(found.report.history.len(), found.report.iterations);
        assert!(found.report.relative_residual <= 1e-12);
        assert!(
            found.report.history.windows(2).skip(20).all(|pair| pair[1] < pair[0]),
            "{iteration:?}"
        );
    }
}

#[test]
fn a_wanted_change_goes_on_where_the_residual_alone_would_end() {
    let system = paper_block(0.46);
    let right = forces(&system, 0);
    let exact = factorised(&system, &right, &TIGHT);
    let loose = Tolerance { relative_residual: 1e-2, ..TIGHT };
    let solved = |relative_change| {
        let stationary = Stationary { relative_change, ..plain(Iteration::GaussSeidel) };
        let found = stationary::solve(&system, &right, &stationary, &loose, &Unobserved).unwrap();
        let difference = largest_difference(&found.unknowns, &exact) / largest(&exact);
        (found.report.iterations, difference)
    };
    let (early, far) = solved(None);
    let (late, near) = solved(Some(1e-10));
    assert!(early < late && far > 1e-4, "{early} {late} {far:.1e}");
    // |du| of the last sweep times 1 / (1 - rho), about a hundred.
    assert!(near < 1e-8, "{near:.1e}");
}

#[test]
fn gauss_seidel_gives_the_same_bits_on_one_two_and_three_threads() {
    let mesh = block(Vector::new(60.0, 60.0, 20.0), [24, 24, 8], CellShape::Tet4);
    let system = system_of(&mesh, "z_min", &[material(15.0, 0.4)], &vec![0; mesh.cells.len()]);
    assert!(system.ordering.parts.len() > 1, "colours for threads are what is tested");
    let right = forces(&system, 0);
    let tolerance = Tolerance { relative_residual: 1e-4, ..TIGHT };
    for iteration in [Iteration::GaussSeidel, Iteration::DampedJacobi] {
        let with_threads = |count| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
            let solve =
                || stationary::solve(&system, &right, &plain(iteration), &tolerance, &Unobserved);
            pool.install(solve).unwrap()
        };
        let one = with_threads(1);
        for threads in [2, 3] {
            let other = with_threads(threads);
            assert_eq!(one.unknowns, other.unknowns, "{iteration:?} on {threads} threads");
            assert_eq!(one.report.history, other.report.history);
        }
    }
}

#[test]
fn iterations_stop_when_cancelled_and_end_where_they_are_too_many() {
    let system = paper_block(0.46);
    let right = forces(&system, 0);
    for iteration in [Iteration::GaussSeidel, Iteration::DampedJacobi, Iteration::Jacobi] {
        let stopped = stationary::solve(
            &system,
            &right,
            &plain(iteration),
            &TIGHT,
            &StopsAfter::iterations(3),
        );
        assert_eq!(stopped.unwrap_err(), SolverError::Stopped);
        let few = Stationary { most_iterations: 7, ..plain(iteration) };
        let ended = stationary::solve(&system, &right, &few, &TIGHT, &Unobserved).unwrap_err();
        assert!(
            matches!(&ended, SolverError::NotConverged { iterations: 7, history, .. } if history.len() == 7),
            "{ended:?}"
        );
    }
    let power = stationary::solve(
        &system,
        &right,
        &plain(Iteration::DampedJacobi),
        &TIGHT,
        &StopsAfter::iterations(0),
    );
    assert_eq!(power.unwrap_err(), SolverError::Stopped, "while lambda_max is looked for");
}

#[test]
fn a_matrix_that_is_not_positive_or_does_not_fit_is_refused() {
    let mut system = paper_block(0.3);
    let right = forces(&system, 0);
    let small = Tolerance { memory_mb: 0.1, ..TIGHT };
    let over =
        stationary::solve(&system, &right, &plain(Iteration::GaussSeidel), &small, &Unobserved);
    assert!(matches!(over, Err(SolverError::OverBudget { allowed_mb: 0.1, .. })), "{over:?}");
    system.matrix.diagonal[5][1][1] = -1.0;
    let bad =
        stationary::solve(&system, &right, &plain(Iteration::GaussSeidel), &TIGHT, &Unobserved);
    assert_eq!(bad.unwrap_err(), SolverError::Singular { node: 5 });
}

/// Random moduli in each of twenty regions, on a bone that moves.
fn patchwork() -> (Case, Plan) {
    let mut mesh = block(Vector::new(20.0, 16.0, 8.0), [5, 4, 2], CellShape::Tet4);
    let label = |cell: usize| ((cell * 7919) % 20) as i64;
    let labels = (0..mesh.cells.len()).map(label).collect();
    mesh.cell_labels.insert("patch".to_owned(), labels);
    let mut case = case_of(mesh, material(15.0, 0.3));
    let regions = RegionNames { array: "patch".to_owned(), names: Default::default() };
    case.regions = Some(regions);
    for region in 0..20 {
        let moduli = material(1.0 + (region * 37 % 100) as f64, 0.024 * f64::from(region));
        case.materials.insert(region.to_string(), moduli);
    }
    case.fixed.push(set("x_min"));
    let plan = Plan {
        prescribed: vec![constraint("x_max", [Some(1.0), None, Some(-2.0)])],
        ..Plan::default()
    };
    (case, plan)
}

fn mass_tensor(iterations: Iterations) -> Settings {
    let method = Method::MassTensor(MassTensorSettings { iterations });
    Settings { method, relative_residual: 1e-13, ..Settings::default() }
}

/// 1/(36 V) [lambda m_j m_k^T + mu m_k m_j^T + mu (m_j . m_k) I], m = 6 V grad N: the tensor as Kim et al.
/// 2012 write it in eq. 29, from area vectors.
fn tensors(mesh: &VolumeMesh, cell: usize, lambda: f64, mu: f64) -> Vec<Matrix3<f64>> {
    let x: Vec<Vector> = mesh.corners(cell).collect();
    // Area vectors: twice the face across from each corner, towards the corner.
    let area = |a: usize, b: usize, c: usize| (x[b] - x[a]).cross(&(x[c] - x[a]));
    let m = [area(1, 3, 2), area(0, 2, 3), area(0, 3, 1), area(0, 1, 2)];
    let volume = (x[1] - x[0]).cross(&(x[2] - x[0])).dot(&(x[3] - x[0])) / 6.0;
    let pair = |j: usize, k: usize| {
        let parts = m[j] * m[k].transpose() * lambda + m[k] * m[j].transpose() * mu;
        (parts + Matrix3::identity() * (mu * m[j].dot(&m[k]))) / (36.0 * volume)
    };
    (0..16).map(|entry| pair(entry / 4, entry % 4)).collect()
}

#[test]
fn the_tensors_are_the_blocks_of_the_stiffness_matrix() {
    let (case, _) = patchwork();
    let mesh = &case.volume;
    let materials: Vec<_> = (0..20).map(|region| case.materials[&region.to_string()]).collect();
    let of_cell: Vec<u16> = mesh.cell_labels["patch"].iter().map(|&label| label as u16).collect();
    let tissue = Tissue::isotropic(mesh, &materials, &of_cell, |_| Dilatation::Pointwise);
    let dof_map = DofMap::new(mesh, &vec![false; mesh.nodes.len()]);
    let mut assembled = tissue.assemble(&dof_map, &Unobserved).unwrap().unwrap();
    let mut sums = std::collections::BTreeMap::new();
    for cell in 0..mesh.cells.len() {
        let law = &materials[of_cell[cell] as usize];
        let blocks = tensors(mesh, cell, law.lambda(), law.shear_modulus());
        for (j, &row) in mesh.cells.nodes(cell).iter().enumerate() {
            for (k, &column) in mesh.cells.nodes(cell).iter().enumerate() {
                *sums.entry((row, column)).or_insert_with(Matrix3::zeros) += blocks[4 * j + k];
            }
        }
    }
    let scale = sums.values().map(|block| block.amax()).fold(0.0, f64::max);
    let mut compared = 0;
    for ((j, k), sum) in &sums {
        let (row, column) = (dof_map.row(*j), dof_map.row(*k));
        if column <= row {
            let block = assembled.block_mut(row, column);
            let block = Matrix3::from_fn(|r, c| block[r][c]);
            assert!((block - sum).amax() < 1e-12 * scale, "{j} {k}");
            compared += 1;
        }
    }
    assert_eq!(compared, assembled.diagonal.len() + assembled.lower.len());
}

#[test]
fn the_mass_tensor_model_answers_as_plain_linear_tetrahedra_do() {
    let (case, plan) = patchwork();
    let plain_settings =
        Settings { element: ElementChoice::Plain, relative_residual: 1e-13, ..Settings::default() };
    let elements = solve(&case, &plan, &plain_settings);
    let tensors = solve(&case, &plan, &mass_tensor(Iterations::Fast));
    let stationary = Iterations::Stationary(plain(Iteration::GaussSeidel));
    let own = solve(&case, &plan, &mass_tensor(stationary));
    for (number, u) in elements.displacement.iter().enumerate() {
        assert!((u - tensors.displacement[number]).norm() < 1e-10);
        assert!((u - own.displacement[number]).norm() < 1e-10);
    }
    assert_eq!(tensors.elements, ["tet4 plain"]);
    assert_eq!(own.solver.method, "gauss_seidel");
    assert_eq!(own.solver.history.len(), own.solver.iterations);
    assert!(tensors.warnings.iter().any(|warning| warning.code == "locking"), "nu up to 0.456");
}

/// Two walls at an angle on which a loaded block slides.
fn against_oblique_walls() -> (Case, Plan, RigidMovement) {
    let turn = RigidMovement::about_pivot(Vector::new(0.4, -1.1, 0.8), Vector::y(), Vector::z());
    let mut mesh = block(Vector::new(6.0, 4.0, 4.0), [4, 3, 3], CellShape::Tet4);
    mesh.nodes.iter_mut().for_each(|x| *x = turn.apply(x));
    let mut case = case_of(mesh, material(15.0, 0.4));
    for (name, normal) in [("x_min", Vector::x()), ("y_min", Vector::y()), ("z_min", Vector::z())] {
        let normal = SlidingNormal::Direction(turn.rotation() * normal);
        case.sliding.push(Sliding { nodes: set(name), normal, segment: None });
    }
    let force = turn.rotation() * Vector::new(0.2, 0.3, -1.0);
    let loads = vec![Load::Force { nodes: set("z_max"), force }];
    (case, Plan { loads, ..Plan::default() }, turn)
}

#[test]
fn own_iterations_hold_nodes_at_any_angle_as_the_fast_solver_does() {
    let (case, plan, turn) = against_oblique_walls();
    let fast = solve(&case, &plan, &mass_tensor(Iterations::Fast));
    let largest = fast.displacement.iter().map(Vector::norm).fold(0.0, f64::max);
    for iteration in [Iteration::GaussSeidel, Iteration::DampedJacobi] {
        let own = solve(&case, &plan, &mass_tensor(Iterations::Stationary(plain(iteration))));
        for (a, b) in fast.displacement.iter().zip(&own.displacement) {
            assert!((a - b).norm() < 1e-10 * largest, "{iteration:?}");
        }
        for &node in case.volume.node_set("x_min").unwrap() {
            let across = own.displacement[node as usize].dot(&(turn.rotation() * Vector::x()));
            assert!(across.abs() < 1e-14, "{across:e}");
        }
        for (a, b) in fast.reactions.values().zip(own.reactions.values()) {
            assert!((a - b).norm() < 1e-8, "reactions in mN");
        }
    }
}

#[test]
fn a_prediction_that_diverges_says_so_and_one_that_is_stopped_stops() {
    let mut mesh = block(Vector::new(30.0, 30.0, 12.0), [8, 8, 4], CellShape::Tet4);
    mesh.node_sets.insert("bone".to_owned(), vec![0, 1, 2]);
    let mut case = case_of(mesh, material(15.0, 0.46));
    case.fixed.push(set("z_min"));
    let force = Vector::new(1.0, 2.0, 3.0);
    let plan = Plan { loads: vec![Load::Force { nodes: set("z_max"), force }], ..Plan::default() };
    let scene = |iteration| {
        let settings = mass_tensor(Iterations::Stationary(plain(iteration)));
        Scene::new(&case, &plan, &settings).unwrap()
    };
    let diverged = predict(&scene(Iteration::Jacobi), &Unobserved).unwrap_err();
    assert!(
        matches!(&diverged, ModelError::Solver(SolverError::Diverged { growth, history, .. }) if *growth > 1.5 && !history.is_empty()),
        "{diverged}"
    );
    let stopped = predict(&scene(Iteration::GaussSeidel), &StopsAfter::iterations(3)).unwrap_err();
    assert_eq!(stopped, ModelError::Solver(SolverError::Stopped));
}

#[test]
fn cells_and_elements_that_tensors_do_not_know_are_refused_where_they_stand() {
    let refused = |shape: CellShape, element: ElementChoice| {
        let mut case =
            case_of(block(Vector::new(2.0, 2.0, 2.0), [2, 2, 2], shape), material(15.0, 0.3));
        case.fixed.push(set("z_min"));
        let settings = Settings { element, ..mass_tensor(Iterations::Fast) };
        let scene = Scene::new(&case, &Plan::default(), &settings);
        scene.err().map(|errors| (errors.0[0].pointer.clone(), errors.0[0].code.name()))
    };
    let code = "method-not-available";
    let at = |pointer: &str| Some((pointer.to_owned(), code));
    assert_eq!(refused(CellShape::Tet4, ElementChoice::Plain), None);
    assert_eq!(refused(CellShape::Hex8, ElementChoice::Auto), at("/case/volume"));
    assert_eq!(refused(CellShape::Tet4, ElementChoice::Stabilised), at("/spec/element"));
    assert_eq!(refused(CellShape::Tet4, ElementChoice::Quadratic), at("/spec/element"));
}
