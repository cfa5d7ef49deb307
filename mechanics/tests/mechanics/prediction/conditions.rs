//! What holds nodes, what is refused, and what must not depend on the observer: docs/verification.md#v27,
//! docs/verification.md#v35, docs/verification.md#v45, docs/verification.md#v46.

use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::{Law, SaintVenantKirchhoff};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, Warning};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Advance, Case, CaseSegment, ElementChoice, Method, ModelError, NodeClass, Plan, Prescribed,
    Scene, Settings, Sliding, SlidingNormal, predict,
};
use mechanics::progress::Unobserved;

use crate::scenes::{case_of, constraint, exact, largest_error, material, set, solve};

/// A slab whose bottom is the bone: segment `jaw` at x_min, fixed at x_max.
fn jaw_and_skull(shape: CellShape) -> Case {
    let mesh = block(Vector::new(40.0, 20.0, 10.0), [8, 4, 3], shape);
    let mut case = case_of(mesh, material(15.0, 0.45));
    case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") });
    case.fixed.push(set("x_max"));
    case
}

fn moved(name: &str, movement: RigidMovement) -> Plan {
    let segment = PlannedSegment { name: name.to_owned(), movement };
    Plan { segments: vec![segment], ..Plan::default() }
}

fn turned() -> RigidMovement {
    let angles = Vector::new(7.0, -5.0, 11.0).map(f64::to_radians);
    RigidMovement::about_pivot(angles, Vector::new(3.0, 40.0, -50.0), Vector::new(1.5, -0.7, 5.0))
}

fn refusal(case: &Case, plan: &Plan) -> (String, &'static str) {
    let errors = Scene::new(case, plan, &Settings::default()).err().expect("the scene is refused");
    (errors.0[0].pointer.clone(), errors.0[0].code.name())
}

#[test]
fn joined_nodes_move_exactly_with_their_segment() {
    let case = jaw_and_skull(CellShape::Hex8);
    let prediction = solve(&case, &moved("jaw", turned()), &Settings::default());
    for &node in case.volume.node_set("x_min").unwrap() {
        let expected = turned().displacement(&case.volume.nodes[node as usize]);
        assert!((prediction.displacement[node as usize] - expected).norm() < 1e-12);
    }
}

#[test]
fn an_identity_plan_moves_nothing_at_all() {
    let case = jaw_and_skull(CellShape::Tet4);
    for plan in [Plan::default(), moved("jaw", RigidMovement::default())] {
        let prediction = solve(&case, &plan, &Settings::default());
        assert!(prediction.displacement.iter().all(|u| *u == Vector::zeros()));
        assert_eq!(prediction.solver.method, "none");
    }
}

#[test]
fn tissue_joined_to_one_segment_alone_is_carried_along_by_a_translation() {
    let mut case = jaw_and_skull(CellShape::Wedge6);
    case.fixed.clear();
    case.allow_unfixed = true;
    let shift = Vector::new(1.0, -2.0, 3.0);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), shift);
    let prediction = solve(&case, &moved("jaw", movement), &exact());
    assert!(largest_error(&case.volume, &prediction.displacement, |_| shift) < 1e-11);
}

#[test]
fn a_rotation_carries_tissue_along_only_up_to_the_linear_artefact() {
    let mut case = jaw_and_skull(CellShape::Hex8);
    case.fixed.clear();
    case.allow_unfixed = true;
    let prediction = solve(&case, &moved("jaw", turned()), &exact());
    let error = largest_error(&case.volume, &prediction.displacement, |x| turned().displacement(x));
    let stretch = (turned().rotation() - nalgebra::Matrix3::identity()).norm().powi(2) * 45.0;
    assert!(error > 1e-3, "linear elasticity does not rotate freely: {error}");
    assert!(error < stretch, "{error} against {stretch}");
}

#[test]
fn tissue_at_finite_strain_that_one_segment_carries_turns_with_it() {
    for shape in [CellShape::Hex8, CellShape::Tet4, CellShape::Wedge6] {
        let mut case = jaw_and_skull(shape);
        case.fixed.clear();
        case.allow_unfixed = true;
        let settings = Settings { method: Method::FemNonlinear, ..exact() };
        let found = solve(&case, &moved("jaw", turned()), &settings);
        let error = largest_error(&case.volume, &found.displacement, |x| turned().displacement(x));
        assert!(error < 1e-9, "{shape:?}: {error:e}");
    }
}

