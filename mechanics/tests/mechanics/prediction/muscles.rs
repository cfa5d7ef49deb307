//! Muscles that pull: closed forms for every element, balance, superposition, mirrors, refinement, and who refuses them.

use std::collections::BTreeMap;

use mechanics::boundary::NodeSelection;
use mechanics::mesh::{CellShape, Vector, VolumeMesh, refinement::refine, sample::block};
use mechanics::prediction::{
    Activation, Case, FibreDirection, MethodKind, Muscle, MuscleCourse, Plan, Prescribed,
    RegionNames, Scene, Settings, predict,
};
use mechanics::progress::Unobserved;
use mechanics::study::methods;

use crate::material::anisotropy::{ELEMENTS, MUSCLE, fibred, tight};
use crate::scenes::{case_of, constraint, exact, largest_error, material, set, solve};

pub fn in_region(name: &str, region: &str, along: Vector) -> Muscle {
    let fibres = Some(FibreDirection::Uniform(along));
    let course = MuscleCourse::Region { region: region.to_owned(), fibres };
    Muscle { name: name.to_owned(), course, tissue: None, stiffening: None }
}

fn around(name: &str, lines: Vec<Vec<Vector>>, within: f64) -> Muscle {
    let course = MuscleCourse::Lines { lines, within };
    Muscle { name: name.to_owned(), course, tissue: None, stiffening: None }
}

fn pull(muscle: &str, stress: f64) -> Activation {
    Activation { muscle: muscle.to_owned(), stress }
}

pub fn pulling(muscle: &str, stress: f64) -> Plan {
    Plan { activations: vec![pull(muscle, stress)], ..Plan::default() }
}

/// A quarter of an arc of radius 20 mm about the y axis, in a block of 24 x 12 x 24 mm.
fn arc() -> Vec<Vector> {
    let point = |k: usize| {
        let angle = std::f64::consts::FRAC_PI_2 * k as f64 / 8.0;
        Vector::new(20.0 * angle.cos(), 6.0, 20.0 * angle.sin())
    };
    (0..=8).map(point).collect()
}

pub fn arched(shape: CellShape, halved: usize) -> Case {
    let cells = [4, 2, 4].map(|count| count << halved);
    let mesh = block(Vector::new(24.0, 12.0, 24.0), cells, shape);
    Case {
        fixed: vec![set("z_min")],
        skin: Some(set("x_max")),
        muscles: vec![around("arc", vec![arc()], 5.0)],
        ..case_of(mesh, material(15.0, 0.46))
    }
}

#[test]
fn a_free_block_shortens_along_its_fibres_by_the_closed_form_in_every_element() {
    // T 10, E_f 110, nu .49: eps_x -.0909091 and eps_y .0445455 (docs/verification.md#muscles).
    for stuff in [material(110.0, 0.49), fibred(MUSCLE).unwrap()] {
        for (shape, element) in ELEMENTS {
            let mut mesh = block(Vector::new(6.0, 4.0, 2.0), [6, 4, 2], shape);
            mesh.node_sets.insert("origin".to_owned(), vec![0]);
            let mut case = case_of(mesh, stuff);
            case.fibres.insert("*".to_owned(), FibreDirection::Uniform(Vector::x()));
            let course = MuscleCourse::Region { region: "tissue".to_owned(), fibres: None };
            case.muscles =
                vec![Muscle { name: "biceps".to_owned(), course, tissue: None, stiffening: None }];
            let zero = Some(0.0);
            let prescribed = vec![
                Prescribed::Uniform {
                    nodes: NodeSelection::NodeSet("origin".to_owned()),
                    displacement: [zero; 3],
                },
                constraint("x_min", [zero, None, None]),
                constraint("y_min", [None, zero, None]),
                constraint("z_min", [None, None, zero]),
            ];
            let plan = Plan { prescribed, ..pulling("biceps", 10.0) };
            let answer = solve(&case, &plan, &Settings { element, ..tight() });
            let error = largest_error(&case.volume, &answer.displacement, |x| {
                Vector::new(-0.090_909_1 * x.x, 0.044_545_5 * x.y, 0.044_545_5 * x.z)
            });
            assert!(error < 1e-6, "{shape:?} {element:?}: {error:e}");
            let missing = answer.numerical_error.map(|error| error.missing);
            let largest = missing.iter().flatten().map(|u| u.norm()).fold(0.0, f64::max);
            assert!(largest < 1e-7, "{shape:?} {element:?}: {largest:e}");
            // Shortened by 9.1 % at small strain, and by less in truth: fibres that are shorter pull less.
            if let Ok(beyond) = answer.nonlinearity {
                let far = case.volume.nodes.iter().zip(&beyond.left_out).find(|(x, _)| x.x > 5.9);
                assert!(far.is_some_and(|(_, u)| u.x > 0.0), "{shape:?} {element:?}");
            }
        }
    }
}

