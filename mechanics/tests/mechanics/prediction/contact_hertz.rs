//! Contact against Hertz and his successors: a ball and a plane, two balls, a flat punch.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, TriangleSurface, Vector, VolumeMesh};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Bone, Case, CaseSegment, Method, Plan, Prediction, Prescribed, Settings, Touch,
};

use super::contact::{together, unilateral};
use super::contact_of_simple_bones::cylinder;
use crate::scenes::{case_of, constraint, material, set, solve};

/// Places from 0, evenly up to `fine_to` and then each cell longer than the last.
fn graded(fine_to: f64, fine: f64, growth: f64, end: f64) -> Vec<f64> {
    let mut places: Vec<f64> =
        (0..=(fine_to / fine).round() as usize).map(|i| i as f64 * fine).collect();
    let mut step = fine;
    while *places.last().unwrap() < end {
        step *= growth;
        places.push(places.last().unwrap() + step);
    }
    places
}

/// A block with nodes at the products of places.
fn at_places(x: &[f64], y: &[f64], z: &[f64]) -> VolumeMesh {
    let cells = [x.len() - 1, y.len() - 1, z.len() - 1];
    let size = Vector::from(cells.map(|cells| cells as f64));
    let mut mesh = block(size, cells, CellShape::Hex8);
    let place = |places: &[f64], at: f64| places[at.round() as usize];
    for node in &mut mesh.nodes {
        *node = Vector::new(place(x, node.x), place(y, node.y), place(z, node.z));
    }
    mesh
}

/// Displacement in mm of a half space below z = 0 under a force in mN down at the origin (Boussinesq 1885; Johnson, Contact
/// Mechanics, equations 3.18).
fn boussinesq(force: f64, young: f64, nu: f64, x: &Vector) -> Vector {
    let shear = young / (2.0 * (1.0 + nu));
    let (r, depth) = (x.norm(), -x.z);
    let factor = force / (4.0 * std::f64::consts::PI * shear);
    let across = factor * (depth / r.powi(3) - (1.0 - 2.0 * nu) / (r * (r + depth)));
    let down = factor * (depth * depth / r.powi(3) + 2.0 * (1.0 - nu) / r);
    Vector::new(across * x.x, across * x.y, -down)
}

/// A quarter of a half space, far from the contact moved as a force at its surface would, under a ball of 10 mm.
fn ball_on_half_space(force: f64, young: f64, nu: f64) -> Case {
    const RADIUS: f64 = 10.0;
    let fine = graded(2.75, 0.25, 1.28, 25.0);
    let depth: Vec<f64> = fine.iter().rev().map(|z| -z).collect();
    let half_space = at_places(&fine, &fine, &depth);
    let ball: Vec<f64> = (0..=28).map(|i| 0.125 * f64::from(i)).collect();
    let mut ball = at_places(&ball, &ball, &[0.0, 1.0]);
    for node in &mut ball.nodes {
        let down = (RADIUS * RADIUS - node.x * node.x - node.y * node.y).sqrt();
        node.z += RADIUS - down;
    }
    let mut mesh = together(&[("half", half_space), ("ball", ball)]);
    let outer = |node: &Vector| {
        if node.norm() > 20.0 { boussinesq(force, young, nu, node) } else { Vector::zeros() }
    };
    mesh.node_vectors.insert("outer".to_owned(), mesh.nodes.iter().map(outer).collect());
    let sides = ["half/x_max", "half/y_max", "half/z_min"];
    let mut far: Vec<u32> = sides.iter().flat_map(|set| mesh.node_sets[*set].clone()).collect();
    far.sort_unstable();
    far.dedup();
    for (plane, side) in [("x_plane", "half/x_min"), ("y_plane", "half/y_min")] {
        let nodes = mesh.node_sets[side].iter().copied();
        let nodes = nodes.filter(|node| far.binary_search(node).is_err()).collect();
        mesh.node_sets.insert(plane.to_owned(), nodes);
    }
    mesh.node_sets.insert("far".to_owned(), far);
    Case {
        segments: vec![CaseSegment { name: "ball".to_owned(), nodes: set("ball") }],
        skin: Some(set("half/z_max")),
        ..case_of(mesh, material(young, nu))
    }
}

/// p0 and a of p^2 = p0^2 (1 - r^2 / a^2), by least squares over pairs of r^2 and p^2.
fn hertz_of(pairs: &[(f64, f64)]) -> [f64; 2] {
    let count = pairs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let slope = pairs.iter().map(|(x, y)| (x - mx) * (y - my)).sum::<f64>()
        / pairs.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>();
    let p0 = (my - slope * mx).sqrt();
    [p0, p0 / (-slope).sqrt()]
}

