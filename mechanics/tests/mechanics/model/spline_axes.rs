//! Volume splines with degrees and control points of their own along each axis, and with control points of bone.

use mechanics::mesh::half_head::half_head;
use mechanics::mesh::{CellShape, Cells, Vector, VolumeMesh, sample};
use mechanics::model::spline::lattice::Lattice;
use mechanics::model::spline::tissue_points::tissue_points;
use mechanics::model::spline::{Bone, ControlPoints, Stiffness, VolumeSpline};
use mechanics::prediction::{Case, Plan, Prediction};
use nalgebra::Matrix3;

use super::spline_volume::with;
use crate::scenes::{case_of, constraint, material, set, solve};

/// Tissue of 20 x 15 x 2 mm, as Ulusoy et al. 2010 fit it: 5 x 5 x 2 control points, linear through the thickness.
fn thin() -> Case {
    let mut mesh = sample::block(Vector::new(20.0, 15.0, 2.0), [10, 8, 2], CellShape::Hex8);
    let bottom = mesh.node_sets["z_min"].clone();
    let half = |first: bool| {
        let is_in = |node: &&u32| (mesh.nodes[**node as usize].x < 9.0) == first;
        bottom.iter().filter(is_in).copied().collect::<Vec<u32>>()
    };
    let (jaw, rest) = (half(true), half(false));
    mesh.node_sets.insert("jaw".to_owned(), jaw);
    mesh.node_sets.insert("rest".to_owned(), rest);
    Case { allow_unfixed: true, ..case_of(mesh, material(15.0, 0.3)) }
}

fn of_the_paper(bone: Bone) -> VolumeSpline {
    let control = ControlPoints::Counted([5, 5, 2]);
    VolumeSpline { degrees: [3, 3, 1], control, bone, ..VolumeSpline::default() }
}

fn prescribed(constraints: &[(&str, Vector)]) -> Plan {
    let all =
        constraints.iter().map(|(name, u)| constraint(name, [Some(u.x), Some(u.y), Some(u.z)]));
    Plan { prescribed: all.collect(), ..Plan::default() }
}

#[test]
fn fifty_control_points_stand_where_the_paper_has_them_and_carry_affine_maps() {
    let mesh = thin().volume;
    let points = tissue_points(&mesh).unwrap();
    let counted =
        |degrees, counts| Lattice::fit(&mesh, &points, degrees, ControlPoints::Counted(counts));
    let lattice = counted([3, 3, 1], [5, 5, 2]);
    assert_eq!((lattice.points.len(), lattice.orders(), lattice.members()), (50, [4, 4, 2], 32));
    // Clamped cubics with one knot inside, and the two faces.
    let greville = |axis: usize| lattice.bases[axis].greville();
    for (found, exact) in greville(0).iter().zip([-10.0, -20.0 / 3.0, 0.0, 20.0 / 3.0, 10.0]) {
        assert!((found - exact).abs() < 1e-12);
    }
    assert!((greville(2)[0] + 1.0).abs() < 1e-12 && (greville(2)[1] - 1.0).abs() < 1e-12);
    let map = Matrix3::new(0.01, 0.02, -0.01, 0.005, -0.02, 0.03, 0.015, -0.01, 0.01);
    for (degrees, counts) in
        [([3, 3, 1], [5, 5, 2]), ([1, 2, 3], [4, 6, 5]), ([2, 1, 1], [3, 2, 4])]
    {
        let lattice = counted(degrees, counts);
        assert_eq!(lattice.points.len(), counts.iter().product::<usize>());
        let control: Vec<Vector> = lattice.points.iter().map(|x| map * x).collect();
        for node in &mesh.nodes {
            let local = lattice.frame.local(node);
            let u = lattice.displacement(&lattice.place(&local).unwrap(), &control);
            assert!((u - map * local).norm() < 1e-13, "{degrees:?}");
        }
    }
}

#[test]
fn control_points_of_bone_move_all_tissue_as_they_move() {
    let case = thin();
    let largest = |answer: &Prediction, field: &dyn Fn(&Vector) -> Vector| {
        let pairs = case.volume.nodes.iter().zip(&answer.displacement);
        pairs.map(|(x, u)| (u - field(x)).norm()).fold(0.0, f64::max)
    };
    let shift = Vector::new(3.0, -1.0, 2.0);
    let moved = prescribed(&[("jaw", shift), ("rest", shift)]);
    let pressed = prescribed(&[("z_min", Vector::zeros()), ("z_max", Vector::new(0.0, 0.0, -0.2))]);
    for stiffness in [Stiffness::Galerkin, Stiffness::Lattice(80.0)] {
        let settings = with(VolumeSpline { stiffness, ..of_the_paper(Bone::ControlPoints) });
        let answer = solve(&case, &moved, &settings);
        assert!(largest(&answer, &|_| shift) < 1e-9, "{stiffness:?}");
        assert!(answer.warnings.iter().all(|warning| warning.code != "held-nodes-missed"));
        // Both layers are bone: linear between them.
        let answer = solve(&case, &pressed, &settings);
        let linear = |x: &Vector| Vector::new(0.0, 0.0, -0.1 * x.z);
        assert!(largest(&answer, &linear) < 1e-12, "{stiffness:?}");
    }
    let answer = solve(&case, &pressed, &with(of_the_paper(Bone::ControlPoints)));
    let force = answer.reactions["prescribed"];
    assert!(force.norm() < 1e-8, "both faces balance: {force}");
    assert_eq!(answer.elements, ["B-spline degree 3 x 3 x 1 galerkin, control points of bone"]);
}