#[test]
fn two_plans_one_after_the_other_equal_the_composed_plan() {
    let first = RigidMovement::about_pivot(Vector::x() * 0.1, Vector::y(), Vector::z());
    let composed = first.then(&turned());
    let x = Vector::new(12.0, -7.0, 3.0);
    assert!((turned().apply(&first.apply(&x)) - composed.apply(&x)).norm() < 1e-12);
    // Tissue whose nodes are brought where the second plan takes what the first one moved.
    let case = jaw_and_skull(CellShape::Hex8);
    let mut by_node = case.clone();
    by_node.segments.clear();
    let mesh = std::sync::Arc::make_mut(&mut by_node.volume);
    let later = |x: &Vector| turned().apply(&first.apply(x)) - x;
    mesh.node_vectors.insert("later".to_owned(), mesh.nodes.iter().map(later).collect());
    let prescribed = vec![Prescribed::FromArray { nodes: set("x_min"), array: "later".to_owned() }];
    let later = Plan { prescribed, ..Plan::default() };
    // Hyperelastic tissue keeps nothing of the way either.
    let at_finite_strain = Settings { method: Method::FemNonlinear, ..exact() };
    for (settings, most) in [(exact(), 1e-9), (at_finite_strain, 1e-8)] {
        let at_once = solve(&case, &moved("jaw", composed), &settings);
        let after = solve(&by_node, &later, &settings);
        let pairs = at_once.displacement.iter().zip(&after.displacement);
        let apart = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
        assert!(apart < most, "{:?}: {apart}", settings.method);
    }
}

#[test]
fn classes_are_counted_and_the_stronger_one_wins() {
    let mesh = block(Vector::new(3.0, 3.0, 3.0), [3, 3, 3], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("z_max") });
    case.fixed.push(set("z_min"));
    case.sliding.push(Sliding {
        nodes: set("x_min"),
        normal: SlidingNormal::Surface,
        segment: None,
    });
    let scene = Scene::new(&case, &Plan::default(), &Settings::default()).unwrap();
    let counts = scene.class_counts();
    // The sliding wall of 16 nodes loses one row of 4 to the jaw and one to the fixed face.
    let expected = [("joined:jaw", 16), ("fixed", 16), ("sliding", 8), ("free", 24)];
    for (name, count) in expected {
        assert_eq!(counts[name], count, "{name}");
    }
    let overlap =
        scene.warnings.iter().find(|warning| warning.code == "conditions-overlap").unwrap();
    assert_eq!(overlap.numbers, [("joined_and_sliding", 4.0), ("fixed_and_sliding", 4.0)]);
    assert_eq!(
        scene.conditions.classes.iter().filter(|class| **class == NodeClass::Fixed).count(),
        16
    );
}

#[test]
fn segments_with_nodes_in_common_are_told_before_a_plan_moves_one_of_them() {
    let mesh = block(Vector::new(3.0, 3.0, 3.0), [3, 3, 3], CellShape::Hex8);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed.push(set("z_min"));
    let told = |segments: [(&str, &str); 2]| {
        let segment =
            |(name, nodes): (&str, &str)| CaseSegment { name: name.to_owned(), nodes: set(nodes) };
        let case = Case { segments: segments.map(segment).to_vec(), ..case.clone() };
        let scene = Scene::new(&case, &Plan::default(), &Settings::default()).unwrap();
        let count = |warning: &Warning| {
            warning.numbers.iter().find(|(name, _)| *name == "joined_twice").map(|own| own.1)
        };
        scene.warnings.iter().find_map(count)
    };
    assert_eq!(told([("jaw", "z_max"), ("twin", "z_max")]), Some(16.0));
    assert_eq!(told([("jaw", "z_max"), ("side", "x_max")]), Some(4.0));
    assert_eq!(told([("left", "x_min"), ("right", "x_max")]), None);
}

#[test]
fn neighbours_that_part_by_more_than_their_distance_are_called_torn() {
    let mut case = jaw_and_skull(CellShape::Hex8);
    case.fixed = vec![set("z_min")];
    let shift =
        |x: f64| RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::x() * x);
    let warned = |x: f64| {
        let scene = Scene::new(&case, &moved("jaw", shift(x)), &Settings::default()).unwrap();
        scene.warnings.iter().any(|warning| warning.code == "tearing")
    };
    // The jaw at x_min and the fixed bottom meet along edges of 5 mm.
    assert!(warned(5.01));
    assert!(!warned(4.99));
}

