//! Sliding on bone that moves: n . u = n . ((R - I) x + t) across a wall that a segment carries, free along it.

use mechanics::mesh::{CellShape, Vector, VolumeMesh, sample::block};
use mechanics::model::fem::mass_tensor::MassTensorSettings;
use mechanics::model::mass_spring::{MassSpringSettings, Search};
use mechanics::model::spline::VolumeSpline;
use mechanics::optimisation::{Goal, Question, SegmentBounds, SkinPoint, Target, optimise};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Method, Plan, Prediction, Prescribed, Scene, Settings,
    Sliding, SlidingNormal,
};
use mechanics::progress::Unobserved;
use mechanics::response::build;
use mechanics::validation::Statistics;

use crate::scenes::{case_of, exact, largest_error, material, set, solve};
use crate::support::responses::{at_rest, direct};

/// Every model that slides, with the cells it takes.
fn models() -> Vec<(CellShape, Settings)> {
    let with = |shape, element, method| (shape, Settings { method, element, ..exact() });
    let fem = |shape, element| with(shape, element, Method::FemLinear);
    let auto = ElementChoice::Auto;
    vec![
        fem(CellShape::Tet4, ElementChoice::Plain),
        fem(CellShape::Tet4, ElementChoice::Stabilised),
        fem(CellShape::Tet4, ElementChoice::Quadratic),
        fem(CellShape::Hex8, ElementChoice::Plain),
        fem(CellShape::Hex8, ElementChoice::MeanDilatation),
        fem(CellShape::Wedge6, ElementChoice::MeanDilatation),
        with(CellShape::Tet4, auto, Method::MassTensor(Default::default())),
        with(CellShape::Tet4, auto, Method::MassTensorTransverse(MassTensorSettings::default())),
        with(CellShape::Tet4, auto, springs()),
        with(CellShape::Hex8, auto, Method::VolumeSpline(VolumeSpline::default())),
    ]
}

fn springs() -> Method {
    Method::MassSpring(MassSpringSettings { search: Search::Newton, most_iterations: 500 })
}

/// The first so many of them meet what holds nodes to rounding; a spline is smooth and misses it.
const EXACT: usize = 9;

fn shifted(by: [f64; 3]) -> RigidMovement {
    RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::from(by))
}

fn turned(degrees: f64) -> RigidMovement {
    let angles = Vector::new(0.0, degrees.to_radians(), 0.0);
    RigidMovement::about_pivot(angles, Vector::new(5.0, 5.0, -10.0), Vector::zeros())
}

fn moved(movement: RigidMovement) -> Plan {
    let jaw = PlannedSegment { name: "jaw".to_owned(), movement };
    Plan { segments: vec![jaw], ..Plan::default() }
}

fn segment(name: &str, nodes: &str) -> CaseSegment {
    CaseSegment { name: name.to_owned(), nodes: set(nodes) }
}

fn wall(name: &str, segment: Option<&str>) -> Sliding {
    let segment = segment.map(str::to_owned);
    Sliding { nodes: set(name), normal: SlidingNormal::Surface, segment }
}

/// A cube of 10 mm, and far beside it a cell that is all bone: set `bone`.
fn cube_beside_bone(shape: CellShape) -> VolumeMesh {
    let mut mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 3, 2], shape);
    let mut bone = block(Vector::new(10.0, 10.0, 10.0), [1, 1, 1], shape);
    bone.nodes.iter_mut().for_each(|node| node.x += 20.0);
    let first = mesh.nodes.len() as u32;
    mesh.nodes.extend(&bone.nodes);
    for (shape, nodes) in bone.cells.iter() {
        let nodes: Vec<u32> = nodes.iter().map(|node| node + first).collect();
        mesh.cells.push(shape, &nodes);
    }
    mesh.node_sets.insert("bone".to_owned(), (first..mesh.nodes.len() as u32).collect());
    mesh
}

/// The cube between sliding walls, of which the jaw carries the lower one.
fn between_walls(shape: CellShape, nu: f64) -> Case {
    let mut case = case_of(cube_beside_bone(shape), material(15.0, nu));
    case.segments = vec![segment("jaw", "bone")];
    case.sliding =
        ["x_min", "x_max", "y_min", "y_max", "z_max"].map(|name| wall(name, None)).into();
    case.sliding.push(wall("z_min", Some("jaw")));
    case
}

