//! Plans that carry tissue along as one: what holds each connected part of a mesh decides, not what holds some part of
//! it.

use std::collections::BTreeMap;

use mechanics::boundary::NodeSelection;
use mechanics::mesh::{CellShape, Cells, Vector, VolumeMesh, Warning, sample::block};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, Load, Plan, Prescribed, Scene, Settings, Sliding, SlidingNormal,
    rigidly_carried,
};
use mechanics::progress::Unobserved;
use mechanics::response::{Columns, ResponseError, build};

use crate::scenes::{case_of, exact, largest_error, material, set, solve};
use crate::support::responses::{at_rest, plan_of};

/// A block whose bones are these node sets.
fn on_bones(names: &[&str]) -> Case {
    let mesh = block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], CellShape::Hex8);
    let bone = |name: &&str| CaseSegment { name: (*name).to_owned(), nodes: set(name) };
    Case { segments: names.iter().map(bone).collect(), ..case_of(mesh, material(15.0, 0.45)) }
}

fn shifted(by: [f64; 3]) -> RigidMovement {
    RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::from(by))
}

const FIVE: [f64; 3] = [-5.0, 0.0, 0.0];

/// The code and the place of a refusal, or the warning, or nothing.
fn judged(case: &Case, plan: &Plan) -> Result<Option<Warning>, (String, &'static str, String)> {
    match Scene::new(case, plan, &Settings::default()) {
        Ok(scene) => Ok(scene.warnings.into_iter().find(|of| of.code == "nothing-held")),
        Err(errors) => {
            let error = &errors.0[0];
            Err((error.pointer.clone(), error.code.name(), error.detail.clone()))
        }
    }
}

#[test]
fn a_plan_that_carries_all_tissue_away_as_one_is_refused_unless_it_is_allowed() {
    for bones in [&["x_min"][..], &["x_min", "x_max"]] {
        let mut case = on_bones(bones);
        let plan = plan_of(&case, &vec![shifted(FIVE); bones.len()]);
        let (pointer, code, detail) = judged(&case, &plan).unwrap_err();
        assert_eq!((pointer.as_str(), code), ("/case/fixed", "nothing-held"));
        assert!(detail.contains("by up to 5.000 mm"), "{detail}");
        case.allow_unfixed = true;
        assert_eq!(judged(&case, &plan), Ok(None));
        let moved = solve(&case, &plan, &exact()).displacement;
        assert!(largest_error(&case.volume, &moved, |_| Vector::from(FIVE)) < 1e-10);
    }
}

/// A flat wall at a set of nodes, at rest or carried.
fn wall(name: &str, segment: Option<&str>) -> Sliding {
    Sliding {
        nodes: set(name),
        normal: SlidingNormal::Surface,
        segment: segment.map(str::to_owned),
    }
}

fn prescribed(name: &str, displacement: [Option<f64>; 3]) -> Prescribed {
    Prescribed::Uniform { nodes: set(name), displacement }
}

/// Refused, with a sentence that holds these words.
fn assert_refused(case: &Case, plan: &Plan, words: &str) {
    let (pointer, code, detail) = judged(case, plan).unwrap_err();
    assert_eq!((pointer.as_str(), code), ("/case/fixed", "nothing-held"), "{detail}");
    assert!(detail.contains(words), "{detail}");
}

#[test]
fn bones_of_which_one_stays_or_goes_another_way_deform_the_tissue() {
    let case = on_bones(&["x_min", "x_max"]);
    let apart = [shifted(FIVE), shifted([5.0, 0.0, 0.0])];
    let told = judged(&case, &plan_of(&case, &apart)).unwrap().unwrap();
    assert_eq!(told.numbers, [("segments", 2.0), ("free_movements", 6.0)]);
    let one = [shifted(FIVE), RigidMovement::default()];
    assert_eq!(judged(&case, &plan_of(&case, &one)), Ok(None));
}

