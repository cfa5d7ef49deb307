//! Contact at finite strain: closed forms, jaws that close, and what it goes over into.

use std::collections::BTreeMap;
use std::num::NonZeroU32;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Advance, Case, CaseSegment, Load, Method, Plan, Settings};

use super::contact::{
    PRESSING, at, bar, blocks, force, jaws, pushed, raised, together, unilateral,
};
use crate::scenes::{case_of, constraint, largest_error, material, set, solve};

fn at_finite_strain() -> Settings {
    Settings { method: Method::FemNonlinear, ..unilateral() }
}

/// A bar of neo-Hookean tissue without lateral strain at rest: what is pressed from 20 to 19 mm resists with mu A (1/l - l).
#[test]
fn a_bar_at_finite_strain_presses_with_the_force_of_its_law() {
    let stretch: f64 = 0.95;
    let resisted = 7.5 * 100.0 * (1.0 / stretch - stretch);
    for (shape, element) in PRESSING {
        let case = bar(shape);
        for (by, wanted) in [(0.3, 0.0), (1.5, resisted)] {
            let found = solve(&case, &pushed(by), &Settings { element, ..at_finite_strain() });
            let exerted = force(&found, "fixed");
            let told = format!("{shape:?} {element:?} {by} mm: {exerted:?}");
            assert!((exerted - Vector::new(-wanted, 0.0, 0.0)).norm() < 1e-5, "{told}");
            assert!((force(&found, "prescribed").x - wanted).abs() < 1e-5, "{told}");
            assert_eq!(found.contact.is_some(), wanted > 0.0, "{told}");
        }
    }
}

#[test]
fn a_bar_presses_with_the_force_of_its_law_at_each_load_step() {
    let advance = Advance::InSteps(NonZeroU32::new(4).unwrap());
    for (shape, element) in PRESSING {
        let case = bar(shape);
        let settings = Settings { element, advance, ..at_finite_strain() };
        let found = solve(&case, &pushed(1.8), &settings);
        // It reaches what it presses on after 0.5 mm.
        let stretches = [1.0, 0.98, 0.9575, 0.935_f64];
        assert_eq!(found.load_steps.len(), stretches.len());
        for (step, stretch) in found.load_steps.iter().zip(stretches) {
            let wanted = 7.5 * 100.0 * (1.0 / stretch - stretch);
            let force = |class: &str| step.reactions[class].x;
            let told = format!("{shape:?} {element:?} {wanted}: {step:?}");
            assert!((force("prescribed") - wanted).abs() < 1e-4, "{told}");
            assert!((force("fixed") + wanted).abs() < 1e-4, "{told}");
            match step.contact {
                Some(touch) => {
                    assert!(wanted > 0.0, "{told}");
                    assert!((touch.area - 100.0).abs() < 1e-9, "{told}");
                }
                None => assert_eq!(wanted, 0.0, "{told}"),
            }
        }
    }
}

#[test]
fn a_bar_at_finite_strain_presses_alike_wherever_it_lies() {
    let stretch: f64 = 0.95;
    let resisted = 7.5 * 100.0 * (1.0 / stretch - stretch);
    for (shape, element) in PRESSING {
        let mut case = bar(shape);
        let mesh = std::sync::Arc::make_mut(&mut case.volume);
        mesh.nodes.iter_mut().for_each(|node| *node += Vector::new(100.0, -200.0, 300.0));
        let found = solve(&case, &pushed(1.5), &Settings { element, ..at_finite_strain() });
        let exerted = force(&found, "fixed");
        let told = format!("{shape:?} {element:?}: {exerted:?}");
        assert!((exerted - Vector::new(-resisted, 0.0, 0.0)).norm() < 1e-5, "{told}");
    }
}

#[test]
fn contact_at_finite_strain_goes_over_into_that_of_linear_elasticity() {
    let case = bar(CellShape::Hex8);
    let beyond = |press: f64| {
        let plan = pushed(0.5 + press);
        let of = |settings: &Settings| force(&solve(&case, &plan, settings), "prescribed").x;
        (of(&at_finite_strain()) - of(&unilateral())).abs()
    };
    let (far, near) = (beyond(0.4), beyond(0.2));
    // mu A (1/l - l) is E A e (1 + e/2 + ...), with e the part by which the bar is shorter.
    assert!(near > 0.0 && (far / near - 4.0).abs() < 0.1, "{far} {near}");
}

