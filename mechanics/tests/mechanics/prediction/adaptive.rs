//! Adaptive refinement: where the skin is off, until it is not, at the nodes of the case.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::mesh::CellShape;
use mechanics::mesh::Vector;
use mechanics::mesh::refinement::refine;
use mechanics::mesh::sample::block;
use mechanics::muscle::strap::box_surface;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Activation, AdaptiveError, AdaptivePrediction, BodyFibres, Case, CaseSegment, ElementChoice,
    FibreDirection, LimitError, Load, Muscle, MuscleCourse, Plan, RefinementGoal, Scene, Settings,
    Sliding, SlidingNormal, Stop, predict, predict_adaptively,
};
use mechanics::progress::Unobserved;
use mechanics::study::scenes::slab;

use crate::scenes::{case_of, constraint, material, set};

fn scene() -> (Case, Plan) {
    let slab = slab();
    let materials = slab.materials[0].by_region.clone();
    (Case { materials, ..slab.case }, slab.plans[0].1.clone())
}

fn wanted(skin_mm: f64, cells: usize) -> RefinementGoal {
    RefinementGoal {
        skin_mm,
        regions_mm: BTreeMap::new(),
        landmarks_mm: BTreeMap::new(),
        is_of_answer: false,
        cells,
        time_s: f64::INFINITY,
    }
}

fn adapted(case: &Case, plan: &Plan, wanted: &RefinementGoal) -> AdaptivePrediction {
    let scene = Scene::new(case, plan, &Settings::default()).unwrap();
    predict_adaptively(&scene, wanted, &|| 0.0, &Unobserved).unwrap()
}

/// The mean distance at skin nodes of the case, in mm.
fn apart(case: &Case, plan: &Plan, a: &[Vector], b: &[Vector]) -> f64 {
    let scene = Scene::new(case, plan, &Settings::default()).unwrap();
    let nodes = scene.skin.nodes().iter().map(|&node| node as usize);
    nodes.clone().map(|node| (a[node] - b[node]).norm()).sum::<f64>() / nodes.len() as f64
}

#[test]
fn a_mesh_that_is_good_enough_is_left_alone() {
    let (case, plan) = scene();
    let adapted = adapted(&case, &plan, &wanted(10.0, 1_000_000));
    assert_eq!((adapted.stop, adapted.levels.len()), (Stop::Met, 1));
    assert!(adapted.finest.is_none());
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    assert_eq!(adapted.prediction.displacement, predict(&scene, &Unobserved).unwrap().displacement);
}

#[test]
fn seven_tenths_of_the_unknowns_where_they_count_come_as_near_within_a_third() {
    let (case, plan) = scene();
    let mut finer = case.clone();
    finer.volume = refine(&refine(&finer.volume)).into();
    let solve = |element: ElementChoice| {
        let settings = Settings { element, ..Settings::default() };
        predict(&Scene::new(&finer, &plan, &settings).unwrap(), &Unobserved).unwrap()
    };
    let (uniform, truth) = (solve(ElementChoice::Auto), solve(ElementChoice::Quadratic));
    let adapted = adapted(&case, &plan, &wanted(1e-3, 30_000));
    let [of_uniform, of_adapted] = [&uniform, &adapted.prediction]
        .map(|own| apart(&case, &plan, &own.displacement, &truth.displacement));
    assert_eq!(adapted.stop, Stop::Cells);
    let unknowns = [&adapted.prediction, &uniform].map(|own| own.solver.unknowns as f64);
    assert!(unknowns[0] < 0.7 * unknowns[1], "{unknowns:?}");
    assert!(of_adapted < 1.3 * of_uniform, "{of_adapted} {of_uniform}");
    assert_eq!(adapted.prediction.displacement.len(), case.volume.nodes.len());
    assert_eq!(adapted.prediction.deformation.len(), case.volume.cells.len());
    let mut warnings = adapted.prediction.warnings.iter();
    assert!(warnings.any(|warning| warning.code == "tolerance-not-met"));
}

