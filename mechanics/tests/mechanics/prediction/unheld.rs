//! Cases in which nothing stays: a plan must not carry a face away as one in silence.

use mechanics::mesh::{CellShape, Vector, Warning, sample::block};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{
    Case, CaseSegment, Load, Plan, Prescribed, Scene, Settings, Sliding, SlidingNormal,
};
use mechanics::progress::Unobserved;
use mechanics::response::{ResponseError, build};

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

#[test]
fn bones_of_which_one_stays_or_goes_another_way_deform_the_tissue() {
    let case = on_bones(&["x_min", "x_max"]);
    let apart = [shifted(FIVE), shifted([5.0, 0.0, 0.0])];
    let told = judged(&case, &plan_of(&case, &apart)).unwrap().unwrap();
    assert_eq!(told.numbers, [("segments", 2.0)]);
    let one = [shifted(FIVE), RigidMovement::default()];
    assert_eq!(judged(&case, &plan_of(&case, &one)), Ok(None));
}

#[test]
fn fixed_and_prescribed_nodes_and_walls_that_stay_hold_and_walls_of_the_bone_do_not() {
    let wall = |segment: Option<&str>| Sliding {
        nodes: set("x_max"),
        normal: SlidingNormal::Surface,
        segment: segment.map(str::to_owned),
    };
    let plan = plan_of(&on_bones(&["x_min"]), &[shifted(FIVE)]);
    let with = |change: &dyn Fn(&mut Case)| {
        let mut case = on_bones(&["x_min"]);
        change(&mut case);
        judged(&case, &plan)
    };
    assert_eq!(with(&|case| case.fixed = vec![set("x_max")]), Ok(None));
    assert_eq!(with(&|case| case.sliding = vec![wall(None)]), Ok(None));
    let code = with(&|case| case.sliding = vec![wall(Some("x_min"))]).unwrap_err().1;
    assert_eq!(code, "nothing-held");
    let held = Prescribed::Uniform { nodes: set("x_max"), displacement: [Some(0.0), None, None] };
    let prescribed = Plan { prescribed: vec![held], ..plan.clone() };
    assert_eq!(judged(&on_bones(&["x_min"]), &prescribed), Ok(None));
    // A bone at rest is what gravity pulls at.
    let gravity = Load::Gravity { acceleration: Vector::new(0.0, 0.0, -9.81e-3) };
    let loaded = Plan { loads: vec![gravity], ..Plan::default() };
    assert_eq!(judged(&on_bones(&["x_min"]), &loaded), Ok(None));
}

#[test]
fn a_case_without_a_plan_says_what_its_plans_may_come_to() {
    let told = judged(&on_bones(&["x_min"]), &Plan::default()).unwrap().unwrap();
    assert!(told.detail.contains("a plan would carry the tissue away"), "{}", told.detail);
    let told = judged(&on_bones(&["x_min", "x_max"]), &Plan::default()).unwrap().unwrap();
    assert!(told.detail.contains("moves all segments alike"), "{}", told.detail);
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
