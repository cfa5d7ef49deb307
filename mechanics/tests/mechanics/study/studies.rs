//! Studies: rows against answers computed without them, truths against each other, sweeps, fronts, series.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use mechanics::material::{Fibre, FibreLaw};
use mechanics::mesh::refinement::refine;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Accepted, Case, CaseSegment, ContactKind, ElementChoice, Load, Method, MethodKind, Plan,
    RegionNames, Scene, Settings, TissueWindow,
};
use mechanics::progress::{Phase, Progress, Unobserved};
use mechanics::study::report::Solved;
use mechanics::study::scenes::{SCENES, default_truth, scene_of, slab, slab_hex, sphere_of};
use mechanics::study::sweep::{Judged, SweepError, Values, best, combinations};
use mechanics::study::{
    ClosedForm, Errors, LINEAR_TRUTH, Materials, NOT_RUN, Outcome, Report, Row, Stopwatch, Strain,
    Study, StudyError, StudyScene, TRUTH_WITHOUT_CONTACT, Truth, Variant, WITHIN_TRUTH_ERROR,
    convergence, methods, pareto, run, truth_cost,
};

use crate::prediction::contact_on_bone;
use crate::scenes::{StopsAfter, case_of, exact, material, set, solve};

/// Time stands still, so that reports can be compared whole.
struct Still;

impl Stopwatch for Still {
    fn seconds(&self) -> f64 {
        0.0
    }
    fn reset_peak(&self) {}
    fn peak_mb(&self) -> Option<f64> {
        None
    }
}

fn variant(label: &str, element: ElementChoice) -> Variant {
    let settings = Settings { method: Method::FemLinear, element, ..Settings::default() };
    Variant {
        method: "fem_linear".to_owned(),
        label: label.to_owned(),
        settings,
        accepted: None,
        may_fail: false,
    }
}

fn study(scene: StudyScene, variants: Vec<Variant>, levels: &[u32]) -> Study {
    Study {
        scenes: vec![scene],
        variants,
        pairs: [].into(),
        levels: levels.to_vec(),
        repeats: 1,
        budget_s: f64::INFINITY,
        row_s: f64::INFINITY,
    }
}

fn of(study: &Study) -> Report {
    run(study, &Still, &Unobserved).unwrap()
}

fn solved(row: &Row) -> &Solved {
    match &row.outcome {
        Outcome::Solved(solved) => solved,
        Outcome::Failed { code, detail } => panic!("{} {}: {code}, {detail}", row.scene, row.label),
    }
}

/// The slab with some of its plans and its first material, its truth one refinement away.
fn slab_with(plans: impl Fn(&str) -> bool) -> StudyScene {
    let mut scene = slab();
    scene.plans.retain(|(name, _)| plans(name));
    scene.materials.truncate(1);
    scene.truth =
        Truth::Refined { times: 1, element: ElementChoice::Quadratic, strain: Strain::Small };
    scene
}

/// Mean, p95 and largest length, by area, from their definitions.
fn errors_of(found: &[Vector], truth: &[Vector], areas: &[f64]) -> Errors {
    let mut pairs: Vec<(f64, f64)> =
        found.iter().zip(truth).zip(areas).map(|((u, v), a)| ((u - v).norm(), *a)).collect();
    let total: f64 = areas.iter().sum();
    let mean = pairs.iter().map(|(e, a)| e * a).sum::<f64>() / total;
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut cumulative = 0.0;
    let reached = pairs.iter().find(|(_, area)| {
        cumulative += area;
        cumulative >= 0.95 * total * (1.0 - 1e-12)
    });
    Errors { mean, p95: reached.unwrap().0, max: pairs.last().unwrap().0 }
}

#[test]
fn the_errors_of_a_row_are_those_of_its_displacement() {
    let scene = slab_with(|name| name == "patch 4,0,8 mm");
    let (case, plan) = (scene.case.clone(), scene.plans[0].1.clone());
    let at_skin = |case: &Case, element, relative_residual| {
        let settings = Settings { element, relative_residual, ..Settings::default() };
        let skin = Scene::new(&scene.case, &plan, &settings).unwrap().skin;
        let answer = solve(case, &plan, &settings);
        let u: Vec<Vector> =
            skin.nodes().iter().map(|&n| answer.displacement[n as usize]).collect();
        (u, skin)
    };
    let finer = Case { volume: refine(&case.volume).into(), ..case.clone() };
    let (truth, skin) = at_skin(&finer, ElementChoice::Quadratic, 1e-10);
    let areas = skin.surface.point_areas();
    let variants = [("P1", ElementChoice::Plain), ("P2", ElementChoice::Quadratic)];
    let plain_and_quadratic = variants.map(|(label, element)| variant(label, element)).into();
    let report = of(&study(slab_with(|name| name == "patch 4,0,8 mm"), plain_and_quadratic, &[0]));
    assert_eq!(report.rows.len(), 2);
    for (row, (label, element)) in report.rows.iter().zip(variants) {
        let (found, _) = at_skin(&case, element, 1e-8);
        let expected = errors_of(&found, &truth, &areas);
        let row = (row.label.as_str(), solved(row));
        // The same equations, solved to the same residual: what is left is rounding in sums.
        for (a, b) in [
            (row.1.error.mean, expected.mean),
            (row.1.error.p95, expected.p95),
            (row.1.error.max, expected.max),
        ] {
            assert!((a - b).abs() < 1e-9, "{label}: {a} and {b}");
        }
        assert_eq!(row.0, label);
        let closest = &row.1.closest_point;
        assert!(closest.mean > 0.0 && closest.mean <= row.1.error.mean);
        assert!(closest.max <= row.1.error.max);
        let over: Vec<usize> = (0..skin.nodes().len())
            .filter(|&p| skin.surface.points[p].x.abs() < 12.1 && skin.surface.points[p].y < 12.1)
            .collect();
        let pick = |values: &[Vector]| over.iter().map(|&p| values[p]).collect::<Vec<_>>();
        let over_areas: Vec<f64> = over.iter().map(|&p| areas[p]).collect();
        let part = errors_of(&pick(&found), &pick(&truth), &over_areas);
        assert!((row.1.regions["over the patch"].mean - part.mean).abs() < 1e-9);
    }
}