#[test]
fn movements_alike_to_a_thousandth_are_one_and_those_that_differ_by_a_hundredth_are_not() {
    let case = on_bones(&["x_min", "x_max"]);
    let plan = |other: f64| plan_of(&case, &[shifted(FIVE), shifted([other, 0.0, 0.0])]);
    assert_refused(&case, &plan(-5.005), "by up to 5.002 mm");
    let told = judged(&case, &plan(-5.05)).unwrap().unwrap();
    assert!(told.detail.contains("slide and turn in every way"), "{}", told.detail);
}

#[test]
fn fixed_nodes_and_walls_across_which_a_bone_moves_hold_and_walls_of_the_bone_do_not() {
    let plan = plan_of(&on_bones(&["x_min"]), &[shifted(FIVE)]);
    let with = |change: &dyn Fn(&mut Case)| {
        let mut case = on_bones(&["x_min"]);
        change(&mut case);
        judged(&case, &plan)
    };
    assert_eq!(with(&|case| case.fixed = vec![set("x_max")]), Ok(None));
    let told = with(&|case| case.sliding = vec![wall("x_max", None)]).unwrap().unwrap();
    assert_eq!(told.numbers, [("segments", 1.0), ("free_movements", 3.0)]);
    let code = with(&|case| case.sliding = vec![wall("x_max", Some("x_min"))]).unwrap_err().1;
    assert_eq!(code, "nothing-held");
    let held =
        Plan { prescribed: vec![prescribed("x_max", [Some(0.0), None, None])], ..plan.clone() };
    assert!(judged(&on_bones(&["x_min"]), &held).is_ok());
    // A bone at rest is what gravity pulls at.
    let gravity = Load::Gravity { acceleration: Vector::new(0.0, 0.0, -9.81e-3) };
    let loaded = Plan { loads: vec![gravity], ..Plan::default() };
    assert_eq!(judged(&on_bones(&["x_min"]), &loaded), Ok(None));
}

#[test]
fn a_bone_that_moves_along_the_only_wall_takes_the_tissue_with_it() {
    let mut case = on_bones(&["x_min"]);
    case.sliding = vec![wall("z_min", None)];
    // Along the wall and turned within it: 3 mm and 3 degrees about z.
    let turn = RigidMovement::about_pivot(
        Vector::new(0.0, 0.0, 3_f64.to_radians()),
        Vector::new(20.0, 10.0, 0.0),
        Vector::new(3.0, 0.0, 0.0),
    );
    for movement in [shifted(FIVE), turn] {
        let plan = plan_of(&case, &[movement]);
        assert_refused(&case, &plan, "moves alike or leaves it free to follow");
        let mut allowed = case.clone();
        allowed.allow_unfixed = true;
        let moved = solve(&allowed, &plan, &exact()).displacement;
        // Small strain follows a finite turn to second order only.
        let along = |x: &Vector| movement.displacement(x);
        let exactly = if movement == turn { 0.1 } else { 1e-10 };
        assert!(largest_error(&case.volume, &moved, |x| along(x)) < exactly);
    }
    // Across the wall, and tilted against it, the tissue is deformed.
    let tilt =
        RigidMovement::about_pivot(Vector::new(0.0, 0.1, 0.0), Vector::zeros(), Vector::zeros());
    for movement in [shifted([0.0, 0.0, 2.0]), tilt] {
        let told = judged(&case, &plan_of(&case, &[movement])).unwrap().unwrap();
        let words = "slide along (1, 0, 0) and (0, 1, 0), turn about the axis";
        assert!(told.detail.contains(words), "{}", told.detail);
    }
    let told = judged(&case, &Plan::default()).unwrap().unwrap();
    assert!(told.detail.contains("that a plan may move"), "{}", told.detail);
}

