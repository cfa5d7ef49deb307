//! Surfaces of bone that tissue may not pass: closed forms, bones that move, and what is told.

use std::sync::Arc;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Bone, Case, CaseSegment, Method, Plan, Prediction, Prescribed, Settings,
};

use super::contact::{PRESSING, at, together, unilateral};
use crate::scenes::{case_of, constraint, material, set, solve};
use crate::surfaces::solid;

const LENGTHS: [f64; 3] = [20.0, 16.0, 12.0];
const GAP: f64 = 0.5;
const PRESSED: f64 = 0.7;

fn both() -> [Settings; 2] {
    [unilateral(), Settings { method: Method::FemNonlinear, ..unilateral() }]
}

/// A slab between planes of symmetry that slides at its bottom, a plate of bone half a millimetre above it, and a block of tissue
/// far away that the segment of the plate holds.
pub(crate) fn slab(shape: CellShape, nu: f64) -> Case {
    let slab = block(Vector::from(LENGTHS), [5, 4, 3], shape);
    let anchor = at(block(Vector::repeat(4.0), [1, 1, 1], shape), [200.0, 0.0, 0.0]);
    let mut mesh = together(&[("slab", slab), ("anchor", anchor)]);
    let top = mesh.node_sets["slab/z_max"].clone();
    mesh.node_sets.insert("top".to_owned(), top);
    let plate = solid([-10.0, -10.0, LENGTHS[2] + GAP], [40.0, 40.0, 20.0]);
    Case {
        segments: vec![CaseSegment { name: "plate".to_owned(), nodes: set("anchor") }],
        bones: vec![Bone { name: "plate".to_owned(), surface: "plate".to_owned() }],
        surfaces: [("plate".to_owned(), Arc::new(plate))].into(),
        skin: Some(set("top")),
        allow_unfixed: true,
        ..case_of(mesh, material(15.0, nu))
    }
}

/// The slab raised, and the plate lowered, by so much each.
pub(crate) fn closed(raised: f64, lowered: f64) -> Plan {
    let down = Vector::new(0.0, 0.0, -lowered);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), down);
    Plan {
        segments: vec![PlannedSegment { name: "plate".to_owned(), movement }],
        prescribed: vec![
            constraint("slab/z_min", [None, None, Some(raised)]),
            constraint("slab/x_min", [Some(0.0), None, None]),
            constraint("slab/y_min", [None, Some(0.0), None]),
        ],
        ..Plan::default()
    }
}

