//! Pressure at finite strain follows its faces; at small strain it is told where it would turn.

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Load, Method, Plan, Prediction, Rung, Settings,
};

use super::adequate::{adequate, within};
use super::inner_at_finite_strain::EVERY;
use crate::scenes::{case_of, constraint, material, set, solve};

fn tight(element: ElementChoice) -> Settings {
    let method = Method::FemNonlinear;
    Settings { method, element, relative_residual: 1e-11, ..Settings::default() }
}

/// A block on bone, its top pressed.
fn on_bone(shape: CellShape) -> Case {
    let mesh = block(Vector::new(20.0, 20.0, 10.0), [4, 4, 3], shape);
    let bone = CaseSegment { name: "bone".to_owned(), nodes: set("z_min") };
    Case {
        skin: Some(set("z_max")),
        segments: vec![bone],
        allow_unfixed: true,
        ..case_of(mesh, material(15.0, 0.4))
    }
}

fn pressed(movement: RigidMovement, pressure: f64) -> Plan {
    let segments = vec![PlannedSegment { name: "bone".to_owned(), movement }];
    let loads = vec![Load::Pressure { faces: set("z_max"), pressure }];
    Plan { segments, loads, ..Plan::default() }
}

fn turned_by(degrees: f64) -> RigidMovement {
    let angles = Vector::new(0.5 * degrees, degrees, 0.0).map(f64::to_radians);
    RigidMovement::about_pivot(angles, Vector::new(10.0, 10.0, 0.0), Vector::new(0.0, 1.0, 2.0))
}

fn told(answer: &Prediction, code: &str) -> bool {
    answer.warnings.iter().any(|warning| warning.code == code)
}

/// A kilopascal sinks the top by half a millimetre, of which a force that stays turns a good part sideways.
#[test]
fn pressure_on_bone_that_turns_does_what_it_does_on_bone_that_stays() {
    for (shape, element) in EVERY {
        let case = on_bone(shape);
        let turned = turned_by(40.0);
        let at_rest = solve(&case, &pressed(RigidMovement::default(), 1.0), &tight(element));
        let answer = solve(&case, &pressed(turned, 1.0), &tight(element));
        let nodes = case.volume.nodes.iter();
        let pairs = nodes.zip(answer.displacement.iter().zip(&at_rest.displacement));
        let off =
            pairs.map(|(x, (after, before))| (x + after - turned.apply(&(x + before))).norm());
        let off = off.fold(0.0, f64::max);
        let [there, here] = [&answer, &at_rest].map(|own| own.reactions["bone"]);
        println!("{shape:?} {element:?}: {off:.1e} mm, {there:?} mN");
        assert!(off < 1e-5, "{shape:?} {element:?}: {off:e} mm");
        assert!((there - turned.rotation() * here).norm() < 1e-3, "{there} and {here}");
        assert!(!told(&answer, "pressure-turned") && !told(&answer, "pressure-unsettled"));
    }
}

/// Neo-Hookean tissue with mu 5 and lambda 20 kPa under a Cauchy stress of -3 kPa along one axis and none across.
#[test]
fn a_pressed_cube_shortens_as_by_the_stress_on_its_deformed_faces() {
    let [mu, lambda, pressure] = [5.0, 20.0, 3.0];
    let stress = |stretch: f64, volume: f64| {
        (mu * (stretch * stretch - 1.0) + lambda * volume.ln()) / volume
    };
    let root = |mut low: f64, mut high: f64, f: &dyn Fn(f64) -> f64| {
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            (low, high) = if f(middle) < 0.0 { (middle, high) } else { (low, middle) };
        }
        low
    };
    let across = |along: f64| root(0.5, 2.0, &|across| stress(across, along * across * across));
    let along = root(0.5, 1.0, &|along| stress(along, along * across(along).powi(2)) + pressure);
    assert!((along - 0.7930).abs() < 1e-4, "{along}");
    for (shape, element) in EVERY {
        let mesh = block(Vector::repeat(10.0), [2, 2, 2], shape);
        let prescribed = vec![
            constraint("x_min", [Some(0.0), None, None]),
            constraint("y_min", [None, Some(0.0), None]),
            constraint("z_min", [None, None, Some(0.0)]),
        ];
        let loads = vec![Load::Pressure { faces: set("z_max"), pressure }];
        let plan = Plan { prescribed, loads, ..Plan::default() };
        let young_modulus = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
        let nu = 0.5 * lambda / (lambda + mu);
        let case = case_of(mesh, material(young_modulus, nu));
        let answer = solve(&case, &plan, &tight(element));
        for (x, u) in case.volume.nodes.iter().zip(&answer.displacement) {
            let aside = across(along) - 1.0;
            let exact = Vector::new(x.x * aside, x.y * aside, x.z * (along - 1.0));
            assert!((u - exact).norm() < 1e-4, "{shape:?} {element:?} {x}: {u}");
        }
    }
}

#[test]
fn small_strain_tells_of_pressure_that_turns_and_the_adequate_model_follows_it() {
    let case = on_bone(CellShape::Tet4);
    let settings = Settings::default();
    assert!(!told(&solve(&case, &pressed(turned_by(0.5), 0.1), &settings), "pressure-turned"));
    let plan = pressed(turned_by(10.0), 1.0);
    let linear = solve(&case, &plan, &settings);
    let told_of = linear.warnings.iter().find(|warning| warning.code == "pressure-turned");
    let share = told_of.unwrap().numbers.iter().find(|(name, _)| *name == "share").unwrap().1;
    assert!((0.1..0.4).contains(&share), "{share}");
    let found = adequate(&case, &plan, &settings, within(5.0));
    assert_eq!((found.rung, found.is_met), (Rung::FiniteStrain, true));
    assert!(!told(&found.prediction, "pressure-turned"));
}