#[test]
fn a_muscle_that_cannot_shorten_pulls_with_stress_times_area() {
    for (shape, element) in ELEMENTS {
        let mesh = block(Vector::new(20.0, 10.0, 10.0), [4, 2, 2], shape);
        let sides = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];
        let case = Case {
            fixed: sides.map(set).to_vec(),
            muscles: vec![in_region("biceps", "tissue", Vector::new(-3.0, 0.0, 0.0))],
            ..case_of(mesh, material(15.0, 0.46))
        };
        let settings = Settings { element, ..exact() };
        // T A, 1000 mN on 100 mm² (docs/verification.md#muscles), drawn inwards at each end: nothing moves.
        let scene = Scene::new(&case, &pulling("biceps", 10.0), &settings).unwrap();
        let edges = scene.edge_nodes().map(|edges| edges.positions(&scene.mesh));
        let places = edges.unwrap_or_else(|| scene.mesh.nodes.clone());
        let end = places.iter().zip(&scene.forces).filter(|(x, _)| x.x < 1e-9);
        let force: Vector = end.map(|(_, force)| force).sum();
        assert!((force - Vector::x() * 1000.0).norm() < 1e-9, "{shape:?} {element:?}: {force}");
        let answer = predict(&scene, &Unobserved).unwrap();
        let largest = answer.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{shape:?} {element:?}: {largest:e}");
    }
}

#[test]
fn a_muscle_exerts_no_force_and_no_moment_as_a_whole() {
    for (shape, element) in ELEMENTS {
        let scene = Scene::new(
            &arched(shape, 1),
            &pulling("arc", 100.0),
            &Settings { element, ..Settings::default() },
        )
        .unwrap();
        let edges = scene.edge_nodes().map(|edges| edges.positions(&scene.mesh));
        let places = edges.unwrap_or_else(|| scene.mesh.nodes.clone());
        assert_eq!(places.len(), scene.forces.len());
        let total = scene.forces.iter().map(|force| force.norm()).sum::<f64>();
        assert!(total > 1000.0, "{total}");
        let force: Vector = scene.forces.iter().sum();
        let moment: Vector = places.iter().zip(&scene.forces).map(|(x, f)| x.cross(f)).sum();
        assert!(force.norm() < 1e-12 * total, "{shape:?} {element:?}: {force}");
        assert!(moment.norm() < 1e-10 * total, "{shape:?} {element:?}: {moment}");
    }
}

#[test]
fn a_line_pulls_with_the_force_that_its_reach_tells() {
    let mesh = block(Vector::new(24.0, 24.0, 24.0), [8, 24, 24], CellShape::Hex8);
    let middle = Vector::new(0.0, 12.0, 12.0);
    let line = vec![middle - Vector::x(), middle + Vector::x() * 25.0];
    let case = Case {
        fixed: ["x_min", "x_max", "y_min", "y_max"].map(set).to_vec(),
        muscles: vec![around("strap", vec![line], 6.0)],
        ..case_of(mesh, material(15.0, 0.3))
    };
    let scene = Scene::new(&case, &pulling("strap", 10.0), &Settings::default()).unwrap();
    let on_the_end = |node: &u32| scene.forces[*node as usize].x;
    let ends = case.volume.node_set("x_min").unwrap();
    let force: f64 = ends.iter().map(on_the_end).sum();
    // pi r² T / 3 = 376.99 mN, pulled inwards.
    let expected = std::f64::consts::PI * 36.0 * 10.0 / 3.0;
    assert!((force / expected - 1.0).abs() < 0.01, "{force} of {expected}");
}

/// Two muscles and a jaw.
fn scene_of_two(shape: CellShape) -> Case {
    let second = vec![Vector::new(4.0, 1.0, 20.0), Vector::new(20.0, 11.0, 20.0)];
    let mut case = arched(shape, 1);
    case.muscles.push(around("oblique", vec![second], 6.0));
    case
}

