//! docs/verification.md#v36: the warp that keeps thickness.

use mechanics::mesh::{CellShape, Vector, VolumeMesh, sample};
use mechanics::model::spline::VolumeSpline;
use mechanics::model::thickness_warp::ThicknessWarp;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Load, Method, ModelError, Plan, Prediction, Scene, Settings,
    Sliding, SlidingNormal, predict,
};
use mechanics::progress::Unobserved;

use crate::prediction::elements::slab;
use crate::scenes::{SHAPES, case_of, constraint, material, set, solve};

fn with(blend_radius: f64) -> Settings {
    let method = Method::ThicknessWarp(ThicknessWarp { blend_radius });
    Settings { method, ..Settings::default() }
}

/// A slab on two bones: `left` up to x = 20 mm, `right` from 30 mm on, its right end fixed nowhere.
fn two_bones(shape: CellShape) -> Case {
    two_bones_from(shape, 30.0)
}

/// The same with `right` from another place on.
fn two_bones_from(shape: CellShape, right: f64) -> Case {
    let mut mesh = sample::block(Vector::new(60.0, 30.0, 12.0), [12, 6, 4], shape);
    let bottom = mesh.node_sets["z_min"].clone();
    let within = |mesh: &VolumeMesh, low: f64, high: f64| -> Vec<u32> {
        let inside = |node: &&u32| (low..=high).contains(&mesh.nodes[**node as usize].x);
        bottom.iter().filter(inside).copied().collect()
    };
    for (name, low, high) in [("left", -0.1, 20.1), ("right", right - 0.1, 60.1)] {
        let nodes = within(&mesh, low, high);
        mesh.node_sets.insert(name.to_owned(), nodes);
    }
    Case {
        skin: Some(set("z_max")),
        segments: vec![CaseSegment { name: "left".to_owned(), nodes: set("left") }],
        fixed: vec![set("right")],
        ..case_of(mesh, material(15.0, 0.46))
    }
}

fn turned() -> RigidMovement {
    let angles = Vector::new(0.1, -0.2, 0.3);
    RigidMovement::about_pivot(angles, Vector::new(10.0, 15.0, 0.0), Vector::new(1.0, -2.0, 3.0))
}

fn plan(movement: RigidMovement) -> Plan {
    let segments = vec![PlannedSegment { name: "left".to_owned(), movement }];
    Plan { segments, ..Plan::default() }
}

fn by(translation: Vector) -> RigidMovement {
    RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), translation)
}

fn warning<'a>(answer: &'a Prediction, code: &str) -> Option<&'a mechanics::mesh::Warning> {
    answer.warnings.iter().find(|warning| warning.code == code)
}

fn told(answer: &Prediction, code: &str, name: &str) -> f64 {
    let numbers = &warning(answer, code).unwrap().numbers;
    numbers.iter().find(|(other, _)| *other == name).unwrap().1
}

#[test]
fn a_bone_plane_that_moves_3_mm_along_its_normal_moves_the_skin_by_3_mm() {
    for shape in SHAPES {
        let mesh = sample::block(Vector::new(30.0, 20.0, 12.0), [6, 4, 3], shape);
        let segments = vec![CaseSegment { name: "bone".to_owned(), nodes: set("z_min") }];
        let tissue = case_of(mesh, material(15.0, 0.46));
        let case = Case { segments, allow_unfixed: true, ..tissue };
        let movement = by(Vector::z() * 3.0);
        let segments = vec![PlannedSegment { name: "bone".to_owned(), movement }];
        let answer = solve(&case, &Plan { segments, ..Plan::default() }, &with(0.0));
        for u in &answer.displacement {
            assert!((u - Vector::z() * 3.0).norm() < 1e-12);
        }
        // No jump, as there is one bone.
        assert_eq!(warning(&answer, "warp-jumps"), None);
        assert_eq!((answer.solver.method, answer.solver.unknowns), ("none", 0));
        assert!(answer.elements.is_empty());
    }
}