#[test]
fn halving_the_cells_of_the_sphere_quarters_its_errors() {
    let variants = vec![
        variant("plain", ElementChoice::Plain),
        variant("stabilised", ElementChoice::Stabilised),
        variant("quadratic", ElementChoice::Quadratic),
    ];
    let mut scene = sphere_of(1, 4, CellShape::Tet4);
    // Plain tetrahedra show their order where they do not lock.
    scene.materials[0].by_region.insert("*".to_owned(), material(15.0, 0.3));
    let report = of(&study(scene, variants, &[0, 1, 2]));
    assert_eq!(report.scenes[0].truth, "closed form");
    // Straight edges leave the walls at order 2, whatever the element; linear ones, with four cells between the walls
    // at level 2, are still on their way to it.
    for (label, least) in [("plain", 1.5), ("stabilised", 1.6), ("quadratic", 1.9)] {
        let rows: Vec<&Row> = report.rows.iter().filter(|row| row.label == label).collect();
        let means = [0, 1, 2].map(|level| solved(rows[level]).error.mean);
        let [first, last] = [(means[0] / means[1]).log2(), (means[1] / means[2]).log2()];
        println!("{label}: {means:?}, orders {first:.2} and {last:.2}");
        assert!(last > least && last < 2.2, "{label}: {means:?}");
        assert!(last >= first, "{label}: {means:?}");
    }
}

#[test]
fn a_truth_summed_from_unit_movements_is_the_truth_of_each_plan() {
    let variants = || vec![variant("plain", ElementChoice::Plain)];
    let together = of(&study(slab_with(|name| name != "patch 1 mm"), variants(), &[0]));
    assert!(together.scenes[0].truth.contains("summed"), "{}", together.scenes[0].truth);
    assert_eq!(together.rows.len(), 7);
    for row in &together.rows {
        let alone = of(&study(slab_with(|name| name == row.plan), variants(), &[0]));
        assert!(!alone.scenes[0].truth.contains("summed"));
        let (a, b) = (solved(row), solved(&alone.rows[0]));
        // Both truths are solved to a residual of 1e-10 of what moves them, 10 mm at most.
        for (a, b) in [(a.error, b.error), (a.closest_point, b.closest_point)] {
            let apart = [a.mean - b.mean, a.p95 - b.p95, a.max - b.max];
            assert!(apart.iter().all(|d| d.abs() < 1e-8), "{}: {apart:?}", row.plan);
        }
    }
}

#[test]
fn rows_that_are_the_truth_themselves_are_left_out() {
    let variants = vec![
        variant("plain", ElementChoice::Plain),
        variant("quadratic", ElementChoice::Quadratic),
    ];
    let report = of(&study(slab_with(|name| name == "patch 4 mm"), variants, &[0, 1]));
    let rows: Vec<(&str, u32)> =
        report.rows.iter().map(|row| (row.label.as_str(), row.level)).collect();
    assert_eq!(rows, [("plain", 0), ("quadratic", 0), ("plain", 1)]);
}

/// A block that forces pull at nodes of its front.
fn pulled_at_nodes() -> (Case, Plan) {
    let mesh = block(Vector::new(20.0, 20.0, 10.0), [4, 4, 2], CellShape::Hex8);
    let case = Case {
        fixed: vec![set("x_min")],
        skin: Some(set("z_max")),
        ..case_of(mesh, material(15.0, 0.3))
    };
    let loads = vec![Load::Force { nodes: set("x_max"), force: Vector::z() * 2.0 }];
    (case, Plan { loads, ..Plan::default() })
}

#[test]
fn forces_at_nodes_stay_there_on_finer_meshes_and_that_is_told() {
    let (case, plan) = pulled_at_nodes();
    let pulled = case.volume.node_sets["x_max"].len();
    let mut finer = refine(&case.volume);
    assert!(finer.node_sets["x_max"].len() > 2 * pulled);
    // Nodes keep their numbers.
    finer.node_sets.insert("x_max".to_owned(), case.volume.node_sets["x_max"].clone());
    let skin = Scene::new(&case, &plan, &Settings::default()).unwrap().skin;
    let answer = solve(&Case { volume: finer.into(), ..case.clone() }, &plan, &exact());
    let expected: Vec<Vector> =
        skin.nodes().iter().map(|&node| answer.displacement[node as usize]).collect();
    let still = vec![Vector::zeros(); expected.len()];
    let expected = errors_of(&expected, &still, &skin.surface.point_areas()).mean;

    let scene = |truth| StudyScene {
        name: "block".to_owned(),
        case: case.clone(),
        plans: vec![("pulled".to_owned(), plan.clone())],
        materials: vec![Materials { by_region: case.materials.clone(), ..Materials::default() }],
        truth,
    };
    let rest = || Truth::Known { displacement: still.clone(), strain: Some(Strain::Small) };
    let stabilised = || vec![variant("stabilised", ElementChoice::Stabilised)];
    let report = of(&study(scene(rest()), stabilised(), &[0, 1]));
    let [coarse, fine] = [0, 1].map(|row| solved(&report.rows[row]));
    let apart = (fine.skin_mean_mm - expected).abs();
    assert!(apart < 1e-5 * expected, "{} {expected}", fine.skin_mean_mm);
    let is_told = |row: &Solved| row.warnings.iter().any(|code| code == "points-refined");
    assert_eq!([is_told(coarse), is_told(fine)], [false, true], "{:?}", fine.warnings);
    let [told] = &report.scenes[0].warnings[..] else { panic!("{:?}", report.scenes[0].warnings) };
    assert_eq!(told.numbers, [("held_nodes", 0.0), ("forces", pulled as f64)]);
    assert!(told.detail.starts_with("plan \"pulled\": "), "{}", told.detail);

    // So does the truth.
    let finest = Truth::Refined { times: 1, element: ElementChoice::Plain, strain: Strain::Small };
    let report = of(&study(scene(finest), stabilised(), &[0]));
    let error = solved(&report.rows[0]).error.mean;
    assert!(error < 0.3 * expected && !report.scenes[0].warnings.is_empty(), "{error} {expected}");
    let alone = of(&study(scene(rest()), stabilised(), &[0]));
    assert!(alone.scenes[0].warnings.is_empty());
}

