//! The cheapest adequate model: what is taken, what is called met, and what is said where nothing is adequate.

use mechanics::material::{Fibre, FibreLaw, PlaneStress, Sheet};
use mechanics::mesh::refinement::refine;
use mechanics::mesh::sample::hard_block;
use mechanics::mesh::{CellShape, Vector, Warning};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{
    Accepted, Adequate, Case, CaseSegment, ContactKind, ElementChoice, FibreDirection, MeanErrors,
    Method, Plan, Prediction, Rung, Scene, Settings, SkinMembrane, TimedProgress, predict,
    predict_adequately,
};
use mechanics::progress::{Progress, Unobserved};

use super::contact::{jaws, raised};
use super::nonlinearity::{movements, slab};
use crate::scenes::{StopsAfter, case_of, material, set};
use crate::support::responses::plan_of;

/// A stopwatch on which each look is a second later.
fn ticking() -> impl Fn() -> f64 {
    let now = std::cell::Cell::new(0.0);
    move || now.replace(now.get() + 1.0)
}

pub(super) fn adequate(
    case: &Case,
    plan: &Plan,
    settings: &Settings,
    accepted: Accepted,
) -> Adequate {
    let scene = Scene::new(case, plan, settings).unwrap();
    let watched = TimedProgress { stopwatch: &ticking(), progress: &Unobserved };
    predict_adequately(case, plan, &scene, &accepted, watched).unwrap()
}

pub(super) fn within(skin_mm: f64) -> Accepted {
    Accepted { skin_mm, time_s: 1e6, ..Accepted::default() }
}

/// The mean over the skin that moves of the distance to Newton's answer of stabilised elements on a mesh of which every edge is halved.
pub(super) fn true_error(case: &Case, plan: &Plan, displacement: &[Vector]) -> f64 {
    let fine = Case { volume: refine(&case.volume).into(), ..case.clone() };
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let scene = Scene::new(&fine, plan, &settings).unwrap();
    let truth = predict(&scene, &Unobserved).unwrap().displacement;
    let coarse = Scene::new(case, plan, &Settings::default()).unwrap();
    let nodes = coarse.skin.nodes();
    let apart = |point: u32| {
        let node = nodes[point as usize] as usize;
        (truth[node] - displacement[node]).norm()
    };
    let moving = coarse.skin.moving_points(displacement);
    moving.iter().map(|&point| apart(point)).sum::<f64>() / moving.len() as f64
}

#[test]
fn larger_movements_need_dearer_models_and_what_is_called_met_is_met() {
    let case = slab(CellShape::Tet4, 0.45);
    let mut taken = Vec::new();
    for (share, skin_mm) in [(0.05, 0.1), (0.3, 0.25), (1.0, 0.5), (1.0, 0.3)] {
        let plan = plan_of(&case, &movements(share));
        let found = adequate(&case, &plan, &Settings::default(), within(skin_mm));
        let error = true_error(&case, &plan, &found.prediction.displacement);
        println!("{share}: {:?} told {:?} true {error:.4} of {skin_mm}", found.rung, found.errors);
        assert!(!found.is_met || error <= skin_mm, "{share}: {error} of {skin_mm}");
        assert_eq!(found.scene.is_some(), found.rung.solution() == Rung::FiniteStrain);
        taken.push((found.rung, found.is_met));
    }
    assert_eq!(taken[0], (Rung::Linear, true));
    assert!(taken.contains(&(Rung::FiniteStrain, true)), "{taken:?}");
}

