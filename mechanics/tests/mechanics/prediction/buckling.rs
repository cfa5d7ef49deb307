//! Struts that buckle: at which stress tissue at small strain is unstable, and which linear answers say so.

use std::f64::consts::PI;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{Case, CaseSegment, Method, Plan, Rung, Scene, Settings};
use mechanics::progress::Unobserved;
use nalgebra::Matrix3;

use super::adequate::{adequate, within};
use crate::scenes::{case_of, material, set, solve};
use crate::support::responses::plan_of;

const YOUNG: f64 = 15.0;
const POISSON: f64 = 0.45;
const THICK: f64 = 10.0;

/// A square strut along x between a bone that stays and one that moves.
fn strut(long: f64, shape: CellShape) -> Case {
    let counts = [(0.4 * long) as usize, 4, 4];
    let mesh = block(Vector::new(long, THICK, THICK), counts, shape);
    Case {
        fixed: vec![set("x_min")],
        segments: vec![CaseSegment { name: "bone".to_owned(), nodes: set("x_max") }],
        ..case_of(mesh, material(YOUNG, POISSON))
    }
}

/// Turned as a whole about its middle, by so many degrees: a bone at each end.
fn turned(case: Case, degrees: f64) -> (Case, Plan) {
    let mut case = case;
    case.fixed.clear();
    case.allow_unfixed = true;
    case.segments.push(CaseSegment { name: "other".to_owned(), nodes: set("x_min") });
    let [low, high] = [case.volume.nodes[0], *case.volume.nodes.last().unwrap()];
    let angles = Vector::new(0.0, 0.0, degrees.to_radians());
    let movement = RigidMovement::about_pivot(angles, (low + high) / 2.0, Vector::zeros());
    let plan = plan_of(&case, &[movement, movement]);
    (case, plan)
}

fn shortened(case: &Case, by_mm: f64) -> Plan {
    let along = Vector::new(-by_mm, 0.0, 0.0);
    plan_of(case, &[RigidMovement::new(Matrix3::identity(), along).unwrap()])
}

/// The pressure at which a strut buckles that is clamped at both ends, and yields to shear (Engesser; Timoshenko, Gere, Theory of
/// elastic stability, 1961, section 2.17), in kPa.
fn buckling_pressure(long: f64) -> f64 {
    let euler = YOUNG * PI * PI / 3.0 * (THICK / long).powi(2);
    let shear_modulus = YOUNG / (2.0 * (1.0 + POISSON));
    euler / (1.0 + euler / (5.0 / 6.0 * shear_modulus))
}

#[test]
fn a_strut_is_stable_up_to_the_pressure_at_which_it_buckles() {
    for shape in [CellShape::Tet4, CellShape::Hex8] {
        for long in [60.0, 100.0] {
            let case = strut(long, shape);
            let scene = Scene::new(&case, &Plan::default(), &Settings::default()).unwrap();
            let system = scene.assemble(&Unobserved).unwrap().unwrap();
            let stable_under = |times: f64| {
                let pressed = -times * buckling_pressure(long);
                let stress = Matrix3::from_diagonal(&Vector::new(pressed, 0.0, 0.0));
                system.is_stable_under(&scene.tissue(), &|_| stress, &Unobserved).unwrap()
            };
            let [below, above] = [0.9, 1.35].map(stable_under);
            assert_eq!([below, above], [Some(true), Some(false)], "{shape:?} of {long} mm");
            assert_ne!(stable_under(-2.0), Some(false), "pulled");
        }
    }
}

#[test]
fn tissue_that_is_held_all_around_does_not_buckle_under_pressure() {
    for shape in [CellShape::Tet4, CellShape::Hex8] {
        let mut case = strut(20.0, shape);
        case.fixed = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"].map(set).to_vec();
        case.segments.clear();
        let scene = Scene::new(&case, &Plan::default(), &Settings::default()).unwrap();
        let system = scene.assemble(&Unobserved).unwrap().unwrap();
        let stress = Matrix3::from_diagonal_element(-10.0 * YOUNG);
        let found = system.is_stable_under(&scene.tissue(), &|_| stress, &Unobserved).unwrap();
        assert_eq!(found, Some(true), "{shape:?}");
    }
}

#[test]
fn linear_answers_say_where_they_would_buckle_and_are_not_called_adequate() {
    let linear = Settings { method: Method::FemLinear, ..Settings::default() };
    let buckles = |case: &Case, by_mm: f64| {
        let found = solve(case, &shortened(case, by_mm), &linear);
        found.warnings.iter().any(|warning| warning.code == "tissue-may-buckle")
    };
    for shape in [CellShape::Tet4, CellShape::Hex8] {
        let slender = strut(60.0, shape);
        // Pressed by a tenth, a fiftieth, and pulled; a stocky one pressed by a tenth.
        let found = [6.0, 1.2, -6.0].map(|by_mm| buckles(&slender, by_mm));
        assert_eq!(found, [true, false, false], "{shape:?}");
        assert!(!buckles(&strut(10.0, shape), 1.0), "{shape:?}");
        // Twenty times as long as thick, pressed by a sixtieth.
        assert!(buckles(&strut(200.0, shape), 3.4), "{shape:?}");
        let (case, plan) = turned(strut(60.0, shape), 25.0);
        let found = solve(&case, &plan, &linear).warnings;
        assert!(!found.iter().any(|own| own.code == "tissue-may-buckle"), "{shape:?}");
    }
    let slender = strut(60.0, CellShape::Hex8);
    let plan = shortened(&slender, 6.0);
    let found = adequate(&slender, &plan, &Settings::default(), within(0.5));
    assert!(!found.is_met, "{:?}", found.errors);
    assert_eq!(found.rung.solution(), Rung::FiniteStrain);
    assert!(found.objections.iter().any(|own| own.warning.code == "another-equilibrium"));
}