#[test]
fn what_one_bone_carries_is_not_torn_however_far_it_turns() {
    let mut case = jaw_and_skull(CellShape::Hex8);
    let angles = Vector::x() * f64::to_radians(89.0);
    let turned = RigidMovement::about_pivot(angles, Vector::new(0.0, 10.0, 5.0), Vector::zeros());
    let is_torn = |case: &Case| {
        let scene = Scene::new(case, &moved("jaw", turned), &Settings::default()).unwrap();
        scene.warnings.iter().any(|warning| warning.code == "tearing")
    };
    assert!(!is_torn(&case));
    case.fixed = vec![set("z_min")];
    assert!(is_torn(&case));
}

#[test]
fn edges_that_bones_turn_round_are_told_with_their_place_and_with_what_passes_through_what() {
    let mut case = jaw_and_skull(CellShape::Hex8);
    case.fixed = vec![set("z_min")];
    let torn = |x: f64| {
        let shift = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::x() * x);
        let scene = Scene::new(&case, &moved("jaw", shift), &Settings::default()).unwrap();
        scene.warnings.into_iter().find(|warning| warning.code == "tearing").unwrap()
    };
    // Towards what is fixed beside it the jaw passes through it, away from it it does not.
    let away = torn(-5.5);
    assert!(away.numbers.iter().all(|(name, _)| *name != "turned_edges"), "{away:?}");
    let through = torn(5.5);
    let number = |wanted: &str| through.numbers.iter().find(|(name, _)| *name == wanted).unwrap().1;
    assert_eq!([number("turned_edges"), number("turned_cells")], [5.0, 4.0], "{through:?}");
    assert_eq!([number("x_mm"), number("z_mm")], [2.5, 0.0], "{through:?}");
    assert!(through.detail.contains("joined:jaw and fixed"), "{}", through.detail);
}

#[test]
fn tissue_that_finds_no_rest_between_bones_that_pass_through_each_other_is_told_where() {
    let law = Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda: 59.0, mu: 5.1 });
    let mut case = jaw_and_skull(CellShape::Hex8);
    case.fixed = vec![set("z_min")];
    case.materials.insert("*".to_owned(), LinearElastic::of_law(law, 1.0).unwrap());
    let settings =
        Settings { method: Method::FemNonlinear, advance: Advance::AtOnce, ..Settings::default() };
    let ended = |x: f64| {
        let shift = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::x() * x);
        predict(&Scene::new(&case, &moved("jaw", shift), &settings).unwrap(), &Unobserved).err()
    };
    let Some(error @ ModelError::BonesPass { edges: 5, cells: 4, .. }) = ended(14.0) else {
        panic!("it does not say what passes")
    };
    let ModelError::BonesPass { cause, .. } = &error else { unreachable!() };
    assert!(
        matches!(**cause, ModelError::Standstill { .. }) && error.code() == cause.code(),
        "{error}"
    );
    assert!(error.to_string().contains("joined:jaw and fixed"), "{error}");
}

#[test]
fn two_segments_that_move_one_node_apart_are_refused() {
    let mut case = jaw_and_skull(CellShape::Hex8);
    case.segments.push(CaseSegment { name: "chin".to_owned(), nodes: set("z_min") });
    let at = ("/plan/segments/0".to_owned(), "plan-conflict");
    assert_eq!(refusal(&case, &moved("chin", turned())), at);
    // The bone of a segment of the case, named by its node set: the plan states one segment only.
    case.segments.pop();
    let mut mesh = (*case.volume).clone();
    mesh.node_sets.insert("mandible".to_owned(), mesh.node_sets["x_min"].clone());
    case.volume = mesh.into();
    let plan = moved("mandible", turned());
    assert_eq!(refusal(&case, &plan), at);
    let error = Scene::new(&case, &plan, &Settings::default()).err().unwrap().0.remove(0);
    for told in ["node set \"mandible\"", "segment \"jaw\" of the case", "State the movement for"] {
        assert!(error.detail.contains(told), "{told}: {error}");
    }
}