#[test]
fn an_answer_that_only_its_mesh_spoils_is_corrected() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(0.1));
    let first = adequate(&case, &plan, &Settings::default(), within(100.0));
    assert_eq!((first.rung, first.is_met), (Rung::Linear, true));
    let of_skin = |error: &Option<MeanErrors>| error.as_ref().unwrap().skin_mm;
    let (mesh, linearity) = (of_skin(&first.errors.mesh), of_skin(&first.errors.linearity));
    let between = 0.9 * mesh + linearity;
    let corrected = adequate(&case, &plan, &Settings::default(), within(between));
    assert_eq!((corrected.rung, corrected.is_met), (Rung::Corrected, true));
    let error = corrected.prediction.numerical_error.unwrap();
    assert!(error.is_added);
    let pairs = first.prediction.displacement.iter().zip(&corrected.prediction.displacement);
    let added =
        pairs.zip(&error.missing).map(|((before, after), missing)| before + missing - after);
    assert!(added.map(|left| left.norm()).fold(0.0, f64::max) < 1e-12);
}

#[test]
fn answers_of_wedges_and_of_nearly_incompressible_hexahedra_are_not_corrected() {
    let is_corrected = |shape: CellShape, nu: f64| {
        let case = slab(shape, nu);
        let plan = plan_of(&case, &movements(0.1));
        let found = adequate(&case, &plan, &Settings::default(), within(1e-3));
        let passed_over = |rung: Rung| {
            let considered = found.considered.iter().find(|one| one.rung == rung);
            considered.unwrap().passed_over.clone()
        };
        match passed_over(Rung::Corrected) {
            None => true,
            Some(why) => {
                assert!(why.contains("nearly incompressible hexahedra"), "{why}");
                assert_ne!(found.rung, Rung::Corrected);
                false
            }
        }
    };
    for (shape, nu, wanted) in [
        (CellShape::Tet4, 0.49, true),
        (CellShape::Hex8, 0.43, true),
        (CellShape::Hex8, 0.45, false),
        (CellShape::Wedge6, 0.3, false),
    ] {
        assert_eq!(is_corrected(shape, nu), wanted, "{shape:?} {nu}");
    }
}

#[test]
fn without_time_the_nearest_answer_is_given_and_said_not_to_be_adequate() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(1.0));
    let usual = Settings::default();
    let mesh = adequate(&case, &plan, &usual, within(100.0)).errors.mesh.unwrap();
    let skin_mm = 0.9 * mesh.skin_mm;
    // The linear answer takes a second of the stopwatch.
    let found = adequate(&case, &plan, &usual, Accepted { time_s: 5.0, ..within(skin_mm) });
    assert_eq!((found.rung.solution(), found.is_met), (Rung::SecondOrder, false));
    let rung = Rung::FiniteStrainCorrected;
    let newton = found.considered.iter().find(|other| other.rung == rung).unwrap();
    assert!(newton.passed_over.as_ref().unwrap().contains("s are left"), "{newton:?}");
    assert!(newton.error.as_ref().unwrap().skin_mm <= skin_mm && newton.spent_s.is_none());
    let warning = |code: &str| found.prediction.warnings.iter().any(|one| one.code == code);
    assert!(warning("tolerance-not-met"));
}

#[test]
fn tissue_with_a_skin_is_answered_at_finite_strain_where_that_is_needed() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(1.0));
    let sheet =
        Sheet { thickness: 1.5, young_modulus: 100.0, poisson_ratio: 0.45, along_lines: None };
    let membrane = Some(SkinMembrane { sheet: PlaneStress::new(&sheet).unwrap(), lines: None });
    let settings = Settings { membrane, ..Settings::default() };
    let found = adequate(&case, &plan, &settings, within(0.4));
    assert_eq!((found.rung.solution(), found.is_met), (Rung::FiniteStrain, true));
}

/// Finite strain has fibres that pull, not those of linear elasticity, and would answer as if there were none.
#[test]
fn tissue_with_fibres_that_also_push_is_answered_with_them() {
    let mut case = slab(CellShape::Tet4, 0.45);
    let fibre = Fibre { young_modulus: 600.0, shear_modulus: None, law: FibreLaw::Engineering };
    for tissue in case.materials.values_mut() {
        *tissue = tissue.with_fibre(&fibre).unwrap();
    }
    case.fibres.insert("*".to_owned(), FibreDirection::Uniform(Vector::x()));
    let plan = plan_of(&case, &movements(1.0));
    let found = adequate(&case, &plan, &Settings::default(), within(0.05));
    assert!(!found.is_met && found.rung.solution() != Rung::FiniteStrain, "{:?}", found.rung);
    let refused = found.considered.iter().find(|other| other.rung == Rung::FiniteStrain).unwrap();
    assert!(refused.passed_over.as_ref().is_some_and(|why| why.contains("also push")));
}