/// Where nodes face nodes the rows of both sides depend on each other, and are met but for what their normals differ by: what counts
/// is that nothing moves any more.
#[test]
fn matching_blocks_at_finite_strain_press_like_one_of_them_on_a_smooth_plane() {
    let size = Vector::new(20.0, 20.0, 10.0);
    for by in [1.9, 2.0, 2.5] {
        let lower = block(size, [6, 6, 3], CellShape::Hex8);
        let upper = at(block(size, [6, 6, 3], CellShape::Hex8), [0.0, 0.0, 11.0]);
        let both = together(&[("lower", lower.clone()), ("upper", upper)]);
        let lowered = |node_set: &str, by: f64| Plan {
            prescribed: vec![constraint(node_set, [Some(0.0), Some(0.0), Some(-by)])],
            ..Plan::default()
        };
        let case = Case {
            fixed: vec![set("lower/z_min")],
            allow_unfixed: true,
            ..case_of(both, material(15.0, 0.45))
        };
        let found = solve(&case, &lowered("upper/z_max", by), &at_finite_strain());
        let told = format!("{by} mm: {} steps", found.solver.iterations);
        assert!(found.solver.iterations <= 20, "{told}");
        assert!(!found.warnings.iter().any(|own| own.code == "bulk-in-all-cells"), "{told}");

        let plane = constraint("z_max", [None, None, Some(-0.5 * (by - 1.0))]);
        let plan = Plan { prescribed: vec![plane], ..Plan::default() };
        let half = Case { fixed: vec![set("z_min")], ..case_of(lower, material(15.0, 0.45)) };
        let wanted = solve(&half, &plan, &at_finite_strain());
        let share = force(&found, "fixed").z / force(&wanted, "fixed").z;
        assert!((share - 1.0).abs() < 1e-4, "{told}: {share}");
    }
}

#[test]
fn jaws_at_finite_strain_close_their_slit_and_do_not_pass() {
    let case = jaws(2.5);
    let found = solve(&case, &raised(6.0), &at_finite_strain());
    let touch = found.contact.as_ref().unwrap();
    assert!(touch.overlap.is_none() && touch.largest_penetration() < 1e-6, "{touch:?}");
    assert!(touch.area() > 180.0 && touch.area() < 240.0, "{}", touch.area());
    let forces = touch.contact.pressed.iter().map(|pressed| pressed.force);
    assert!(forces.fold(f64::INFINITY, f64::min) > 0.0);
    let free = solve(
        &case,
        &raised(6.0),
        &Settings { method: Method::FemNonlinear, ..Settings::default() },
    );
    let passed = free.warnings.iter().find(|warning| warning.code == "skin-overlaps");
    assert!(passed.is_some_and(|warning| warning.detail.contains("1.3 mm deep")));
    let open = solve(&case, &raised(1.0), &at_finite_strain());
    assert!(open.contact.is_none());
}

/// What holds exert is what tissue exerts on them, contact between its parts or not.
#[test]
fn holds_of_tissue_in_contact_at_finite_strain_are_in_balance() {
    let (case, plan) = blocks();
    let found = solve(&case, &plan, &at_finite_strain());
    let sum: Vector = found.condition_reactions.iter().map(|condition| condition.force).sum();
    assert!(sum.norm() < 1e-6, "{sum}");
    let touch = found.contact.as_ref().unwrap();
    // A stretch of .9 all over: mu (1/l - l).
    let pressed: f64 = touch.pairs.iter().map(|pair| pair.force).sum::<f64>();
    let wanted = 144.0 * 7.5 * (1.0 / 0.9 - 0.9);
    assert!((pressed / wanted - 1.0).abs() < 0.02, "{pressed} {wanted}");
}

/// Where meshes match, the row of a node repeats that of the node it faces, and one of both has all of the force: the faces of
/// both press nevertheless, and nothing acts on their edges that would move them.
#[test]
fn nothing_is_missing_of_blocks_that_press_evenly_at_finite_strain() {
    let (_, plan) = blocks();
    for (shape, element) in PRESSING {
        for cells in [3, 2] {
            // Hexahedra that do not match press unevenly.
            if shape == CellShape::Hex8 && cells == 2 {
                continue;
            }
            let lower = block(Vector::new(12.0, 12.0, 6.0), [3, 3, 2], shape);
            let upper = block(Vector::new(12.0, 12.0, 6.0), [cells, cells, 2], shape);
            let mesh = together(&[("lower", lower), ("upper", at(upper, [0.0, 0.0, 6.0]))]);
            let case = Case { allow_unfixed: true, ..case_of(mesh, material(15.0, 0.0)) };
            let found = solve(&case, &plan, &Settings { element, ..at_finite_strain() });
            let told = format!("{shape:?} {element:?}, 3 cells to {cells}");
            let even = |x: &Vector| Vector::z() * (-0.1 * x.z);
            let off = largest_error(&case.volume, &found.displacement, even);
            assert!(off < 1e-7, "{told}: {off:e}");
            let missing = found.numerical_error.unwrap().missing;
            let largest = missing.iter().map(Vector::norm).fold(0.0, f64::max);
            assert!(largest < 1e-6, "{told}: {largest:e}");
        }
    }
}

