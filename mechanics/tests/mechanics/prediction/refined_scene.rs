//! A scene on a locally refined mesh asks the same question as the one that it comes from.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::mesh::bisection::{Bisection, HALVES_EVERY_EDGE};
use mechanics::mesh::{CellShape, Vector, sample::block};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Activation, Case, CaseSegment, FibreDirection, Growth, Load, Muscle, MuscleCourse, NodeClass,
    Plan, Prescribed, RegionNames, Scene, Settings, Sliding, SlidingNormal, predict,
};
use mechanics::progress::Unobserved;

use crate::scenes::{case_of, constraint, exact, largest_error, material, on_the_boundary, set};

/// A block on a moving jaw, a wall that the jaw carries, a fixed side, gravity, traction and a force.
fn everything() -> (Case, Plan) {
    let mut mesh = block(Vector::new(6.0, 4.0, 2.0), [3, 2, 2], CellShape::Tet4);
    let nodes = 0..mesh.nodes.len() as u32;
    let where_ = |is_inside: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        nodes.clone().filter(|&n| is_inside(&mesh.nodes[n as usize])).collect()
    };
    let jaw = where_(&|x| x.z == 0.0 && x.x <= 2.0);
    let wall = where_(&|x| x.z == 0.0 && x.x >= 4.0);
    let pressed = where_(&|x| x.y == 0.0 && x.z > 0.0 && x.x < 6.0);
    let near = where_(&|x| x.z == 2.0 && x.x <= 2.0);
    mesh.node_sets.extend([("jaw".to_owned(), jaw), ("wall".to_owned(), wall)]);
    mesh.node_sets.extend([("pressed".to_owned(), pressed), ("near".to_owned(), near)]);
    mesh.cell_labels.insert("layer".into(), (0..mesh.cells.len() as i64).map(|c| c % 2).collect());
    let case = Case {
        skin: Some(set("z_max")),
        regions: Some(RegionNames { array: "layer".to_owned(), names: BTreeMap::new() }),
        muscles: vec![Muscle {
            name: "biceps".to_owned(),
            course: MuscleCourse::Region {
                region: "1".to_owned(),
                fibres: Some(FibreDirection::Uniform(Vector::new(1.0, 2.0, 0.5))),
            },
            tissue: None,
            stiffening: None,
        }],
        skin_regions: BTreeMap::from([("near".to_owned(), set("near"))]),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("jaw") }],
        fixed: vec![set("x_max")],
        sliding: vec![Sliding {
            nodes: set("wall"),
            normal: SlidingNormal::Surface,
            segment: Some("jaw".to_owned()),
        }],
        ..case_of(mesh, material(15.0, 0.45))
    };
    let turn = Vector::new(0.0, 0.1, 0.05);
    let movement = RigidMovement::about_pivot(turn, Vector::zeros(), Vector::new(0.2, 0.1, 0.3));
    let plan = Plan {
        segments: vec![PlannedSegment { name: "jaw".to_owned(), movement }],
        prescribed: vec![constraint("pressed", [None, Some(0.25), None])],
        loads: vec![
            Load::Gravity { acceleration: Vector::new(0.0, 0.0, -9.81e-3) },
            Load::Traction { faces: set("z_max"), traction: Vector::new(0.5, 0.0, 0.25) },
            Load::Force { nodes: set("y_max"), force: Vector::new(0.0, 2.0, 0.0) },
        ],
        ..Plan::default()
    };
    (case, plan)
}

fn refined(scene: &Scene, passes: usize) -> (Bisection, Scene) {
    let mut bisection = Bisection::new(scene.mesh.clone()).unwrap();
    for pass in 0..passes {
        let cells: Vec<usize> = (pass..bisection.cell_count()).step_by(3).collect();
        bisection.refine(&cells, HALVES_EVERY_EDGE);
    }
    let finer = scene.on(&bisection).unwrap();
    (bisection, finer)
}

#[test]
fn the_same_mesh_gives_the_same_scene() {
    let (case, plan) = everything();
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let (_, same) = refined(&scene, 0);
    assert_eq!(*same.mesh, *scene.mesh);
    assert_eq!(same.conditions.classes, scene.conditions.classes);
    assert_eq!(same.conditions.walls, scene.conditions.walls);
    assert_eq!(same.stated, scene.stated);
    assert_eq!(same.skin.surface, scene.skin.surface);
    assert_eq!(same.skin.regions, scene.skin.regions);
    assert_eq!(same.parts, scene.parts);
    for (own, other) in same.conditions.constraints.iter().zip(&scene.conditions.constraints) {
        // Rounding only.
        assert!((own.axes() * own.values() - other.axes() * other.values()).norm() < 1e-14);
    }
    for (own, other) in same.forces.iter().zip(&scene.forces) {
        // Rounding only.
        assert!((own - other).norm() < 1e-14);
    }
}