#[test]
fn activations_growth_and_loads_add_up() {
    for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
        let case = scene_of_two(shape);
        let answer = |plan: &Plan| solve(&case, plan, &exact()).displacement;
        let growth =
            vec![mechanics::prediction::Growth { region: "*".to_owned(), volume_change: 0.05 }];
        let lifted = vec![constraint("y_max", [None, Some(0.3), None])];
        let held = vec![constraint("y_max", [None, Some(0.0), None])];
        let activations = vec![pull("arc", 20.0), pull("oblique", 7.0)];
        let together = answer(&Plan {
            prescribed: lifted.clone(),
            growth: growth.clone(),
            activations: activations.clone(),
            ..Plan::default()
        });
        let apart = [
            Plan { prescribed: lifted, ..Plan::default() },
            Plan { prescribed: held.clone(), growth, ..Plan::default() },
            Plan { prescribed: held.clone(), ..pulling("arc", 20.0) },
            Plan { prescribed: held, ..pulling("oblique", 7.0) },
        ]
        .map(|plan| answer(&plan));
        for (node, whole) in together.iter().enumerate() {
            let sum: Vector = apart.iter().map(|part| part[node]).sum();
            assert!((whole - sum).norm() < 1e-10, "{shape:?}: {}", (whole - sum).norm());
        }
    }
}

/// The same mesh behind a mirror at x = 0: hexahedra with their corners in an order that is not inside out.
fn mirrored(mesh: &VolumeMesh) -> VolumeMesh {
    let mut other = VolumeMesh { node_sets: mesh.node_sets.clone(), ..VolumeMesh::default() };
    other.nodes = mesh.nodes.iter().map(|x| Vector::new(-x.x, x.y, x.z)).collect();
    for (shape, nodes) in mesh.cells.iter() {
        let order: &[usize] = match shape {
            CellShape::Tet4 => &[0, 2, 1, 3],
            CellShape::Hex8 => &[1, 0, 3, 2, 5, 4, 7, 6],
            CellShape::Wedge6 => &[0, 2, 1, 3, 5, 4],
        };
        let nodes: Vec<u32> = order.iter().map(|&corner| nodes[corner]).collect();
        other.cells.push(shape, &nodes);
    }
    other
}

#[test]
fn a_mirrored_mesh_answers_mirrored() {
    for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
        let case = scene_of_two(shape);
        let turned = |x: &Vector| Vector::new(-x.x, x.y, x.z);
        let mut other = Case { volume: mirrored(&case.volume).into(), ..case.clone() };
        for muscle in &mut other.muscles {
            let MuscleCourse::Lines { lines, .. } = &mut muscle.course else { panic!("lines") };
            lines.iter_mut().flatten().for_each(|x| *x = turned(x));
        }
        let growth = vec![mechanics::prediction::Growth {
            region: "tissue".to_owned(),
            volume_change: -0.03,
        }];
        let plan = Plan {
            activations: vec![pull("arc", 20.0), pull("oblique", 7.0)],
            growth,
            ..Plan::default()
        };
        let one = solve(&case, &plan, &exact()).displacement;
        let two = solve(&other, &plan, &exact()).displacement;
        for (u, v) in one.iter().zip(&two) {
            assert!((turned(u) - v).norm() < 1e-9, "{shape:?}: {u} {v}");
        }
    }
}

#[test]
fn the_skin_converges_as_the_mesh_is_refined_and_its_estimate_tells_how_far_it_is() {
    for shape in [CellShape::Hex8, CellShape::Tet4] {
        let skin = |halved: usize| {
            let mut mesh = (*arched(shape, 1).volume).clone();
            for _ in 0..halved {
                mesh = refine(&mesh);
            }
            let case = Case { volume: mesh.into(), ..arched(shape, 1) };
            let answer = solve(&case, &pulling("arc", 20.0), &Settings::default());
            let missing = answer.numerical_error.unwrap().missing;
            let coarse = arched(shape, 1);
            let at = |x: &Vector| {
                let node = case.volume.nodes.iter().position(|y| (x - y).norm() < 1e-9).unwrap();
                (answer.displacement[node], missing[node])
            };
            let points = coarse.volume.node_set("x_max").unwrap().iter();
            points.map(|&node| at(&coarse.volume.nodes[node as usize])).collect::<Vec<_>>()
        };
        let levels = [0, 1, 2].map(skin);
        let mean = |a: &[(Vector, Vector)], b: &[(Vector, Vector)]| {
            a.iter().zip(b).map(|((u, _), (v, _))| (u - v).norm()).sum::<f64>() / a.len() as f64
        };
        let moved = levels[2].iter().map(|(u, _)| u.norm()).sum::<f64>() / levels[2].len() as f64;
        let (first, second) = (mean(&levels[0], &levels[1]), mean(&levels[1], &levels[2]));
        let told = levels[0].iter().map(|(_, e)| e.norm()).sum::<f64>() / levels[0].len() as f64;
        println!("{shape:?}: moved {moved:.4}, steps {first:.5} {second:.5}, told {told:.5}");
        assert!(second < 0.5 * first, "{shape:?}: {first} {second}");
        let error = mean(&levels[0], &levels[2]);
        assert!((0.4..2.5).contains(&(told / error)), "{shape:?}: {told} of {error}");
    }
}