/// The displacement of the cube without the bone beside it.
fn of_cube<'a>(case: &Case, prediction: &'a Prediction) -> &'a [Vector] {
    let bone = case.volume.node_sets["bone"].len();
    &prediction.displacement[..prediction.displacement.len() - bone]
}

#[test]
fn a_wall_that_moves_along_itself_moves_no_tissue() {
    // The control points of a spline reach from the cube to the bone.
    for (shape, settings) in models().into_iter().take(EXACT) {
        let case = between_walls(shape, 0.46);
        let prediction = solve(&case, &moved(shifted([8.0, 0.0, 0.0])), &settings);
        let largest = of_cube(&case, &prediction).iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(largest < 1e-12, "{:?}: {largest:e}", settings.method);
    }
}

#[test]
fn a_cube_pressed_by_the_wall_of_a_jaw_resists_with_its_confined_modulus() {
    for (nu, pressure) in [(0.3, 1.009615), (0.46, 3.467465), (0.49, 12.835570)] {
        for (shape, settings) in models().into_iter().take(8) {
            let case = between_walls(shape, nu);
            let plan = moved(shifted([0.0, 0.0, 0.5]));
            let scene = Scene::new(&case, &plan, &settings).unwrap();
            let answer = scene.solve(&Unobserved).unwrap();
            let lid = &case.volume.node_sets["z_max"];
            let constraints = scene.conditions.constraints.iter().zip(&answer.reactions);
            let on_lid = constraints.filter(|(constraint, _)| lid.contains(&constraint.node));
            let found = -on_lid.map(|(_, force)| force.z).sum::<f64>() / 100.0;
            assert!((found - pressure).abs() < 1e-6, "{:?} nu {nu}: {found}", settings.method);
        }
    }
}

#[test]
fn a_wall_that_moves_across_itself_is_a_prescribed_component() {
    for (shape, settings) in models() {
        let mut case = between_walls(shape, 0.46);
        let carried = solve(&case, &moved(shifted([0.0, 0.0, 0.5])), &settings);
        case.sliding.pop();
        // Nodes on other walls too slide along these.
        let rise =
            Prescribed::Uniform { nodes: set("z_min"), displacement: [None, None, Some(0.5)] };
        let plan = Plan { prescribed: vec![rise], ..moved(shifted([0.0, 0.0, 0.5])) };
        let prescribed = solve(&case, &plan, &settings);
        for (u, v) in of_cube(&case, &carried).iter().zip(of_cube(&case, &prescribed)) {
            assert!((u - v).norm() < 1e-10, "{:?}: {u} {v}", settings.method);
        }
    }
}

#[test]
fn tissue_between_a_bone_and_its_wall_goes_with_both_as_one() {
    let shift = [2.0, -1.0, 3.0];
    for (number, (shape, settings)) in models().into_iter().enumerate() {
        let mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 3, 2], shape);
        let mut case = case_of(mesh, material(15.0, 0.46));
        case.allow_unfixed = true;
        case.segments = vec![segment("jaw", "z_min")];
        case.sliding = vec![wall("z_max", Some("jaw")), wall("x_max", Some("jaw"))];
        let prediction = solve(&case, &moved(shifted(shift)), &settings);
        let error = largest_error(&case.volume, &prediction.displacement, |_| Vector::from(shift));
        let allowed = if number < EXACT { 1e-10 } else { 1e-3 };
        assert!(error < allowed, "{:?}: {error:e}", settings.method);
        assert!(!prediction.warnings.iter().any(|w| w.code == "sliding-off-wall"));
    }
}

/// A corner of the top, all of whose nodes are held or slide, once counted as wall: a node of tetrahedra was told to leave it.
#[test]
fn nodes_that_slide_along_flat_walls_stay_on_them() {
    for (shape, settings) in models() {
        let mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 3, 2], shape);
        let mut case = case_of(mesh, material(15.0, 0.46));
        case.fixed = vec![set("x_min")];
        case.segments = vec![segment("jaw", "x_max")];
        case.sliding = vec![wall("y_min", None), wall("y_max", None)];
        let prediction = solve(&case, &moved(shifted([0.0, 0.0, 4.0])), &settings);
        assert!(
            !prediction.warnings.iter().any(|w| w.code == "sliding-off-wall"),
            "{:?} of {shape:?}",
            settings.method
        );
    }
}

