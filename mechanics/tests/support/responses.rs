//! Plan responses beside direct solutions of the same scene.

use mechanics::mesh::Vector;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Case, Plan, Prediction, Scene, Settings, predict};
use mechanics::progress::Unobserved;
use mechanics::response::{Columns, build};

pub fn tight() -> Settings {
    Settings { relative_residual: 1e-12, ..Settings::default() }
}

/// 25 mm and 30 degrees about an oblique axis, and something else.
pub fn movements() -> Vec<RigidMovement> {
    let axis = Vector::new(1.0, -2.0, 3.0).normalize();
    let turn = nalgebra::Rotation3::new(axis * 30_f64.to_radians()).into_inner();
    let pivot = Vector::new(10.0, -30.0, 5.0);
    let along = Vector::new(-2.0, 1.0, 4.0).normalize() * 25.0;
    let far = RigidMovement::new(turn, pivot - turn * pivot + along).unwrap();
    let angles = Vector::new(7.0, -5.0, 11.0).map(f64::to_radians);
    let near = RigidMovement::about_pivot(angles, pivot, Vector::new(1.5, -0.7, 5.0));
    vec![far, near]
}

pub fn plan_of(case: &Case, movements: &[RigidMovement]) -> Plan {
    let names = case.segments.iter().map(|segment| segment.name.clone());
    let planned = names.zip(movements);
    let segments = planned.map(|(name, &movement)| PlannedSegment { name, movement }).collect();
    Plan { segments, ..Plan::default() }
}

pub fn direct(case: &Case, movements: &[RigidMovement], settings: &Settings) -> Prediction {
    let scene = Scene::new(case, &plan_of(case, movements), settings).unwrap();
    predict(&scene, &Unobserved).unwrap()
}

pub fn at_rest(case: &Case, settings: &Settings) -> Scene {
    Scene::new(case, &Plan::default(), settings).unwrap()
}

pub fn columns(case: &Case, settings: &Settings) -> Columns {
    build(&at_rest(case, settings), &[], &Unobserved).unwrap()
}

/// The largest distance in mm between a direct solution and sums of columns in f64 and in f32.
pub fn differences(case: &Case) -> [f64; 2] {
    let columns = columns(case, &tight());
    let exact = direct(case, &movements(), &tight()).displacement;
    let response = columns.to_response();
    let largest = |moved: Vec<Vector>| {
        assert_eq!(moved.len(), columns.nodes.len());
        let nodes = columns.nodes.iter().map(|&node| exact[node as usize]);
        nodes.zip(moved).map(|(u, v)| (u - v).norm()).fold(0.0, f64::max)
    };
    [largest(columns.apply(&movements())), largest(response.apply(&movements()))]
}