/// The stress in kPa and the stretch across, of neo-Hookean tissue mu (F - F^-T) + lambda ln J F^-T that is free across.
fn uniaxial(young: f64, nu: f64, along: f64) -> (f64, f64) {
    let (mu, lambda) = (young / (2.0 * (1.0 + nu)), young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    let stress = |own: f64, j: f64| mu * (own - 1.0 / own) + lambda * j.ln() / own;
    let (mut low, mut high) = (0.5, 2.0);
    for _ in 0..200 {
        let across = 0.5 * (low + high);
        match stress(across, along * across * across) < 0.0 {
            true => low = across,
            false => high = across,
        }
    }
    (stress(along, along * low * low), low)
}

#[test]
fn a_slab_pressed_by_a_plate_of_bone_is_strained_evenly_whichever_of_both_moves() {
    for (shape, element) in PRESSING {
        for settings in both() {
            let settings = Settings { element, ..settings };
            let nu = if shape == CellShape::Hex8 { 0.46 } else { 0.3 };
            let is_linear = settings.method == Method::FemLinear;
            let strain = -PRESSED / LENGTHS[2];
            let (stress, across) = match is_linear {
                true => (15.0 * strain, 1.0 - nu * strain),
                false => uniaxial(15.0, nu, 1.0 + strain),
            };
            for (raised, lowered) in [(GAP + PRESSED, 0.0), (0.0, GAP + PRESSED), (0.5, 0.7)] {
                let case = slab(shape, nu);
                let found = solve(&case, &closed(raised, lowered), &settings);
                let told =
                    format!("{shape:?} {element:?} {:?} {raised} {lowered}", settings.method);
                let wanted = |x: &Vector| {
                    Vector::new((across - 1.0) * x.x, (across - 1.0) * x.y, raised + strain * x.z)
                };
                let slab = case.volume.node_sets["slab"].iter().map(|&node| node as usize);
                let off = slab.map(|n| found.displacement[n] - wanted(&case.volume.nodes[n]));
                let off = off.map(|off| off.norm()).fold(0.0, f64::max);
                assert!(off < 1e-6, "{told}: {off}");
                let rest = LENGTHS[0] * LENGTHS[1];
                // At finite strain the area is that of the deformed slab.
                let area = if is_linear { rest } else { rest * across * across };
                assert_same_report(&case, &found, [-stress * rest, area], &told);
            }
        }
    }
}

/// What is told of a plate that presses with a force in mN on an area in mm².
fn assert_same_report(case: &Case, found: &Prediction, [force, area]: [f64; 2], told: &str) {
    let touch = found.contact.as_ref().unwrap();
    let [pair] = &touch.pairs[..] else { panic!("{told}: {:?}", touch.pairs) };
    assert_eq!(pair.between, ["plate", "skin"], "{told}");
    assert!((pair.area - area).abs() < 1e-6 * area, "{told}: {}", pair.area);
    assert!((pair.force / force - 1.0).abs() < 1e-6, "{told}: {} {force}", pair.force);
    // Points of equal triangles around a node share the pressure of a quadrangle unevenly.
    if case.volume.cells.iter().all(|(shape, _)| shape == CellShape::Hex8) {
        assert!((touch.largest_pressure() * area / force - 1.0).abs() < 1e-6, "{told}");
    }
    let exerted = found.reactions["plate"] + Vector::new(0.0, 0.0, force);
    assert!(exerted.norm() < 1e-6 * force, "{told}: {exerted}");
    // Signorini's conditions, with gaps and forces measured anew.
    let forces = &touch.contact.forces;
    for &node in &case.volume.node_sets["top"] {
        let place = case.volume.nodes[node as usize] + found.displacement[node as usize];
        let lowered =
            found.displacement[*case.volume.node_sets["anchor"].first().unwrap() as usize].z;
        let gap = LENGTHS[2] + GAP + lowered - place.z;
        assert!(
            gap > -1e-8 && (gap * forces[node as usize].z).abs() < 1e-8 * force,
            "{told}: {gap}"
        );
        assert!(forces[node as usize].z < 1e-8 * force, "{told}");
    }
}

#[test]
fn a_jaw_that_closes_on_tissue_and_opens_again_leaves_no_trace() {
    for settings in both() {
        let case = slab(CellShape::Hex8, 0.46);
        let step = |by: f64| {
            let moved = Vector::new(0.0, 0.0, by);
            RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), moved)
        };
        let of = |movement: RigidMovement| {
            let mut plan = closed(0.0, 0.0);
            plan.segments[0].movement = movement;
            solve(&case, &plan, &settings)
        };
        assert!(of(step(-1.2)).contact.is_some());
        let opened = of(step(-1.2).then(&step(1.2)));
        let left = opened.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(left < 1e-8 && opened.contact.is_none(), "{left}");
        // Opened to where it just touches.
        let touching = of(step(-1.2).then(&step(1.2 - GAP)));
        let slab = case.volume.node_sets["slab"].iter();
        let left = slab.map(|&n| touching.displacement[n as usize].norm()).fold(0.0, f64::max);
        assert!(left < 1e-8, "{left}");
    }
}

