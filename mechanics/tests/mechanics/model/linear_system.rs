//! Linear finite elements that are kept: several solves of one assembly, and loose ones.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::model::fem::linear_system::{LinearSystem, Residual};
use mechanics::model::problem::{LoadCase, ModelError};
use mechanics::prediction::{
    Case, ElementChoice, Plan, RegionNames, Scene, Settings, Sliding, SlidingNormal,
};
use mechanics::progress::Unobserved;
use mechanics::solver::SolverError;

use crate::scenes::{case_of, constraint, exact, material, set};

/// A block on a sliding slope, its lid prescribed; some are small enough to be factorised.
fn scenes() -> Vec<(&'static str, Scene)> {
    let scene = |shape, cells, element| {
        let mesh = block(Vector::new(40.0, 40.0, 20.0), cells, shape);
        let mut case = case_of(mesh, material(15.0, 0.46));
        let slope = SlidingNormal::Direction(Vector::new(0.3, 0.1, -1.0));
        case.sliding.push(Sliding { nodes: set("z_min"), normal: slope, segment: None });
        let prescribed = vec![constraint("z_max", [Some(1.0), Some(0.0), Some(-0.5)])];
        let plan = Plan { prescribed, ..Plan::default() };
        Scene::new(&case, &plan, &Settings { element, ..exact() }).unwrap()
    };
    vec![
        ("mixed", scene(CellShape::Tet4, [8, 8, 4], ElementChoice::Stabilised)),
        ("factorised", scene(CellShape::Tet4, [8, 8, 4], ElementChoice::Plain)),
        ("iterated", scene(CellShape::Hex8, [18, 18, 9], ElementChoice::Auto)),
    ]
}

/// Forces that vary from node to node.
fn forces(scene: &Scene) -> Vec<Vector> {
    let force = |x: &Vector| Vector::new((x.x * 0.3).sin(), (x.y + x.z).cos(), x.z * 0.05);
    scene.mesh.nodes.iter().map(force).collect()
}

fn largest(vectors: &[Vector]) -> f64 {
    vectors.iter().map(Vector::norm).fold(0.0, f64::max)
}

fn largest_difference(a: &[Vector], b: &[Vector]) -> f64 {
    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

fn assemble(scene: &Scene) -> LinearSystem<'_> {
    scene.assemble(&Unobserved).unwrap().expect("elements of first order")
}

#[test]
fn what_forces_change_is_the_difference_of_the_answers_with_and_without_them() {
    for (name, scene) in scenes() {
        let system = assemble(&scene);
        let without = scene.load_case();
        let with = LoadCase { forces: forces(&scene), ..without.clone() };
        let solved = system.solve(&[without, with], &Unobserved).unwrap();
        let residual = Residual { forces: forces(&scene), volumes: Vec::new() };
        let change = system.solve_for(&[residual], 1e-12, &Unobserved).unwrap().remove(0);
        let [without, with] = &solved[..] else { panic!("two cases") };
        let (a, b) = (&with.equilibrium.displacement, &without.equilibrium.displacement);
        let expected: Vec<Vector> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        let apart = largest_difference(&change.displacement, &expected);
        assert!(apart < 1e-9 * largest(&expected), "{name}: {apart:e}");
        let differences = with.pressures.iter().zip(&without.pressures).map(|(a, b)| a - b);
        for (found, expected) in change.pressures.iter().zip(differences) {
            assert!((found - expected).abs() < 1e-8, "{name}: {found} {expected}");
        }
        assert_eq!(change.pressures.is_empty(), name != "mixed");
    }
}

#[test]
fn a_second_solve_of_a_kept_system_has_the_bits_of_the_first() {
    for (name, scene) in scenes() {
        let system = assemble(&scene);
        let solve = || system.solve(&[scene.load_case()], &Unobserved).unwrap().remove(0);
        let (first, second) = (solve(), solve());
        let fresh = scene.solve(&Unobserved).unwrap();
        assert_eq!(first.equilibrium.displacement, second.equilibrium.displacement, "{name}");
        assert_eq!(first.equilibrium.displacement, fresh.displacement, "{name}");
    }
}

#[test]
fn a_loose_solve_ends_at_its_residual_and_before_a_tight_one() {
    for (name, scene) in scenes() {
        let system = assemble(&scene);
        let residuals: Vec<Residual> = (1..=9)
            .map(|factor| Residual {
                forces: forces(&scene).iter().map(|f| f * f64::from(factor)).collect(),
                volumes: Vec::new(),
            })
            .collect();
        let loose = system.solve_for(&residuals, 0.1, &Unobserved).unwrap();
        let tight = system.solve_for(&residuals, 1e-10, &Unobserved).unwrap();
        for (loose, tight) in loose.iter().zip(&tight) {
            assert!(loose.relative_residual <= 0.1 && tight.relative_residual <= 1e-10, "{name}");
            assert!(loose.iterations < tight.iterations || name == "factorised", "{name}");
        }
    }
}

