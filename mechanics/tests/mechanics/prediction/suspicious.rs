//! Plans and constants that look like a mistake of the unit.

use std::sync::Arc;

use mechanics::material::{LinearElastic, MaterialError, PlaneStress, Sheet};
use mechanics::mesh::{CellShape, Vector, Warning, sample::block};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::model::mass_spring::{MassSpringSettings, Search};
use mechanics::model::spline::VolumeSpline;
use mechanics::plan::RigidMovement;
use mechanics::prediction::{
    Case, CaseSegment, Load, Method, Plan, RegionNames, Scene, Settings, SkinMembrane, predict,
};
use mechanics::progress::Unobserved;
use mechanics::solver::stationary::{Iteration, Stationary};

use crate::scenes::{case_of, half_head_case, largest_error, material, set, solve};
use crate::support::responses::plan_of;

fn layer() -> Case {
    let mesh = block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], CellShape::Hex8);
    Case {
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("z_min") }],
        fixed: vec![set("x_max")],
        ..case_of(mesh, material(15.0, 0.45))
    }
}

fn shifted(by: f64) -> RigidMovement {
    RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::x() * by)
}

fn warnings(case: &Case, plan: &Plan, settings: &Settings, code: &str) -> Vec<Warning> {
    let mut found = Scene::new(case, plan, settings).unwrap().warnings;
    found.retain(|warning| warning.code == code);
    found
}

#[test]
fn a_plan_that_moves_nothing_says_so_and_a_case_without_one_does_not() {
    let case = layer();
    let still = plan_of(&case, &[RigidMovement::default()]);
    let settings = Settings::default();
    assert_eq!(warnings(&case, &still, &settings, "nothing-moves").len(), 1);
    assert_eq!(warnings(&case, &Plan::default(), &settings, "nothing-moves"), []);
    for plan in [still, Plan::default()] {
        let scene = Scene::new(&case, &plan, &settings).unwrap();
        let told = predict(&scene, &Unobserved).unwrap().warnings;
        assert_eq!(told.iter().filter(|warning| warning.code == "nothing-moves").count(), 1);
    }
    let moved = plan_of(&case, &[shifted(0.5)]);
    assert_eq!(warnings(&case, &moved, &settings, "nothing-moves"), []);
    // Its square is none.
    let vanishing = plan_of(&case, &[shifted(1e-300)]);
    assert_eq!(warnings(&case, &vanishing, &settings, "nothing-moves").len(), 1);
}

#[test]
fn tissue_at_rest_is_not_told_to_be_pressed() {
    let mesh = block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], CellShape::Tet4);
    let case = Case { volume: Arc::new(mesh), ..layer() };
    let still = plan_of(&case, &[RigidMovement::default()]);
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let scene = Scene::new(&case, &still, &settings).unwrap();
    let told = predict(&scene, &Unobserved).unwrap().warnings;
    let codes: Vec<&str> = told.iter().map(|warning| warning.code).collect();
    assert!(codes.contains(&"nothing-moves"), "{codes:?}");
    assert!(!codes.contains(&"bulk-in-all-cells"), "{codes:?}");
}

#[test]
fn skin_that_moves_farther_than_bone_is_told_with_its_place() {
    let case = half_head_case(0.45);
    let back = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::y() * 4.0);
    let plan = plan_of(&case, &[RigidMovement::default(), back]);
    let told = |method| {
        let settings = Settings { method, ..Settings::default() };
        let scene = Scene::new(&case, &plan, &settings).unwrap();
        let mut found = predict(&scene, &Unobserved).unwrap().warnings;
        found.retain(|warning| warning.code == "skin-outruns-plan");
        found
    };
    assert_eq!(told(Method::FemLinear), []);
    let settings = MassSpringSettings { search: Search::Newton, most_iterations: 1000 };
    let springs = told(Method::MassSpring(settings));
    let [warning] = &springs[..] else { panic!("{springs:?}") };
    let [_, (_, skin_mm), (_, moving_mm)] = warning.numbers[..] else { panic!("{warning:?}") };
    assert!(moving_mm == 4.0 && skin_mm > 5.0, "{warning:?}");
    assert!(warning.detail.contains("nothing that moves it by more than 4.0 mm"), "{warning:?}");
}