#[test]
fn a_row_that_fails_is_a_row_and_what_does_not_apply_is_none() {
    let mut poor = variant("poor", ElementChoice::Plain);
    poor.settings.memory_mb = 1e-3;
    let variants = vec![
        variant("quadratic", ElementChoice::Quadratic),
        poor,
        variant("plain", ElementChoice::Plain),
    ];
    let mut scene = slab_hex();
    scene.materials.truncate(1);
    scene.truth =
        Truth::Refined { times: 1, element: ElementChoice::MeanDilatation, strain: Strain::Small };
    scene.plans.truncate(1);
    let segments =
        vec![PlannedSegment { name: "nowhere".to_owned(), movement: RigidMovement::default() }];
    scene.plans.push(("unknown".to_owned(), Plan { segments, ..Plan::default() }));
    let report = of(&study(scene, variants, &[0, 9]));
    let told = |row: &Row| match &row.outcome {
        Outcome::Solved(_) => "solved".to_owned(),
        Outcome::Failed { code, detail } => {
            assert!(!detail.is_empty());
            code.clone()
        }
    };
    let told: Vec<String> = report.rows.iter().map(told).collect();
    let poor = "budget-exceeded";
    let known = [poor, "solved", poor, poor];
    assert_eq!(told, [&known[..], &["unknown-segment"; 6]].concat());
    assert_eq!(report.rows[0].element, "");
    assert_eq!(report.rows[1].element, "hex8 plain");
    // Quadratic elements do not serve hexahedra, on either level: that is no failure.
    let [skipped] = report.skipped.as_slice() else { panic!("{:?}", report.skipped) };
    assert_eq!((skipped.label.as_str(), skipped.rows), ("quadratic", 2));
    assert!(skipped.reason.contains("made of tet4 only"), "{}", skipped.reason);
}

/// Counts the meshes that truths are solved on.
#[derive(Default)]
struct Meshes(AtomicUsize);

impl Progress for Meshes {
    fn phase(&self, _phase: Phase) {}
    fn iteration(&self, _iteration: usize, _relative_residual: f64, _wanted: f64) {}
    fn step(&self, done: usize, of: usize) {
        assert!(done < of);
        self.0.fetch_add(1, Ordering::Relaxed);
    }
    fn is_cancelled(&self) -> bool {
        false
    }
}

#[test]
fn what_a_truth_costs_is_known_before_and_reported_while_it_is_solved() {
    let plain = || vec![variant("plain", ElementChoice::Plain)];
    let study = study(slab_with(|name| name != "patch 1 mm"), plain(), &[0]);
    let scene = &study.scenes[0];
    let (cells, nodes) = (scene.case.volume.cells.len(), scene.case.volume.nodes.len());
    let cost = truth_cost(scene, &study.variants).unwrap();
    // Level 0, for the error of the truth, and level 1. Seven plans are summed from unit movements of a segment, which
    // cost as three.
    let cells_at: Vec<f64> = cost.meshes.iter().map(|mesh| mesh.cells).collect();
    assert_eq!(cells_at, [cells as f64, 8.0 * cells as f64]);
    assert_eq!(cost.meshes[1].unknowns, (24 * 8 * nodes) as f64, "quadratic");
    assert!(cost.meshes.iter().all(|mesh| mesh.solves == 3), "{cost:?}");
    let told = Meshes::default();
    run(&study, &Still, &told).unwrap();
    assert_eq!(told.0.into_inner(), cost.meshes.len());

    let mut hexahedra = slab_hex();
    hexahedra.plans.truncate(2);
    hexahedra.materials.truncate(1);
    hexahedra.truth =
        Truth::Refined { times: 2, element: ElementChoice::MeanDilatation, strain: Strain::Small };
    let cost = truth_cost(&hexahedra, &plain()).unwrap();
    let (cells, nodes) = (hexahedra.case.volume.cells.len(), hexahedra.case.volume.nodes.len());
    assert_eq!((cost.meshes.len(), cost.meshes[2].solves), (3, 2));
    assert_eq!(
        (cost.meshes[2].cells, cost.meshes[2].unknowns),
        (64.0 * cells as f64, (192 * nodes) as f64)
    );
    hexahedra.truth = Truth::Known { displacement: Vec::new(), strain: None };
    assert_eq!(truth_cost(&hexahedra, &plain()), None);
}

#[test]
fn a_truth_that_fails_fails_its_rows_only() {
    let mut scene = slab_with(|name| name == "patch 4 mm");
    scene.truth = Truth::Known { displacement: vec![Vector::zeros(); 3], strain: None };
    let report = of(&study(scene, vec![variant("plain", ElementChoice::Plain)], &[0]));
    let Outcome::Failed { code, detail } = &report.rows[0].outcome else { panic!("no truth") };
    assert_eq!(code, "truth-failed");
    assert!(detail.contains("3 displacements") && detail.contains("66 skin nodes"), "{detail}");
}

#[test]
fn the_same_study_gives_the_same_report_but_for_times() {
    let study = || {
        let variants = vec![
            variant("stabilised", ElementChoice::Stabilised),
            variant("quadratic", ElementChoice::Quadratic),
        ];
        study(slab_with(|name| name.ends_with("deg")), variants, &[0])
    };
    let (first, second) = (of(&study()), of(&study()));
    assert_eq!(first.rows.len(), 6);
    assert_eq!(first, second);
}

/// Moves on by a second each time it is looked at.
struct Ticking(AtomicUsize);

impl Stopwatch for Ticking {
    fn seconds(&self) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed) as f64
    }
    fn reset_peak(&self) {}
    fn peak_mb(&self) -> Option<f64> {
        Some(7.0)
    }
}

