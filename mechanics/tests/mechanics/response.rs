//! Plan response: its sum of columns is the direct solution, for every movement.

use mechanics::mesh::{CellShape, Vector, VolumeMesh, sample};
use mechanics::model::fem::mass_tensor::MassTensorSettings;
use mechanics::optimisation::{
    Goal, InnerBounds, Question, SegmentBounds, SkinPoint, Target, optimise,
};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{
    Activation, Case, CaseSegment, ElementChoice, Growth, Load, Method, MethodKind, ModelError,
    Muscle, MuscleCourse, Plan, Prescribed, Scene, Settings, Sliding, SlidingNormal, SolverError,
    linear_strain,
};
use mechanics::progress::Unobserved;
use mechanics::response::linearity::LINEAR_RANGE_MM;
use mechanics::response::{
    Amounts, ColumnRequest, Linearity, ResponseError, ResponseOrder, build, build_of, coefficients,
    inner_loads,
};
use mechanics::study::methods;

use crate::scenes::{case_of, half_head_case, material, set, solve};
use crate::support::responses::{at_rest, columns, differences, direct, movements, plan_of, tight};

fn segment(name: &str) -> CaseSegment {
    CaseSegment { name: name.to_owned(), nodes: set(name) }
}

/// Two bones under a block, its far end fixed, one side along a wall, another along an oblique plane.
fn block(shape: CellShape) -> Case {
    let mut mesh = sample::block(Vector::new(60.0, 40.0, 12.0), [10, 6, 3], shape);
    let bottom = mesh.node_sets["z_min"].clone();
    let within = |mesh: &VolumeMesh, low: f64, high: f64| -> Vec<u32> {
        let inside = |node: &&u32| (low..=high).contains(&mesh.nodes[**node as usize].x);
        bottom.iter().filter(inside).copied().collect()
    };
    let (first, second) = (within(&mesh, 0.0, 19.0), within(&mesh, 29.0, 43.0));
    mesh.node_sets.insert("first".to_owned(), first);
    mesh.node_sets.insert("second".to_owned(), second);
    let along = |name: &str, normal| Sliding { nodes: set(name), normal, segment: None };
    Case {
        segments: vec![segment("first"), segment("second")],
        fixed: vec![set("x_max")],
        sliding: vec![
            along("y_min", SlidingNormal::Surface),
            along("y_max", SlidingNormal::Direction(Vector::new(0.3, 1.0, 0.2))),
        ],
        ..case_of(mesh, material(15.0, 0.46))
    }
}

#[test]
fn the_sum_of_columns_is_the_direct_solution_with_sliding_walls() {
    for shape in [CellShape::Tet4, CellShape::Hex8] {
        let [in_f64, in_f32] = differences(&block(shape));
        // Both were solved to 1e-12 of some 25 mm; f32 keeps 1e-7 of columns of up to 60 mm.
        assert!(in_f64 < 1e-7, "{in_f64:e}");
        assert!(in_f32 > in_f64 && in_f32 < 1e-4, "{in_f32:e}");
    }
}

#[test]
fn the_sum_of_columns_is_the_direct_solution_on_a_half_head() {
    let [in_f64, in_f32] = differences(&half_head_case(0.45));
    assert!(in_f64 < 1e-7 && in_f32 < 1e-4, "{in_f64:e} {in_f32:e}");
}

#[test]
fn columns_solved_to_the_usual_tolerance_serve_to_a_ten_thousandth_of_a_millimetre() {
    let case = half_head_case(0.45);
    let usual = columns(&case, &Settings::default()).to_response().apply(&movements());
    let exact = columns(&case, &tight()).apply(&movements());
    let largest = exact.iter().zip(&usual).map(|(u, v)| (u - v).norm()).fold(0.0, f64::max);
    assert!(largest < 1e-4, "{largest:e}");
}

