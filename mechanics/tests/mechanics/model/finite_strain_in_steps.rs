//! Load steps at finite strain: each is a state at rest, and the last one the answer without steps.

use std::num::NonZeroU32;

use mechanics::boundary::Constraint;
use mechanics::mesh::{CellShape, Vector, VolumeMesh, sample::block};
use mechanics::model::fem::finite_strain::Elements;
use mechanics::model::problem::Equilibrium;
use mechanics::prediction::{
    Advance, Case, ElementChoice, Load, Method, Plan, Prediction, Settings, linear_strain,
};
use mechanics::progress::Unobserved;

use super::finite_strain::{RING, hard_block, neo_hookean, rest_by};
use crate::prediction::growth::growing;
use crate::prediction::muscles::{in_region, pulling};
use crate::scenes::{case_of, constraint, material, set, solve};

fn in_steps(count: u32) -> Advance {
    Advance::InSteps(NonZeroU32::new(count).unwrap())
}

fn rest(
    advance: Advance,
    elements: Elements,
    mesh: &VolumeMesh,
    held: &[Constraint],
) -> Equilibrium {
    rest_by((advance, elements), mesh, neo_hookean(0.46), held, &Unobserved).unwrap()
}

fn farthest(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn each_load_step_is_rest_of_its_share_and_the_last_one_is_the_answer() {
    let (mesh, held) = hard_block([20, 20, 4], 1.0, RING);
    for elements in [Elements::PLAIN, Elements::STABLE] {
        let stepped = rest(in_steps(4), elements, &mesh, &held);
        let newton = stepped.solver.newton.as_ref().unwrap();
        assert!(newton.parts.is_empty());
        let shares: Vec<f64> = newton.load_steps.iter().map(|step| step.rest.share).collect();
        assert_eq!(shares, [0.25, 0.5, 0.75, 1.0]);
        let steps: usize = newton.load_steps.iter().map(|step| step.rest.steps).sum();
        assert_eq!(steps, stepped.solver.iterations);
        for step in &newton.load_steps {
            let there: Vec<Constraint> = held
                .iter()
                .map(|own| Constraint::at(own.node, own.values() * step.rest.share))
                .collect();
            let alone = rest(Advance::AtOnce, elements, &mesh, &there);
            let alone_newton = alone.solver.newton.unwrap();
            assert!(alone_newton.load_steps.is_empty());
            let (energy, wanted) = (step.rest.energy, alone_newton.energy);
            assert!((energy / wanted - 1.0).abs() < 1e-9, "{}: {energy} {wanted}", step.rest.share);
            assert!((step.rest.least_det_f - alone_newton.least_det_f).abs() < 1e-5);
            assert!(step.relative_residual <= 1e-7 && step.is_stable == Some(true));
            assert!(step.bulk_in_cells == 0.0 && !step.is_bulk_in_all);
            let largest = alone.reactions.iter().map(Vector::norm).fold(0.0, f64::max);
            assert!(farthest(&step.reactions, &alone.reactions) < 1e-5 * largest);
        }
        let at_once = rest(Advance::AtOnce, elements, &mesh, &held);
        let apart = farthest(&stepped.displacement, &at_once.displacement);
        assert!(apart < 1e-4, "{apart:e}");
    }
}

/// A movement after which all cells keep bulk modulus, and one after which a few pressed ones do.
#[test]
fn a_load_step_at_which_all_cells_keep_bulk_modulus_says_so_and_the_first_one_is_named() {
    for (count, ring, all_keep_it) in [(1, 0.0, true), (2, 0.0, true), (1, RING, false)] {
        let (mesh, held) = hard_block([20, 20, 4], 1.5, ring);
        let moved = rest(in_steps(count), Elements::STABLE, &mesh, &held);
        let newton = moved.solver.newton.unwrap();
        for step in &newton.load_steps {
            let keeps = step.bulk_in_cells > 0.0 && step.cells_with_bulk == mesh.cells.len();
            assert_eq!(step.is_bulk_in_all, keeps, "{step:?}");
        }
        let last = newton.load_steps.last().unwrap();
        let (bulk, cells) = (newton.bulk_in_cells, newton.cells_with_bulk);
        assert_eq!((last.bulk_in_cells, last.cells_with_bulk), (bulk, cells));
        let first = newton.load_steps.iter().position(|step| step.is_bulk_in_all);
        assert_eq!(first.is_some(), all_keep_it, "{count} {ring}");
        let told: Vec<f64> = moved
            .warnings
            .iter()
            .filter(|warning| warning.code == "bulk-in-all-cells")
            .flat_map(|warning| warning.numbers.iter())
            .filter(|(name, _)| *name == "load_step")
            .map(|(_, step)| *step)
            .collect();
        let named: Vec<f64> = first.map(|first| (first + 1) as f64).into_iter().collect();
        assert_eq!(told, named, "{count} {ring}");
    }
}

/// 54 mm and 30 degrees, with no free ring around what is moved.
#[test]
fn a_load_step_without_rest_at_once_is_made_in_parts() {
    let (mesh, held) = hard_block([20, 20, 4], 2.0, 0.0);
    let moved = rest(in_steps(1), Elements::STABLE, &mesh, &held);
    let newton = moved.solver.newton.unwrap();
    assert!(newton.parts.len() > 1);
    assert_eq!(
        (newton.load_steps.len(), newton.load_steps[0].rest.steps),
        (1, moved.solver.iterations)
    );
}

/// Tissue that is moved, pulled at, grows and pulls, by shares of all of it.
fn acted_on(share: f64, shape: CellShape, settings: &Settings) -> Prediction {
    let mesh = block(Vector::new(24.0, 12.0, 12.0), [6, 3, 3], shape);
    let case = Case {
        fixed: vec![set("z_min")],
        muscles: vec![in_region("biceps", "tissue", Vector::x())],
        ..case_of(mesh, material(15.0, 0.46))
    };
    let grown = (1.0 + share * linear_strain(0.1)).powi(3) - 1.0;
    let moved = [4.0, 0.0, -2.0].map(|movement| Some(share * movement));
    let force = Vector::new(0.0, 10.0, 0.0) * share;
    let plan = Plan {
        prescribed: vec![constraint("x_max", moved)],
        loads: vec![Load::Force { nodes: set("x_min"), force }],
        growth: growing("tissue", grown),
        ..pulling("biceps", share * 3.0)
    };
    solve(&case, &plan, settings)
}

#[test]
fn loads_growth_and_muscles_are_advanced_with_the_movement() {
    for (shape, element) in [
        (CellShape::Tet4, ElementChoice::Stabilised),
        (CellShape::Tet4, ElementChoice::Quadratic),
        (CellShape::Hex8, ElementChoice::MeanDilatation),
    ] {
        let method = Method::FemNonlinear;
        let settings =
            Settings { method, element, relative_residual: 1e-10, ..Settings::default() };
        let advance = in_steps(3);
        let stepped = acted_on(1.0, shape, &Settings { advance, ..settings.clone() });
        assert_eq!(stepped.load_steps.len(), 3);
        for step in &stepped.load_steps {
            let alone = acted_on(step.rest.share, shape, &settings);
            let energy = alone.solver.newton.as_ref().unwrap().energy;
            let told = format!("{element:?} {}: {} {energy}", step.rest.share, step.rest.energy);
            assert!((step.rest.energy / energy - 1.0).abs() < 1e-9, "{told}");
            for (name, force) in &alone.reactions {
                assert!(
                    (step.reactions[name] - force).norm() < 1e-6 * force.norm(),
                    "{told} {name}"
                );
            }
        }
        let at_once = acted_on(1.0, shape, &settings);
        assert!(farthest(&stepped.displacement, &at_once.displacement) < 1e-7);
    }
}
