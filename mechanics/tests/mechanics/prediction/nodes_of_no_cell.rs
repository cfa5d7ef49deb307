//! Nodes that belong to no cell are no part of the tissue, whatever selections name them: nothing holds, loads or moves them.

use std::sync::Arc;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, Warning};
use mechanics::model::fem::mass_tensor::MassTensorSettings;
use mechanics::model::mass_spring::{MassSpringSettings, Search};
use mechanics::model::spline::VolumeSpline;
use mechanics::model::thickness_warp::ThicknessWarp;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, Load, Method, Plan, Scene, Settings, Sliding, SlidingNormal,
};

use crate::scenes::{case_of, material, set, solve};

/// Places inside the tissue, on it, and far away.
const PLACES: [[f64; 3]; 3] = [[20.0, 9.0, 5.5], [0.0, 4.0, 4.0], [300.0, 15.0, 12.0]];

fn slab() -> Case {
    let mesh = block(Vector::new(40.0, 20.0, 10.0), [8, 4, 3], CellShape::Tet4);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") });
    case.fixed.push(set("x_max"));
    let wall = Sliding { nodes: set("z_min"), normal: SlidingNormal::Surface, segment: None };
    case.sliding.push(wall);
    case.skin = Some(set("z_max"));
    case
}

/// The same with nodes of no cell in each set of nodes.
fn with_spare_nodes() -> Case {
    let mut case = slab();
    let mesh = Arc::make_mut(&mut case.volume);
    let first = mesh.nodes.len() as u32;
    mesh.nodes.extend(PLACES.map(Vector::from));
    let spare = first..first + PLACES.len() as u32;
    mesh.node_sets.values_mut().for_each(|nodes| nodes.extend(spare.clone()));
    mesh.node_sets.insert("spare".to_owned(), spare.collect());
    case
}

fn plan(has_force: bool) -> Plan {
    let shift = Vector::new(1.0, -0.5, 0.7);
    let movement = RigidMovement::about_pivot(Vector::z() * 0.05, Vector::zeros(), shift);
    let force = Load::Force { nodes: set("z_max"), force: Vector::z() * 0.01 };
    Plan {
        segments: vec![PlannedSegment { name: "jaw".to_owned(), movement }],
        loads: if has_force { vec![force] } else { Vec::new() },
        ..Plan::default()
    }
}

#[test]
fn they_stay_at_their_place_by_every_method_and_change_nothing() {
    let methods = [
        Method::FemLinear,
        Method::FemNonlinear,
        Method::MassTensor(MassTensorSettings::default()),
        Method::MassTensorNonlinear,
        Method::MassSpring(MassSpringSettings { search: Search::Newton, most_iterations: 1000 }),
        Method::VolumeSpline(VolumeSpline::default()),
        Method::ThicknessWarp(ThicknessWarp::default()),
    ];
    for method in methods {
        let plan = plan(method.properties().knows_loads);
        let settings = Settings { method, ..Settings::default() };
        let clean = solve(&slab(), &plan, &settings);
        let found = solve(&with_spare_nodes(), &plan, &settings);
        let (own, spare) = found.displacement.split_at(clean.displacement.len());
        assert_eq!(spare, [Vector::zeros(); PLACES.len()], "{:?}", settings.method);
        let pairs = own.iter().zip(&clean.displacement);
        let apart = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-5, "{:?}: {apart:e}", settings.method);
        let codes = |warnings: &[Warning]| -> Vec<&str> {
            warnings.iter().map(|warning| warning.code).collect()
        };
        assert_eq!(codes(&found.warnings), codes(&clean.warnings), "{:?}", settings.method);
    }
}

#[test]
fn they_belong_to_no_class_and_a_selection_of_nothing_else_is_empty() {
    let counts = |case: &Case| {
        let scene = Scene::new(case, &Plan::default(), &Settings::default()).unwrap();
        ["joined:jaw", "fixed", "sliding"].map(|name| scene.class_counts()[name])
    };
    assert_eq!(counts(&with_spare_nodes()), counts(&slab()));
    let mut case = with_spare_nodes();
    case.fixed.push(set("spare"));
    let errors = Scene::new(&case, &Plan::default(), &Settings::default()).err().unwrap();
    let place = (errors.0[0].pointer.as_str(), errors.0[0].code.name());
    assert_eq!(place, ("/case/fixed/1", "empty-selection"));
    assert!(errors.0[0].detail.contains("none of the 3 nodes"), "{}", errors.0[0].detail);
    // A plan may name a set in place of a segment.
    let movement = RigidMovement::default();
    let segments = vec![PlannedSegment { name: "spare".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let errors = Scene::new(&with_spare_nodes(), &plan, &Settings::default()).err().unwrap();
    assert_eq!(errors.0[0].code.name(), "empty-selection");
}
