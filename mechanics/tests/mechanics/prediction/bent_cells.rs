//! The estimate of the discretisation error where hexahedra and wedges bend: by growth, under a stiff skin, in flat layers, under
//! a load.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Load, Method, Plan, RegionNames, Settings, Sliding,
    SlidingNormal,
};

use super::growth::growing;
use super::numerical_error::Question;
use crate::scenes::{case_of, material, set};

/// Tissue of two layers, the upper one above a height.
fn layered(size: Vector, cells: [usize; 3], shape: CellShape, above: f64, times: f64) -> Case {
    let mut mesh = block(size, cells, shape);
    let is_upper = |cell: usize| {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        corners.iter().sum::<Vector>().z / corners.len() as f64 > above
    };
    let layer = (0..mesh.cells.len()).map(|cell| i64::from(is_upper(cell))).collect();
    mesh.cell_labels.insert("layer".to_owned(), layer);
    let names = BTreeMap::from([(0, "lower".to_owned()), (1, "upper".to_owned())]);
    if !mesh.cell_labels["layer"].contains(&1) {
        return Case { fixed: vec![set("x_min")], ..case_of(mesh, material(15.0, 0.46)) };
    }
    Case {
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        materials: [("lower", 1.0), ("upper", times)]
            .map(|(name, times)| (name.to_owned(), material(15.0 * times, 0.46)))
            .into(),
        fixed: vec![set("x_min")],
        ..case_of(mesh, material(15.0, 0.46))
    }
}

fn question(case: Case, plan: Plan, method: Method) -> Question {
    let truth = ElementChoice::MeanDilatation;
    let settings = Settings { element: truth, method, ..Settings::default() };
    Question { case, plan, settings, halved: 2, truth }
}

fn asserted(name: &str, question: &Question, [least, most]: [f64; 2]) {
    let found = question.effectivity();
    println!("{name}: {:.2} {:.2}", found.mean, found.p95);
    assert!((least..=most).contains(&found.mean), "{name}: {:.2}", found.mean);
}

#[test]
fn growth_that_bends_a_strip_is_not_underestimated() {
    for (shape, limits) in [(CellShape::Hex8, [0.7, 3.0]), (CellShape::Wedge6, [0.5, 3.0])] {
        for method in [Method::FemLinear, Method::FemNonlinear] {
            let case = layered(Vector::new(60.0, 6.0, 6.0), [8, 1, 2], shape, 3.0, 1.0);
            let plan = Plan { growth: growing("upper", 0.03), ..Plan::default() };
            asserted(&format!("{shape:?} {method:?}"), &question(case, plan, method), limits);
        }
    }
}

#[test]
fn a_load_that_bends_a_beam_is_estimated_within_a_factor_of_two() {
    for (shape, cells) in [
        (CellShape::Hex8, [6, 2, 2]),
        (CellShape::Hex8, [12, 4, 4]),
        (CellShape::Wedge6, [6, 2, 2]),
    ] {
        let case = layered(Vector::new(60.0, 10.0, 10.0), cells, shape, 100.0, 1.0);
        let traction = Vector::new(0.0, 0.0, -0.05);
        let loads = vec![Load::Traction { faces: set("x_max"), traction }];
        let plan = Plan { loads, ..Plan::default() };
        let name = format!("{shape:?} {cells:?}");
        asserted(&name, &question(case, plan, Method::FemLinear), [0.5, 2.0]);
    }
}