/// The answer for the ball, which goes down by so many mm while what is far is moved as by a force in mN.
fn pressed_ball(force: f64, by: f64) -> (Case, Prediction) {
    let case = ball_on_half_space(force, 15.0, 0.49);
    let down = Vector::new(0.0, 0.0, -by);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), down);
    let plan = Plan {
        segments: vec![PlannedSegment { name: "ball".to_owned(), movement }],
        ..in_quarters(["x_plane", "y_plane"])
    };
    let found = solve(&case, &plan, &unilateral());
    (case, found)
}

/// What is far where its array says, and planes of symmetry.
fn in_quarters([x_plane, y_plane]: [&str; 2]) -> Plan {
    Plan {
        prescribed: vec![
            Prescribed::FromArray { nodes: set("far"), array: "outer".to_owned() },
            constraint(x_plane, [Some(0.0), None, None]),
            constraint(y_plane, [None, Some(0.0), None]),
        ],
        ..Plan::default()
    }
}

/// p0 and a of the pressures within .8 of a radius of some nodes, `r2` their distance squared.
fn fitted(found: &Prediction, nodes: &[u32], radius: f64, r2: impl Fn(u32) -> f64) -> [f64; 2] {
    let touch = found.contact.as_ref().unwrap();
    let at = |&node: &u32| (r2(node), touch.pressure[node as usize].powi(2));
    let inner = nodes.iter().map(at).filter(|&(r2, p2)| p2 > 0.0 && r2 < (0.8 * radius).powi(2));
    hertz_of(&inner.collect::<Vec<_>>())
}

/// A rigid ball of 10 mm pressed .386519 mm into a half space: 20 mN, a = 1.96601 mm, p0 = 2.470589 kPa, 2.13959 kPa at a/2, the
/// surface .0842594 mm deep at 2 a, 77.6158 mN/mm more (Hertz 1882). Small strain is off by the order of (a / R)^2 / 2 = 2 %.
#[test]
fn a_ball_presses_on_a_half_space_as_hertz_says() {
    const DEPTH: f64 = 0.386519;
    let force = 20.0;
    let (case, found) = pressed_ball(force, DEPTH);
    let touch = found.contact.as_ref().unwrap();
    let pressed = -4.0 * force_of(touch);
    let top = &case.volume.node_sets["half/z_max"];
    let place = |node: u32| case.volume.nodes[node as usize];
    let [p0, a] = fitted(&found, top, 1.96601, |node| place(node).xy().norm_squared());
    let halfway = p0 * (1.0 - (0.5 * 1.96601 / a).powi(2)).sqrt();
    println!("{pressed} mN, p0 {p0}, a {a}, p(a/2) {halfway}");
    assert!((pressed / force - 1.0).abs() < 0.03, "{pressed}");
    assert!((p0 / 2.470589 - 1.0).abs() < 0.03, "{p0}");
    assert!((a / 1.96601 - 1.0).abs() < 0.03, "{a}");
    assert!((halfway / 2.13959 - 1.0).abs() < 0.03, "{halfway}");
    assert!(touch.contact.effort.changes <= 12, "{}", touch.contact.effort.changes);

    let along: Vec<u32> = top.iter().copied().filter(|&n| place(n).y < 1e-9).collect();
    let mut depths: Vec<[f64; 2]> =
        along.iter().map(|&n| [place(n).x, -found.displacement[n as usize].z]).collect();
    depths.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let beyond = depths.iter().position(|[x, _]| *x > 2.0 * 1.96601).unwrap();
    let [[x0, low], [x1, high]] = [depths[beyond - 1], depths[beyond]];
    let depth = low + (2.0 * 1.96601 - x0) / (x1 - x0) * (high - low);
    println!("{depth} mm deep at 2 a");
    assert!((depth / 0.0842594 - 1.0).abs() < 0.03, "{depth}");

    // The secant of the last tenth of the depth, beside that of F = d^1.5; the tangent at its end is 77.6158 mN/mm.
    let part = 0.9_f64;
    let (_, less) = pressed_ball(force * part.powf(1.5), part * DEPTH);
    let less = -4.0 * force_of(less.contact.as_ref().unwrap());
    let stiffness = (pressed - less) / (1.0 - part.powf(1.5)) * 1.5 / DEPTH;
    println!("{stiffness} mN/mm");
    assert!((stiffness / 77.6158 - 1.0).abs() < 0.05, "{stiffness}");
}