#[test]
fn springs_and_finite_strain_know_that_a_wall_turns_with_its_bone() {
    let mesh = block(Vector::new(10.0, 10.0, 10.0), [2, 3, 2], CellShape::Tet4);
    let mut case = case_of(mesh, material(15.0, 0.46));
    case.allow_unfixed = true;
    case.segments = vec![segment("jaw", "z_min")];
    case.sliding = vec![wall("x_max", Some("jaw"))];
    for method in [springs(), Method::FemNonlinear] {
        let settings = Settings { method, ..exact() };
        let prediction = solve(&case, &moved(turned(25.0)), &settings);
        let exact = |x: &Vector| turned(25.0).displacement(x);
        let error = largest_error(&case.volume, &prediction.displacement, exact);
        assert!(error < 1e-8, "{:?}: {error:e}", settings.method);
        assert!(!prediction.warnings.iter().any(|w| w.code == "sliding-normal-turned"));
    }
}

#[test]
fn small_strain_says_that_it_keeps_the_normals_of_a_wall_that_turns() {
    let warned = |degrees: f64| {
        let scene =
            Scene::new(&between_walls(CellShape::Hex8, 0.46), &moved(turned(degrees)), &exact());
        let warnings = scene.unwrap().warnings;
        warnings.into_iter().find(|warning| warning.code == "sliding-normal-turned")
    };
    assert_eq!(warned(4.9), None);
    let warning = warned(5.1).unwrap();
    assert!((warning.numbers[0].1 - 5.1).abs() < 1e-9, "{warning:?}");
    assert_eq!(warning.numbers[1], ("nodes", 12.0));
}

/// 60 x 60 x 12 mm; from the middle of its base outwards the jaw, a ring that slides on its teeth, and what is fixed.
fn layer() -> Case {
    let mut mesh = block(Vector::new(60.0, 60.0, 12.0), [15, 15, 4], CellShape::Hex8);
    let outwards = |x: &Vector| (x.x - 30.0).abs().max((x.y - 30.0).abs());
    let base = mesh.node_sets["z_min"].clone();
    let within = |low: f64, high: f64| -> Vec<u32> {
        let place = |node: &u32| outwards(&mesh.nodes[*node as usize]);
        base.iter().copied().filter(|node| place(node) > low && place(node) <= high).collect()
    };
    let (jaw, ring, far) = (within(-1.0, 10.0), within(10.0, 18.0), within(25.9, 31.0));
    for (name, nodes) in [("jaw", jaw), ("ring", ring), ("far", far)] {
        mesh.node_sets.insert(name.to_owned(), nodes);
    }
    Case {
        skin: Some(set("z_max")),
        segments: vec![segment("jaw", "jaw")],
        fixed: vec![set("far")],
        sliding: vec![wall("ring", Some("jaw"))],
        ..case_of(mesh, material(15.0, 0.46))
    }
}

/// Statistics of |u| over the skin, plain over its nodes and by area.
fn on_skin(case: &Case, movement: RigidMovement) -> (Prediction, [Statistics; 2]) {
    let scene = Scene::new(case, &moved(movement), &exact()).unwrap();
    let prediction = mechanics::prediction::predict(&scene, &Unobserved).unwrap();
    let nodes = scene.skin.nodes().iter();
    let lengths: Vec<f64> =
        nodes.map(|&node| prediction.displacement[node as usize].norm()).collect();
    let plain = Statistics::weighted(&lengths, &vec![1.0; lengths.len()]).unwrap();
    let by_area = Statistics::weighted(&lengths, &scene.skin.surface.point_areas()).unwrap();
    (prediction, [plain, by_area])
}