/// Shear that the cells resist too much and changes of volume that they do not resist nearly cancel here.
#[test]
fn a_beam_of_hexahedra_between_walls_is_estimated_near_the_incompressible_limit_too() {
    for (nu, least_left) in [(0.3, 0.4), (0.45, 0.8), (0.485, 1.3)] {
        let mesh = block(Vector::new(80.0, 8.0, 20.0), [8, 1, 2], CellShape::Hex8);
        let mut case = case_of(mesh, material(15.0, nu));
        case.fixed = vec![set("x_min")];
        case.sliding = ["y_min", "y_max"]
            .map(|wall| Sliding {
                nodes: set(wall),
                normal: SlidingNormal::Direction(Vector::y()),
                segment: None,
            })
            .to_vec();
        let traction = Vector::new(0.0, 0.0, 0.05);
        let plan = Plan {
            loads: vec![Load::Traction { faces: set("x_max"), traction }],
            ..Plan::default()
        };
        let found = question(case, plan, Method::FemLinear).effectivity();
        println!("nu {nu}: {:.2} {:.2}, {:.2} left", found.mean, found.p95, found.left);
        assert!((0.7..=2.2).contains(&found.mean), "nu {nu}: {:.2}", found.mean);
        assert!(found.left < least_left, "nu {nu}: {:.2}", found.left);
    }
}

/// Half of what lies on a slab moves, the other half stays; the mesh bends in between.
fn half_moved(mut case: Case, by: Vector) -> (Case, Plan) {
    let mesh = Arc::make_mut(&mut case.volume);
    let bottom = mesh.node_sets["z_min"].clone();
    let middle = mesh.nodes.iter().map(|node| node.x).fold(0.0, f64::max) / 2.0;
    let moves = |node: &u32| mesh.nodes[*node as usize].x < middle - 1e-9;
    let (moved, stays): (Vec<u32>, Vec<u32>) = bottom.into_iter().partition(moves);
    mesh.node_sets.insert("moved".to_owned(), moved);
    mesh.node_sets.insert("stays".to_owned(), stays);
    case.fixed = vec![set("stays")];
    case.segments = vec![CaseSegment { name: "bone".to_owned(), nodes: set("moved") }];
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), by);
    let segments = vec![PlannedSegment { name: "bone".to_owned(), movement }];
    (case, Plan { segments, ..Plan::default() })
}

#[test]
fn flat_layers_over_bone_that_moves_are_estimated_within_a_factor_of_two() {
    for layers in [1, 3, 6] {
        let case =
            layered(Vector::new(60.0, 20.0, 9.0), [6, 2, layers], CellShape::Hex8, 100.0, 1.0);
        let (case, plan) = half_moved(case, Vector::new(3.0, 0.0, 1.0));
        asserted(&format!("{layers} layers"), &question(case, plan, Method::FemLinear), [0.5, 2.1]);
    }
}

/// What a correction leaves, as a share of the estimate that is added: `auto` expects four fifths, and makes none where it may be more.
#[test]
fn a_correction_leaves_four_fifths_of_the_estimate_at_most_where_it_is_made() {
    use ElementChoice::{MeanDilatation, Stabilised};
    let rows = [
        (CellShape::Tet4, Stabilised, 0.3, true),
        (CellShape::Tet4, Stabilised, 0.49, true),
        (CellShape::Hex8, MeanDilatation, 0.3, true),
        (CellShape::Hex8, MeanDilatation, 0.43, true),
        (CellShape::Hex8, MeanDilatation, 0.49, false),
        (CellShape::Wedge6, MeanDilatation, 0.3, false),
        (CellShape::Wedge6, MeanDilatation, 0.49, false),
    ];
    let mut wrong = Vec::new();
    for (shape, truth, nu, is_made) in rows {
        let methods = [(Method::FemLinear, 0.5), (Method::FemNonlinear, 4.0)];
        for (method, mm) in methods.into_iter().take(if is_made { 2 } else { 1 }) {
            let shares = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-0.6, 0.0, 0.8]];
            let shares = shares.map(|way| {
                let case = case_of(
                    block(Vector::new(40.0, 32.0, 16.0), [5, 4, 2], shape),
                    material(15.0, nu),
                );
                let (case, plan) = half_moved(case, Vector::from(way) * mm);
                let settings =
                    Settings { element: truth, method: method.clone(), ..Settings::default() };
                let found = Question { case, plan, settings, halved: 2, truth }.effectivity();
                found.left / found.mean
            });
            let row = format!("{shape:?} nu {nu} {method:?}: {shares:.2?} of the estimate left");
            println!("{row}");
            let gains_little = shares.iter().any(|share| *share > 0.8);
            wrong.extend((is_made == gains_little).then_some(row));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
