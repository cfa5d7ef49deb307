//! Growth as an eigenstrain: closed forms for every element, what the estimates make of it, and who refuses it.

use std::collections::BTreeMap;

use mechanics::boundary::NodeSelection;
use mechanics::mesh::{CellShape, Vector, VolumeMesh, sample::block};
use mechanics::model::fem::mass_tensor::MassTensorSettings;
use mechanics::prediction::{
    Case, ElementChoice, FibreDirection, Growth, Method, MethodKind, Plan, Prediction, Prescribed,
    RegionNames, Scene, Settings, linear_strain, predict,
};
use mechanics::progress::Unobserved;
use mechanics::study::methods;

use super::elements::{at_skin_points, slab};
use crate::material::anisotropy::{ELEMENTS, MUSCLE, fibred, tight};
use crate::scenes::{case_of, constraint, exact, largest_error, material, set, solve};

pub const SIZE: Vector = Vector::new(6.0, 4.0, 2.0);

pub fn growing(region: &str, volume_change: f64) -> Vec<Growth> {
    vec![Growth { region: region.to_owned(), volume_change }]
}

/// A block whose inner nodes are moved by up to a tenth of a mm, the same at every run.
pub fn distorted(shape: CellShape) -> VolumeMesh {
    let mut mesh = block(SIZE, [6, 4, 3], shape);
    for (number, node) in mesh.nodes.iter_mut().enumerate() {
        let is_inside = (0..3).all(|k| node[k] > 0.1 && node[k] < SIZE[k] - 0.1);
        if is_inside {
            let wave = |k: f64| (k * number as f64).sin() * 0.1;
            *node += Vector::new(wave(1.7), wave(2.3), wave(3.1));
        }
    }
    mesh
}

fn held(node: u32, displacement: [Option<f64>; 3]) -> Prescribed {
    let name = format!("node {node}");
    Prescribed::Uniform { nodes: NodeSelection::NodeSet(name), displacement }
}

/// Holds one node, a second across the line to it, and a third across the plane of all three: no more than a rigid body.
fn pinned(mesh: &mut VolumeMesh) -> Vec<Prescribed> {
    let at = |x: Vector| mesh.nodes.iter().position(|node| *node == x).unwrap() as u32;
    let (o, x, y) = (at(Vector::zeros()), at(Vector::x() * SIZE.x), at(Vector::y() * SIZE.y));
    for node in [o, x, y] {
        mesh.node_sets.insert(format!("node {node}"), vec![node]);
    }
    let zero = Some(0.0);
    vec![held(o, [zero; 3]), held(x, [None, zero, zero]), held(y, [None, None, zero])]
}

pub fn free(mut mesh: VolumeMesh, material: mechanics::material::LinearElastic) -> (Case, Plan) {
    let prescribed = pinned(&mut mesh);
    (case_of(mesh, material), Plan { prescribed, ..Plan::default() })
}

pub fn largest_reaction(answer: &Prediction) -> f64 {
    answer.reactions.values().map(|force| force.norm()).fold(0.0, f64::max)
}

#[test]
fn free_tissue_keeps_its_shape_and_has_no_stress_in_every_element() {
    // g .9 gives .9654893846 of each length (docs/verification.md#growth).
    let strain = linear_strain(-0.1);
    assert!((1.0 + strain - 0.965_489_384_6).abs() < 1e-10);
    for (shape, element) in ELEMENTS {
        for nu in [0.0, 0.3, 0.46, 0.4999] {
            let (case, plan) = free(distorted(shape), material(15.0, nu));
            let plan = Plan { growth: growing("tissue", -0.1), ..plan };
            let answer = solve(&case, &plan, &Settings { element, ..exact() });
            let error = largest_error(&case.volume, &answer.displacement, |x| x * strain);
            // Rounding, which grows as 1 / (1 - 2 nu).
            let most = if nu > 0.499 { 1e-9 } else { 1e-11 };
            assert!(error < most, "{shape:?} {element:?} nu {nu}: {error:e}");
            let most = if nu > 0.499 { 1e-7 } else { 1e-9 };
            assert!(largest_reaction(&answer) < most, "{shape:?} {element:?} nu {nu}");
        }
    }
}

#[test]
fn free_tissue_with_fibres_keeps_its_shape_too() {
    for (shape, element) in ELEMENTS {
        let (mut case, plan) = free(distorted(shape), fibred(MUSCLE).unwrap());
        let course = FibreDirection::Uniform(Vector::new(1.0, 2.0, -0.5));
        case.fibres.insert("*".to_owned(), course);
        let plan = Plan { growth: growing("*", 0.2), ..plan };
        let answer = solve(&case, &plan, &Settings { element, ..tight() });
        let strain = linear_strain(0.2);
        let error = largest_error(&case.volume, &answer.displacement, |x| x * strain);
        assert!(error < 1e-8, "{shape:?} {element:?}: {error:e}");
    }
}

