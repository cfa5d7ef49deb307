//! Edges of walls and seams between sets of sliding nodes: docs/conditions.md#walls-that-tissue-slides-on.

use std::collections::BTreeSet;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Case, CaseSegment, Plan, Scene, Sliding, SlidingNormal};
use mechanics::progress::Unobserved;

use crate::scenes::{case_of, constraint, exact, largest_error, material, set};

const SHAPES: [CellShape; 3] = [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6];

fn wall(name: &str, normal: SlidingNormal) -> Sliding {
    Sliding { nodes: set(name), normal, segment: None }
}

/// The nodes of a set for which something holds, as a set of another name.
fn part(mesh: &mut VolumeMesh, of: &str, name: &str, holds: impl Fn(u32) -> bool) {
    let nodes = mesh.node_sets[of].iter().copied().filter(|&node| holds(node)).collect();
    mesh.node_sets.insert(name.to_owned(), nodes);
}

/// A block on a floor, moved along it by 1.5 mm at one end: bent about the y axis with a radius of 20 mm at the floor, or straight.
/// The floor is the set `floor`; its halves `left` and `right` share the row in the middle.
fn on_floor(shape: CellShape, bent: bool, walls: Vec<Sliding>) -> (Case, Plan) {
    let mut mesh = block(Vector::new(1.0, 1.0, 1.0), [8, 2, 2], shape);
    let flat = mesh.nodes.clone();
    for node in &mut mesh.nodes {
        let (angle, radius) = (2.0 * (node.x - 0.5), 20.0 + 10.0 * node.z);
        *node = match bent {
            true => Vector::new(radius * angle.sin(), 20.0 * node.y, radius * angle.cos()),
            false => Vector::new(40.0 * node.x, 20.0 * node.y, 10.0 * node.z),
        };
    }
    part(&mut mesh, "z_min", "floor", |_| true);
    part(&mut mesh, "z_min", "left", |node| flat[node as usize].x < 0.5 + 1e-9);
    part(&mut mesh, "z_min", "right", |node| flat[node as usize].x > 0.5 - 1e-9);
    let mut case = case_of(mesh, material(15.0, 0.45));
    case.fixed = vec![set("x_max")];
    case.segments = vec![CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") }];
    case.sliding = walls;
    let turn = if bent { Vector::new(0.0, 0.075, 0.0) } else { Vector::zeros() };
    let shift = if bent { Vector::zeros() } else { Vector::x() * 1.5 };
    let movement = RigidMovement::about_pivot(turn, Vector::zeros(), shift);
    let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
    (case, Plan { segments, ..Plan::default() })
}

fn displacement((case, plan): &(Case, Plan)) -> (Vec<Vector>, Vec<String>) {
    let scene = Scene::new(case, plan, &exact()).unwrap();
    let codes = scene.warnings.iter().map(|warning| warning.code.to_string()).collect();
    (scene.solve(&Unobserved).unwrap().displacement, codes)
}

fn largest_difference(one: &[Vector], other: &[Vector]) -> f64 {
    one.iter().zip(other).map(|(u, v)| (u - v).norm()).fold(0.0, f64::max)
}

#[test]
fn a_curved_wall_slides_alike_in_one_set_and_in_two_that_share_a_row() {
    let surface = |name| wall(name, SlidingNormal::Surface);
    for shape in SHAPES {
        let (one, _) = displacement(&on_floor(shape, true, vec![surface("floor")]));
        let two = on_floor(shape, true, vec![surface("left"), surface("right")]);
        let (two, codes) = displacement(&two);
        assert!(largest_difference(&one, &two) < 1e-9, "{shape:?}");
        assert!(!codes.iter().any(|code| code == "walls-nearly-parallel"), "{codes:?}");
    }
}

#[test]
fn directions_that_differ_by_rounding_hold_a_row_once_and_by_twenty_degrees_are_told() {
    let given =
        |name, slope: f64| wall(name, SlidingNormal::Direction(Vector::new(slope, 0.0, 1.0)));
    let surface = |name| wall(name, SlidingNormal::Surface);
    let (one, _) = displacement(&on_floor(CellShape::Hex8, false, vec![surface("floor")]));
    for walls in
        [vec![given("left", 0.0), given("right", 1e-4)], vec![surface("right"), given("left", 0.0)]]
    {
        let (two, codes) = displacement(&on_floor(CellShape::Hex8, false, walls));
        let difference = largest_difference(&one, &two);
        assert!(difference < 1e-3, "{difference}");
        assert!(!codes.iter().any(|code| code == "walls-nearly-parallel"), "{codes:?}");
    }
    let apart = vec![given("left", 0.0), given("right", 20.0_f64.to_radians().tan())];
    let (held, codes) = displacement(&on_floor(CellShape::Hex8, false, apart));
    assert!(codes.iter().any(|code| code == "walls-nearly-parallel"), "{codes:?}");
    assert!(largest_difference(&one, &held) > 0.1);
}

/// A prism whose sides meet at an angle and at what is left of 180 degrees, all sides one set or four, pressed by 5 %: u = -.05 z e_z.
#[test]
fn tissue_stays_between_walls_that_meet_at_any_angle_in_one_set_or_several() {
    for (shape, degrees) in
        SHAPES.into_iter().flat_map(|shape| [20.0, 40.0, 60.0].map(|a| (shape, a)))
    {
        let mut mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 3, 2], shape);
        let angle = f64::to_radians(degrees);
        for node in &mut mesh.nodes {
            *node = Vector::new(node.x + node.y * angle.cos(), node.y * angle.sin(), node.z);
        }
        let sides = ["x_min", "x_max", "y_min", "y_max"].map(|name| mesh.node_sets[name].clone());
        let sides: BTreeSet<u32> = sides.into_iter().flatten().collect();
        mesh.node_sets.insert("sides".to_owned(), sides.into_iter().collect());
        let mut case = case_of(mesh, material(15.0, 0.3));
        let below = SlidingNormal::Direction(-Vector::z());
        let four = ["x_min", "x_max", "y_min", "y_max"];
        for sides in [&["sides"][..], &four] {
            let surface = |name: &&str| wall(name, SlidingNormal::Surface);
            case.sliding = sides.iter().map(surface).collect();
            case.sliding.push(wall("z_min", below.clone()));
            let lid = constraint("z_max", [None, None, Some(-0.5)]);
            let plan = Plan { prescribed: vec![lid], ..Plan::default() };
            let scene = Scene::new(&case, &plan, &exact()).unwrap();
            assert!(scene.warnings.iter().all(|warning| warning.code != "walls-nearly-parallel"));
            let answer = scene.solve(&Unobserved).unwrap();
            let field = |x: &Vector| Vector::z() * (-0.05 * x.z);
            let error = largest_error(&case.volume, &answer.displacement, field);
            assert!(error < 1e-9, "{shape:?} {degrees} degrees, {sides:?}: {error:e}");
        }
    }
}