#[test]
fn a_row_is_timed_as_often_as_asked_for_until_that_takes_long() {
    let timed = |repeats| {
        let scene = slab_with(|name| name == "patch 4 mm");
        let mut study = study(scene, vec![variant("plain", ElementChoice::Plain)], &[0]);
        study.repeats = repeats;
        let report = run(&study, &Ticking(AtomicUsize::new(0)), &Unobserved).unwrap();
        let row = solved(&report.rows[0]);
        assert_eq!((row.wall_s, row.peak_mb), (1.0, Some(7.0)));
        row.repeats
    };
    assert_eq!(timed(2), 2);
    // Three solves of a second are the first to take more than two.
    assert_eq!(timed(40), 3);
}

#[test]
fn once_its_time_is_used_up_a_study_begins_no_row() {
    let scene = slab_with(|name| name.ends_with("deg"));
    let mut study = study(scene, vec![variant("plain", ElementChoice::Plain)], &[0]);
    // Looked at when the study begins, before each row and twice within.
    study.budget_s = 3.5;
    let report = run(&study, &Ticking(AtomicUsize::new(0)), &Unobserved).unwrap();
    solved(&report.rows[0]);
    for row in &report.rows[1..] {
        let Outcome::Failed { code, .. } = &row.outcome else { panic!("it was solved") };
        assert_eq!(code, NOT_RUN);
    }
    study.budget_s = 0.5;
    let report = run(&study, &Ticking(AtomicUsize::new(0)), &Unobserved).unwrap();
    assert_eq!(report.scenes[0].truth, "not sought: no method has an answer");
}

#[test]
fn a_solve_that_takes_too_long_fails_its_row_and_no_other() {
    let scene = slab_with(|name| name == "patch 4 mm");
    let mut study = study(scene, vec![variant("plain", ElementChoice::Plain)], &[0, 1]);
    study.row_s = 0.5;
    let report = run(&study, &Ticking(AtomicUsize::new(0)), &Unobserved).unwrap();
    for row in &report.rows {
        let Outcome::Failed { code, detail } = &row.outcome else { panic!("it was solved") };
        assert_eq!((code.as_str(), detail.as_str()), ("budget-exceeded", "not solved after 0.5 s"));
    }
    assert_eq!(report.rows.len(), 2);
}

#[test]
fn a_solve_that_takes_too_long_is_not_tried_with_the_next_plan() {
    let scene = slab_with(|name| name.ends_with("deg"));
    let mut study = study(scene, vec![variant("plain", ElementChoice::Plain)], &[0]);
    study.row_s = 0.5;
    let report = run(&study, &Ticking(AtomicUsize::new(0)), &Unobserved).unwrap();
    let details = report.rows.iter().map(|row| match &row.outcome {
        Outcome::Failed { code, detail } if code == "budget-exceeded" => detail.clone(),
        _ => panic!("{} was not given up", row.plan),
    });
    let details: Vec<String> = details.collect();
    assert_eq!(details[0], "not solved after 0.5 s");
    let later = format!("not tried: not solved after 0.5 s with plan {:?}", report.rows[0].plan);
    assert!(details.len() > 2 && details[1..].iter().all(|detail| *detail == later), "{details:?}");
}

#[test]
fn cancelling_ends_a_study() {
    let study = study(slab_with(|_| true), vec![variant("plain", ElementChoice::Plain)], &[0]);
    assert!(matches!(run(&study, &Still, &StopsAfter::iterations(0)), Err(StudyError::Cancelled)));
}

#[test]
fn a_study_of_nothing_is_an_error() {
    let full = || study(slab_with(|_| true), vec![variant("plain", ElementChoice::Plain)], &[0]);
    type Emptying = (&'static str, fn(&mut Study));
    let emptied: [Emptying; 6] = [
        ("scene", |study| study.scenes.clear()),
        ("variant", |study| study.variants.clear()),
        ("level", |study| study.levels.clear()),
        ("plan", |study| study.scenes[0].plans.clear()),
        ("material", |study| study.scenes[0].materials.clear()),
        ("repeat", |study| study.repeats = 0),
    ];
    for (what, empty) in emptied {
        let mut study = full();
        empty(&mut study);
        let refused = run(&study, &Still, &Unobserved).unwrap_err().to_string();
        assert_eq!(refused, format!("the study has no {what}"));
    }
    let mut twice = full();
    twice.levels = vec![0, 0];
    assert!(matches!(run(&twice, &Still, &Unobserved), Err(StudyError::Repeated { .. })));
}

/// A block of two layers whose base is moved.
fn twin() -> Case {
    let mut mesh = block(Vector::new(24.0, 18.0, 12.0), [4, 3, 4], CellShape::Tet4);
    let height = |cell: usize| mesh.corners(cell).map(|x| x.z).fold(0.0, f64::max);
    let labels = (0..mesh.cells.len()).map(|cell| i64::from(height(cell) < 6.1)).collect();
    mesh.cell_labels.insert("layer".to_owned(), labels);
    let mut case = case_of(mesh, material(50.0, 0.45));
    let names = BTreeMap::from([(1, "muscle".to_owned())]);
    case.regions = Some(RegionNames { array: "layer".to_owned(), names });
    case.segments.push(CaseSegment { name: "jaw".to_owned(), nodes: set("x_min") });
    case.fixed.push(set("x_max"));
    case.skin = Some(set("z_max"));
    case
}

#[test]
fn a_sweep_finds_the_constants_that_were_planted() {
    let movement =
        RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::new(3.0, 0.0, 1.0));
    let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
    let plan = Plan { segments, ..Plan::default() };
    let case = twin();
    let mut planted = case.clone();
    planted.materials.insert("muscle".to_owned(), material(300.0, 0.43));
    let settings = Settings::default();
    let skin = Scene::new(&planted, &plan, &settings).unwrap().skin;
    let answer = solve(&planted, &plan, &settings);
    let truth = skin.nodes().iter().map(|&node| answer.displacement[node as usize]).collect();

    let muscle = Values {
        young_modulus: vec![150.0, 300.0, 450.0],
        poisson_ratio: vec![0.4, 0.43, 0.46],
        ..Values::default()
    };
    let soft = Values { poisson_ratio: vec![0.45, 0.47], ..Values::default() };
    let sweep = BTreeMap::from([("muscle".to_owned(), muscle), ("*".to_owned(), soft)]);
    let materials = combinations(&case.materials, &[], &sweep).unwrap();
    assert_eq!(materials.len(), 18);
    assert_eq!(materials[0].name, "all nu 0.45, muscle E 150 kPa nu 0.4");
    let scene = StudyScene {
        name: "twin".to_owned(),
        case,
        plans: vec![("jaw".to_owned(), plan)],
        materials,
        truth: Truth::Known { displacement: truth, strain: None },
    };
    let report = of(&study(scene, vec![variant("auto", ElementChoice::Auto)], &[0]));
    let judged = Judged { scene: "twin", plan: "jaw", label: "auto", level: 0 };
    let found = best(&report, &judged).unwrap();
    assert_eq!(found.material, "all nu 0.45, muscle E 300 kPa nu 0.43");
    // Both are solved to a relative residual of 1e-8, of 3 mm.
    assert!(solved(found).error.max < 1e-6);
    let others = report.rows.iter().filter(|row| row.material != found.material);
    assert!(others.map(|row| solved(row).error.mean).all(|mean| mean > 1e-4));
}