#[test]
fn the_mass_tensor_grows_as_the_plain_element_does() {
    let (case, plan) = free(distorted(CellShape::Tet4), material(15.0, 0.3));
    let plan = Plan { growth: growing("tissue", -0.1), ..plan };
    let methods = [
        Method::MassTensor(MassTensorSettings::default()),
        Method::MassTensorTransverse(MassTensorSettings::default()),
    ];
    for method in methods {
        let answer = solve(&case, &plan, &Settings { method: method.clone(), ..exact() });
        let strain = linear_strain(-0.1);
        let error = largest_error(&case.volume, &answer.displacement, |x| x * strain);
        assert!(error < 1e-9, "{method:?}: {error:e}");
    }
}

/// The force in mN that the faces of a set exert.
pub fn reaction_of(answer: &Prediction, place: usize) -> Vector {
    answer.condition_reactions[place].force
}

/// Holds the sides of a block across, all but that at z_max, which is held as asked.
pub(super) fn between_walls(top: Option<Prescribed>) -> Vec<Prescribed> {
    let zero = Some(0.0);
    let mut prescribed = vec![
        constraint("x_min", [zero, None, None]),
        constraint("x_max", [zero, None, None]),
        constraint("y_min", [None, zero, None]),
        constraint("y_max", [None, zero, None]),
        constraint("z_min", [None, None, zero]),
    ];
    prescribed.extend(top);
    prescribed
}

#[test]
fn a_layer_held_at_its_sides_thins_and_a_confined_one_is_pressed_by_the_closed_forms() {
    for (shape, element) in ELEMENTS {
        let settings = Settings { element, ..exact() };
        let case = case_of(distorted(shape), material(15.0, 0.46));
        // g .98 and .9: eps_zz and what the sides pull with; g .9: 6.47074 kPa where nothing yields
        // (docs/verification.md#growth).
        for (change, strain, pull) in
            [(-0.02, -0.018_146_2, 0.186_434), (-0.1, -0.093_306_5, 0.958_628)]
        {
            let growth = growing("tissue", change);
            let plan = Plan { prescribed: between_walls(None), growth, ..Plan::default() };
            let answer = solve(&case, &plan, &settings);
            let error =
                largest_error(&case.volume, &answer.displacement, |x| Vector::z() * (strain * x.z));
            assert!(error < 2e-7, "{shape:?} {element:?} {change}: {error:e}");
            let across = reaction_of(&answer, 1).x / (SIZE.y * SIZE.z);
            assert!((across - pull).abs() < 1e-6, "{shape:?} {element:?} {change}: {across}");
        }

        let above = constraint("z_max", [None, None, Some(0.0)]);
        let growth = growing("tissue", -0.1);
        let plan = Plan { prescribed: between_walls(Some(above)), growth, ..Plan::default() };
        let answer = solve(&case, &plan, &settings);
        let across = reaction_of(&answer, 1).x / (SIZE.y * SIZE.z);
        assert!((across - 6.470_74).abs() < 1e-5, "{shape:?} {element:?}: {across}");
    }
}

#[test]
fn the_slab_loses_what_other_codes_say() {
    // docs/verification.md#growth, by mean-dilatation hexahedra of 3 mm.
    for (loss, expected) in [(0.02, 0.192), (0.05, 0.485), (0.10, 0.987)] {
        let (case, _) = slab(3.0, 0.46);
        let prescribed = vec![
            constraint("patch", [Some(0.0); 3]),
            constraint("far", [Some(0.0); 3]),
            constraint("y_min", [None, Some(0.0), None]),
        ];
        let plan = Plan { prescribed, growth: growing("tissue", -loss), ..Plan::default() };
        let answer = solve(&case, &plan, &Settings::default());
        let points = at_skin_points(&case, &answer);
        let mean = points.iter().map(|u| u.norm()).sum::<f64>() / points.len() as f64;
        println!("loss {loss}: mean {mean:.4} at {} points, expected {expected}", points.len());
        assert!((mean - expected).abs() < 0.02 * expected, "{loss}: {mean}");
    }
}

/// Two layers of one material of which the lower one swells, on a fixed base.
fn layers(shape: CellShape, halved: usize) -> Case {
    let cells = 1 << halved;
    let mut mesh = block(Vector::new(12.0, 12.0, 6.0), [4 * cells, 4 * cells, 2 * cells], shape);
    let lower = |cell: usize| {
        let (sum, count) =
            (mesh.corners(cell).map(|x| x.z).sum::<f64>(), mesh.corners(cell).count());
        i64::from(sum < 3.0 * count as f64)
    };
    let labels = (0..mesh.cells.len()).map(lower).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    let names = BTreeMap::from([(0, "upper".to_owned()), (1, "lower".to_owned())]);
    Case {
        regions: Some(RegionNames { array: "layer".to_owned(), names }),
        fixed: vec![set("z_min")],
        skin: Some(set("z_max")),
        ..case_of(mesh, material(15.0, 0.49))
    }
}

/// How far the middle of the skin rises.
fn rise(case: &Case, element: ElementChoice) -> f64 {
    let plan = Plan { growth: growing("lower", 0.1), ..Plan::default() };
    let answer = solve(case, &plan, &Settings { element, ..Settings::default() });
    let middle = Vector::new(6.0, 6.0, 6.0);
    let node = case.volume.nodes.iter().position(|x| (x - middle).norm() < 1e-9).unwrap();
    answer.displacement[node].z
}