/// A scalp that stays does not make a face adequate.
#[test]
fn the_error_is_meant_over_the_skin_that_moves() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(0.1));
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let found = adequate(&case, &plan, &Settings::default(), within(100.0));
    let lengths = scene.skin.lengths(&found.prediction.displacement);
    let least = 0.1 * lengths.iter().copied().fold(0.0, f64::max);
    let missing = scene.skin.lengths(&found.prediction.numerical_error.unwrap().missing);
    let pairs = lengths.iter().zip(&missing).filter(|(length, _)| **length >= least);
    let moving: Vec<f64> = pairs.map(|(_, missing)| *missing).collect();
    assert!(moving.len() < lengths.len(), "some of the skin stays");
    let mean = moving.iter().sum::<f64>() / moving.len() as f64;
    let told = found.errors.mesh.unwrap().skin_mm;
    assert!((told / mean - 1.0).abs() < 1e-12, "{told} {mean}");
}

#[test]
fn contact_that_may_close_and_stays_open_leaves_the_choice_of_a_model() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(0.3));
    let settings = Settings { contact: ContactKind::Auto, ..Settings::default() };
    let [open, none] = [&settings, &Settings::default()]
        .map(|settings| adequate(&case, &plan, settings, within(0.2)));
    assert_eq!(open.errors.mesh, none.errors.mesh);
    assert!(open.rung > Rung::Linear || none.rung == Rung::Linear, "{:?}", open.rung);
    assert!(open.considered.len() == none.considered.len());
}

#[test]
fn where_tissue_presses_only_finite_strain_is_called_adequate() {
    let (case, plan) = (jaws(2.5), raised(6.0));
    let settings = Settings { contact: ContactKind::Auto, ..Settings::default() };
    for (time_s, taken, is_met) in [(1e9, Rung::FiniteStrain, true), (0.0, Rung::Linear, false)] {
        let accepted = Accepted { time_s, ..within(100.0) };
        let found = adequate(&case, &plan, &settings, accepted);
        assert_eq!((found.rung, found.is_met), (taken, is_met), "{:?}", found.objections);
        let touch = found.prediction.contact.unwrap();
        assert!(touch.area() > 100.0, "{}", touch.area());
    }
}

/// Lips that pass each other are no answer, however small the error of its model.
#[test]
fn skin_that_passes_through_itself_deeper_than_accepted_is_never_called_met() {
    let case = jaws(2.5);
    let met = |by: f64, skin_mm: f64| {
        let found = adequate(&case, &raised(by), &Settings::default(), within(skin_mm));
        let mut told = found.prediction.warnings;
        told.retain(|warning| warning.code == "tolerance-not-met");
        (found.is_met, told)
    };
    // The slit is 5 mm wide.
    let (is_met, told) = met(9.0, 1.5);
    let is_of_skin = |own: &&Warning| own.detail.contains("deeper than before the movement");
    let of_skin = told.iter().find(is_of_skin).unwrap();
    let depth = of_skin.numbers.iter().find(|(name, _)| *name == "depth_mm").unwrap().1;
    assert!(!is_met && depth > 1.5 && depth < 5.0, "{told:?}");
    let (is_met, told) = met(3.0, 1.5);
    assert!(is_met && told.is_empty(), "{told:?}");
}

