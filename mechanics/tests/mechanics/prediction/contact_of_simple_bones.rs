//! Bones of few triangles and sharp edges that press on a slab: contact settles, and what it says of gaps and forces holds.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, SurfaceSearch, TriangleSurface, Vector, Warning};
use mechanics::model::fem::contact::PressingRow;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Bone, Case, CaseSegment, Method, Plan, Prediction, Settings};

use super::contact::{at, together, unilateral};
use crate::scenes::{case_of, material, set, solve};
use crate::surfaces::{map, movement, solid, sphere};

/// The slab.
const SIDE: f64 = 30.0;
const HEIGHT: f64 = 12.0;

/// How far bones begin above the slab.
const ABOVE: f64 = 0.5;

/// A slab held at its bottom, a bone whose lowest point is half a millimetre above it, and a block that carries the bone.
fn under(bone: TriangleSurface, place: [f64; 2], shape: CellShape) -> Case {
    let slab = block(Vector::new(SIDE, SIDE, HEIGHT), [15, 15, 6], shape);
    let anchor = at(block(Vector::repeat(4.0), [1, 1, 1], shape), [200.0, 0.0, 0.0]);
    let lowest = bone.points.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
    let shift = Vector::new(place[0], place[1], HEIGHT + ABOVE - lowest);
    let bone = map(&bone, |x| x + shift);
    Case {
        segments: vec![CaseSegment { name: "bone".to_owned(), nodes: set("anchor") }],
        bones: vec![Bone { name: "bone".to_owned(), surface: "bone".to_owned() }],
        surfaces: [("bone".to_owned(), Arc::new(bone))].into(),
        skin: Some(set("slab/z_max")),
        fixed: vec![set("slab/z_min")],
        allow_unfixed: true,
        ..case_of(together(&[("slab", slab), ("anchor", anchor)]), material(15.0, 0.45))
    }
}

fn lowered(by: f64) -> Plan {
    let down = Vector::new(0.0, 0.0, -by);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), down);
    Plan { segments: vec![PlannedSegment { name: "bone".to_owned(), movement }], ..Plan::default() }
}

fn turned(bone: &TriangleSurface, degrees: [f64; 3]) -> TriangleSurface {
    let turn = movement(degrees, [0.0; 3]);
    map(bone, |x| turn.rotation * x)
}

/// A lying cylinder of so many facets about the y axis, one of them, or an edge between two, lowest.
pub(super) fn cylinder(radius: f64, length: f64, facets: u32) -> TriangleSurface {
    let mut points =
        vec![Vector::new(0.0, -0.5 * length, 0.0), Vector::new(0.0, 0.5 * length, 0.0)];
    for step in 0..facets {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(facets);
        let at = |y: f64| Vector::new(radius * angle.cos(), y, -radius * angle.sin());
        points.extend([at(-0.5 * length), at(0.5 * length)]);
    }
    let side = |step: u32| {
        let next = (step + 1) % facets;
        let [near, far, on, beyond] = [2 + 2 * step, 3 + 2 * step, 2 + 2 * next, 3 + 2 * next];
        [[0, on, near], [1, far, beyond], [near, on, beyond], [near, beyond, far]]
    };
    TriangleSurface { points, triangles: (0..facets).flat_map(side).collect(), node_ids: None }
}

fn cube(side: f64) -> TriangleSurface {
    solid([-0.5 * side; 3], [0.5 * side; 3])
}

/// What presses: names, surfaces, and how deep they go.
fn bones() -> Vec<(&'static str, TriangleSurface, f64)> {
    let corner = turned(&turned(&cube(12.0), [0.0, 0.0, 45.0]), [0.0, 54.7356, 10.0]);
    let long = solid([-6.0, -40.0, -6.0], [6.0, 40.0, 6.0]);
    vec![
        ("corner", corner, 2.0),
        ("edge", turned(&cube(12.0), [45.0, 0.0, 0.0]), 2.0),
        ("edge across the slab", turned(&long, [0.0, 45.0, 0.0]), 2.0),
        ("edge askew", turned(&cube(12.0), [40.0, 0.0, 25.0]), 2.0),
        ("flat", cube(13.0), 1.5),
        ("flat askew", turned(&cube(13.0), [0.0, 0.0, 20.0]), 1.5),
        ("ball of 80", sphere(8.0, Vector::zeros(), 1), 2.0),
        ("ball of 1280", sphere(8.0, Vector::zeros(), 3), 2.0),
        ("cylinder of 24", cylinder(8.0, 80.0, 24), 1.5),
        ("cylinder of 96", cylinder(8.0, 80.0, 96), 1.5),
        ("end of a cylinder of 24", cylinder(8.0, 16.0, 24), 1.5),
    ]
}