#[test]
fn a_refined_truth_loses_what_a_sweep_loses() {
    let mut tissue = slab_with(|_| true);
    tissue.plans.truncate(1);
    let sweep = Values { volume_change: vec![-0.1, 0.0], ..Values::default() };
    let sweep = BTreeMap::from([("*".to_owned(), sweep)]);
    tissue.materials = combinations(&tissue.case.materials, &[], &sweep).unwrap();
    let report = of(&study(tissue, vec![variant("plain", ElementChoice::Plain)], &[0]));
    let means: Vec<f64> = report.rows.iter().map(|row| solved(row).error.mean).collect();
    // What the element is off by, and no loss of a tenth of the tissue, which moves the skin by millimetres.
    assert!(means.len() == 2 && (means[0] - means[1]).abs() < 0.1, "{means:?}");
}

#[test]
fn a_sweep_of_unknown_regions_or_too_many_values_is_refused() {
    let base = BTreeMap::from([("soft".to_owned(), material(50.0, 0.45))]);
    let sweep = |region: &str, values: usize| {
        let poisson_ratio = (0..values).map(|k| 0.4 / values as f64 * k as f64).collect();
        let values = Values { poisson_ratio, ..Values::default() };
        combinations(&base, &[], &BTreeMap::from([(region.to_owned(), values)]))
    };
    assert!(matches!(sweep("bone", 2), Err(SweepError::UnknownRegion { .. })));
    assert_eq!(sweep("soft", 1001).err(), Some(SweepError::TooMany { combinations: 1001 }));
    let along = Fibre { young_modulus: 80.0, shear_modulus: None, law: FibreLaw::default() };
    let striped = BTreeMap::from([("soft".to_owned(), base["soft"].with_fibre(&along).unwrap())]);
    let soft = Values { poisson_ratio: vec![0.4], ..Values::default() };
    let refused = combinations(&striped, &[], &BTreeMap::from([("soft".to_owned(), soft)]));
    assert!(matches!(refused, Err(SweepError::Fibres { .. })));
    let window = TissueWindow {
        name: "muscle".to_owned(),
        from_hu: -30.0,
        to_hu: 100.0,
        material: material(300.0, 0.43),
    };
    let nu = Values { poisson_ratio: vec![0.4, 0.45], ..Values::default() };
    let sweep = |region: &str| BTreeMap::from([(region.to_owned(), nu.clone())]);
    let of_tissue = combinations(&base, std::slice::from_ref(&window), &sweep("muscle")).unwrap();
    assert_eq!(of_tissue[1].tissues["muscle"], material(300.0, 0.45));
    assert_eq!((of_tissue[1].name.as_str(), &of_tissue[1].by_region), ("muscle nu 0.45", &base));
    let twice = TissueWindow { name: "soft".to_owned(), ..window };
    let refused = combinations(&base, &[twice], &sweep("soft"));
    assert!(matches!(refused, Err(SweepError::TwoThings { .. })));
    let stiff = Values { young_modulus: vec![-1.0], ..Values::default() };
    let refused = combinations(&base, &[], &BTreeMap::from([("soft".to_owned(), stiff)]));
    assert!(matches!(refused, Err(SweepError::Material { .. })));
}

/// `*` was swept in regions without an entry of their own alone, under the name of all.
#[test]
fn a_sweep_of_all_regions_changes_all_of_them() {
    let soft = ("soft".to_owned(), material(50.0, 0.45));
    let base = BTreeMap::from([soft, ("*".to_owned(), material(10.0, 0.4))]);
    let window = TissueWindow {
        name: "muscle".to_owned(),
        from_hu: -30.0,
        to_hu: 100.0,
        material: material(300.0, 0.43),
    };
    let windows = std::slice::from_ref(&window);
    let nu = |poisson_ratio: Vec<f64>| Values { poisson_ratio, ..Values::default() };
    let all = Values { volume_change: vec![0.1], ..nu(vec![0.3]) };
    let sweep = BTreeMap::from([("*".to_owned(), all.clone())]);
    let found = combinations(&base, windows, &sweep).unwrap().remove(0);
    let both = [("soft", material(50.0, 0.3)), ("*", material(10.0, 0.3))];
    assert_eq!(found.by_region, both.map(|(name, own)| (name.to_owned(), own)).into());
    assert_eq!(found.tissues["muscle"], material(300.0, 0.3));
    let growth = [("*".to_owned(), 0.1)];
    assert_eq!(
        found.growth.iter().map(|g| (g.region.clone(), g.volume_change)).collect::<Vec<_>>(),
        growth
    );

    // What is varied by name is not of all; the rest of its material is.
    let young = Values { young_modulus: vec![20.0], ..Values::default() };
    let named = [
        ("*", Values { poisson_ratio: vec![0.3], ..young }),
        ("!fat", nu(vec![0.2])),
        ("soft", nu(vec![0.4])),
    ];
    let sweep = named.map(|(name, own)| (name.to_owned(), own)).into();
    let found = combinations(&base, &[], &sweep).unwrap().remove(0);
    assert_eq!(found.by_region["soft"], material(20.0, 0.4));
    assert_eq!(found.by_region["!fat"], material(20.0, 0.2));
    assert_eq!(found.by_region["*"], material(20.0, 0.3));

    let along = Fibre { young_modulus: 80.0, shear_modulus: None, law: FibreLaw::default() };
    let fibrous = base["soft"].with_fibre(&along).unwrap();
    let striped = BTreeMap::from([("soft".to_owned(), fibrous), ("*".to_owned(), base["*"])]);
    let refused = combinations(&striped, &[], &BTreeMap::from([("*".to_owned(), nu(vec![0.3]))]));
    assert_eq!(refused.err(), Some(SweepError::Fibres { region: "soft".to_owned() }));
}