#[test]
fn the_twelve_numbers_give_back_the_movement() {
    let centre = Vector::new(3.0, 40.0, -50.0);
    for movement in movements() {
        let a = coefficients(&movement, &centre);
        let point = Vector::new(12.0, -70.0, 33.0);
        let x = point - centre;
        let sum =
            Vector::from_fn(|i, _| (0..3).map(|j| a[4 * i + j] * x[j]).sum::<f64>() + a[4 * i + 3]);
        assert!((sum - movement.displacement(&point)).norm() < 1e-12);
    }
}

#[test]
fn a_response_of_one_segment_leaves_the_others_where_they_are() {
    let case = block(CellShape::Hex8);
    let scene = at_rest(&case, &tight());
    let second = build(&scene, &["second".to_owned()], &Unobserved).unwrap();
    assert_eq!(second.segments.len(), 1);
    assert_eq!(second.values.len(), 12 * 3 * second.nodes.len());
    let movement = movements()[1];
    let exact = direct(&case, &[RigidMovement::default(), movement], &tight()).displacement;
    for (node, moved) in second.nodes.iter().zip(second.apply(&[movement])) {
        assert!((exact[*node as usize] - moved).norm() < 1e-7);
    }
}

#[test]
fn nothing_moves_where_no_segment_does() {
    let columns = columns(&block(CellShape::Hex8), &Settings::default());
    let still = columns.apply(&[RigidMovement::default(); 2]);
    assert!(still.iter().all(|u| *u == Vector::zeros()));
    let nonlinearity = columns.linearity.of(&[RigidMovement::default(); 2]);
    assert_eq!((nonlinearity.estimate, nonlinearity.is_within_linear_range()), (0.0, true));
}

#[test]
fn what_no_response_can_follow_is_refused_with_its_numbers() {
    let refused = |case: &Case, plan: &Plan, names: &[&str]| {
        let scene = Scene::new(case, plan, &Settings::default()).unwrap();
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        build(&scene, &names, &Unobserved).unwrap_err()
    };
    let (mut case, still) = (block(CellShape::Hex8), Plan::default());
    let unknown = refused(&case, &still, &["third"]);
    let known = "first, second".to_owned();
    assert_eq!(unknown, ResponseError::UnknownSegment { name: "third".to_owned(), known });
    let gravity = Load::Gravity { acceleration: Vector::new(0.0, 0.0, -9.81e-3) };
    let loaded = Plan { loads: vec![gravity], ..Plan::default() };
    assert_eq!(refused(&case, &loaded, &[]), ResponseError::Loaded);
    let pulled = Prescribed::Uniform { nodes: set("z_max"), displacement: [Some(1.0), None, None] };
    let pulled = Plan { prescribed: vec![pulled], ..Plan::default() };
    assert_eq!(refused(&case, &pulled, &[]), ResponseError::Loaded);

    let both = case.volume.node_sets["first"].len();
    case.segments.push(CaseSegment { name: "again".to_owned(), nodes: set("first") });
    assert_eq!(
        refused(&case, &still, &[]),
        ResponseError::SharedNodes { count: both, first: case.volume.node_sets["first"][0] }
    );
    case.segments.clear();
    assert_eq!(refused(&case, &still, &[]), ResponseError::NoSegments);

    let small = Settings { memory_mb: 0.5, ..Settings::default() };
    let error = build(&at_rest(&half_head_case(0.45), &small), &[], &Unobserved).unwrap_err();
    let ResponseError::Prediction(ModelError::Solver(SolverError::OverBudget {
        needed_mb,
        allowed_mb,
    })) = error
    else {
        panic!("{error}")
    };
    assert!(needed_mb > 0.5 && allowed_mb == 0.5);
}