#[test]
fn the_error_of_a_level_is_that_of_the_skin_that_moves() {
    let (case, plan) = scene();
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let adapted = predict_adaptively(&scene, &wanted(10.0, 1), &|| 0.0, &Unobserved).unwrap();
    let prediction = predict(&scene, &Unobserved).unwrap();
    let missing = prediction.numerical_error.unwrap().missing;
    let moving = scene.skin.moving_points(&prediction.displacement);
    let mean = |points: &[u32]| scene.skin.mean_length(points, &missing);
    assert!((adapted.levels[0].mean_mm - mean(&moving)).abs() < 1e-9);
    assert!(mean(&moving) > 1.01 * mean(&scene.skin.points()), "{} move", moving.len());
}

#[test]
fn refinement_goes_on_until_the_estimate_is_accepted() {
    let (case, plan) = scene();
    let coarse = adapted(&case, &plan, &wanted(10.0, 1_000_000)).levels[0].mean_mm;
    let adapted = adapted(&case, &plan, &wanted(0.5 * coarse, 1_000_000));
    let means: Vec<f64> = adapted.levels.iter().map(|level| level.mean_mm).collect();
    // What linearity leaves out is more than that, which no mesh mends.
    assert_eq!(adapted.stop, Stop::Incomplete, "{means:?}");
    assert!(adapted.prediction.warnings.iter().any(|own| own.code == "tolerance-not-met"));
    let (last, before) = means.split_last().unwrap();
    assert!(*last <= 0.5 * coarse && before.iter().all(|mean| *mean > 0.5 * coarse), "{means:?}");
}

/// A slab held below whose bottom moves at both ends, with a landmark and a part of the skin above the left one.
fn slab_moved_at_both_ends() -> (Case, Plan) {
    let mut mesh = block(Vector::new(60.0, 20.0, 10.0), [18, 6, 3], CellShape::Tet4);
    let where_ = |is_inside: &dyn Fn(&Vector) -> bool| -> Vec<u32> {
        (0_u32..).zip(&mesh.nodes).filter(|(_, x)| is_inside(x)).map(|(node, _)| node).collect()
    };
    let ends = where_(&|x| x.z == 0.0 && (x.x - 30.0).abs() > 20.0);
    let rest = where_(&|x| x.z == 0.0 && (x.x - 30.0).abs() <= 20.0);
    let left = where_(&|x| x.z == 10.0 && x.x < 15.0);
    mesh.node_sets.extend([
        ("ends".to_owned(), ends),
        ("rest".into(), rest),
        ("left".into(), left),
    ]);
    let case = Case {
        skin: Some(set("z_max")),
        skin_regions: BTreeMap::from([("left".to_owned(), set("left"))]),
        landmarks: BTreeMap::from([
            ("left".to_owned(), Vector::new(8.0, 9.0, 10.5)),
            ("below".to_owned(), Vector::new(8.0, 9.0, 0.0)),
        ]),
        fixed: vec![set("rest")],
        ..case_of(mesh, material(15.0, 0.45))
    };
    (case, lifted_at_both_ends(4.0))
}

fn lifted_at_both_ends(mm: f64) -> Plan {
    let prescribed = vec![constraint("ends", [Some(0.0), Some(0.0), Some(mm)])];
    Plan { prescribed, ..Plan::default() }
}

/// New nodes of the left half, and of both.
fn new_nodes(case: &Case, adapted: &AdaptivePrediction) -> [usize; 2] {
    let finest = adapted.finest.as_ref().unwrap();
    let new = &finest.scene.mesh.nodes[case.volume.nodes.len()..];
    [new.iter().filter(|x| x.x < 30.0).count(), new.len()]
}