fn row(label: &str, level: u32, wall_s: f64, p95: f64, skin_mean_mm: f64) -> Row {
    let errors = Errors { mean: p95 / 2.0, p95, max: p95 };
    Row {
        scene: "s".to_owned(),
        plan: "p".to_owned(),
        method: "m".to_owned(),
        label: label.to_owned(),
        element: String::new(),
        material: "t".to_owned(),
        level,
        outcome: Outcome::Solved(Box::new(Solved {
            unknowns: 1,
            iterations: 1,
            wall_s,
            repeats: 1,
            peak_mb: None,
            skin_mean_mm,
            error: errors,
            closest_point: errors,
            regions: BTreeMap::new(),
            numerical_error: None,
            linearity_error: None,
            effectivity: None,
            chosen: None,
            smallest_det_f: 1.0,
            truth_error: None,
            truth_contact: false,
            covered_share: None,
            warnings: Vec::new(),
        })),
    }
}

#[test]
fn the_front_of_a_plan_names_rows_and_passes_over_failures_and_other_plans() {
    let mut failed = row("broken", 0, 0.0, 0.0, 1.0);
    failed.outcome = Outcome::Failed { code: "c".to_owned(), detail: "d".to_owned() };
    let other = Row { plan: "q".to_owned(), ..row("other", 0, 0.0, 0.0, 1.0) };
    let rows = vec![
        failed,
        row("slow", 0, 3.0, 0.1, 1.0),
        other,
        row("fast", 0, 1.0, 0.5, 1.0),
        row("beaten", 0, 3.5, 0.2, 1.0),
    ];
    let report = Report { rows, ..Report::default() };
    assert_eq!(pareto::of_plan(&report, "s", "p"), [3, 1]);
}

#[test]
fn a_series_of_three_levels_has_an_order_and_a_limit() {
    let on = |level: u32| 4.0 - 0.32 * 0.25_f64.powi(level as i32);
    let mut rows: Vec<Row> = (0..4).map(|level| row("a", level, 1.0, 1.0, on(level))).collect();
    rows.extend([0, 1].map(|level| row("two", level, 1.0, 1.0, on(level))));
    rows.extend([0, 2].map(|level| row("gap", level, 1.0, 1.0, on(level))));
    let series = convergence::series(&Report { rows, ..Report::default() });
    assert_eq!(series.len(), 2);
    assert_eq!((series[0].label.as_str(), series[0].levels.as_slice()), ("a", &[1, 2, 3][..]));
    // Rounding only.
    assert!((series[0].order.unwrap() - 2.0).abs() < 1e-9);
    assert!((series[0].limit_mm.unwrap() - 4.0).abs() < 1e-12);
    assert!((series[0].last_change.unwrap() - (on(3) - on(2)) / on(3)).abs() < 1e-12);
    assert_eq!((series[1].order, series[1].limit_mm), (None, None));
    assert_eq!(series[1].levels, [0, 1]);
}

#[test]
fn every_method_has_variants_of_its_own_name_and_no_label_comes_twice() {
    let mut all: Vec<Variant> = Vec::new();
    for method in MethodKind::ALL {
        let own = methods::of_method(*method);
        assert!(!own.is_empty(), "{method:?}");
        let is_own =
            |one: &Variant| one.method == method.name() && one.settings.method.kind() == *method;
        assert!(own.iter().all(is_own), "{method:?}");
        all.extend(own);
    }
    assert_eq!(methods::available().len(), all.len());
    all.push(methods::auto());
    for (place, variant) in all.iter().enumerate() {
        assert!(all[..place].iter().all(|other| other.label != variant.label), "{}", variant.label);
    }
}

#[test]
fn on_the_slab_elements_come_in_the_order_of_the_table_and_the_truth_knows_its_own_error() {
    let mut scene = slab();
    scene.plans.truncate(1);
    scene.materials.truncate(1);
    let study = study(scene, methods::of_method(MethodKind::FemLinear), &[0, 1]);
    let report = of(&study);
    let scene = &report.scenes[0];
    println!("{} {:?}", scene.truth, scene.truth_error_mm);
    let [mean, p95] = scene.truth_error_mm.unwrap();
    assert!(mean < 0.02 && p95 < 0.03, "{mean} {p95}");
    assert!(scene.truth.starts_with("tet10 quadratic, 1"), "{}", scene.truth);
    assert_eq!(report.rows.len(), study.variants.len() * study.levels.len());
    for row in &report.rows {
        println!("{} {} {:?}", row.label, row.level, row.outcome);
    }
    // The measure is not that of the table, which weighs 45 points alike; the order of elements is.
    let mean = |label: &str, level| {
        let found = report.rows.iter().find(|row| row.label == label && row.level == level);
        solved(found.unwrap()).error.mean
    };
    assert!(mean("fem_linear quadratic", 1) < 0.3 * mean("fem_linear stabilised", 1));
    assert!(mean("fem_linear stabilised", 1) < 0.5 * mean("fem_linear plain", 1));
    assert!(mean("fem_linear plain", 1) < 0.6 * mean("fem_linear plain", 0));
}