#[test]
fn tissue_moves_exactly_with_the_bone_it_lies_on_and_keeps_its_thickness() {
    for shape in SHAPES {
        let case = two_bones(shape);
        let answer = solve(&case, &plan(turned()), &with(0.0));
        // Half way between the bones is x = 25 mm.
        for (x, u) in case.volume.nodes.iter().zip(&answer.displacement) {
            let expected = match x.x < 24.9 {
                true => turned().displacement(x),
                false if x.x > 25.1 => Vector::zeros(),
                false => continue,
            };
            assert!((u - expected).norm() < 1e-9, "{x}: {u} and not {expected}");
            let bone = Vector::new(x.x.min(20.0), x.y, 0.0);
            if x.x < 24.9 {
                let thickness = (x + u - turned().apply(&bone)).norm();
                assert!((thickness - (x - bone).norm()).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn a_point_as_near_to_two_bones_takes_the_mean_of_their_movements_wherever_the_scene_lies() {
    for shift in [Vector::zeros(), Vector::new(500.1, -300.7, 200.3)] {
        for shape in SHAPES {
            let mut case = two_bones(shape);
            let mesh = std::sync::Arc::make_mut(&mut case.volume);
            let between: Vec<bool> = mesh.nodes.iter().map(|x| (x.x - 25.0).abs() < 1e-9).collect();
            mesh.nodes.iter_mut().for_each(|x| *x += shift);
            let lifted = solve(&case, &plan(by(Vector::z() * 8.0)), &with(0.0)).displacement;
            let taken: Vec<Vector> =
                lifted.into_iter().zip(between).filter(|own| own.1).map(|own| own.0).collect();
            assert_eq!(taken.len(), 35);
            assert!(taken.iter().all(|u| (u - Vector::z() * 4.0).norm() < 1e-12), "{taken:?}");
        }
    }
}

/// A floor that moves beside a wall that does not: of the lowest faces of the wall two nodes belong to the floor.
#[test]
fn tissue_before_a_face_between_two_bones_goes_with_the_bone_whose_nodes_are_nearest() {
    for shape in SHAPES {
        let mut mesh = sample::block(Vector::new(40.0, 40.0, 40.0), [4, 4, 4], shape);
        let floor = &mesh.node_sets["z_min"];
        let wall = mesh.node_sets["y_min"].iter().filter(|node| !floor.contains(node)).copied();
        let wall = wall.collect();
        let inner = mesh.nodes.iter().position(|x| *x == Vector::new(20.0, 10.0, 10.0)).unwrap();
        mesh.node_sets.insert("wall".to_owned(), wall);
        for (y, z, follows_floor) in
            [(3.0, 10.0, false), (3.0, 9.0, false), (3.0, 7.0, false), (9.0, 6.0, true)]
        {
            let mut mesh = mesh.clone();
            mesh.nodes[inner] = Vector::new(20.0, y, z);
            let segments = vec![CaseSegment { name: "left".to_owned(), nodes: set("z_min") }];
            let fixed = vec![set("wall")];
            let case = Case { segments, fixed, ..case_of(mesh, material(15.0, 0.46)) };
            let answer = solve(&case, &plan(by(Vector::x() * 5.0)), &with(0.0));
            let wanted = if follows_floor { 5.0 } else { 0.0 };
            let taken = answer.displacement[inner];
            assert!((taken - Vector::x() * wanted).norm() < 1e-12, "{shape:?} {y} {z}: {taken}");
        }
    }
}

#[test]
fn nothing_moves_where_the_plan_moves_nothing() {
    let answer = solve(&two_bones(CellShape::Tet4), &plan(RigidMovement::default()), &with(10.0));
    assert!(answer.displacement.iter().all(|u| *u == Vector::zeros()));
}

#[test]
fn prescribed_bone_carries_tissue_by_its_own_displacement() {
    let (case, plan) = slab(6.0, 0.46);
    let answer = solve(&case, &plan, &with(0.0));
    let moved = Vector::new(4.0, 0.0, 8.0);
    for (x, u) in case.volume.nodes.iter().zip(&answer.displacement) {
        if x.x.abs() < 12.1 && x.y < 12.1 {
            assert!((u - moved).norm() < 1e-12, "{x}: {u}");
        } else if x.x.abs() > 23.9 || x.y > 23.9 {
            assert!(u.norm() < 1e-12, "{x}: {u}");
        }
    }
    // The symmetry plane is prescribed in y alone, but for 9 of its 33 nodes, which are on bone.
    assert_eq!(told(&answer, "conditions-ignored", "partly_prescribed_nodes"), 24.0);
}

#[test]
fn a_blend_radius_softens_the_jump_between_bones() {
    // Half way between the bones there is no node.
    let case = two_bones_from(CellShape::Hex8, 35.0);
    let lifted = plan(by(Vector::z() * 8.0));
    let jump = |radius| told(&solve(&case, &lifted, &with(radius)), "warp-jumps", "largest_mm");
    let (sharp, soft) = (jump(0.0), jump(20.0));
    assert!((sharp - 8.0).abs() < 1e-12, "{sharp}");
    // 5 mm from one bone and 10 mm from the other the farther one weighs 9/16 of the nearer one.
    assert!((soft - 8.0 * (1.0 - 0.5625) / 1.5625).abs() < 1e-12, "{soft}");
    // What touches bone goes with it, whatever the radius.
    let answer = solve(&case, &lifted, &with(20.0));
    for &node in &case.volume.node_sets["left"] {
        assert_eq!(answer.displacement[node as usize], Vector::z() * 8.0);
    }
}

#[test]
fn what_a_warp_ignores_is_reported_and_what_it_cannot_do_is_refused() {
    let mut case = two_bones(CellShape::Tet4);
    let before = solve(&case, &plan(turned()), &with(0.0));
    let sliding = Sliding { nodes: set("y_min"), normal: SlidingNormal::Surface, segment: None };
    case.sliding.push(sliding);
    case.materials.insert("*".to_owned(), material(300.0, 0.2));
    let after = solve(&case, &plan(turned()), &with(0.0));
    assert_eq!(before.displacement, after.displacement);
    assert!(told(&after, "conditions-ignored", "sliding_nodes") > 20.0);

    let pressed = Plan {
        loads: vec![Load::Pressure { faces: set("z_max"), pressure: 1.0 }],
        ..plan(turned())
    };
    let refused = Scene::new(&case, &pressed, &with(0.0)).err().unwrap();
    let found: Vec<_> = refused.0.iter().map(|p| (p.pointer.as_str(), p.code.name())).collect();
    assert_eq!(found, [("/plan/loads", "method-not-available")]);
}

#[test]
fn an_element_asked_of_a_method_without_elements_is_refused() {
    for method in [with(0.0).method, Method::VolumeSpline(VolumeSpline::default())] {
        let settings = Settings { method, element: ElementChoice::Plain, ..Settings::default() };
        let refused = Scene::new(&two_bones(CellShape::Tet4), &plan(turned()), &settings).err();
        let errors = refused.unwrap().0;
        let found: Vec<_> = errors.iter().map(|p| (p.pointer.as_str(), p.code.name())).collect();
        assert_eq!(found, [("/spec/element", "method-not-available")]);
    }
}

#[test]
fn tissue_without_a_face_on_bone_is_refused() {
    let mut mesh = sample::block(Vector::new(30.0, 20.0, 12.0), [6, 4, 3], CellShape::Hex8);
    mesh.node_sets.insert("pins".to_owned(), vec![0, 6, 34]);
    let case = Case { allow_unfixed: true, ..case_of(mesh, material(15.0, 0.46)) };
    let prescribed = vec![constraint("pins", [Some(1.0); 3])];
    let scene = Scene::new(&case, &Plan { prescribed, ..Plan::default() }, &with(0.0)).unwrap();
    assert!(matches!(predict(&scene, &Unobserved), Err(ModelError::NoBone)));
}

#[test]
fn held_nodes_that_bound_no_bone_face_are_reported() {
    let mut case = two_bones(CellShape::Tet4);
    let mesh = std::sync::Arc::make_mut(&mut case.volume);
    let corner = mesh.node_sets["z_max"][0];
    mesh.node_sets.insert("pin".to_owned(), vec![corner]);
    case.fixed.push(set("pin"));
    let answer = solve(&case, &plan(turned()), &with(0.0));
    assert_eq!(told(&answer, "held-off-bone", "nodes"), 1.0);
    assert_eq!(answer.displacement[corner as usize], Vector::zeros());
}

#[test]
fn a_turned_scene_has_the_turned_warp_and_threads_change_no_bit() {
    let mut case = two_bones(CellShape::Tet4);
    let straight = solve(&case, &plan(turned()), &with(7.0)).displacement;
    let on = |threads: usize, case: &Case| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(case, &plan(turned()), &with(7.0)).displacement)
    };
    assert!([1, 2, 3].iter().all(|&threads| on(threads, &case) == straight));
    let around = RigidMovement::about_pivot(
        Vector::new(1.0, 0.4, -0.7),
        Vector::zeros(),
        Vector::new(5.0, -60.0, 9.0),
    );
    let mesh = std::sync::Arc::make_mut(&mut case.volume);
    mesh.nodes.iter_mut().for_each(|x| *x = around.apply(x));
    let movement = around.inverse().then(&turned()).then(&around);
    let turned = solve(&case, &plan(movement), &with(7.0)).displacement;
    for (u, v) in turned.iter().zip(&straight) {
        assert!((u - around.rotation() * v).norm() < 1e-8);
    }
}