#[test]
fn a_part_of_the_skin_with_a_limit_of_its_own_is_refined_for() {
    let (case, plan) = slab_moved_at_both_ends();
    let cells = 4 * case.volume.cells.len();
    let own = RefinementGoal {
        regions_mm: BTreeMap::from([("left".to_owned(), 1e-3)]),
        ..wanted(100.0, cells)
    };
    let adapted = adapted(&case, &plan, &own);
    assert!(adapted.levels.len() > 1);
    assert!(adapted.levels.iter().all(|level| level.regions_mm.contains_key("left")));
    let [left, all] = new_nodes(&case, &adapted);
    assert!(left > 4 * (all - left), "{left} of {all}");
}

#[test]
fn a_landmark_with_a_limit_of_its_own_is_refined_for_until_its_error_is_met() {
    let (case, _) = slab_moved_at_both_ends();
    // So little that linearity leaves out less.
    let plan = lifted_at_both_ends(0.04);
    let at = |name: &str, accepted: f64| RefinementGoal {
        landmarks_mm: BTreeMap::from([(name.to_owned(), accepted)]),
        ..wanted(100.0, 100_000)
    };
    let first = adapted(&case, &plan, &at("left", 100.0));
    let [level] = &first.levels[..] else { panic!("{:?}", first.levels) };
    let (error, told) = (level.landmarks_mm["left"], first.prediction.landmarks_missing["left"]);
    assert!((error - told.norm()).abs() < 1e-12, "{error} {told}");
    let accepted = 0.4 * error;
    let adapted = adapted(&case, &plan, &at("left", accepted));
    assert_eq!(adapted.stop, Stop::Met);
    let errors: Vec<f64> = adapted.levels.iter().map(|own| own.landmarks_mm["left"]).collect();
    let (last, before) = errors.split_last().unwrap();
    assert!(*last <= accepted && before.iter().all(|own| *own > accepted), "{errors:?}");
    assert!((last - adapted.prediction.landmarks_missing["left"].norm()).abs() < 1e-12);
    let [left, all] = new_nodes(&case, &adapted);
    assert!(left > 4 * (all - left), "{left} of {all}");

    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    for (name, error) in [
        ("nose", LimitError::UnknownLandmark("nose".to_owned())),
        ("below", LimitError::FarLandmark { name: "below".to_owned(), distance: 10.0 }),
    ] {
        let ended = predict_adaptively(&scene, &at(name, 1.0), &|| 0.0, &Unobserved);
        assert_eq!(ended.err(), Some(AdaptiveError::Limit(error)));
    }
}

/// Why an answer on the first mesh is not called met though the mesh is.
fn objections(case: &Case, plan: &Plan, settings: &Settings, is_of_answer: bool) -> Vec<String> {
    let scene = Scene::new(case, plan, settings).unwrap();
    let wanted = RefinementGoal { is_of_answer, ..wanted(1e3, 1_000_000) };
    let adapted = predict_adaptively(&scene, &wanted, &|| 0.0, &Unobserved).unwrap();
    let warnings = adapted.prediction.warnings.into_iter();
    let told: Vec<String> = warnings
        .filter(|warning| warning.code == "tolerance-not-met")
        .map(|warning| warning.detail)
        .collect();
    let stop = if told.is_empty() { Stop::Met } else { Stop::Incomplete };
    assert_eq!((adapted.stop, adapted.levels.len()), (stop, 1), "{told:?}");
    told
}

#[test]
fn an_answer_that_something_speaks_against_is_not_met_on_any_mesh() {
    let (case, _) = slab_moved_at_both_ends();
    let usual = Settings::default();
    let pressed = Plan {
        prescribed: vec![constraint("ends", [Some(25.0), Some(0.0), Some(9.0)])],
        ..Plan::default()
    };
    let loose = Settings { relative_residual: 1e-2, ..usual.clone() };
    for is_of_answer in [false, true] {
        assert!(objections(&case, &lifted_at_both_ends(0.1), &usual, is_of_answer).is_empty());
        let found = objections(&case, &pressed, &usual, is_of_answer);
        assert!(found.iter().any(|told| told.contains("inside out")), "{found:?}");
        let found = objections(&case, &lifted_at_both_ends(0.1), &loose, is_of_answer);
        assert!(found.iter().any(|told| told.contains("relative residual")), "{found:?}");
    }
}