#[test]
fn prescribed_nodes_that_go_along_are_no_hold() {
    let case = on_bones(&["x_min"]);
    let plan = |value: f64| Plan {
        prescribed: vec![prescribed("x_max", [Some(value), Some(0.0), Some(0.0)])],
        ..plan_of(&case, &[shifted(FIVE)])
    };
    assert_refused(&case, &plan(-5.0), "by up to 5.000 mm");
    assert_eq!(judged(&case, &plan(-4.0)), Ok(None));
    // Nothing but prescribed nodes, by a rigid turn of 30 degrees from an array.
    let mut alone = on_bones(&[]);
    let turn = RigidMovement::about_pivot(
        Vector::new(0.2, 30_f64.to_radians(), 0.0),
        Vector::new(7.0, 0.0, 3.0),
        Vector::new(0.0, 1.0, 0.0),
    );
    let mut mesh = (*alone.volume).clone();
    let turned = mesh.nodes.iter().map(|x| turn.displacement(x)).collect();
    let sheared = mesh.nodes.iter().map(|x| Vector::new(0.1 * x.y, 0.0, 0.0)).collect();
    mesh.node_vectors =
        BTreeMap::from([("turned".to_owned(), turned), ("sheared".to_owned(), sheared)]);
    alone.volume = mesh.into();
    let from = |array: &str| {
        let nodes =
            NodeSelection::Any(vec![set("x_min"), set("x_max"), set("y_min"), set("y_max")]);
        let array = array.to_owned();
        Plan { prescribed: vec![Prescribed::FromArray { nodes, array }], ..Plan::default() }
    };
    assert_refused(&alone, &from("turned"), "the tissue would move rigidly");
    assert_eq!(judged(&alone, &from("sheared")), Ok(None));
}

/// Two meshes side by side; the sets of the second begin with "other_".
fn beside(one: &VolumeMesh, other: &VolumeMesh, by: Vector) -> VolumeMesh {
    let first = one.nodes.len() as u32;
    let mut cells = Cells::default();
    for (shape, nodes) in one.cells.iter() {
        cells.push(shape, nodes);
    }
    for (shape, nodes) in other.cells.iter() {
        cells.push(shape, &nodes.iter().map(|node| node + first).collect::<Vec<_>>());
    }
    let shifted = other.node_sets.iter().map(|(name, nodes)| {
        (format!("other_{name}"), nodes.iter().map(|node| node + first).collect())
    });
    VolumeMesh {
        nodes: one.nodes.iter().copied().chain(other.nodes.iter().map(|x| x + by)).collect(),
        cells,
        node_sets: one.node_sets.clone().into_iter().chain(shifted).collect(),
        ..VolumeMesh::default()
    }
}

#[test]
fn what_is_fixed_in_another_part_of_the_mesh_holds_that_part_only() {
    let one = block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], CellShape::Hex8);
    let mesh = beside(&one, &one, Vector::new(0.0, 60.0, 0.0));
    let bone = CaseSegment { name: "x_min".to_owned(), nodes: set("x_min") };
    let mut case = case_of(mesh.clone(), material(15.0, 0.45));
    case.segments = vec![bone.clone()];
    case.fixed = vec![set("other_x_max")];
    let plan = plan_of(&case, &[shifted(FIVE)]);
    assert_refused(
        &case,
        &plan,
        "the part of 45 nodes that contains node 0, with 50 % of the skin,",
    );
    case.fixed.push(set("x_max"));
    assert_eq!(judged(&case, &plan), Ok(None));

    // An island on the bone, without skin, is told and goes with it.
    let island =
        CaseSegment { nodes: NodeSelection::Any(vec![set("x_min"), set("other_x_min")]), ..bone };
    case.segments = vec![island];
    case.fixed = vec![set("x_max")];
    case.skin = Some(set("z_max"));
    let told = judged(&case, &plan).unwrap().unwrap();
    assert_eq!(told.numbers[1..], [("nodes", 45.0), ("skin_share", 0.0)]);
    assert!((told.numbers[0].1 - 5.0).abs() < 1e-9, "{told:?}");
}