#[test]
fn every_method_without_muscles_refuses_them_by_name() {
    let case = arched(CellShape::Tet4, 0);
    for kind in MethodKind::ALL {
        let settings = methods::of_method(*kind).remove(0).settings;
        let properties = kind.properties();
        let built = Scene::new(&case, &pulling("arc", 1.0), &settings);
        assert_eq!(built.is_ok(), properties.knows_inner_stress, "{}", properties.name);
        if let Err(errors) = built {
            let mut all = errors.0.iter();
            let refused = all.find(|error| error.pointer == "/plan/activations").unwrap();
            assert_eq!(refused.code.name(), "method-not-available");
            assert!(refused.detail.contains(properties.title), "{}", refused.detail);
        }
    }
}

#[test]
fn what_is_wrong_with_muscles_is_reported_with_its_place() {
    let refused = |muscle: Muscle, plan: &Plan| {
        let mut case = arched(CellShape::Hex8, 0);
        case.muscles = vec![muscle];
        let Err(errors) = Scene::new(&case, plan, &Settings::default()) else { panic!("built") };
        let error = &errors.0[0];
        (error.pointer.clone(), error.code.name(), error.detail.clone())
    };
    let arc = || around("arc", vec![arc()], 5.0);
    let (pointer, code, detail) = refused(arc(), &pulling("risorius", 1.0));
    assert_eq!((pointer.as_str(), code), ("/plan/activations/0/muscle", "unknown-muscle"));
    assert!(detail.contains("risorius") && detail.contains("arc"), "{detail}");
    let (pointer, code, detail) = refused(arc(), &pulling("arc", -1.0));
    assert_eq!((pointer.as_str(), code), ("/plan/activations/0/stress_kpa", "plan-out-of-range"));
    assert!(detail.contains("-1 kPa"), "{detail}");
    let still = Plan::default();
    let far = around("arc", vec![vec![Vector::repeat(500.0), Vector::repeat(510.0)]], 5.0);
    let (pointer, code, _) = refused(far, &still);
    assert_eq!((pointer.as_str(), code), ("/case/muscles/0/lines_mm", "empty-selection"));
    let point = around("point", vec![vec![Vector::repeat(5.0), Vector::repeat(5.0)]], 5.0);
    let (pointer, code, detail) = refused(point, &still);
    assert_eq!((pointer.as_str(), code), ("/case/muscles/0/lines_mm", "empty-selection"));
    assert!(detail.contains("have no length") && !detail.contains("in mm"), "{detail}");
    let (pointer, code, _) = refused(in_region("biceps", "arm", Vector::x()), &still);
    assert_eq!((pointer.as_str(), code), ("/case/muscles/0/region", "unknown-region"));
    let (_, code, _) = refused(in_region("biceps", "tissue", Vector::zeros()), &still);
    assert_eq!(code, "fibre-direction-zero");
    let course = MuscleCourse::Region { region: "tissue".to_owned(), fibres: None };
    let (pointer, code, _) = refused(
        Muscle { name: "biceps".to_owned(), course, tissue: None, stiffening: None },
        &still,
    );
    assert_eq!((pointer.as_str(), code), ("/case/muscles/0", "missing-field"));
}

#[test]
fn a_muscle_of_few_cells_is_reported() {
    let mut case = arched(CellShape::Hex8, 0);
    let short = vec![Vector::new(3.0, 3.0, 20.0), Vector::new(9.0, 3.0, 20.0)];
    case.muscles = vec![around("short", vec![short], 3.0)];
    let scene = Scene::new(&case, &pulling("short", 1.0), &Settings::default()).unwrap();
    let told = scene.warnings.iter().find(|warning| warning.code == "muscle-few-cells").unwrap();
    assert!(told.detail.contains("short") && told.numbers[0].1 < 20.0, "{told:?}");
}