/// The second order across a wall that turns with its segment is not known.
#[test]
fn an_answer_of_unknown_linearity_is_not_met_on_any_mesh() {
    let mesh = block(Vector::new(60.0, 40.0, 20.0), [5, 4, 3], CellShape::Tet4);
    let carried = Sliding {
        nodes: set("x_min"),
        normal: SlidingNormal::Surface,
        segment: Some("jaw".to_owned()),
    };
    let case = Case {
        skin: Some(set("z_max")),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("z_min") }],
        sliding: vec![carried],
        allow_unfixed: true,
        ..case_of(mesh, material(15.0, 0.3))
    };
    let turned = |degrees: f64| {
        let angles = Vector::new(degrees, -degrees, degrees).map(f64::to_radians);
        let movement = RigidMovement::about_pivot(angles, Vector::zeros(), Vector::x());
        let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
        Plan { segments, ..Plan::default() }
    };
    for is_of_answer in [false, true] {
        let told =
            |degrees: f64| objections(&case, &turned(degrees), &Settings::default(), is_of_answer);
        let [unknown] = &told(4.0)[..] else { panic!() };
        assert!(unknown.contains("not known") && unknown.contains("jaw"), "{unknown}");
        assert!(told(0.0).is_empty());
    }
}

#[test]
fn what_auto_accepts_is_mesh_and_linearity_together() {
    let (case, _) = slab_moved_at_both_ends();
    let errors = |adapted: &AdaptivePrediction, case: &Case, plan: &Plan| {
        let scene = Scene::new(case, plan, &Settings::default()).unwrap();
        let moving = scene.skin.moving_points(&adapted.prediction.displacement);
        let left = &adapted.prediction.nonlinearity.as_ref().unwrap().left_out;
        (adapted.levels.last().unwrap().mean_mm, scene.skin.mean_length(&moving, left))
    };
    let whole = lifted_at_both_ends(4.0);
    let first = adapted(&case, &whole, &wanted(1e3, 100_000));
    let (mesh, linearity) = errors(&first, &case, &whole);
    // The first order of the mesh and the second of linearity, so that they are as 5 to 3.
    let share = 0.6 * mesh / linearity;
    let plan = lifted_at_both_ends(4.0 * share);
    let of_mesh = wanted(1.3 * share * mesh, 100_000);
    let named = adapted(&case, &plan, &of_mesh);
    assert_eq!((named.stop, named.levels.len()), (Stop::Met, 1));
    let of_answer = RefinementGoal { is_of_answer: true, ..of_mesh };
    let chosen = adapted(&case, &plan, &of_answer);
    let (mesh, linearity) = errors(&chosen, &case, &plan);
    assert!(chosen.levels.len() > 1 && mesh + linearity <= of_answer.skin_mm);
    assert_eq!(chosen.stop, Stop::Met, "{:?}", chosen.prediction.warnings);
}