fn both() -> [Settings; 2] {
    [unilateral(), Settings { method: Method::FemNonlinear, ..unilateral() }]
}

/// Signorini's conditions at rows, and against the bone where it has gone to.
fn assert_met(case: &Case, found: &Prediction, by: f64, told: &str) {
    let contact = &found.contact.as_ref().unwrap().contact;
    assert_eq!(contact.effort.kept, 0, "{told}");
    let largest = contact.pressed.iter().map(|pressed| pressed.force).fold(0.0, f64::max);
    assert!(largest > 0.0, "{told}");
    for PressingRow { row, force } in &contact.pressed {
        let gap = contact.gaps[&row.node];
        assert!(*force > -1e-8 * largest && gap.abs() < 1e-8, "{told}: {force} {gap}");
    }
    let least = contact.gaps.values().copied().fold(f64::INFINITY, f64::min);
    assert!(least > -1e-8, "{told}: {least}");
    let bone = SurfaceSearch::new(&case.surfaces["bone"]).unwrap();
    let distance = |node: u32| {
        let moved = case.volume.nodes[node as usize] + found.displacement[node as usize];
        let at = moved + Vector::new(0.0, 0.0, ABOVE + by);
        bone.signed_distance(&at, &bone.closest(&at))
    };
    // Rows are those of surfaces a micrometre off.
    let top = case.volume.node_sets["slab/z_max"].iter().copied();
    let deepest = top.map(distance).fold(f64::INFINITY, f64::min);
    assert!(deepest > -2e-3, "{told}: {deepest}");
    let pressed = contact.pressed.iter().map(|pressed| distance(pressed.row.node));
    let farthest = pressed.fold(0.0, f64::max);
    assert!(farthest < 2e-3, "{told}: {farthest}");
}

#[test]
fn bones_with_sharp_edges_and_few_triangles_settle() {
    for (name, bone, by) in bones() {
        for place in [[15.3, 14.6], [15.0, 15.0]] {
            for settings in both() {
                let case = under(bone.clone(), place, CellShape::Hex8);
                let found = solve(&case, &lowered(ABOVE + by), &settings);
                assert_met(&case, &found, by, &format!("{name} {place:?} {:?}", settings.method));
            }
        }
    }
}