/// The estimates of an answer that no tissue can have are none, however much is accepted.
#[test]
fn an_answer_that_turns_cells_inside_out_is_never_called_adequate() {
    let case = Case {
        skin: Some(set("z_max")),
        segments: vec![CaseSegment { name: "patch".to_owned(), nodes: set("patch") }],
        fixed: vec![set("rest")],
        ..case_of(hard_block([20, 20, 4]), material(15.0, 0.46))
    };
    let angles = Vector::new(0.0, 15_f64.to_radians(), 0.0);
    let (pivot, along) = (Vector::new(50.0, 50.0, 0.0), Vector::new(25.0, 0.0, 10.0));
    let plan = plan_of(&case, &[RigidMovement::about_pivot(angles, pivot, along)]);
    let usual = Settings::default();
    let linear = predict(&Scene::new(&case, &plan, &usual).unwrap(), &Unobserved).unwrap();
    assert!(linear.deformation.iter().any(|cell| cell.det_f <= 0.0));

    let found = adequate(&case, &plan, &usual, within(100.0));
    assert_eq!((found.rung, found.is_met), (Rung::FiniteStrain, true), "{:?}", found.considered);
    assert!(found.objections.is_empty());
    assert!(found.prediction.deformation.iter().all(|cell| cell.det_f > 0.0));
    let first = &found.considered[0];
    assert!(first.error.as_ref().unwrap().skin_mm <= 100.0);
    assert!(first.passed_over.as_ref().unwrap().contains("inside out"), "{first:?}");

    let no_finite_strain = Some("no room".to_owned());
    let found = adequate(&case, &plan, &usual, Accepted { no_finite_strain, ..within(100.0) });
    assert!(!found.is_met && found.rung.solution() != Rung::FiniteStrain);
    assert_eq!(found.objections[0].warning.code, "cells-inverted");
    let mut told = found.prediction.warnings.iter();
    let told = told.find(|one| one.code == "tolerance-not-met").unwrap();
    assert!(told.detail.contains("inside out"), "{told:?}");
}

#[test]
fn an_answer_that_was_solved_loosely_says_so_and_is_never_called_adequate() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(0.05));
    for (relative_residual, is_loose) in [(1e-8, false), (1e-6, false), (1e-3, true)] {
        let settings = Settings { relative_residual, ..Settings::default() };
        let found = adequate(&case, &plan, &settings, within(100.0));
        let objected = found.objections.iter().any(|own| own.warning.code == "solved-loosely");
        assert_eq!((found.is_met, objected), (!is_loose, is_loose), "{relative_residual:e}");
        let told = found.prediction.warnings.iter().find(|one| one.code == "solved-loosely");
        let numbers = told.map(|told| (told.numbers[0].1 > 1e-6, told.numbers[1].1));
        assert_eq!(numbers, is_loose.then_some((true, relative_residual)));
    }
}

#[test]
fn elements_without_an_estimate_are_never_called_adequate() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(0.05));
    let settings = Settings { element: ElementChoice::Quadratic, ..Settings::default() };
    let found = adequate(&case, &plan, &settings, within(10.0));
    assert_eq!((found.rung, found.is_met), (Rung::Linear, false));
}

#[test]
fn a_search_for_a_model_stops_when_cancelled() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(1.0));
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let stops: &dyn Progress = &StopsAfter::iterations(2);
    let watched = TimedProgress { stopwatch: &ticking(), progress: stops };
    assert!(predict_adequately(&case, &plan, &scene, &within(0.3), watched).is_err());
}

/// Plain tetrahedra, at which Newton's answer on the same mesh is what both orders come to.
fn newton(case: &Case, plan: &Plan) -> Prediction {
    let (method, element) = (Method::FemNonlinear, ElementChoice::Plain);
    let settings = Settings { method, element, ..Settings::default() };
    predict(&Scene::new(case, plan, &settings).unwrap(), &Unobserved).unwrap()
}