/// The plate goes where the segment takes the slab, so that the gap stays.
#[test]
fn bone_and_tissue_that_turn_as_one_do_not_touch() {
    let mut case = slab(CellShape::Hex8, 0.46);
    case.segments[0].nodes = set("slab/z_min");
    case.fixed = vec![set("anchor")];
    let turn = Vector::new(0.4, -0.3, 0.5);
    let movement = RigidMovement::about_pivot(turn, Vector::new(30.0, 0.0, -40.0), Vector::zeros());
    let segments = vec![PlannedSegment { name: "plate".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let settings = Settings { method: Method::FemNonlinear, ..unilateral() };
    let found = solve(&case, &plan, &settings);
    assert!(found.contact.is_none(), "{:?}", found.contact);
    for &node in &case.volume.node_sets["slab"] {
        let wanted = movement.displacement(&case.volume.nodes[node as usize]);
        assert!((found.displacement[node as usize] - wanted).norm() < 1e-6);
    }
}

/// A turned slab under a turned plate is pressed as an upright one.
#[test]
fn a_plate_of_bone_presses_along_its_normal_wherever_it_lies() {
    let turned = RigidMovement::about_pivot(
        Vector::new(0.7, -0.4, 1.1),
        Vector::zeros(),
        Vector::new(120.0, -80.0, 300.0),
    );
    for settings in both() {
        let upright = slab(CellShape::Hex8, 0.46);
        let mut case = upright.clone();
        let mesh = Arc::make_mut(&mut case.volume);
        mesh.nodes.iter_mut().for_each(|node| *node = turned.apply(node));
        let plate = Arc::make_mut(case.surfaces.get_mut("plate").unwrap());
        plate.points.iter_mut().for_each(|point| *point = turned.apply(point));
        case.fixed = vec![set("slab/z_min")];
        let of = |case: &Case, movement: RigidMovement| {
            let segments = vec![PlannedSegment { name: "plate".to_owned(), movement }];
            solve(case, &Plan { segments, ..Plan::default() }, &settings)
        };
        let down = RigidMovement::about_pivot(
            Vector::zeros(),
            Vector::zeros(),
            Vector::new(0.0, 0.0, -1.2),
        );
        let straight = of(&Case { fixed: case.fixed.clone(), ..upright }, down);
        let oblique = of(&case, turned.inverse().then(&down).then(&turned));
        assert!(straight.contact.is_some());
        for (one, other) in straight.displacement.iter().zip(&oblique.displacement) {
            assert!((turned.rotation() * one - other).norm() < 1e-6);
        }
    }
}

/// Tissue that lies on bone as a scan has it, a little in it, does not press before something moves, and bone that leaves it
/// pulls at nothing.
#[test]
fn tissue_that_lies_in_bone_at_rest_starts_with_no_gap() {
    for settings in both() {
        let mut case = slab(CellShape::Hex8, 0.3);
        let plate = Arc::make_mut(case.surfaces.get_mut("plate").unwrap());
        plate.points.iter_mut().for_each(|point| point.z -= GAP + 0.3);
        let rest = solve(&case, &closed(0.0, 0.0), &settings);
        assert!(rest.contact.is_none() && rest.displacement.iter().all(|u| u.norm() < 1e-12));
        assert!(solve(&case, &closed(0.0, -2.0), &settings).contact.is_none());
        let pressed = solve(&case, &closed(0.0, 0.6), &settings);
        let force = pressed.contact.as_ref().unwrap().pairs[0].force;
        let stress = match settings.method {
            Method::FemLinear => 15.0 * 0.6 / LENGTHS[2],
            _ => -uniaxial(15.0, 0.3, 1.0 - 0.6 / LENGTHS[2]).0,
        };
        assert!((force / (stress * LENGTHS[0] * LENGTHS[1]) - 1.0).abs() < 1e-6, "{force}");
    }
}

/// Bone under thin tissue, whose back lies nearer to the skin than tissue could be pressed, is no obstacle to it.
#[test]
fn the_back_of_thin_bone_under_tissue_is_not_faced() {
    for settings in both() {
        let mut case = slab(CellShape::Hex8, 0.3);
        let below = solid([-10.0, -10.0, LENGTHS[2] - 1.5], [40.0, 40.0, LENGTHS[2] - 0.5]);
        case.surfaces.insert("plate".to_owned(), Arc::new(below));
        let push =
            Prescribed::Uniform { nodes: set("top"), displacement: [None, None, Some(-0.4)] };
        let mut plan = closed(0.0, 0.0);
        plan.prescribed.push(push);
        assert!(solve(&case, &plan, &settings).contact.is_none());
    }
}

#[test]
fn what_bone_presses_with_is_listed_so_that_all_reactions_are_in_balance() {
    for settings in both() {
        for (raised, lowered) in [(GAP + PRESSED, 0.0), (0.0, GAP + PRESSED)] {
            let found = solve(&slab(CellShape::Hex8, 0.3), &closed(raised, lowered), &settings);
            let listed = &found.condition_reactions;
            let sum: Vector = listed.iter().map(|own| own.force).sum();
            let plate = listed.last().unwrap();
            assert_eq!(
                (plate.pointer.as_str(), plate.segment.as_deref()),
                ("/case/bones/0", Some("plate"))
            );
            assert!(plate.force.z < -100.0 && plate.nodes > 0, "{plate:?}");
            assert!(sum.norm() < 1e-6 * plate.force.norm(), "{listed:?}");
        }
    }
}