#[test]
fn the_rule_of_thumb_covers_what_was_measured_on_the_slab() {
    // Mean distance of the skin between linear and neo-Hookean tissue on a slab of 12 mm, by an independent
    // program (docs/verification.md#v29): lifted and pushed, pushed along, pulled back.
    let measured = [
        (Vector::new(4.0, 0.0, 8.0), [(0.25, 0.048), (0.5, 0.186), (1.0, 0.697), (1.5, 1.464)]),
        (Vector::x(), [(2.0, 0.013), (4.0, 0.052), (8.0, 0.181), (12.0, 0.415)]),
        (-Vector::z(), [(1.5, 0.024), (3.0, 0.098), (6.0, 0.414), (9.0, 0.981)]),
    ];
    let linearity = Linearity {
        thickness: 12.0,
        something_stays: true,
        boxes: vec![[Vector::zeros(), Vector::new(12.0, 12.0, 0.0)]],
        sampled: Vec::new(),
        coupling: Vec::new(),
    };
    for (direction, rows) in measured {
        for (share, difference) in rows {
            let movement =
                RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), direction * share);
            let estimate = linearity.of(&[movement]).estimate;
            let ratio = estimate / difference;
            assert!((1.0..4.5).contains(&ratio), "{direction} {share}: {ratio}");
        }
    }
}

#[test]
fn a_bone_that_carries_all_tissue_around_is_a_rotation_and_the_estimate_knows_the_artefact() {
    // Nothing else is held, so the tissue turns as a whole, and linear tissue swells instead.
    let mesh = sample::block(Vector::new(60.0, 60.0, 12.0), [10, 10, 4], CellShape::Hex8);
    let case = Case {
        skin: Some(set("z_max")),
        segments: vec![segment("z_min")],
        allow_unfixed: true,
        ..case_of(mesh, material(15.0, 0.46))
    };
    let columns = columns(&case, &tight());
    // Nodes stand below skin nodes, so the median distance is the thickness.
    assert!((columns.linearity.thickness - 12.0).abs() < 1e-12);
    let middle = Vector::new(30.0, 30.0, 0.0);
    let shifted = RigidMovement::about_pivot(Vector::zeros(), middle, Vector::new(9.0, 9.0, 9.0));
    // Without rotation nothing is left out, however far everything moves.
    let estimate = columns.linearity.of(&[shifted]).estimate;
    assert!(estimate < 1e-9, "{estimate}");
    for degrees in [2.0, 10.0, 30.0] {
        let angles = Vector::new(0.0, f64::to_radians(degrees), 0.0);
        let movement = RigidMovement::about_pivot(angles, middle, Vector::zeros());
        let moved = columns.apply(&[movement]);
        let errors = columns.nodes.iter().zip(moved).map(|(&node, u)| {
            (u - movement.displacement(&case.volume.nodes[node as usize])).norm()
        });
        let (sum, count) =
            errors.fold((0.0, 0.0), |(sum, count), error| (sum + error, count + 1.0));
        let ratio = columns.linearity.of(&[movement]).estimate / (sum / count);
        assert!((0.5..2.0).contains(&ratio), "{degrees}: {ratio}");
    }
}

#[test]
fn a_response_of_a_method_that_is_not_linear_is_refused_and_that_of_every_other_is_built() {
    let case = block(CellShape::Tet4);
    for method in MethodKind::ALL {
        let settings = methods::of_method(*method).remove(0).settings;
        let scene = Scene::new(&case, &Plan::default(), &settings).unwrap();
        match build(&scene, &[], &Unobserved) {
            Ok(_) => assert!(method.properties().is_linear, "{method:?}"),
            Err(ResponseError::OtherMethod) => assert!(!method.properties().is_linear),
            Err(other) => panic!("{method:?}: {other}"),
        }
    }
}

#[test]
fn a_response_of_tensors_for_tissue_with_fibres_is_that_of_plain_tetrahedra() {
    let of = |method, element| {
        let settings = Settings { method, element, ..tight() };
        columns(&block(CellShape::Tet4), &settings).values
    };
    let tensors =
        of(Method::MassTensorTransverse(MassTensorSettings::default()), ElementChoice::Auto);
    assert_eq!(tensors, of(Method::FemLinear, ElementChoice::Plain));
}