/// Bone of 2 mm between nodes of tissue that are 5 mm apart is faced by none of them.
#[test]
fn a_blade_that_passes_between_the_nodes_of_tissue_is_reported() {
    let tissue =
        at(block(Vector::new(60.0, 20.0, 10.0), [12, 4, 2], CellShape::Hex8), [0.0, 0.0, -10.0]);
    let blade =
        at(block(Vector::new(2.0, 24.0, 12.0), [1, 8, 4], CellShape::Hex8), [31.5, -2.0, 2.0]);
    let case = Case {
        skin: Some(set("tissue/z_max")),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("blade") }],
        fixed: vec![set("tissue/z_min")],
        allow_unfixed: true,
        ..case_of(together(&[("tissue", tissue), ("blade", blade)]), material(15.0, 0.45))
    };
    for settings in [unilateral(), at_finite_strain()] {
        let found = solve(&case, &raised(-6.0), &settings);
        let told = found.warnings.iter().find(|warning| warning.code == "contact-overlap").unwrap();
        let numbers: BTreeMap<&str, f64> = told.numbers.iter().copied().collect();
        assert!((numbers["depth_mm"] - 4.0).abs() < 0.01, "{told:?}");
        let penetration = found.contact.as_ref().unwrap().largest_penetration();
        assert!((penetration - 4.0).abs() < 0.01, "{penetration}");
        let outside = solve(&case, &raised(-1.0), &settings);
        assert!(outside.contact.is_none());
    }
}

/// A block that turns by ten degrees onto another one: points alternated between two states, and it ended as `contact-unsettled`.
#[test]
fn a_block_that_turns_onto_tissue_settles_between_two_states() {
    let lower = block(Vector::new(20.0, 12.0, 8.0), [10, 6, 4], CellShape::Hex8);
    let upper = block(Vector::new(14.0, 8.0, 6.0), [7, 4, 3], CellShape::Hex8);
    let mesh = together(&[("lower", lower), ("upper", at(upper, [3.0, 2.0, 8.2]))]);
    let case = Case {
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("upper/z_max") }],
        fixed: vec![set("lower/z_min")],
        skin: Some(set("lower/z_max")),
        ..case_of(mesh, material(15.0, 0.45))
    };
    let turn = Vector::new(0.0, 10f64.to_radians(), 0.0);
    let pivot = Vector::new(10.0, 6.0, 8.0);
    let movement = RigidMovement::about_pivot(turn, pivot, Vector::new(0.0, 0.0, -1.5));
    let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let found = solve(&case, &plan, &at_finite_strain());
    let touch = found.contact.as_ref().unwrap();
    assert!(touch.contact.last_moved_mm < 0.05, "{}", touch.contact.last_moved_mm);
    assert!(touch.largest_penetration() < 0.05, "{}", touch.largest_penetration());
    assert!((force(&found, "fixed") + force(&found, "jaw")).norm() < 1e-3);
}

/// Two bars pressed on each other over a gap, their meshes not matching: rows that depend on each other keep what their normals differ by.
#[test]
fn bars_whose_meshes_do_not_match_settle_with_what_their_rows_cannot_meet() {
    let size = Vector::new(30.0, 12.0, 10.0);
    let lower = block(size, [6, 1, 1], CellShape::Hex8);
    let upper = at(block(size, [9, 1, 1], CellShape::Hex8), [0.0, 0.0, 10.8]);
    let mesh = together(&[("lower", lower), ("upper", upper)]);
    let ends = ["lower/x_min", "lower/x_max", "upper/x_min", "upper/x_max"];
    let case = Case {
        fixed: ends.map(set).to_vec(),
        skin: Some(set("lower/z_max")),
        ..case_of(mesh, material(15.0, 0.4))
    };
    let pressed = |faces, traction| Load::Traction { faces: set(faces), traction };
    let loads = vec![
        pressed("lower/z_min", Vector::new(0.0, 0.0, 0.3)),
        pressed("upper/z_max", Vector::new(0.0, 0.0, -0.3)),
    ];
    let plan = Plan { loads, ..Plan::default() };
    let settings = Settings { relative_residual: 1e-8, ..at_finite_strain() };
    let found = solve(&case, &plan, &settings);
    let touch = found.contact.as_ref().unwrap();
    println!("{} steps, {:e} mm", found.solver.iterations, touch.largest_penetration());
    assert!(found.solver.iterations < 40, "{}", found.solver.iterations);
    assert!(touch.largest_penetration() < 1e-3, "{:e}", touch.largest_penetration());
    // Both bars are pressed with 108 mN.
    assert!(force(&found, "fixed").norm() < 1e-3, "{:?}", force(&found, "fixed"));
}