#[test]
fn a_prescribed_value_against_a_joined_one_is_refused() {
    let case = jaw_and_skull(CellShape::Hex8);
    let plan =
        Plan { prescribed: vec![constraint("x_min", [None, Some(1.0), None])], ..Plan::default() };
    assert_eq!(refusal(&case, &plan), ("/plan".to_owned(), "plan-conflict"));
}

#[test]
fn unknown_names_and_empty_selections_say_where_they_are() {
    let case = jaw_and_skull(CellShape::Hex8);
    let plan = moved("nose", turned());
    assert_eq!(refusal(&case, &plan), ("/plan/segments/0/name".to_owned(), "unknown-segment"));
    let mut other = case.clone();
    other.fixed.push(set("nowhere"));
    assert_eq!(refusal(&other, &Plan::default()), ("/case/fixed/1".to_owned(), "unknown-set"));
    let mut other = case.clone();
    other.materials.clear();
    assert_eq!(
        refusal(&other, &Plan::default()),
        ("/case/materials".to_owned(), "missing-material")
    );
    let mut other = case;
    other.materials.insert("fat".to_owned(), material(3.0, 0.4));
    assert_eq!(
        refusal(&other, &Plan::default()),
        ("/case/materials/fat".to_owned(), "unknown-region")
    );
}

#[test]
fn a_sliding_direction_of_length_zero_is_refused() {
    let mut case = jaw_and_skull(CellShape::Hex8);
    let normal = SlidingNormal::Direction(Vector::zeros());
    case.sliding.push(Sliding { nodes: set("z_min"), normal, segment: None });
    assert_eq!(refusal(&case, &Plan::default()).1, "sliding-normal-zero");
}

#[test]
fn parts_that_nothing_holds_are_refused_before_anything_is_solved() {
    let mut case = jaw_and_skull(CellShape::Tet4);
    case.fixed.clear();
    case.segments.clear();
    assert_eq!(refusal(&case, &Plan::default()).1, "underconstrained");

    // A sliding plane leaves two translations and one turn.
    case.sliding.push(Sliding {
        nodes: set("z_min"),
        normal: SlidingNormal::Surface,
        segment: None,
    });
    let errors = Scene::new(&case, &Plan::default(), &Settings::default()).err().unwrap();
    assert!(errors.0[0].detail.contains("3 of the 6"), "{errors}");
}

#[test]
fn an_inverted_tetrahedron_is_reported_and_not_solved() {
    let mut case = jaw_and_skull(CellShape::Tet4);
    let mut mesh = std::sync::Arc::unwrap_or_clone(case.volume);
    mesh.cells.nodes_mut(7).swap(0, 1);
    case.volume = std::sync::Arc::new(mesh);
    let scene = Scene::new(&case, &moved("jaw", turned()), &Settings::default());
    let refused = match scene {
        Err(errors) => errors.0[0].code.name() == "mesh-inverted-elements",
        Ok(scene) => predict(&scene, &Unobserved).is_err(),
    };
    assert!(refused);
}

#[test]
fn plain_elements_and_wedges_warn_of_locking_above_nu_0_45_and_no_other_element_does() {
    let warned = |shape: CellShape, nu: f64, element: ElementChoice| {
        let mut case = jaw_and_skull(shape);
        case.materials.insert("*".to_owned(), material(15.0, nu));
        let settings = Settings { element, ..Settings::default() };
        let scene = Scene::new(&case, &Plan::default(), &settings).unwrap();
        scene.warnings.iter().any(|warning| warning.code == "locking")
    };
    for element in [ElementChoice::Plain, ElementChoice::MeanDilatation] {
        assert!(warned(CellShape::Tet4, 0.46, element));
        assert!(!warned(CellShape::Tet4, 0.45, element));
    }
    assert!(warned(CellShape::Hex8, 0.46, ElementChoice::Plain));
    for element in [ElementChoice::Auto, ElementChoice::Stabilised] {
        assert!(!warned(CellShape::Tet4, 0.499, element));
        assert!(!warned(CellShape::Hex8, 0.499, element));
    }
    assert!(!warned(CellShape::Tet4, 0.499, ElementChoice::Quadratic));
    assert!(warned(CellShape::Wedge6, 0.46, ElementChoice::MeanDilatation));
    assert!(!warned(CellShape::Wedge6, 0.45, ElementChoice::MeanDilatation));
}