/// K_ff C_f = -K_fb C_b leaves the free control points in balance, and the forces of bone add up to nothing.
#[test]
fn bone_pulls_as_much_as_it_is_pulled_and_springs_of_great_weight_come_near_to_it() {
    let mut case = thin();
    case.fixed.push(set("rest"));
    let plan = prescribed(&[("jaw", Vector::new(0.0, 0.0, 0.5))]);
    let answer = |spline: VolumeSpline| solve(&case, &plan, &with(spline));
    let bone = answer(of_the_paper(Bone::ControlPoints));
    let (jaw, rest) = (bone.reactions["prescribed"], bone.reactions["fixed"]);
    assert!(jaw.z > 0.1 && (jaw + rest).norm() < 1e-8 * jaw.norm(), "{jaw} {rest}");
    // What is stretched moves between what stays and what is moved, the skin above the jaw with it.
    let lift = |answer: &Prediction, x: f64| {
        let at = |node: &&u32| {
            let place = &case.volume.nodes[**node as usize];
            (place.x - x).abs() < 0.1 && (place.y - 7.5).abs() < 0.1
        };
        let node = case.volume.node_sets["z_max"].iter().find(at).unwrap();
        answer.displacement[*node as usize].z
    };
    assert!(lift(&bone, 2.0) > 0.4 && lift(&bone, 18.0).abs() < 0.1, "{}", lift(&bone, 18.0));
    // Control points 4 mm apart miss nodes beside the step, springs too; on the skin both say much the same.
    let springs = answer(VolumeSpline { hold_weight: 1e4, ..of_the_paper(Bone::Springs) });
    for x in [2.0, 18.0] {
        let (one, other) = (lift(&bone, x), lift(&springs, x));
        assert!((one - other).abs() < 0.1, "{x}: {one} {other}");
    }
    assert!(bone.warnings.iter().any(|warning| warning.code == "held-nodes-missed"));
}

#[test]
fn degree_one_through_the_depth_of_a_curved_head_is_solved_and_keeps_rigid_movements() {
    let case = Case {
        skin: Some(set("skin")),
        fixed: vec![set("rim")],
        allow_unfixed: true,
        ..case_of(half_head(1).mesh, material(15.0, 0.4))
    };
    let shift = Vector::new(1.0, 2.0, -1.0);
    let plan = prescribed(&[("skull", shift), ("rim", shift)]);
    let spline = VolumeSpline {
        degrees: [3, 2, 1],
        control: ControlPoints::Counted([8, 7, 6]),
        ..VolumeSpline::default()
    };
    let answer = solve(&case, &plan, &with(spline));
    let off = answer.displacement.iter().map(|u| (u - shift).norm()).fold(0.0, f64::max);
    assert!(off < 1e-5, "{off}");
}

/// Nodes of a regular mesh lie in the middle between control points, and rounding must not choose one.
#[test]
fn held_nodes_between_control_points_move_them_alike_wherever_the_scene_is_and_however_it_is_numbered()
 {
    let spline = VolumeSpline {
        degrees: [1, 1, 1],
        control: ControlPoints::Counted([7, 6, 3]),
        bone: Bone::ControlPoints,
        ..VolumeSpline::default()
    };
    let mesh = || {
        let mut mesh = sample::block(Vector::new(48.0, 40.0, 20.0), [12, 10, 4], CellShape::Hex8);
        let bottom = mesh.node_sets["z_min"].clone();
        let is_jaw = |node: &u32| mesh.nodes[*node as usize].x < 21.0;
        let (jaw, rest) = bottom.into_iter().partition(is_jaw);
        mesh.node_sets.insert("jaw".to_owned(), jaw);
        mesh.node_sets.insert("rest".to_owned(), rest);
        mesh
    };
    let plan = prescribed(&[("jaw", Vector::new(3.0, 0.0, 2.0)), ("rest", Vector::zeros())]);
    let answer = |mesh: VolumeMesh| {
        let case = case_of(mesh, material(15.0, 0.4));
        solve(&case, &plan, &with(spline.clone())).displacement
    };
    let here = answer(mesh());
    let mut elsewhere = mesh();
    elsewhere.nodes.iter_mut().for_each(|x| *x += Vector::new(123.4567, -56.7891, 89.1234));
    let last = mesh().nodes.len() as u32 - 1;
    let mut reversed = mesh();
    reversed.nodes.reverse();
    let mut cells = Cells::default();
    for (shape, nodes) in mesh().cells.iter() {
        let nodes: Vec<u32> = nodes.iter().map(|node| last - node).collect();
        cells.push(shape, &nodes);
    }
    reversed.cells = cells;
    for nodes in reversed.node_sets.values_mut() {
        nodes.iter_mut().for_each(|node| *node = last - *node);
        nodes.sort_unstable();
    }
    let mut renumbered = answer(reversed);
    renumbered.reverse();
    for (name, there) in [("elsewhere", answer(elsewhere)), ("renumbered", renumbered)] {
        let apart = here.iter().zip(&there).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-6, "{name}: {apart} mm");
    }
    // The scene is the same from both sides of its middle along y.
    let at = |y: f64| {
        let near = |x: &Vector| (x - Vector::new(24.0, y, 20.0)).norm() < 1e-6;
        here[mesh().nodes.iter().position(near).unwrap()]
    };
    let apart = (at(12.0).z - at(28.0).z).abs();
    assert!(apart < 1e-6 && at(20.0).z > 0.1, "{apart} {}", at(20.0));
}