/// A quarter of a body that is a half space but for the cap of a ball of 10 mm, below its surface or above it.
fn capped(is_above: bool, force: f64) -> (VolumeMesh, Vec<Vector>) {
    let fine = graded(2.75, 0.25, 1.28, 25.0);
    let depth: Vec<f64> = match is_above {
        true => fine.clone(),
        false => fine.iter().rev().map(|z| -z).collect(),
    };
    let sign = if is_above { 1.0 } else { -1.0 };
    let mut mesh = at_places(&fine, &fine, &depth);
    let mirrored = |u: Vector| Vector::new(u.x, u.y, -sign * u.z);
    let far = |x: &Vector| match x.norm() > 20.0 {
        true => mirrored(boussinesq(force, 15.0, 0.49, &mirrored(*x))),
        false => Vector::zeros(),
    };
    let outer = mesh.nodes.iter().map(far).collect();
    for node in &mut mesh.nodes {
        node.z += sign * node.xy().norm().min(3.0).powi(2) / 20.0;
    }
    (mesh, outer)
}

/// Two balls of 10 mm: E* 9.86972 kPa and R* 5 mm have the radius and the pressure of one rigid ball, at twice the approach.
#[test]
fn two_balls_press_on_each_other_as_hertz_says() {
    let force = 20.0;
    let ((lower, below), (upper, above)) = (capped(false, force), capped(true, force));
    let mut mesh = together(&[("lower", lower), ("upper", upper)]);
    let approach = Vector::new(0.0, 0.0, -2.0 * 0.386519);
    let above = above.into_iter().map(|u| u + approach);
    mesh.node_vectors.insert("outer".to_owned(), below.into_iter().chain(above).collect());
    let of = |mesh: &VolumeMesh, sides: &[&str]| -> Vec<u32> {
        let mut nodes: Vec<u32> =
            sides.iter().flat_map(|set| mesh.node_sets[*set].clone()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    };
    let sides =
        ["lower/x_max", "lower/y_max", "lower/z_min", "upper/x_max", "upper/y_max", "upper/z_max"];
    let far = of(&mesh, &sides);
    for (plane, sides) in
        [("x_plane", ["lower/x_min", "upper/x_min"]), ("y_plane", ["lower/y_min", "upper/y_min"])]
    {
        let own = of(&mesh, &sides).into_iter().filter(|node| far.binary_search(node).is_err());
        let own = own.collect();
        mesh.node_sets.insert(plane.to_owned(), own);
    }
    mesh.node_sets.insert("far".to_owned(), far);
    let case = Case {
        skin: Some(set("lower/z_max")),
        allow_unfixed: true,
        ..case_of(mesh, material(15.0, 0.49))
    };
    let found = solve(&case, &in_quarters(["x_plane", "y_plane"]), &unilateral());
    let touch = found.contact.as_ref().unwrap();
    let lower = &case.volume.node_sets["lower"];
    let pressed = -4.0 * lower.iter().map(|&n| touch.contact.forces[n as usize].z).sum::<f64>();
    let top = &case.volume.node_sets["lower/z_max"];
    let place = |node: u32| case.volume.nodes[node as usize];
    let [p0, a] = fitted(&found, top, 1.96601, |node| place(node).xy().norm_squared());
    println!("two balls: {pressed} mN, p0 {p0}, a {a}");
    assert!((pressed / force - 1.0).abs() < 0.05, "{pressed}");
    assert!((p0 / 2.470589 - 1.0).abs() < 0.05, "{p0}");
    assert!((a / 1.96601 - 1.0).abs() < 0.05, "{a}");
}

/// A case whose tissue lies below a bone.
fn under(bone: TriangleSurface, mesh: VolumeMesh) -> Case {
    Case {
        bones: vec![Bone { name: "stamp".to_owned(), surface: "stamp".to_owned() }],
        surfaces: [("stamp".to_owned(), Arc::new(bone))].into(),
        skin: Some(set("z_max")),
        ..case_of(mesh, material(15.0, 0.49))
    }
}

/// A flat disc of 5 mm with a bottom at z = 0.
fn punch() -> TriangleSurface {
    const AROUND: u32 = 96;
    let mut points = vec![Vector::zeros(), Vector::new(0.0, 0.0, 5.0)];
    for step in 0..AROUND {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(AROUND);
        let at = |z: f64| Vector::new(5.0 * angle.cos(), 5.0 * angle.sin(), z);
        points.extend([at(0.0), at(5.0)]);
    }
    let side = |step: u32| {
        let next = (step + 1) % AROUND;
        let [low, high, on, above] = [2 + 2 * step, 3 + 2 * step, 2 + 2 * next, 3 + 2 * next];
        [[0, on, low], [1, high, above], [low, on, above], [low, above, high]]
    };
    TriangleSurface { points, triangles: (0..AROUND).flat_map(side).collect(), node_ids: None }
}

/// A flat punch of 5 mm meets 2 a E* = 197.3944 mN/mm. Its pressure has no bound at its edge: nodes half a millimetre apart are some per
/// cent too stiff.
#[test]
fn a_flat_punch_is_as_stiff_as_boussinesq_says() {
    const BY: f64 = 0.2;
    let fine = graded(6.5, 0.5, 1.25, 50.0);
    let depth: Vec<f64> = fine.iter().rev().map(|z| -z).collect();
    let mut mesh = at_places(&fine, &fine, &depth);
    let force = 197.3944 * BY;
    // The punch stays, and what is far is lifted.
    let outer = |x: &Vector| match x.norm() > 40.0 {
        true => boussinesq(force, 15.0, 0.49, x) + Vector::new(0.0, 0.0, BY),
        false => Vector::zeros(),
    };
    mesh.node_vectors.insert("outer".to_owned(), mesh.nodes.iter().map(outer).collect());
    let mut far: Vec<u32> =
        ["x_max", "y_max", "z_min"].iter().flat_map(|set| mesh.node_sets[*set].clone()).collect();
    far.sort_unstable();
    far.dedup();
    for side in ["x_min", "y_min"] {
        let own = mesh.node_sets.get_mut(side).unwrap();
        own.retain(|node| far.binary_search(node).is_err());
    }
    mesh.node_sets.insert("far".to_owned(), far);
    let case = under(punch(), mesh);
    let found = solve(&case, &in_quarters(["x_min", "y_min"]), &unilateral());
    let pressed = -4.0 * force_of(found.contact.as_ref().unwrap());
    println!("punch: {} mN/mm", pressed / BY);
    assert!((pressed / BY / 197.3944 - 1.0).abs() < 0.08, "{}", pressed / BY);
}

/// A cylinder of 10 mm and 96 facets pressed by .6 mm into half of a slab that is as wide as it is deep: whatever moves far away, its
/// force P for each mm has a^2 = 4 P R / (pi E*) and p0 = 2 P / (pi a), in plane strain (Hertz 1882; Johnson, Contact Mechanics,
/// equations 4.43 and 4.45).
#[test]
fn a_cylinder_presses_on_a_slab_as_hertz_says() {
    const THICK: f64 = 1.0;
    let fine = graded(3.5, 0.25, 1.28, 40.0);
    let depth: Vec<f64> = fine.iter().rev().map(|z| -z).collect();
    let mesh = at_places(&fine, &[0.0, THICK], &depth);
    let top = mesh.node_sets["z_max"].clone();
    let stamp = cylinder(10.0, 40.0, 96);
    let raised = stamp.points.iter().map(|x| x + Vector::new(0.0, 0.0, 10.0)).collect();
    let stamp = TriangleSurface { points: raised, ..stamp };
    let materials = BTreeMap::from([("*".to_owned(), material(15.0, 0.3))]);
    let case = Case { allow_unfixed: true, materials, ..under(stamp, mesh) };
    let plan = Plan {
        prescribed: vec![
            constraint("z_min", [None, None, Some(0.6)]),
            constraint("x_min", [Some(0.0), None, None]),
            constraint("y_min", [None, Some(0.0), None]),
            constraint("y_max", [None, Some(0.0), None]),
        ],
        ..Plan::default()
    };
    for method in [Method::FemLinear, Method::FemNonlinear] {
        let settings = Settings { method, relative_residual: 1e-7, ..unilateral() };
        let found = solve(&case, &plan, &settings);
        let force = -2.0 * force_of(found.contact.as_ref().unwrap()) / THICK;
        let plane = 15.0 / (1.0 - 0.3 * 0.3);
        let width = (4.0 * force * 10.0 / (std::f64::consts::PI * plane)).sqrt();
        let peak = 2.0 * force / (std::f64::consts::PI * width);
        let x2 = |node: u32| case.volume.nodes[node as usize].x.powi(2);
        let [p0, a] = fitted(&found, &top, width, x2);
        println!(
            "cylinder {:?}: {force} mN/mm, p0 {p0} of {peak}, a {a} of {width}",
            settings.method
        );
        assert!((p0 / peak - 1.0).abs() < 0.05, "{p0} {peak}");
        assert!((a / width - 1.0).abs() < 0.05, "{a} {width}");
    }
}

/// The force along z on the nodes that are not held.
fn force_of(touch: &Touch) -> f64 {
    touch.contact.pressed.iter().map(|pressed| pressed.force * pressed.row.terms[0].1.z).sum()
}