#[test]
fn every_scene_of_the_program_is_accepted_with_each_of_its_plans_and_materials() {
    for name in SCENES {
        let scene = scene_of(name).unwrap();
        assert_eq!(scene.name, name);
        let mut names: Vec<&str> = scene.plans.iter().map(|(plan, _)| plan.as_str()).collect();
        names.dedup();
        assert_eq!(names.len(), scene.plans.len());
        for Materials { by_region, .. } in &scene.materials {
            for (plan, movement) in &scene.plans {
                let case = Case { materials: by_region.clone(), ..scene.case.clone() };
                let made = Scene::new(&case, movement, &Settings::default());
                let made = made.unwrap_or_else(|errors| panic!("{name} {plan}: {errors}"));
                let codes = made.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>();
                // The symmetry planes of slab and sphere end on what is held altogether, and the skin of the
                // slab and of the sphere on these planes.
                let usual = ["conditions-overlap", "skin-held"];
                assert!(codes.iter().all(|code| usual.contains(code)), "{plan}: {codes:?}");
                assert!(made.skin.nodes().len() > 60);
            }
        }
    }
    assert!(scene_of("nowhere").is_none());
}

#[test]
fn a_case_without_a_truth_of_its_own_gets_a_finer_mesh() {
    let of = |shape| {
        let mesh = block(Vector::new(4.0, 4.0, 4.0), [2, 2, 2], shape);
        default_truth(&case_of(mesh, material(15.0, 0.46)))
    };
    let quadratic = ElementChoice::Quadratic;
    assert!(
        matches!(of(CellShape::Tet4), Truth::Refined { times: 1, element, strain: Strain::Small } if element == quadratic)
    );
    let mean = ElementChoice::MeanDilatation;
    assert!(
        matches!(of(CellShape::Hex8), Truth::Refined { times: 2, element, strain: Strain::Small } if element == mean)
    );
}

#[test]
fn a_truth_of_finite_strain_is_near_finite_strain_and_far_from_linearity() {
    let mut scene = slab_with(|name| name == "patch 8 mm");
    let (element, strain) = (ElementChoice::Stabilised, Strain::Finite);
    scene.truth = Truth::Refined { times: 1, element, strain };
    let nonlinear = |label: &str, element| {
        let settings = Settings { method: Method::FemNonlinear, element, ..Settings::default() };
        Variant { settings, ..variant(label, element) }
    };
    let tolerant = Accepted { skin_mm: 0.13, ..Accepted::default() };
    let variants = vec![
        variant("linear", element),
        nonlinear("nonlinear", element),
        Variant { label: "auto".to_owned(), ..methods::auto() },
        Variant { label: "tolerant".to_owned(), accepted: Some(tolerant), ..methods::auto() },
    ];
    let study = study(scene, variants, &[0, 1]);
    let cost = truth_cost(&study.scenes[0], &study.variants).unwrap();
    assert_eq!((cost.strain, cost.meshes[0].solves), (Strain::Finite, 1));
    let report = of(&study);
    assert!(report.scenes[0].truth.contains("at finite strain"), "{}", report.scenes[0].truth);
    let rows: Vec<(&str, u32)> =
        report.rows.iter().map(|row| (row.label.as_str(), row.level)).collect();
    // What the truth is made of has no row.
    let all = ["linear", "nonlinear", "auto", "tolerant"].map(|label| (label, 0));
    assert_eq!(rows, [&all[..], &[("linear", 1), ("auto", 1)]].concat());
    // A model that was chosen may be the truth itself.
    let skipped: Vec<&str> = report.skipped.iter().map(|own| own.label.as_str()).collect();
    assert_eq!(skipped, ["nonlinear", "tolerant"]);
    let chosen = &report.skipped[1].reason;
    assert!(chosen.starts_with("the model that was chosen is the truth itself"), "{chosen}");
    let [linear, own, auto, _, finer, _] = [0, 1, 2, 3, 4, 5].map(|row| solved(&report.rows[row]));
    assert!(finer.error.mean > 3.0 * own.error.mean, "{finer:?} {own:?}");
    assert!(auto.error.mean < 0.5 * linear.error.mean, "{auto:?}");
    assert!(auto.chosen.as_deref().is_some_and(|rung| rung != "linear"));
    for (name, row) in [("linear", linear), ("nonlinear", own), ("finer", finer)] {
        let effectivity = row.effectivity.unwrap();
        assert!((0.4..2.5).contains(&effectivity), "{name}: {effectivity}");
        assert!(row.numerical_error.is_some() && row.chosen.is_none());
    }
    assert!(linear.linearity_error.is_some() && own.linearity_error.is_none());
}

#[test]
fn answers_of_finite_strain_say_that_their_truth_is_linear() {
    let scene = slab_with(|name| name == "patch 8 mm");
    let own = |kind| methods::of_method(kind).remove(0);
    let variants = vec![own(MethodKind::FemLinear), own(MethodKind::FemNonlinear)];
    let report = of(&study(scene, variants, &[0]));
    let [linear, nonlinear] = [0, 1].map(|row| solved(&report.rows[row]));
    let is_told = |row: &Solved| row.warnings.iter().any(|code| code == LINEAR_TRUTH);
    assert_eq!([linear, nonlinear].map(is_told), [false, true]);
    assert!(linear.effectivity.is_some() && nonlinear.effectivity.is_none());
}

/// Tissue that is raised by 1.2 mm under a plate of bone half a millimetre above it: with contact its skin stops there.
fn under_a_plate(truth: Truth) -> StudyScene {
    let case = contact_on_bone::slab(CellShape::Hex8, 0.3);
    let by_region = case.materials.clone();
    StudyScene {
        name: "plate".to_owned(),
        case,
        plans: vec![("raised".to_owned(), contact_on_bone::closed(1.2, 0.0))],
        materials: vec![Materials { by_region, name: "case".to_owned(), ..Materials::default() }],
        truth,
    }
}