#[test]
fn a_layer_over_a_jaw_with_teeth_rises_as_it_was_computed_independently() {
    let mut case = layer();
    let (prediction, [plain, by_area]) = on_skin(&case, shifted([0.0, 0.0, 3.0]));
    let found = [by_area.mean, plain.mean, plain.max];
    for (found, known) in found.into_iter().zip([1.8747, 1.7775, 2.8502]) {
        assert!((found - known).abs() < 1e-4, "{found} {known}");
    }
    assert!(!prediction.warnings.iter().any(|w| w.code.starts_with("sliding")));
    // Teeth that stay while their jaw rises: told, with the nodes that touch the jaw.
    case.sliding = vec![wall("ring", None)];
    let (prediction, [_, by_area]) = on_skin(&case, shifted([0.0, 0.0, 3.0]));
    assert!((by_area.mean - 0.72).abs() < 0.005, "{}", by_area.mean);
    let told = prediction.warnings.iter().find(|w| w.code == "sliding-beside-segment").unwrap();
    assert!(told.detail.contains("\"jaw\", which moves across"), "{}", told.detail);
    // The square around the 6 x 6 nodes of the jaw.
    assert_eq!(told.numbers, [("nodes", 28.0)]);
    // Along them it may go, as along a plane of symmetry; before there is a plan it may go anywhere.
    let told = |plan: &Plan| {
        let warnings = Scene::new(&case, plan, &exact()).unwrap().warnings;
        warnings.into_iter().find(|warning| warning.code == "sliding-beside-segment")
    };
    assert_eq!(told(&moved(shifted([3.0, 0.0, 0.0]))), None);
    assert!(told(&Plan::default()).unwrap().detail.contains("which may move"));
}

#[test]
fn teeth_that_move_along_their_flat_wall_pull_at_nothing() {
    let (prediction, [plain, _]) = on_skin(&layer(), shifted([3.0, 0.0, 0.0]));
    let [teeth, jaw] = ["sliding", "jaw"].map(|name| prediction.reactions[name]);
    assert!(plain.max > 1.0 && jaw.x > 10.0, "{} {jaw}", plain.max);
    assert!(teeth.x.abs() < 1e-10 * jaw.x && teeth.y.abs() < 1e-10 * jaw.x, "{teeth}");
    // The wall by itself, with the bone that carries it.
    let found = prediction.condition_reactions.iter();
    let wall = found.into_iter().find(|of| of.pointer == "/case/sliding/0").unwrap();
    assert_eq!(wall.segment.as_deref(), Some("jaw"));
    assert!((wall.force - teeth).norm() < 1e-9 * jaw.norm(), "{wall:?} {teeth}");
}

/// The same state, seen from a bone that has turned.
#[test]
fn nodes_that_leave_a_curved_wall_are_counted_however_far_its_segment_turns() {
    let mut mesh = block(Vector::new(40.0, 10.0, 10.0), [8, 2, 2], CellShape::Hex8);
    mesh.nodes.iter_mut().for_each(|x| x.y -= (x.x - 20.0).powi(2) / 80.0);
    let on_chin = mesh.node_sets["x_max"].clone();
    mesh.node_sets.get_mut("y_min").unwrap().retain(|node| !on_chin.contains(node));
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.allow_unfixed = true;
    case.segments = vec![segment("jaw", "x_min"), segment("chin", "x_max")];
    case.sliding = vec![wall("y_min", Some("jaw"))];
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let told = [0.0_f64, 60.0].map(|degrees| {
        let angles = Vector::new(0.0, 0.0, degrees.to_radians());
        let about = |shift| RigidMovement::about_pivot(angles, Vector::new(20.0, 0.0, 0.0), shift);
        let turned = about(Vector::zeros());
        let movement = about(turned.rotation() * Vector::new(12.0, 0.0, 0.0));
        let chin = PlannedSegment { name: "chin".to_owned(), movement };
        let plan =
            Plan { segments: [moved(turned).segments, vec![chin]].concat(), ..Plan::default() };
        let found = solve(&case, &plan, &settings).warnings;
        found.into_iter().find(|w| w.code == "sliding-off-wall").unwrap().numbers
    });
    for ((name, one), (_, other)) in told[0].iter().zip(&told[1]) {
        assert!((one - other).abs() < 1e-3, "{name}: {one} {other}");
    }
}

fn some_movement() -> RigidMovement {
    let angles = Vector::new(2.0, -1.5, 1.0).map(f64::to_radians);
    RigidMovement::about_pivot(angles, Vector::new(30.0, 30.0, 0.0), Vector::new(0.4, -0.3, 1.0))
}