#[test]
fn volumes_do_to_forces_what_forces_do_to_volumes() {
    let (_, scene) = scenes().swap_remove(0);
    let system = assemble(&scene);
    let count = system.pressures.as_ref().unwrap().cells.pressure_count;
    let volumes: Vec<f64> = (0..count).map(|number| (number as f64 * 0.7).sin()).collect();
    let residuals = [
        Residual { forces: forces(&scene), volumes: Vec::new() },
        Residual { forces: vec![Vector::zeros(); scene.mesh.nodes.len()], volumes },
    ];
    let changes = system.solve_for(&residuals, 1e-12, &Unobserved).unwrap();
    let of_volumes = changes[0].pressures.iter().zip(&residuals[1].volumes);
    let of_volumes: f64 = of_volumes.map(|(p, h)| p * h).sum();
    let of_forces = changes[1].displacement.iter().zip(&residuals[0].forces);
    let of_forces: f64 = of_forces.map(|(u, f)| u.dot(f)).sum();
    assert!((of_volumes / of_forces - 1.0).abs() < 1e-8, "{of_volumes} {of_forces}");
}

/// Soft tissue of 80 x 60 x 20 mm under a layer of 1 mm that is 1000 times as stiff, in cells of 10 x 10 mm, pulled by its floor.
fn flat_cells_of_a_stiff_layer(memory_mb: f64) -> Scene {
    let mut mesh = block(Vector::new(80.0, 60.0, 20.0), [8, 6, 5], CellShape::Tet4);
    let height = |z: f64| if z > 18.0 { 20.0 } else { z * 19.0 / 16.0 };
    mesh.nodes.iter_mut().for_each(|node| node.z = height(node.z));
    let is_layer =
        |cell: usize| mesh.cells.nodes(cell).iter().all(|&node| mesh.nodes[node as usize].z > 18.0);
    let layer = (0..mesh.cells.len()).map(|cell| i64::from(is_layer(cell))).collect();
    mesh.cell_labels.insert("layer".to_owned(), layer);
    let floor = mesh.node_sets["z_min"].clone();
    let is_moved = |node: &u32| mesh.nodes[*node as usize].x > 45.0;
    let (moved, still) = floor.into_iter().partition(is_moved);
    mesh.node_sets.extend([("still".to_owned(), still), ("moved".to_owned(), moved)]);
    let names = [(0, "soft".to_owned()), (1, "stiff".to_owned())];
    let materials = [("soft", 2.0), ("stiff", 2000.0)];
    let case = Case {
        regions: Some(RegionNames { array: "layer".to_owned(), names: names.into() }),
        materials: materials.map(|(name, young)| (name.to_owned(), material(young, 0.49))).into(),
        fixed: vec![set("still")],
        ..case_of(mesh, material(2.0, 0.49))
    };
    let prescribed = vec![constraint("moved", [Some(4.0), Some(0.0), Some(2.0)])];
    let plan = Plan { prescribed, ..Plan::default() };
    let element = ElementChoice::Stabilised;
    Scene::new(&case, &plan, &Settings { element, memory_mb, ..Settings::default() }).unwrap()
}

#[test]
fn flat_cells_of_a_layer_1000_times_as_stiff_are_solved_under_a_factor() {
    let scene = flat_cells_of_a_stiff_layer(4000.0);
    let system = assemble(&scene);
    let twice = LoadCase {
        held: scene.load_case().held.iter().map(|held| held * 2.0).collect(),
        ..scene.load_case()
    };
    let solved = system.solve(&[scene.load_case(), twice], &Unobserved).unwrap();
    let [once, twice] = [&solved[0].equilibrium, &solved[1].equilibrium];
    for found in [once, twice] {
        let report = &found.solver;
        assert!(report.relative_residual <= report.wanted_residual, "{report:?}");
        assert_eq!(report.preconditioner, "cholesky and pressure mass");
        assert!(report.iterations < 60, "{}", report.iterations);
    }
    assert!(once.solver.why.contains("multigrid stalled: residual"), "{}", once.solver.why);
    let doubled: Vec<Vector> = once.displacement.iter().map(|u| u * 2.0).collect();
    let apart = largest_difference(&twice.displacement, &doubled);
    assert!(apart < 1e-5 * largest(&doubled), "{apart:e}");
    let [first, second] = [0, 1].map(|_| scene.solve(&Unobserved).unwrap().displacement);
    assert_eq!(first, second);
}

#[test]
fn a_factor_over_the_memory_leaves_the_iterations_as_diverged() {
    let needed_mb = assemble(&flat_cells_of_a_stiff_layer(4000.0)).megabytes();
    let scene = flat_cells_of_a_stiff_layer(needed_mb + 0.05);
    let ended = assemble(&scene).solve(&[scene.load_case()], &Unobserved).map(|_| ());
    let is_stalled = matches!(ended, Err(ModelError::Solver(SolverError::NotConverged { .. })));
    assert!(is_stalled, "{ended:?}");
}