/// A pyramid of .8 by .8 by 12 mm on its tip.
fn needle() -> TriangleSurface {
    let at = |x: f64, y: f64| Vector::new(0.4 * x, 0.4 * y, 12.0);
    TriangleSurface {
        points: vec![Vector::zeros(), at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
        triangles: vec![[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [1, 2, 3], [1, 3, 4]],
        node_ids: None,
    }
}

/// A wedge whose edge of 80 mm is longer than the slab, so that no corner of it is in tissue.
fn wedge() -> TriangleSurface {
    let across =
        |y: f64| [Vector::new(0.0, y, 0.0), Vector::new(0.4, y, 12.0), Vector::new(-0.4, y, 12.0)];
    TriangleSurface {
        points: [across(-40.0), across(40.0)].concat(),
        triangles: vec![
            [0, 1, 2],
            [3, 5, 4],
            [0, 3, 4],
            [0, 4, 1],
            [0, 2, 5],
            [0, 5, 3],
            [1, 4, 5],
            [1, 5, 2],
        ],
        node_ids: None,
    }
}

/// Nodes are 2 mm apart, and a needle and a wedge go in halfway between them.
#[test]
fn bone_that_goes_in_between_the_nodes_of_tissue_is_reported() {
    for (name, bone) in [("needle", needle()), ("wedge", wedge())] {
        for settings in both() {
            let case = under(bone.clone(), [15.0, 15.0], CellShape::Hex8);
            let told = |by: f64| -> Vec<Warning> {
                let found = solve(&case, &lowered(by), &settings);
                let overlaps = found.warnings.into_iter();
                overlaps.filter(|warning| warning.code == "contact-overlap").collect()
            };
            assert_eq!(told(0.0), [], "{name}");
            assert_eq!(told(ABOVE), [], "{name}");
            let [warning] = &told(ABOVE + 2.0)[..] else { panic!("{name}") };
            let numbers: BTreeMap<&str, f64> = warning.numbers.iter().copied().collect();
            assert!((numbers["depth_mm"] - 2.0).abs() < 0.02, "{name}: {warning:?}");
            assert!((numbers["z_mm"] - (HEIGHT - 2.0)).abs() < 1e-9, "{name}: {warning:?}");
            assert!((numbers["x_mm"] - 15.0).abs() < 1e-9, "{name}: {warning:?}");
            assert!(numbers["points"] >= 3.0, "{name}: {warning:?}");
            assert!(warning.detail.contains("\"bone\""), "{name}: {warning:?}");
        }
    }
}

#[test]
fn bone_that_goes_into_tissue_without_contact_is_reported() {
    let case = under(needle(), [15.0, 15.0], CellShape::Hex8);
    let told = |by: f64| -> Vec<Warning> {
        let found = solve(&case, &lowered(by), &Settings::default());
        found.warnings.into_iter().filter(|warning| warning.code == "bone-in-tissue").collect()
    };
    assert_eq!(told(ABOVE), []);
    assert_eq!(told(ABOVE + 0.4), []);
    let [warning] = &told(ABOVE + 2.0)[..] else { panic!("one bone") };
    let numbers: BTreeMap<&str, f64> = warning.numbers.iter().copied().collect();
    assert!((numbers["depth_mm"] - 2.0).abs() < 0.02, "{warning:?}");
    assert!((numbers["z_mm"] - (HEIGHT - 2.0)).abs() < 1e-9, "{warning:?}");
}

/// Bone that lies in tissue at rest, as scans have it, and hardly moves is not told.
#[test]
fn bone_that_lies_in_tissue_at_rest_is_reported_by_what_it_moves() {
    let sunk = map(&needle(), |x| x - Vector::new(0.0, 0.0, ABOVE + 1.0));
    for settings in both() {
        let mut case = under(needle(), [15.0, 15.0], CellShape::Hex8);
        let place = Vector::new(15.0, 15.0, HEIGHT + ABOVE);
        case.surfaces.insert("bone".to_owned(), Arc::new(map(&sunk, |x| x + place)));
        let is_told = |by: f64| {
            let found = solve(&case, &lowered(by), &settings);
            found.warnings.iter().any(|warning| warning.code == "contact-overlap")
        };
        assert!(!is_told(0.04) && is_told(0.2));
    }
}

/// Forces along what the normal was on the way would hold as friction does: a script from outside the project found 8 to 50 % of the force
/// along the slab missing.
#[test]
fn plate_that_turns_presses_along_its_normal() {
    let plate = solid([-40.0, -40.0, 0.0], [40.0, 40.0, 6.0]);
    let pivot = Vector::new(0.5 * SIDE, 0.5 * SIDE, HEIGHT + ABOVE);
    for degrees in [[2.4, 0.0, 0.0], [3.0, 3.0, 3.0]] {
        let angles = Vector::from(degrees.map(f64::to_radians));
        let down = Vector::new(0.0, 0.0, -1.5);
        let movement = RigidMovement::about_pivot(angles, pivot, down);
        let out = movement.rotation() * -Vector::z();
        for settings in both() {
            let case = under(plate.clone(), [pivot.x, pivot.y], CellShape::Hex8);
            let segments = vec![PlannedSegment { name: "bone".to_owned(), movement }];
            let found = solve(&case, &Plan { segments, ..Plan::default() }, &settings);
            let pressed = &found.contact.as_ref().unwrap().contact.pressed;
            assert!(pressed.len() > 100, "{}", pressed.len());
            let aslant = |pressed: &PressingRow| pressed.row.normal().cross(&out).norm();
            let most = pressed.iter().map(aslant).fold(0.0, f64::max);
            assert!(most < 4e-4, "{degrees:?} {:?}: {most}", settings.method);
        }
    }
}