#[test]
fn a_response_with_moving_walls_is_the_direct_solution() {
    let settings = Settings { relative_residual: 1e-14, ..Settings::default() };
    for shape in [CellShape::Hex8, CellShape::Tet4] {
        let mut case = layer();
        let mut mesh = block(Vector::new(60.0, 60.0, 12.0), [15, 15, 4], shape);
        mesh.node_sets = case.volume.node_sets.clone();
        case.volume = mesh.into();
        // A second wall, oblique and carried too, so that nodes of both have two normals.
        let oblique = SlidingNormal::Direction(Vector::new(1.0, 0.2, 0.3));
        let side =
            Sliding { nodes: set("x_max"), normal: oblique, segment: Some("jaw".to_owned()) };
        case.sliding.push(side);
        case.sliding.push(wall("y_max", None));
        let columns = build(&at_rest(&case, &settings), &[], &Unobserved).unwrap();
        assert_eq!(columns.carries_wall, [true]);
        let exact = direct(&case, &[some_movement()], &settings).displacement;
        for (node, moved) in columns.nodes.iter().zip(columns.apply(&[some_movement()])) {
            let apart = (exact[*node as usize] - moved).norm();
            assert!(apart < 1e-10, "{shape:?} {apart:e}");
        }
    }
}

#[test]
fn inverse_planning_finds_the_movement_of_a_jaw_that_carries_teeth() {
    let case = layer();
    let columns = build(&at_rest(&case, &exact()), &[], &Unobserved).unwrap();
    let skin = direct(&case, &[some_movement()], &exact()).displacement;
    let goals = (0_u32..).zip(&columns.nodes).map(|(place, &node)| Goal {
        point: SkinPoint::node(place),
        displacement: <[f64; 3]>::from(skin[node as usize]).map(Some),
    });
    let targets = [Target { goals: goals.collect(), sigma: 0.1 }];
    let turn = (-0.2, 0.2);
    let intervals = [(-5.0, 5.0), (-5.0, 5.0), (-5.0, 5.0), turn, turn, turn];
    let bounds = [SegmentBounds { intervals, pivot: Vector::new(30.0, 30.0, 0.0) }];
    let response = columns.to_response();
    let optimum = optimise(&Question {
        response: &response,
        bounds: &bounds,
        targets: &targets,
        inner: &[],
        constants: &[],
        second_order: None,
    })
    .unwrap();
    let corner = Vector::new(40.0, 20.0, 0.0);
    let apart = optimum.movements[0].displacement(&corner) - some_movement().displacement(&corner);
    assert!(apart.norm() < 1e-4, "{apart}");
}

fn refusal(case: &Case) -> (String, &'static str, String) {
    let errors = Scene::new(case, &Plan::default(), &Settings::default()).err().unwrap().0;
    assert_eq!(errors.len(), 1, "{errors:?}");
    (errors[0].pointer.clone(), errors[0].code.name(), errors[0].detail.clone())
}

#[test]
fn a_wall_on_an_unknown_segment_or_on_what_is_fixed_is_refused() {
    let mut case = layer();
    case.sliding[0].segment = Some("jaws".to_owned());
    let (pointer, code, detail) = refusal(&case);
    assert_eq!((pointer.as_str(), code), ("/case/sliding/0/segment", "unknown-segment"));
    assert!(detail.contains("\"jaws\"") && detail.ends_with("its segments: jaw"), "{detail}");
    case.sliding[0].segment = Some("far".to_owned());
    let (pointer, code, detail) = refusal(&case);
    assert_eq!((pointer.as_str(), code), ("/case/sliding/0/segment", "unknown-segment"));
    assert!(detail.contains("is fixed and no segment"), "{detail}");
}

#[test]
fn a_wall_of_two_bones_is_refused() {
    // It has nodes of another segment.
    let mut case = layer();
    case.segments.push(segment("chin", "ring"));
    let (pointer, code, detail) = refusal(&case);
    assert_eq!((pointer.as_str(), code), ("/case/sliding/0", "sliding-conflict"));
    assert!(detail.contains("64 nodes of segment \"chin\""), "{detail}");
    // It follows the jaw and stays.
    let mut case = layer();
    case.sliding.push(wall("ring", None));
    let (pointer, code, detail) = refusal(&case);
    assert_eq!((pointer.as_str(), code), ("/case/sliding/1", "sliding-conflict"));
    assert!(detail.contains("that segment \"jaw\" carries"), "{detail}");
    // At a corner each of two walls has its own.
    let mut case = layer();
    let across = SlidingNormal::Direction(Vector::x());
    case.sliding.push(Sliding { nodes: set("ring"), normal: across, segment: None });
    assert!(Scene::new(&case, &Plan::default(), &Settings::default()).is_ok());
}