#[test]
fn the_second_order_is_nearer_to_newton_and_its_holds_are_in_balance() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(0.5));
    let settings = Settings { element: ElementChoice::Plain, ..Settings::default() };
    let linear = adequate(&case, &plan, &settings, within(100.0));
    let mean = |error: &Option<MeanErrors>| error.as_ref().unwrap().skin_mm;
    let skin_mm = mean(&linear.errors.mesh) + 0.5 * mean(&linear.errors.linearity);
    let corrected = mean(&linear.errors.mesh) * 0.8 + mean(&linear.errors.linearity);
    assert!(corrected > skin_mm, "a corrected answer is not enough: {:?}", linear.errors);
    let second = adequate(&case, &plan, &settings, within(skin_mm));
    assert_eq!((second.rung, second.is_met), (Rung::SecondOrder, true), "{:?}", second.errors);
    let exact = newton(&case, &plan);
    let off = |found: &Prediction| -> f64 {
        let pairs = found.displacement.iter().zip(&exact.displacement);
        pairs.map(|(a, b)| (a - b).norm()).sum()
    };
    assert!(4.0 * off(&second.prediction) < off(&linear.prediction));
    // Along a movement forces change at third order first: nearer, and not by as much.
    let apart = |found: &Prediction| -> f64 {
        let pairs = exact.reactions.iter();
        pairs.map(|(name, exerted)| (found.reactions[name] - exerted).norm()).sum()
    };
    assert!(apart(&second.prediction) < apart(&linear.prediction));
    let left: Vector = second.prediction.reactions.values().sum();
    let largest = exact.reactions.values().map(Vector::norm).fold(0.0, f64::max);
    println!("out of balance by {:.3} of {largest:.1} mN", left.norm());
    assert!(left.norm() < 1e-3 * largest, "{left}");
    // What the second order leaves out is told in place of the second order.
    let told = second.prediction.nonlinearity.unwrap().left_out;
    let before = linear.prediction.nonlinearity.unwrap().left_out;
    let total = |values: &[Vector]| values.iter().map(Vector::norm).sum::<f64>();
    assert!(total(&told) < 0.5 * total(&before));
}

#[test]
fn a_part_of_the_skin_may_ask_for_more_than_the_whole() {
    let mut case = slab(CellShape::Tet4, 0.45);
    let top = case.volume.node_sets["z_max"].clone();
    let near = |node: &u32| {
        (case.volume.nodes[*node as usize] - Vector::new(18.0, 30.0, 14.0)).norm() < 12.0
    };
    let over: Vec<u32> = top.into_iter().filter(near).collect();
    let mut mesh = (*case.volume).clone();
    mesh.node_sets.insert("over".to_owned(), over);
    case.volume = mesh.into();
    case.skin_regions = [("over".to_owned(), set("over"))].into();
    let plan = plan_of(&case, &movements(0.3));
    let accepted = |region: f64| Accepted {
        regions_mm: [("over".to_owned(), region)].into(),
        ..within(100.0)
    };
    let loose = adequate(&case, &plan, &Settings::default(), accepted(100.0));
    assert_eq!((loose.rung, loose.is_met), (Rung::Linear, true));
    let own = loose.considered[0].error.as_ref().unwrap().regions_mm["over"];
    assert!(own > 0.0 && own != loose.considered[0].error.as_ref().unwrap().skin_mm);
    let strict = adequate(&case, &plan, &Settings::default(), accepted(0.99 * own));
    assert!(strict.rung > Rung::Linear && strict.is_met);
    let impossible = adequate(&case, &plan, &Settings::default(), accepted(1e-3));
    assert!(!impossible.is_met);
    let told = impossible.prediction.warnings.iter().find(|one| one.code == "tolerance-not-met");
    assert!(told.unwrap().detail.contains("over"), "{told:?}");
}

#[test]
fn finite_strain_is_passed_over_where_there_is_no_room_for_it() {
    let case = slab(CellShape::Tet4, 0.45);
    let plan = plan_of(&case, &movements(1.0));
    let no_finite_strain = Some("no room".to_owned());
    let accepted = Accepted { no_finite_strain, ..within(0.3) };
    let found = adequate(&case, &plan, &Settings::default(), accepted);
    assert!(found.scene.is_none() && !found.is_met);
    let newton = found.considered.iter().find(|other| other.rung == Rung::FiniteStrain).unwrap();
    assert_eq!(newton.passed_over.as_deref(), Some("no room"));
}