#[test]
fn the_same_scene_gives_the_same_meshes_on_one_thread_and_on_two() {
    let (case, plan) = scene();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let adapted = pool.install(|| adapted(&case, &plan, &wanted(1e-3, 20_000)));
        (adapted.levels, adapted.prediction.displacement, adapted.finest.unwrap().scene.mesh)
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn muscles_around_lines_and_in_surfaces_are_told_to_stay_as_coarse_as_they_were() {
    let (mut case, still) = scene();
    let middle = case.volume.nodes.iter().sum::<Vector>() / case.volume.nodes.len() as f64;
    let line = vec![middle - Vector::x() * 20.0, middle + Vector::x() * 20.0];
    let course = MuscleCourse::Lines { lines: vec![line], within: 15.0 };
    let name = "levator".to_owned();
    case.muscles = vec![Muscle { name: name.clone(), course, tissue: None, stiffening: None }];
    let pulling =
        Plan { activations: vec![Activation { muscle: name, stress: 5.0 }], ..still.clone() };
    let told = |case: &Case, plan: &Plan, skin_mm: f64| {
        let adapted = adapted(case, plan, &wanted(skin_mm, 20_000));
        adapted.prediction.warnings.iter().any(|own| own.code == "muscles-not-refined")
    };
    assert!(told(&case, &pulling, 1e-3));
    assert!(!told(&case, &still, 1e-3) && !told(&case, &pulling, 1e3));

    // So are those in surfaces, with tissue of their own whether they pull or not.
    let surface = Arc::new(box_surface(middle, [0, 1, 2].map(|k| Vector::ith(k, 4.0))));
    let fibres = BodyFibres::Course(FibreDirection::Uniform(Vector::x()));
    case.muscles[0].course = MuscleCourse::Body { surface, fibres };
    assert!(told(&case, &pulling, 1e-3) && !told(&case, &still, 1e-3));
    case.muscles[0].tissue = Some(material(60.0, 0.4));
    assert!(told(&case, &still, 1e-3));
}

#[test]
fn a_sheet_inside_tissue_and_forces_at_nodes_are_told_to_stay_points() {
    let mut mesh = block(Vector::new(20.0, 20.0, 20.0), [4, 4, 4], CellShape::Tet4);
    let middle = |x: &Vector| [x.x, x.y, x.z].iter().all(|at| *at > 4.0 && *at < 16.0);
    let sheet = (0_u32..).zip(&mesh.nodes).filter(|(_, x)| middle(x) && (x.z - 10.0).abs() < 0.1);
    let sheet: Vec<u32> = sheet.map(|(node, _)| node).collect();
    assert_eq!(sheet.len(), 9);
    mesh.node_sets.insert("sheet".to_owned(), sheet);
    let base = Case { fixed: vec![set("z_min")], ..case_of(mesh, material(15.0, 0.3)) };
    let numbers = |case: &Case, plan: &Plan| {
        let adapted = adapted(case, plan, &wanted(1e-3, 8000));
        assert!(adapted.finest.is_some());
        let mut warnings = adapted.prediction.warnings.into_iter();
        let told = warnings.find(|warning| warning.code == "points-refined")?;
        Some(told.numbers.iter().take(2).map(|(_, value)| *value).collect::<Vec<f64>>())
    };
    let moved_by = |name: &str, mm: f64| Plan {
        prescribed: vec![constraint(name, [Some(0.5 * mm), Some(0.0), Some(mm)])],
        ..Plan::default()
    };
    let moved = |name: &str| moved_by(name, 1.0);
    assert_eq!(numbers(&base, &moved("sheet")), Some(vec![9.0, 0.0]));
    assert_eq!(numbers(&base, &moved("z_max")), None);
    let pulled = Plan {
        loads: vec![Load::Force { nodes: set("z_max"), force: Vector::z() * 5.0 }],
        ..Plan::default()
    };
    assert_eq!(numbers(&base, &pulled), Some(vec![0.0, 25.0]));

    // An estimate that is accepted there is not called met.
    for (name, stop) in [("sheet", Stop::Incomplete), ("z_max", Stop::Met)] {
        let plan = moved_by(name, 0.01);
        let coarse = adapted(&base, &plan, &wanted(10.0, 100_000));
        assert_eq!((coarse.stop, coarse.levels.len()), (Stop::Met, 1));
        let finer = adapted(&base, &plan, &wanted(0.9 * coarse.levels[0].mean_mm, 100_000));
        assert_eq!(finer.stop, stop, "{:?}", finer.prediction.warnings);
        assert!(finer.levels.len() > 1);
    }
}