#[test]
fn skin_that_turns_with_its_bone_farther_from_the_pivot_does_not_outrun_it() {
    let mesh = block(Vector::new(50.0, 40.0, 30.0), [5, 4, 3], CellShape::Hex8);
    let case = Case {
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("z_min") }],
        skin: Some(set("z_max")),
        allow_unfixed: true,
        ..case_of(mesh, material(20.0, 0.4))
    };
    let angles = Vector::x() * f64::to_radians(45.0);
    let turned = RigidMovement::about_pivot(angles, Vector::new(20.0, 20.0, 0.0), Vector::zeros());
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let found = solve(&case, &plan_of(&case, &[turned]), &settings);
    let farthest = |name: &str| {
        let nodes = case.volume.node_sets[name].iter();
        nodes.map(|&node| found.displacement[node as usize].norm()).fold(0.0, f64::max)
    };
    assert!(farthest("z_max") > 1.5 * farthest("z_min"));
    let off = largest_error(&case.volume, &found.displacement, |x| turned.displacement(x));
    assert!(off < 1e-2, "{off}");
    assert!(found.warnings.iter().all(|own| own.code != "skin-outruns-plan"));
}

#[test]
fn a_plan_in_metres_is_reported_and_one_beyond_the_face_is_refused() {
    let case = layer();
    let told = warnings(
        &case,
        &plan_of(&case, &[shifted(0.005)]),
        &Settings::default(),
        "plan-units-suspect",
    );
    let numbers = &told[0].numbers;
    assert!((numbers[0].1 - 0.005).abs() < 1e-12 && (numbers[1].1 - 5.0).abs() < 1e-9, "{told:?}");
    let beyond = Scene::new(&case, &plan_of(&case, &[shifted(46.0)]), &Settings::default());
    let error = beyond.err().unwrap().0.remove(0);
    assert_eq!(
        (error.pointer.as_str(), error.code.name()),
        ("/plan/segments/0", "plan-out-of-range")
    );
    assert!(error.detail.contains("46.000 mm") && error.detail.contains("45.826 mm"), "{error}");
}

#[test]
fn a_total_movement_of_more_than_a_hundred_millimetres_is_refused_on_a_larger_mesh() {
    let mesh = block(Vector::new(300.0, 100.0, 100.0), [3, 1, 1], CellShape::Hex8);
    let case = Case {
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("z_min") }],
        fixed: vec![set("z_max")],
        ..case_of(mesh, material(15.0, 0.45))
    };
    let scene = |movement: RigidMovement| {
        Scene::new(&case, &plan_of(&case, &[movement]), &Settings::default())
    };
    let error = scene(shifted(75.0).then(&shifted(75.0))).err().unwrap().0.remove(0);
    assert_eq!(
        (error.pointer.as_str(), error.code.name()),
        ("/plan/segments/0", "plan-out-of-range")
    );
    assert!(error.detail.contains("150.000 mm in all"), "{error}");
    assert!(scene(shifted(75.0).then(&shifted(-60.0))).is_ok());
}

#[test]
fn a_modulus_no_unit_explains_is_refused_with_its_number() {
    for modulus in [1e-170, 0.99e-9, 1.01e9] {
        let error = LinearElastic::new(modulus, 0.3, 1.0).unwrap_err();
        assert_eq!(error, MaterialError::YoungModulus(modulus));
        let sheet =
            Sheet { thickness: 1.5, young_modulus: modulus, poisson_ratio: 0.3, along_lines: None };
        assert!(PlaneStress::new(&sheet).is_err());
    }
    assert!(
        LinearElastic::new(1e-9, 0.3, 1.0).is_ok() && LinearElastic::new(1e9, 0.3, 1.0).is_ok()
    );
    let thin =
        Sheet { thickness: 0.9e-3, young_modulus: 1.0, poisson_ratio: 0.3, along_lines: None };
    assert!(PlaneStress::new(&thin).is_err());
}