#[test]
fn two_segments_that_part_are_farther_apart_than_either_moves() {
    let case = Case { skin: Some(set("z_max")), ..block(CellShape::Hex8) };
    let columns = columns(&case, &Settings::default());
    let by = |x| RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::x() * x);
    let found = columns.linearity.of(&[by(-2.0), by(3.0)]);
    assert!((found.largest_relative_movement - 5.0).abs() < 1e-12);
    assert!(found.estimate < LINEAR_RANGE_MM && found.is_within_linear_range());
    assert!(!columns.linearity.of(&[by(-20.0), by(3.0)]).is_within_linear_range());
}

/// A long block whose far end nothing moves.
fn long_block() -> Case {
    let mut mesh = sample::block(Vector::new(160.0, 20.0, 10.0), [32, 4, 3], CellShape::Tet4);
    let (jaw, rest): (Vec<u32>, Vec<u32>) =
        mesh.node_sets["z_min"].iter().partition(|node| mesh.nodes[**node as usize].x < 11.0);
    mesh.node_sets.insert("jaw".to_owned(), jaw);
    mesh.node_sets.insert("rest".to_owned(), rest);
    Case {
        skin: Some(set("z_max")),
        segments: vec![segment("jaw")],
        fixed: vec![set("rest")],
        ..case_of(mesh, material(15.0, 0.45))
    }
}

#[test]
fn what_linearity_leaves_out_is_told_of_the_skin_that_moves() {
    let case = long_block();
    let movement =
        RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::new(0.0, 0.0, 4.0));
    let told = columns(&case, &tight()).linearity.of(&[movement]).estimate;
    let prediction = direct(&case, &[movement], &tight());
    let left_out = prediction.nonlinearity.unwrap().left_out;
    let skin = at_rest(&case, &tight()).skin;
    let moving = skin.moving_points(&prediction.displacement);
    let mean = skin.mean_length(&moving, &left_out);
    assert!((told - mean).abs() < 0.15 * mean, "{told} {mean}");
    let diluted = skin.mean_length(&skin.points(), &left_out);
    assert!(told > 2.0 * diluted, "{told} {diluted}, {} points", moving.len());
}

/// The half head with a muscle around lines on each side, and fat of which there is less.
fn head_with_muscles() -> Case {
    let case = half_head_case(0.45);
    let [low, high] = case.volume.bounds();
    let at = |a: f64, b: f64, c: f64| low + (high - low).component_mul(&Vector::new(a, b, c));
    let line = |x: f64| vec![at(0.5, x, 0.2), at(0.6, x, 0.5), at(0.5, x, 0.8)];
    let muscle = |name: &str, x: f64| Muscle {
        name: name.to_owned(),
        course: MuscleCourse::Lines { lines: vec![line(x)], within: 15.0 },
        tissue: None,
        stiffening: None,
    };
    Case { muscles: vec![muscle("left", 0.1), muscle("right", 0.2)], ..case }
}

#[test]
fn growth_and_muscles_add_to_the_sum_of_columns_as_they_do_to_the_direct_solution() {
    let mut block = block(CellShape::Hex8);
    let lines = vec![vec![Vector::new(30.0, 5.0, 9.0), Vector::new(50.0, 35.0, 6.0)]];
    let course = MuscleCourse::Lines { lines, within: 8.0 };
    block.muscles =
        vec![Muscle { name: "left".to_owned(), course, tissue: None, stiffening: None }];
    for (case, element) in [
        (head_with_muscles(), ElementChoice::Auto),
        (block.clone(), ElementChoice::Auto),
        (head_with_muscles(), ElementChoice::Plain),
        (head_with_muscles(), ElementChoice::Quadratic),
    ] {
        let settings = Settings { element, ..tight() };
        let rest = at_rest(&case, &settings);
        let inner = inner_loads(&rest, &["*".to_owned()], &["left".to_owned()]).unwrap();
        let asked = ColumnRequest { segments: &[], order: ResponseOrder::First, inner: &inner };
        let columns = build_of(&rest, &asked, &Unobserved).unwrap();
        let plan = Plan {
            growth: vec![Growth { region: "*".to_owned(), volume_change: -0.05 }],
            activations: vec![Activation { muscle: "left".to_owned(), stress: 12.0 }],
            ..plan_of(&case, &movements())
        };
        let exact = solve(&case, &plan, &settings).displacement;
        let amounts = [linear_strain(-0.05), 12.0];
        let amounts = Amounts { movements: &movements(), inner: &amounts };
        let moved = columns.apply_all(&amounts);
        let stored = columns.to_response().apply_all(&amounts);
        let without = columns.apply(&movements());
        let mut apart: f64 = 0.0;
        for (place, &node) in columns.nodes.iter().enumerate() {
            let direct = exact[node as usize];
            assert!((moved[place] - direct).norm() < 1e-7, "{element:?}");
            assert!((stored[place] - direct).norm() < 1e-4, "{element:?}");
            apart = apart.max((without[place] - direct).norm());
        }
        assert!(apart > 0.05, "{element:?}: growth and muscles move the skin by {apart} mm");
    }
}