#[test]
fn new_nodes_are_held_where_what_holds_them_goes() {
    let (case, plan) = everything();
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let (_, finer) = refined(&scene, 2);
    let movement = plan.segments[0].movement;
    let mut met = [0; 4];
    for constraint in &finer.conditions.constraints {
        let (x, held) =
            (finer.mesh.nodes[constraint.node as usize], constraint.axes() * constraint.values());
        if (constraint.node as usize) < scene.mesh.nodes.len() {
            continue;
        }
        let carried = movement.displacement(&x);
        // Rounding only, in every case.
        match finer.conditions.classes[constraint.node as usize] {
            NodeClass::Joined(_) => {
                assert!(x.z == 0.0 && x.x <= 2.0 && (held - carried).norm() < 1e-14);
                met[0] += 1;
            }
            NodeClass::Fixed => {
                assert!(x.x == 6.0 && held == Vector::zeros());
                met[1] += 1;
            }
            NodeClass::Sliding => {
                assert!(x.z == 0.0 && x.x >= 4.0 && constraint.count() == 1);
                assert!((held.z - carried.z).abs() < 1e-14 && held.xy().norm() < 1e-14);
                met[2] += 1;
            }
            NodeClass::Prescribed => {
                assert!(x.y == 0.0 && x.z > 0.0 && (held.y - 0.25).abs() < 1e-14);
                met[3] += 1;
            }
            NodeClass::Free => panic!("a free node is held"),
        }
    }
    assert!(met.iter().all(|&count| count > 3), "{met:?}");
}

#[test]
fn growth_and_muscles_act_on_finer_cells_as_on_those_that_they_are_cut_from() {
    let (case, _) = everything();
    let plan = Plan {
        growth: vec![Growth { region: "0".to_owned(), volume_change: 0.01 }],
        activations: vec![Activation { muscle: "biceps".to_owned(), stress: 0.5 }],
        ..Plan::default()
    };
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let (_, finer) = refined(&scene, 2);
    let anew = Case { volume: finer.mesh.clone(), ..case };
    let anew = Scene::new(&anew, &plan, &Settings::default()).unwrap();
    let largest = anew.forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
    assert!(largest > 0.01, "{largest}");
    for (own, other) in finer.forces.iter().zip(&anew.forces) {
        // Rounding only.
        assert!((own - other).norm() < 1e-13, "{own} {other}");
    }
    assert_eq!(finer.load_case().grown, anew.load_case().grown);
    assert_eq!(finer.distributed.inner, anew.distributed.inner);
    assert_eq!(finer.muscles, anew.muscles);
}

#[test]
fn loads_skin_and_tissue_of_a_finer_scene_are_those_of_the_first() {
    let (case, plan) = everything();
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let (_, finer) = refined(&scene, 2);
    let sum = |forces: &[Vector]| forces.iter().sum::<Vector>();
    // Rounding only.
    assert!((sum(&finer.forces) - sum(&scene.forces)).norm() < 1e-12);
    let force = Vector::new(0.0, 2.0, 0.0);
    let y_max = scene.mesh.node_sets["y_max"].len() as f64;
    let pushed = finer.forces.iter().filter(|f| (f.y - 2.0).abs() < 1e-12).count() as f64;
    assert_eq!(pushed, y_max, "{force}");
    assert!((finer.skin.surface.area() - scene.skin.surface.area()).abs() < 1e-12);
    assert!(finer.skin.surface.triangles.len() > 2 * scene.skin.surface.triangles.len());
    let place = |&point: &u32| finer.skin.surface.points[point as usize];
    let near: Vec<Vector> = finer.skin.regions["near"].iter().map(place).collect();
    let all = finer.mesh.nodes.iter().filter(|x| x.z == 2.0 && x.x <= 2.0).count();
    assert!(near.iter().all(|x| x.x <= 2.0) && near.len() == all && all > 6, "{}", near.len());
}

#[test]
fn a_linear_displacement_is_exact_on_a_refined_mesh() {
    let mut mesh = block(Vector::new(3.0, 2.0, 1.0), [3, 2, 1], CellShape::Tet4);
    let field =
        |x: &Vector| Vector::new(0.1 * x.x + 0.02 * x.y, 0.05 * x.z - 0.1 * x.x, 0.03 * x.y);
    let plan = on_the_boundary(&mut mesh, field);
    let case = case_of(mesh, material(15.0, 0.45));
    assert!(matches!(plan.prescribed[0], Prescribed::FromArray { .. }));
    let scene = Scene::new(&case, &plan, &exact()).unwrap();
    let (bisection, finer) = refined(&scene, 3);
    assert!(Arc::ptr_eq(&scene.mesh, &case.volume) && bisection.cell_count() > 200);
    let prediction = predict(&finer, &Unobserved).unwrap();
    // The residual of the solver.
    assert!(largest_error(&finer.mesh, &prediction.displacement, field) < 1e-11);
    let reactions: Vector = prediction.condition_reactions.iter().map(|own| own.force).sum();
    assert!(reactions.norm() < 1e-9, "{reactions}");
}