#[test]
fn a_law_that_is_taken_at_each_point_locks_in_stabilised_tetrahedra_and_not_in_quadratic_ones() {
    let law = Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda: 60.0, mu: 5.0 });
    let mut case = jaw_and_skull(CellShape::Tet4);
    case.materials.insert("*".to_owned(), LinearElastic::of_law(law, 1.0).unwrap());
    let warned = |element: ElementChoice| {
        let settings = Settings { method: Method::FemNonlinear, element, ..Settings::default() };
        let scene = Scene::new(&case, &Plan::default(), &settings).unwrap();
        scene.warnings.iter().any(|warning| warning.code == "locking")
    };
    assert!(warned(ElementChoice::Stabilised) && !warned(ElementChoice::Quadratic));
}

#[test]
fn the_answer_has_the_same_bits_on_any_number_of_threads() {
    for shape in [CellShape::Tet4, CellShape::Hex8] {
        let mesh = block(Vector::new(60.0, 40.0, 30.0), [24, 16, 12], shape);
        let mut case = case_of(mesh, material(15.0, 0.46));
        case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") });
        case.fixed.push(set("x_max"));
        let answer = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                solve(&case, &moved("jaw", turned()), &Settings::default()).displacement
            })
        };
        let once = answer(1);
        assert_eq!(once, answer(1));
        for threads in [2, 3] {
            assert_eq!(once, answer(threads), "{threads} threads, {shape:?}");
        }
    }
}

#[test]
fn moving_and_turning_the_whole_scene_moves_and_turns_the_answer() {
    let case = jaw_and_skull(CellShape::Hex8);
    let here = solve(&case, &moved("jaw", turned()), &exact());
    let pose = RigidMovement::about_pivot(
        Vector::new(0.4, -1.2, 2.0),
        Vector::new(10.0, 0.0, 5.0),
        Vector::new(100.0, -30.0, 70.0),
    );
    let mut there = case.clone();
    let mut mesh = std::sync::Arc::unwrap_or_clone(there.volume);
    mesh.nodes.iter_mut().for_each(|x| *x = pose.apply(x));
    there.volume = std::sync::Arc::new(mesh);
    let movement = pose.inverse().then(&turned()).then(&pose);
    let turned_answer = solve(&there, &moved("jaw", movement), &exact());
    for (a, b) in here.displacement.iter().zip(&turned_answer.displacement) {
        assert!((pose.rotation() * a - b).norm() < 1e-8);
    }
}

/// Two blocks of one cell each that share the given corners of the first one's face at x = 1.
fn two_blocks_sharing(corners: &[usize]) -> Case {
    let mut mesh = block(Vector::new(1.0, 1.0, 1.0), [1, 1, 1], CellShape::Hex8);
    let first: Vec<u32> = mesh.cells.nodes(0).to_vec();
    // Local nodes 1, 2, 6, 5 of the first cell are 0, 3, 7, 4 of the second.
    let pairs = [(1, 0), (2, 3), (6, 7), (5, 4)];
    let mut second = [0; 8];
    for (local, slot) in second.iter_mut().enumerate() {
        let shared = pairs.iter().position(|(_, other)| *other == local);
        *slot = match shared.filter(|pair| corners.contains(pair)) {
            Some(pair) => first[pairs[pair].0],
            None => {
                let position = mesh.nodes[first[local] as usize] + Vector::x();
                mesh.nodes.push(position);
                mesh.nodes.len() as u32 - 1
            }
        };
    }
    mesh.cells.push(CellShape::Hex8, &second);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.fixed.push(set("x_min"));
    case
}

#[test]
fn a_part_that_hinges_on_an_edge_is_refused_and_one_that_shares_three_corners_is_held() {
    let free_movements = |corners: &[usize]| {
        let scene =
            Scene::new(&two_blocks_sharing(corners), &Plan::default(), &Settings::default());
        scene.err().map(|errors| errors.0[0].detail.clone())
    };
    assert!(free_movements(&[0, 1]).unwrap().contains("1 of the 6"));
    assert!(free_movements(&[0]).unwrap().contains("3 of the 6"));
    assert!(free_movements(&[]).unwrap().contains("6 of the 6"));
    assert_eq!(free_movements(&[0, 1, 2]), None);
    assert_eq!(free_movements(&[0, 1, 2, 3]), None);
}