#[test]
fn a_muscle_thinner_than_the_way_between_points_of_finer_cells_has_no_share() {
    let mesh = block(Vector::repeat(30.0), [3, 3, 3], CellShape::Hex8);
    // Within a fifth of a millimetre of a quadrature point of a cell of 10 mm, and of none of a cell of 2.5 mm.
    let line = vec![Vector::repeat(2.11), Vector::repeat(2.12)];
    let muscles = vec![around("thread", vec![line], 0.2)];
    let case = Case { fixed: vec![set("x_min")], muscles, ..case_of(mesh, material(15.0, 0.46)) };
    let scene = Scene::new(&case, &pulling("thread", 1.0), &Settings::default()).unwrap();
    let told = scene.warnings.iter().find(|warning| warning.code == "muscle-few-cells").unwrap();
    assert_eq!(told.numbers, [("cells", 1.0)]);
    assert!(told.detail.contains("no point"), "{}", told.detail);
}

#[test]
fn a_muscle_in_cells_too_coarse_for_its_width_is_reported_with_how_much_of_it_pulls() {
    let told = |cells: [usize; 3], at: f64| {
        let mesh = block(Vector::new(120.0, 30.0, 30.0), cells, CellShape::Hex8);
        let line = vec![Vector::new(0.0, at, at), Vector::new(120.0, at, at)];
        let muscles = vec![around("long", vec![line], 4.5)];
        let case =
            Case { fixed: vec![set("x_min")], muscles, ..case_of(mesh, material(15.0, 0.46)) };
        let scene = Scene::new(&case, &pulling("long", 1.0), &Settings::default()).unwrap();
        let mut told = scene.warnings.into_iter().filter(|own| own.code == "muscle-few-cells");
        told.next().map(|own| own.numbers)
    };
    // A line through the middle of cells of 10 mm, no point of which is nearer than 3.9 mm: a fraction pulls.
    let numbers = told([24, 3, 3], 15.0).unwrap();
    assert!(numbers[0].1 >= 20.0 && numbers[1].1 < 0.5, "{numbers:?}");
    assert_eq!(told([24, 24, 24], 15.0), None);
}

#[test]
fn lines_that_leave_the_tissue_are_reported_with_how_much_of_them_lies_in_it() {
    let told = |from: f64| {
        let mesh = block(Vector::new(60.0, 30.0, 30.0), [24, 12, 12], CellShape::Hex8);
        let line = vec![Vector::new(from, 15.0, 15.0), Vector::new(from + 60.0, 15.0, 15.0)];
        let muscles = vec![around("long", vec![line], 4.5)];
        let case =
            Case { fixed: vec![set("x_min")], muscles, ..case_of(mesh, material(15.0, 0.46)) };
        let scene = Scene::new(&case, &pulling("long", 1.0), &Settings::default()).unwrap();
        let mut told = scene.warnings.into_iter().filter(|own| own.code == "muscle-outside");
        told.next().map(|own| own.numbers[0].1)
    };
    assert_eq!(told(20.0), None);
    let share = told(45.0).unwrap();
    assert!((share - 0.25).abs() < 0.03, "{share}");
}

#[test]
fn a_muscle_pulls_in_its_region_only() {
    let mut case = arched(CellShape::Hex8, 0);
    let mut mesh = (*case.volume).clone();
    let is_upper = |cell: usize| i64::from(mesh.corners(cell).all(|x| x.z > 11.9));
    let labels = (0..mesh.cells.len()).map(is_upper).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    case.volume = mesh.into();
    let names = BTreeMap::from([(1, "upper".to_owned())]);
    case.regions = Some(RegionNames { array: "layer".to_owned(), names });
    case.muscles = vec![in_region("levator", "upper", Vector::z())];
    let scene = Scene::new(&case, &pulling("levator", 1.0), &Settings::default()).unwrap();
    for (x, force) in scene.mesh.nodes.iter().zip(&scene.forces) {
        assert!(x.z > 11.9 || *force == Vector::zeros(), "{x} {force}");
    }
    assert!(scene.forces.iter().any(|force| force.z < 0.0));
}