#[test]
fn a_response_refuses_regions_and_muscles_that_are_not_there_and_a_second_order_of_them() {
    let rest = at_rest(&head_with_muscles(), &tight());
    let refused = |growth: &str, muscle: &str| {
        inner_loads(&rest, &[growth.to_owned()], &[muscle.to_owned()]).unwrap_err().to_string()
    };
    let of_region = refused("fat", "left");
    assert!(of_region.contains("\"fat\"") && of_region.contains("tissue"), "{of_region}");
    let of_muscle = refused("tissue", "jaw");
    assert!(of_muscle.contains("\"jaw\"") && of_muscle.contains("right"), "{of_muscle}");
    let inner = inner_loads(&rest, &[], &["left".to_owned()]).unwrap();
    let asked = ColumnRequest { segments: &[], order: ResponseOrder::Second, inner: &inner };
    let refused = build_of(&rest, &asked, &Unobserved).unwrap_err();
    assert_eq!(refused, ResponseError::NoSecondOrderInside);
}

#[test]
fn inverse_planning_finds_the_plan_beside_growth_and_muscles_that_stay() {
    let case = head_with_muscles();
    let rest = at_rest(&case, &tight());
    let inner = inner_loads(&rest, &["*".to_owned()], &["right".to_owned()]).unwrap();
    let asked = ColumnRequest { segments: &[], order: ResponseOrder::First, inner: &inner };
    let response = build_of(&rest, &asked, &Unobserved).unwrap().to_response();
    let planted = [Vector::new(1.0, -2.0, 3.0), Vector::new(-0.5, 4.0, 0.0)];
    let movements = planted
        .map(|shift| RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), shift))
        .to_vec();
    let held = [linear_strain(0.1), 30.0];
    let skin = response.apply_all(&Amounts { movements: &movements, inner: &held });
    let goal = |(place, u): (usize, &Vector)| Goal {
        point: SkinPoint::node(place as u32),
        displacement: [Some(u.x), Some(u.y), Some(u.z)],
    };
    let goals: Vec<Goal> = skin.iter().enumerate().step_by(11).map(goal).collect();
    let free = [(-10.0, 10.0), (-10.0, 10.0), (-10.0, 10.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)];
    let bounds = [(); 2].map(|()| SegmentBounds { intervals: free, pivot: Vector::zeros() });
    let targets = [Target { goals, sigma: 1.0 }];
    let (inner, constants) = (&held.map(InnerBounds::Held), &[]);
    let question = Question {
        response: &response,
        bounds: &bounds,
        targets: &targets,
        inner,
        constants,
        second_order: None,
    };
    let optimum = optimise(&question).unwrap();
    for (found, planted) in optimum.movements.iter().zip(&planted) {
        assert!((found.translation() - planted).norm() < 1e-6, "{}", found.translation());
    }
    assert!(optimum.targets[0].rms < 1e-6, "{}", optimum.targets[0].rms);
}
