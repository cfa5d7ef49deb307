//! Meshes in which nothing is left to solve for, or hardly anything hangs together.

use mechanics::mesh::{CellShape, Cells, Vector, VolumeMesh, sample::block};
use mechanics::optimisation::{Goal, Question, SegmentBounds, SkinPoint, Target, optimise};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{Case, CaseSegment, ElementChoice, Settings};
use mechanics::progress::Unobserved;
use mechanics::response::build;

use crate::scenes::{case_of, exact, material, set, solve};
use crate::support::responses::{at_rest, direct, plan_of};

fn jaw(nodes: &str) -> Vec<CaseSegment> {
    vec![CaseSegment { name: "jaw".to_owned(), nodes: set(nodes) }]
}

/// One tetrahedron, two corners fixed and two joined.
fn one_tetrahedron() -> Case {
    let mut cells = Cells::default();
    cells.push(CellShape::Tet4, &[0, 1, 2, 3]);
    let corners = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 30.0, 0.0], [0.0, 0.0, 30.0]];
    let sets = [("fix", vec![0, 1]), ("jaw", vec![2, 3]), ("skin", vec![1, 2, 3])];
    let mesh = VolumeMesh {
        nodes: corners.map(Vector::from).to_vec(),
        cells,
        node_sets: sets.map(|(name, nodes)| (name.to_owned(), nodes)).into(),
        ..VolumeMesh::default()
    };
    Case {
        skin: Some(set("skin")),
        segments: jaw("jaw"),
        fixed: vec![set("fix")],
        ..case_of(mesh, material(15.0, 0.45))
    }
}

fn aside() -> RigidMovement {
    let angles = Vector::new(0.0, 0.1, 0.0);
    RigidMovement::about_pivot(angles, Vector::zeros(), Vector::new(1.0, -2.0, 3.0))
}

#[test]
fn tissue_without_a_free_node_goes_where_it_is_held_and_pulls_as_its_strain_says() {
    let case = one_tetrahedron();
    let plan = plan_of(&case, &[aside()]);
    let with = |element: ElementChoice| solve(&case, &plan, &Settings { element, ..exact() });
    // Its strain and its pressure are constant, so that it is the plain element.
    let plain = with(ElementChoice::Plain);
    for element in [ElementChoice::Auto, ElementChoice::Stabilised, ElementChoice::Quadratic] {
        let found = with(element);
        for (node, u) in found.displacement.iter().enumerate() {
            let held = match node {
                0 | 1 => Vector::zeros(),
                _ => aside().displacement(&case.volume.nodes[node]),
            };
            assert!((u - held).norm() < 1e-12, "{element:?}: {u} {held}");
        }
        if element != ElementChoice::Quadratic {
            let [pull, known] = [&found, &plain].map(|answer| answer.reactions["jaw"]);
            assert!((pull - known).norm() < 1e-9 * known.norm(), "{element:?}: {pull} {known}");
        }
    }
}

#[test]
fn a_response_and_inverse_planning_do_without_a_free_node() {
    let case = one_tetrahedron();
    let columns = build(&at_rest(&case, &exact()), &[], &Unobserved).unwrap();
    let moved = direct(&case, &[aside()], &exact()).displacement;
    for (&node, u) in columns.nodes.iter().zip(columns.apply(&[aside()])) {
        assert!((u - moved[node as usize]).norm() < 1e-12);
    }
    let goal = Goal { point: SkinPoint::node(1), displacement: [Some(1.0), Some(2.0), None] };
    let intervals = [(-5.0, 5.0), (-5.0, 5.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)];
    let question = Question {
        response: &columns.to_response(),
        bounds: &[SegmentBounds { intervals, pivot: Vector::zeros() }],
        targets: &[Target { goals: vec![goal], sigma: 1.0 }],
        inner: &[],
        constants: &[],
        second_order: None,
    };
    let optimum = optimise(&question).unwrap();
    assert!((optimum.movements[0].translation() - Vector::new(1.0, 2.0, 0.0)).norm() < 1e-6);
}

#[test]
fn free_nodes_that_touch_no_other_free_node_are_solved_without_a_dense_matrix() {
    let mut mesh = block(Vector::new(40.0, 40.0, 40.0), [20, 20, 20], CellShape::Tet4);
    let odd = |value: f64| (value / 2.0).round() as i64 % 2 == 1;
    let alone = |x: &Vector| odd(x.x) && odd(x.y) && odd(x.z);
    let nodes = (0_u32..).zip(&mesh.nodes);
    let held: Vec<u32> = nodes.filter(|(_, x)| !alone(x)).map(|(node, _)| node).collect();
    assert_eq!(mesh.nodes.len() - held.len(), 1000);
    let (moving, staying) = held.iter().partition(|node| mesh.nodes[**node as usize].x < 20.0);
    mesh.node_sets.insert("jaw".to_owned(), moving);
    mesh.node_sets.insert("far".to_owned(), staying);
    let mut case = case_of(mesh, material(15.0, 0.3));
    (case.segments, case.fixed) = (jaw("jaw"), vec![set("far")]);
    let shift = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::x() * 0.2);
    let found = solve(&case, &plan_of(&case, &[shift]), &Settings::default());
    assert!(found.solver.iterations < 100, "{}", found.solver.iterations);
    // Far inside the jaw everything around a node moves, and far inside the rest nothing.
    let at = |place: [f64; 3]| {
        let nodes = case.volume.nodes.iter();
        let node = nodes.zip(&found.displacement).find(|(x, _)| **x == Vector::from(place));
        *node.unwrap().1
    };
    assert!((at([2.0, 18.0, 18.0]) - Vector::x() * 0.2).norm() < 1e-6);
    assert!(at([38.0, 18.0, 18.0]).norm() < 1e-6);
}