#[test]
fn constants_that_a_wrong_unit_explains_are_reported_with_their_numbers() {
    let told = |constants: [f64; 3], loads: Vec<Load>, thickness: f64| -> Vec<f64> {
        let mut case = layer();
        let [modulus, ratio, density] = constants;
        let material = LinearElastic::new(modulus, ratio, density).unwrap();
        case.materials.insert("*".to_owned(), material);
        let sheet =
            Sheet { thickness, young_modulus: 200.0, poisson_ratio: 0.3, along_lines: None };
        let membrane = Some(SkinMembrane { sheet: PlaneStress::new(&sheet).unwrap(), lines: None });
        let settings = Settings { membrane, ..Settings::default() };
        let plan = Plan { loads, ..plan_of(&case, &[shifted(1.0)]) };
        let found = warnings(&case, &plan, &settings, "constant-suspect");
        found.iter().map(|warning| warning.numbers[0].1).collect()
    };
    const NONE: [f64; 0] = [];
    let usual = [15.0, 0.45, 1.0];
    assert_eq!(told(usual, vec![], 1.5), NONE);
    assert_eq!(told([1.0, 0.45, 0.0], vec![], 1.5), NONE, "no density is no mistake");
    // 15 kPa in Pa; 300 kPa in MPa.
    assert_eq!(told([15_000.0, 0.45, 1.0], vec![], 1.5), [15_000.0]);
    assert_eq!(told([0.3, 0.45, 1.0], vec![], 1.5), [0.3]);
    // MPa, Pa; kg/m3 are refused, t/mm3 are not.
    assert_eq!(told([0.015, 0.45, 1.0], vec![], 1.5), [0.015]);
    assert_eq!(told([1.5e7, 0.45, 1e-9], vec![], 1.5), [1.5e7, 1e-9]);
    assert_eq!(told(usual, vec![], 0.0015), [0.0015], "metres");
    let faces = || set("z_max");
    let loads = vec![
        Load::Traction { faces: faces(), traction: Vector::z() * 2e3 },
        Load::Pressure { faces: faces(), pressure: -0.5 },
        Load::Pressure { faces: faces(), pressure: 5e-3 },
        Load::Force { nodes: faces(), force: Vector::x() * 2e5 },
        Load::Gravity { acceleration: Vector::new(0.0, 0.0, -9.81) },
    ];
    assert_eq!(told(usual, loads, 1.5), [2e3, 5e-3, 2e5, 9810.0]);
}

#[test]
fn a_movement_whose_squares_vanish_is_answered_like_any_other() {
    let (iteration, most_iterations) = (Iteration::GaussSeidel, 10_000);
    let sweeps = Stationary { iteration, relative_change: None, most_iterations };
    let by_sweeps = MassTensorSettings { iterations: Iterations::Stationary(sweeps) };
    let models = [
        (CellShape::Tet4, Method::FemLinear),
        (CellShape::Hex8, Method::FemLinear),
        (CellShape::Tet4, Method::MassTensor(by_sweeps)),
        (CellShape::Hex8, Method::VolumeSpline(VolumeSpline::default())),
    ];
    for (shape, method) in models {
        let mesh = block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], shape);
        let case = Case { volume: mesh.into(), ..layer() };
        let settings = Settings { method, relative_residual: 1e-10, ..Settings::default() };
        let [usual, tiny] = [1.0, 1e-170].map(|by| {
            let plan = plan_of(&case, &[shifted(by)]);
            solve(&case, &plan, &settings).displacement
        });
        for (u, v) in usual.iter().zip(&tiny) {
            assert!((u - v * 1e170).norm() < 1e-6, "{:?}: {u} {v}", settings.method);
        }
    }
}

#[test]
fn a_tissue_in_pascal_beside_others_in_kilopascal_is_reported_with_both() {
    let mut case = layer();
    let mut mesh = (*case.volume).clone();
    let cells = mesh.cells.len() as i64;
    mesh.cell_labels.insert("layer".to_owned(), (0..cells).map(|cell| cell % 2).collect());
    case.volume = mesh.into();
    let names = [(0, "fat".to_owned()), (1, "skin".to_owned())].into();
    case.regions = Some(RegionNames { array: "layer".to_owned(), names });
    let told = |fat: f64, skin: f64| {
        let mut case = case.clone();
        case.materials = [("fat", fat), ("skin", skin)]
            .map(|(name, modulus)| (name.to_owned(), material(modulus, 0.45)))
            .into();
        warnings(&case, &Plan::default(), &Settings::default(), "moduli-far-apart")
    };
    let warning = told(3.0, 30000.0).remove(0);
    assert!(warning.detail.contains("\"skin\" is 30000 kPa"), "{}", warning.detail);
    assert!(warning.detail.contains("\"fat\" 3 kPa"), "{}", warning.detail);
    assert_eq!(warning.numbers[1..], [("stiffest_kpa", 30000.0), ("softest_kpa", 3.0)]);
    assert!((warning.numbers[0].1 - 1e4).abs() < 1e-9, "{warning:?}");
    assert_eq!(told(3.0, 2990.0), []);
}