fn touching(label: &str, element: ElementChoice, contact: ContactKind) -> Variant {
    let plain = variant(label, element);
    Variant { settings: Settings { contact, ..plain.settings.clone() }, ..plain }
}

#[test]
fn rows_with_contact_are_held_against_a_truth_with_contact() {
    for strain in [Strain::Small, Strain::Finite] {
        let element = ElementChoice::MeanDilatation;
        let truth = Truth::Refined { times: 1, element, strain };
        let variants = vec![
            variant("free", ElementChoice::Plain),
            touching("pressing", ElementChoice::Plain, ContactKind::Unilateral),
            touching("auto", ElementChoice::Plain, ContactKind::Auto),
        ];
        let study = study(under_a_plate(truth), variants, &[0]);
        let cost = truth_cost(&study.scenes[0], &study.variants).unwrap();
        assert_eq!((cost.truths, cost.meshes[1].solves), (2, 2));
        let told = Meshes::default();
        let report = run(&study, &Still, &told).unwrap();
        assert_eq!(told.0.into_inner(), cost.truths * cost.meshes.len());
        let words = &report.scenes[0].truth;
        assert!(
            words.contains(". Of rows with contact: ") && words.contains(" with contact, "),
            "{words}"
        );
        for row in &report.rows {
            let solved = solved(row);
            // Even strain of a sixteenth: what linearity leaves out of it is less than a twentieth of a millimetre.
            assert!(solved.error.mean < 0.05, "{strain:?} {} {:?}", row.label, solved.error);
            assert!(!solved.warnings.iter().any(|code| code == TRUTH_WITHOUT_CONTACT));
        }
        let [free, pressing, auto] = [0, 1, 2].map(|row| solved(&report.rows[row]).skin_mean_mm);
        assert!((free - 1.2).abs() < 0.01 && pressing < 0.9, "{free} {pressing}");
        assert!((auto - pressing).abs() < 1e-6, "{auto} {pressing}");
        let only = self::study(
            under_a_plate(Truth::Refined { times: 1, element, strain }),
            vec![touching("pressing", ElementChoice::Plain, ContactKind::Unilateral)],
            &[0],
        );
        let report = of(&only);
        assert!(!report.scenes[0].truth.contains("Of rows"), "{}", report.scenes[0].truth);
    }
}

#[test]
fn rows_with_contact_beside_a_formula_without_are_marked() {
    let formula = ClosedForm { displacement: |_, _, _| Vector::x() * 1.5, walls: |_| {} };
    let variants = vec![
        variant("free", ElementChoice::Plain),
        touching("pressing", ElementChoice::Plain, ContactKind::Unilateral),
    ];
    let report = of(&study(under_a_plate(Truth::ClosedForm(formula)), variants, &[0]));
    let is_told = |row: &Row| solved(row).warnings.iter().any(|c| c == TRUTH_WITHOUT_CONTACT);
    assert_eq!([0, 1].map(|row| is_told(&report.rows[row])), [false, true]);
}

#[test]
fn levels_that_are_the_truth_are_reported_as_skipped() {
    let scene = slab_with(|name| name == "patch 4 mm");
    let variants = vec![
        variant("stabilised", ElementChoice::Stabilised),
        variant("quadratic", ElementChoice::Quadratic),
    ];
    let report = of(&study(scene, variants, &[0, 1]));
    assert_eq!(report.rows.len(), 3);
    let [skipped] = report.skipped.as_slice() else { panic!("{:?}", report.skipped) };
    assert_eq!((skipped.label.as_str(), skipped.rows), ("quadratic", 1));
    assert_eq!(
        skipped.reason,
        "level 1 is the truth itself or finer than it: that is the same method and element, every edge of level 0 halved once"
    );
}

#[test]
fn rows_that_are_nearer_to_the_truth_than_it_is_known_are_marked() {
    let mut scene = slab_with(|name| name == "patch 4 mm");
    scene.truth = Truth::Refined { times: 1, element: ElementChoice::Plain, strain: Strain::Small };
    let variants = vec![
        variant("stabilised", ElementChoice::Stabilised),
        variant("plain", ElementChoice::Plain),
    ];
    let report = of(&study(scene, variants, &[0]));
    let [own, _] = report.scenes[0].truth_error_mm.unwrap();
    let told: Vec<bool> = report
        .rows
        .iter()
        .map(|row| {
            let Solved { error, warnings, .. } = solved(row);
            let is_told = warnings.iter().any(|code| code == WITHIN_TRUTH_ERROR);
            assert_eq!(is_told, error.mean <= own * (1.0 + 1e-6), "{} {error:?} {own}", row.label);
            is_told
        })
        .collect();
    // The second is what the error of the truth is extrapolated from, with order 1: the same number.
    assert!(told[1], "{told:?}");
}

#[test]
fn the_error_of_a_truth_is_that_of_its_own_plan() {
    let errors = |names: &[&str]| -> Vec<(String, f64)> {
        let mut scene = slab_with(|name| names.contains(&name));
        scene.truth =
            Truth::Refined { times: 1, element: ElementChoice::Plain, strain: Strain::Small };
        let report = of(&study(scene, vec![variant("plain", ElementChoice::Plain)], &[0]));
        let rows = report.rows.iter();
        rows.map(|row| (row.plan.clone(), solved(row).truth_error.unwrap()[0])).collect()
    };
    let all: Vec<String> = slab_with(|_| true).plans.iter().map(|(name, _)| name.clone()).collect();
    let [one, other, ..] = &all[..] else { panic!("{all:?}") };
    let both = errors(&[one, other]);
    let alone = [one, other].map(|name| errors(&[name]).remove(0));
    for (own, (name, error)) in alone.iter().zip(&both) {
        // Solved by themselves or with others, to the residual of a truth.
        assert!(own.0 == *name && (own.1 - error).abs() < 1e-7, "{alone:?} {both:?}");
    }
    assert!((both[0].1 / both[1].1 - 1.0).abs() > 0.1, "{both:?}");
}