#[test]
fn a_layer_that_swells_under_another_of_the_same_stuff_lifts_it_alike_in_every_element() {
    let truth = rise(&layers(CellShape::Hex8, 2), ElementChoice::MeanDilatation);
    for (shape, element, within) in [
        (CellShape::Hex8, ElementChoice::MeanDilatation, 0.04),
        (CellShape::Wedge6, ElementChoice::MeanDilatation, 0.06),
        (CellShape::Tet4, ElementChoice::Stabilised, 0.06),
    ] {
        let found = rise(&layers(shape, 1), element);
        println!("{shape:?}: {found:.5} of {truth:.5}");
        assert!((found / truth - 1.0).abs() < within, "{shape:?}: {found} of {truth}");
    }
}

#[test]
fn the_estimate_of_the_mesh_takes_growth_into_account() {
    for (shape, element) in ELEMENTS {
        if element == ElementChoice::Quadratic {
            continue;
        }
        // What every element shows exactly leaves nothing out; without growth in the residual this would be mm.
        let (case, plan) = free(distorted(shape), material(15.0, 0.46));
        let plan = Plan { growth: growing("tissue", -0.1), ..plan };
        let answer = solve(&case, &plan, &Settings { element, ..exact() });
        let missing = answer.numerical_error.unwrap().missing;
        let largest = missing.iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{shape:?} {element:?}: {largest:e}");
        let beyond = answer.nonlinearity.unwrap().left_out;
        let largest = beyond.iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(element == ElementChoice::Quadratic || largest < 1e-9, "{shape:?} {element:?}");
    }
}

#[test]
fn every_method_without_growth_refuses_it_by_name() {
    let (case, plan) = free(block(SIZE, [3, 2, 1], CellShape::Tet4), material(15.0, 0.3));
    let plan = Plan { growth: growing("tissue", -0.1), ..plan };
    for kind in MethodKind::ALL {
        let settings = methods::of_method(*kind).remove(0).settings;
        let properties = kind.properties();
        let built = Scene::new(&case, &plan, &settings);
        assert_eq!(built.is_ok(), properties.knows_inner_stress, "{}", properties.name);
        if let Err(errors) = built {
            let refused = errors.0.iter().find(|error| error.pointer == "/plan/growth").unwrap();
            assert_eq!(refused.code.name(), "method-not-available");
            assert!(refused.detail.contains(properties.title), "{}", refused.detail);
        }
    }
}

#[test]
fn what_is_wrong_with_growth_is_reported_with_its_place() {
    let case = layers(CellShape::Hex8, 0);
    let refused = |growth: Vec<Growth>| {
        let plan = Plan { growth, ..Plan::default() };
        let Err(errors) = Scene::new(&case, &plan, &Settings::default()) else { panic!("built") };
        let error = &errors.0[0];
        (error.pointer.clone(), error.code.name(), error.detail.clone())
    };
    let (pointer, code, detail) = refused(growing("fat", 0.1));
    assert_eq!((pointer.as_str(), code), ("/plan/growth/0/region", "unknown-region"));
    assert!(detail.contains("lower") && detail.contains("upper"), "{detail}");
    let (pointer, code, detail) = refused(growing("lower", -0.6));
    assert_eq!((pointer.as_str(), code), ("/plan/growth/0/volume_change", "plan-out-of-range"));
    assert!(detail.contains("-0.6") && detail.contains("-0.5 to 1"), "{detail}");
    let twice = [growing("lower", 0.1), growing("lower", 0.1)].concat();
    let (pointer, code, _) = refused(twice);
    assert_eq!((pointer.as_str(), code), ("/plan/growth/1/region", "plan-conflict"));
}

#[test]
fn a_star_stands_for_the_regions_without_an_entry() {
    let case = layers(CellShape::Hex8, 0);
    let answer = |growth: Vec<Growth>| {
        let plan = Plan { growth, ..Plan::default() };
        solve(&case, &plan, &exact()).displacement
    };
    let both = answer([growing("lower", 0.1), growing("upper", -0.05)].concat());
    let rest = answer([growing("*", -0.05), growing("lower", 0.1)].concat());
    assert_eq!(both, rest);
}

#[test]
fn growth_is_a_plan_that_does_something() {
    let case = layers(CellShape::Hex8, 0);
    let codes = |volume_change: f64| {
        let plan = Plan { growth: growing("*", volume_change), ..Plan::default() };
        let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
        let answer = predict(&scene, &Unobserved).unwrap();
        answer.warnings.iter().map(|warning| warning.code.to_owned()).collect::<Vec<_>>()
    };
    assert!(!codes(0.1).contains(&"nothing-moves".into()));
    assert!(codes(0.0).contains(&"nothing-moves".into()));
    // A share of 0.5 is rather a percentage.
    assert!(codes(0.5).contains(&"constant-suspect".into()));
    assert!(!codes(0.1).contains(&"constant-suspect".into()));
}