#[test]
fn a_part_that_may_move_says_how() {
    let with = |change: &dyn Fn(&mut Case)| {
        let mut case = on_bones(&[]);
        change(&mut case);
        judged(&case, &Plan::default()).unwrap_err()
    };
    let (_, code, detail) = with(&|case| case.sliding = vec![wall("z_min", None)]);
    assert_eq!(code, "underconstrained");
    let words = "may slide along (1, 0, 0) and (0, 1, 0), turn about the axis through";
    assert!(detail.contains(words), "{detail}");
    let (_, code, detail) = with(&|_| ());
    assert_eq!(code, "underconstrained");
    assert!(detail.contains("may slide and turn in every way"), "{detail}");
}

#[test]
fn a_plan_of_no_movement_is_none_that_carries_tissue_along() {
    let case = on_bones(&["x_min"]);
    let plan = plan_of(&case, &[RigidMovement::default()]);
    assert!(judged(&case, &plan).is_ok());
}

#[test]
fn a_case_without_a_plan_says_what_its_plans_may_come_to() {
    for bones in [&["x_min"][..], &["x_min", "x_max"]] {
        let told = judged(&on_bones(bones), &Plan::default()).unwrap().unwrap();
        assert!(told.detail.contains("would carry it along as one"), "{}", told.detail);
    }
}

#[test]
fn a_response_of_one_bone_and_nothing_that_stays_is_refused() {
    let refused = build(&at_rest(&on_bones(&["x_min"]), &exact()), &[], &Unobserved).unwrap_err();
    assert_eq!(refused, ResponseError::NothingHeld { name: "x_min".to_owned() });
    let two = build(&at_rest(&on_bones(&["x_min", "x_max"]), &exact()), &[], &Unobserved).unwrap();
    assert!(!two.linearity.something_stays && !two.allow_unfixed);
    let mut allowed = on_bones(&["x_min"]);
    allowed.allow_unfixed = true;
    assert!(build(&at_rest(&allowed, &exact()), &[], &Unobserved).unwrap().allow_unfixed);
}

#[test]
fn a_response_knows_which_plans_carry_the_tissue_along() {
    let mut case = on_bones(&["x_min", "x_max"]);
    case.sliding = vec![wall("z_min", None)];
    let both = build(&at_rest(&case, &exact()), &[], &Unobserved).unwrap();
    let is_refused = |columns: &Columns, movements: &[RigidMovement]| {
        let found = rigidly_carried(&columns.parts, |segment| movements[segment as usize]);
        !found.refused.is_empty()
    };
    assert!(is_refused(&both, &[shifted(FIVE), shifted(FIVE)]));
    assert!(!is_refused(&both, &[shifted(FIVE), RigidMovement::default()]));
    assert!(!is_refused(&both, &[shifted([0.0, 0.0, 2.0]); 2]));
    assert!(!is_refused(&both, &[RigidMovement::default(); 2]));
    // One that was built for the second segment keeps the first where it is.
    let one = build(&at_rest(&case, &exact()), &["x_max".to_owned()], &Unobserved).unwrap();
    assert!(one.linearity.something_stays);
    assert!(!is_refused(&one, &[shifted(FIVE)]));
}

#[test]
fn a_set_to_be_fixed_that_is_not_there_is_the_only_thing_that_is_wrong() {
    for name in ["skull", "nobody"] {
        let mut case = on_bones(&["x_min"]);
        let mut mesh = (*case.volume).clone();
        mesh.node_sets.insert("nobody".to_owned(), Vec::new());
        case.volume = mesh.into();
        case.fixed = vec![set(name)];
        let plan = plan_of(&case, &[shifted(FIVE)]);
        let errors = Scene::new(&case, &plan, &Settings::default()).err().unwrap().0;
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(errors[0].pointer, "/case/fixed/0");
    }
}

#[test]
fn a_name_that_is_no_segment_of_a_case_without_any_is_told_so() {
    let case = on_bones(&[]);
    let segment = PlannedSegment { name: "jaw".to_owned(), movement: shifted(FIVE) };
    let plan = Plan { segments: vec![segment], ..Plan::default() };
    let errors = Scene::new(&case, &plan, &Settings::default()).err().unwrap().0;
    assert!(errors[0].detail.ends_with("its segments: none"), "{}", errors[0].detail);
}
