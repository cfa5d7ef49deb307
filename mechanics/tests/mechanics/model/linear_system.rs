//! Linear finite elements that are kept: several solves of one assembly, and loose ones.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::model::fem::linear_system::{LinearSystem, Residual};
use mechanics::model::problem::LoadCase;
use mechanics::prediction::{ElementChoice, Plan, Scene, Settings, Sliding, SlidingNormal};
use mechanics::progress::Unobserved;

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
