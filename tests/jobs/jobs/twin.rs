//! A synthetic twin of Zachow et al. 2006 and Kim et al. 2012: an operation is planted, and its scans are all that is known of it.
//!
//! Bone before and after gives the way back of the scan and the plan; the predicted skin of each pair of constants is held against the
//! scan of the skin, which lies elsewhere, has other triangles and a hole. What was planted has to come back.

use std::fs;

use facies::jobs::{JobContext, JobInput, PredictInput, StoredMesh, StudyInput, work};
use facies::schema::reproduce::result::ReproductionDocument;
use facies::schema::{Faults, Limits, Matrix4x4, ReportDocument, StudyDocument};
use mechanics::format::{self, ReadLimits};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, TriangleSurface, Vector, VolumeMesh};
use mechanics::plan::RigidMovement;
use mechanics::progress::Unobserved;
use serde_json::{Value, json};
use tempfile::TempDir;

use super::planning::{moved, performed, reproduced, surface};
use crate::sources::{Meshes, stored};

/// Young's modulus of the outer layer in kPa, where that of the inner one is 15, and its Poisson's ratio.
const MODULI: [f64; 3] = [15.0, 60.0, 240.0];
const RATIOS: [f64; 4] = [0.3, 0.38, 0.46, 0.49];
const PLANTED: (f64, f64) = (60.0, 0.46);

/// Tissue of 60 x 40 x 12 mm in two layers, which a jaw carries in the middle of its bottom.
fn tissue() -> VolumeMesh {
    let mut mesh = block(Vector::new(60.0, 40.0, 12.0), [24, 16, 6], CellShape::Hex8);
    let bottom = mesh.node_sets["z_min"].clone();
    let is_jaw = |&node: &u32| {
        let x = &mesh.nodes[node as usize];
        (10.0..=40.0).contains(&x.x) && (8.0..=32.0).contains(&x.y)
    };
    let is_far = |&node: &u32| {
        let x = &mesh.nodes[node as usize];
        x.x > 55.0 || x.x < 2.0
    };
    let jaw: Vec<u32> = bottom.iter().copied().filter(|node| is_jaw(node)).collect();
    let rest: Vec<u32> = bottom.iter().copied().filter(|node| is_far(node)).collect();
    let cells = 0..mesh.cells.len();
    let middle = |cell: usize| mesh.corners(cell).map(|x| x.z).sum::<f64>() / 8.0;
    let layers: Vec<i64> = cells.map(|cell| i64::from(middle(cell) > 6.0)).collect();
    mesh.node_sets.insert("jaw".to_owned(), jaw);
    mesh.node_sets.insert("rest".to_owned(), rest);
    mesh.cell_labels.insert("layer".to_owned(), layers);
    mesh
}

/// Of these constants of the outer layer.
fn case((young_modulus, poisson_ratio): (f64, f64)) -> Value {
    json!({
        "units": "mm", "volume": "tissue", "skin": {"node_set": "z_max"}, "fixed": [{"node_set": "rest"}],
        "segments": [{"name": "jaw", "nodes": {"node_set": "jaw"}}],
        "regions": {"array": "layer", "names": {"0": "deep", "1": "outer"}},
        "materials": {
            "deep": {"young_modulus_kpa": 15, "poisson_ratio": 0.46},
            "outer": {"young_modulus_kpa": young_modulus, "poisson_ratio": poisson_ratio}}
    })
}

/// The same layers as a scan shows them: 40 HU up to z = 6 mm and 120 HU above, in slices of 1 mm.
fn ct() -> StoredMesh {
    let placement = Placement {
        origin: Vector::new(-5.0, -5.0, -0.5),
        steps: [Vector::x() * 70.0, Vector::y() * 50.0, Vector::z()],
    };
    let (slices, per_slice) = (14, 4);
    let value = |n: usize| if n / per_slice > 6 { 120 } else { 40 };
    let values = (0..slices * per_slice).map(value).collect();
    let image = ImageVolume::new([2, 2, slices], placement, Voxels::I16(values)).unwrap();
    let image = stored(facies::jobs::StoredShape::Image(image.into()), None);
    StoredMesh { frame: None, ..image }
}

/// The tissue by the values of the scan, and no regions.
fn imaged_case((young_modulus, poisson_ratio): (f64, f64)) -> Value {
    let mut case = case((15.0, 0.46));
    case.as_object_mut().unwrap().remove("regions");
    case["materials"] = json!({"*": {"young_modulus_kpa": 1, "poisson_ratio": 0.3}});
    case["hounsfield"] = json!({"image": "ct", "samples": 64, "tissues": [
        {"name": "deep", "from_hu": 0, "to_hu": 80,
         "material": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}},
        {"name": "outer", "from_hu": 80, "to_hu": 200,
         "material": {"young_modulus_kpa": young_modulus, "poisson_ratio": poisson_ratio}}]});
    case
}

/// The predicted skin, as its file is read.
fn predicted(sources: &Meshes, constants: (f64, f64), plan: &Value) -> StoredMesh {
    predicted_of(case(constants), sources, plan)
}

fn predicted_of(case: Value, sources: &Meshes, plan: &Value) -> StoredMesh {
    let folder = tempfile::tempdir().unwrap();
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(case.clone()).unwrap(),
        plan: serde_json::from_value(plan.clone()).unwrap(),
        spec: serde_json::from_value(
            json!({"method": "fem_linear", "estimate": "none", "outputs": ["skin.vtp"]}),
        )
        .unwrap(),
    };
    let place = JobContext { sources, limits: &Limits::default(), out: folder.path() };
    work(&JobInput::Predict(input), &place, &Unobserved).unwrap();
    let bytes = fs::read(folder.path().join("skin.vtp")).unwrap();
    let read = format::read(&bytes, &ReadLimits::default()).unwrap();
    StoredMesh::new(read, None, format!("skin of {case}"))
}

/// The same surface of other triangles in another order, with a hole of 5 mm, and no numbers of nodes.
fn scanned(skin: &TriangleSurface) -> TriangleSurface {
    let hole = Vector::new(48.0, 20.0, 12.0);
    let (mut points, mut triangles) = (skin.points.clone(), Vec::new());
    for number in (0..skin.triangles.len()).rev() {
        let [a, b, c] = skin.triangles[number];
        let middle = skin.corners(number).iter().sum::<Vector>() / 3.0;
        if (middle - hole).norm() < 5.0 {
            continue;
        }
        let own = points.len() as u32;
        points.push(middle);
        triangles.extend([[c, a, own], [b, c, own], [a, b, own]]);
    }
    TriangleSurface { points, triangles, node_ids: None }
}

/// A study of the constants of the outer layer against a scan, its folder and the warnings of its result.
fn study(
    sources: &Meshes,
    plan: &Value,
    truth: Value,
) -> Result<(ReportDocument, Vec<String>, TempDir), String> {
    study_of(case((30.0, 0.4)), sources, plan, truth)
}

fn study_of(
    case: Value,
    sources: &Meshes,
    plan: &Value,
    truth: Value,
) -> Result<(ReportDocument, Vec<String>, TempDir), String> {
    let sweep = json!({"outer": {"young_modulus_kpa": MODULI, "poisson_ratio": RATIOS}});
    swept(case, sources, (plan, sweep), truth)
}

fn swept(
    case: Value,
    sources: &Meshes,
    (plan, sweep): (&Value, Value),
    truth: Value,
) -> Result<(ReportDocument, Vec<String>, TempDir), String> {
    let folder = tempfile::tempdir().unwrap();
    let spec = json!({
        "kind": "study", "scenes": [{"case": "twin", "name": "twin", "plans": [plan]}],
        "methods": [{"method": "fem_linear", "label": "fem"}], "repeats": 1, "truth": truth,
        "sweep": sweep
    });
    let cases = [("twin".to_owned(), serde_json::from_value(case).unwrap())];
    let input = StudyInput {
        job: None,
        queue_s: None,
        cases: cases.into(),
        baseline: None,
        truth_method: None,
        earlier: None,
        spec: serde_json::from_value(spec).unwrap(),
    };
    let place = JobContext { sources, limits: &Limits::default(), out: folder.path() };
    let done = work(&JobInput::Study(input), &place, &Unobserved);
    let done = done.map_err(|error| format!("{error:?}"))?;
    let report = fs::read(folder.path().join("report.json")).unwrap();
    let codes = done.result.warnings.into_iter().map(|warning| warning.code).collect();
    Ok((serde_json::from_slice(&report).unwrap(), codes, folder))
}

/// The scan of the skin as bone leads it back.
fn by_bone() -> Value {
    json!({"mesh": "scan", "align": {
        "method": "surfaces", "fixed": {"mesh": "before"}, "moving": {"mesh": "after"},
        "mask": {"box_mm": [-50, -50, -8, 150, 100, 60]}}})
}

/// The scans of a twin: where its scanner stood after the operation, what was done, and all meshes.
fn twin() -> (RigidMovement, RigidMovement, Meshes, Value) {
    let (done, mut sources, spec) = performed();
    // The same way as in `performed`: where the scan after the operation lies.
    let scan = RigidMovement::about_pivot(
        Vector::new(0.05, 0.1, -0.05),
        Vector::zeros(),
        Vector::new(9.0, 4.0, -6.0),
    );
    let volume = facies::jobs::StoredShape::Volume(tissue().into());
    sources.0.insert("tissue".to_owned(), StoredMesh { frame: None, ..stored(volume, None) });
    let plan = json!({"segments": [{"name": "jaw", "matrix4x4": done.matrix4()}]});
    let skin = predicted(&sources, PLANTED, &plan);
    let there = moved(&scanned(&skin.surface().unwrap()), &scan.inverse());
    sources.0.insert("scan".to_owned(), surface(there));
    (scan, done, sources, spec)
}

fn assert_near(found: &Matrix4x4, planted: &RigidMovement, what: &str) {
    for (found, wanted) in found.0.iter().zip(planted.matrix4()) {
        assert!((found - wanted).abs() < 2e-3, "{what}: {found} instead of {wanted}");
    }
}

#[test]
fn transform_plan_and_constants_that_were_planted_come_back() {
    let (scan, done, sources, spec) = twin();
    // 1. Bone says where the scan lies and what was done.
    let ReproductionDocument { plan, base, segments } = reproduced(&sources, spec).unwrap();
    assert_near(&base.matrix4x4, &scan, "where the scan lies");
    assert_near(&segments[0].matrix4x4, &done, "what was done");
    let plan = serde_json::to_value(&plan).unwrap();

    // 2. D of each pair of constants, where the operation moves the skin.
    let (report, codes, folder) = study(&sources, &plan, by_bone()).unwrap();
    let [map] = &report.constant_maps[..] else { panic!("one map") };
    assert_eq!(map.best.values, [PLANTED.0, PLANTED.1], "{map:?}");
    assert!(map.best.mean_mm < 0.02 && report.scenes[0].noise_mm.unwrap() < 0.02, "{map:?}");
    let mut grid: Vec<f64> = map.cells.iter().map(|cell| cell.mean_mm).collect();
    grid.sort_by(f64::total_cmp);
    assert_eq!(grid.len(), MODULI.len() * RATIOS.len());
    // No other pair is as near: the data determine the constants.
    assert!(grid[1] > 2.0 * grid[0] && grid[1] > 0.001, "{grid:?}");
    assert!(map.axes.iter().all(|axis| axis.is_determined), "{map:?}");
    assert!(report.scenes[0].unmoved_mm.unwrap() > 0.2, "{:?}", report.scenes);
    assert!(!codes.iter().any(|code| code.starts_with("constant-")), "{codes:?}");
    assert!(codes.iter().any(|code| code == "growth-left-out"), "{codes:?}");
    let covered =
        report.rows.iter().map(|row| row.numbers.as_ref().unwrap().covered_share.unwrap());
    // The hole has 79 mm2 of the skin.
    assert!(covered.into_iter().all(|share| (0.9..1.0).contains(&share)));
    let chart = fs::read_to_string(folder.path().join("constants-1-fem.svg")).unwrap();
    assert_eq!(chart.matches("class=\"cell\"").count(), grid.len());
}

#[test]
fn constants_of_a_tissue_that_a_scan_shows_come_back() {
    let (_, done, mut sources, _) = twin();
    sources.0.insert("ct".to_owned(), ct());
    let plan = json!({"segments": [{"name": "jaw", "matrix4x4": done.matrix4()}]});
    let skin = predicted_of(imaged_case(PLANTED), &sources, &plan).surface().unwrap();
    // The scan finds the same layers as the regions of the mesh.
    let by_region = predicted(&sources, PLANTED, &plan).surface().unwrap();
    let apart = skin.points.iter().zip(&by_region.points).map(|(a, b)| (a - b).norm());
    assert!(apart.fold(0.0, f64::max) < 1e-6);
    sources.0.insert("scan".to_owned(), surface(scanned(&skin)));
    let (report, _, _) =
        study_of(imaged_case((30.0, 0.4)), &sources, &plan, json!({"mesh": "scan"})).unwrap();
    let [map] = &report.constant_maps[..] else { panic!("one map") };
    let names: Vec<String> = map.axes.iter().map(|axis| axis.words()).collect();
    assert!(names.iter().all(|name| name.contains("outer")), "{names:?}");
    assert_eq!(map.best.values, [PLANTED.0, PLANTED.1], "{map:?}");
    assert_eq!(map.cells.len(), MODULI.len() * RATIOS.len());
    assert!(map.best.mean_mm < 0.02, "{map:?}");
    let others = map.cells.iter().filter(|cell| cell.values != map.best.values);
    let second = others.map(|cell| cell.mean_mm).fold(f64::INFINITY, f64::min);
    assert!(second > 2.0 * map.best.mean_mm && second > 0.001, "{map:?}");
}

#[test]
fn tissue_that_was_lost_comes_back_with_the_ratio_and_shifts_it_where_it_is_left_out() {
    let (_, done, mut sources, _) = twin();
    let plan = json!({"segments": [{"name": "jaw", "matrix4x4": done.matrix4()}]});
    let mut lost = plan.clone();
    lost["growth"] = json!([{"region": "outer", "volume_change": -0.05}]);
    let skin = predicted(&sources, PLANTED, &lost).surface().unwrap();
    sources.0.insert("scan".to_owned(), surface((*skin).clone()));
    let found = |sweep: Value| {
        let by_nodes = json!({"mesh": "scan", "metric": "node_wise"});
        let (report, codes, _) =
            swept(case(PLANTED), &sources, (&plan, json!({"outer": sweep})), by_nodes).unwrap();
        let best = report.constant_maps[0].best.clone();
        (best, codes.iter().any(|code| code == "growth-left-out"))
    };
    let (both, is_warned) =
        found(json!({"poisson_ratio": RATIOS, "volume_change": [-0.1, -0.05, 0.0]}));
    assert_eq!((both.values, is_warned), (vec![PLANTED.1, -0.05], false));
    assert!(both.mean_mm < 1e-6, "{}", both.mean_mm);
    let (alone, is_warned) = found(json!({"poisson_ratio": RATIOS}));
    assert!(is_warned && alone.mean_mm > 0.05, "{}", alone.mean_mm);
    assert!((alone.values[0] - PLANTED.1).abs() > 0.05, "{:?}", alone.values);
}

#[test]
fn what_a_sweep_of_growth_cannot_mean_is_reported_with_its_place() {
    let (_, done, sources, _) = twin();
    let plan = json!({"segments": [{"name": "jaw", "matrix4x4": done.matrix4()}]});
    let sweep = json!({"outer": {"volume_change": [-0.05, -0.7]}});
    let refused = swept(case(PLANTED), &sources, (&plan, sweep), json!({"mesh": "scan"}));
    let why = refused.unwrap_err();
    assert!(why.contains("-0.7 is outside -0.5 to 1") && why.contains("sweep/outer"), "{why}");
}

/// Landmarks at points of the skin and above it, since all of the skin at rest lies in one plane.
fn marks_of(skin: &TriangleSurface) -> Value {
    let points = skin.points.len();
    let marks =
        [(0, 0.0), (points / 5, 8.0), (points / 3, 0.0), (points / 2, 8.0), (points - 9, 0.0)];
    let mark = |(number, (point, up)): (usize, (usize, f64))| {
        let at = skin.points[point] + Vector::z() * up;
        (format!("mark {number}"), json!([at.x, at.y, at.z]))
    };
    Value::Object(marks.into_iter().enumerate().map(mark).collect())
}

#[test]
fn constants_come_back_by_points_and_by_landmarks_too() {
    let (_, done, mut sources, _) = twin();
    let plan = json!({"segments": [{"name": "jaw", "matrix4x4": done.matrix4()}]});
    let [rest, planted] = [json!({}), plan.clone()]
        .map(|plan| (*predicted(&sources, PLANTED, &plan).surface().unwrap()).clone());
    let mut case = case((30.0, 0.4));
    case["landmarks"] = marks_of(&rest);
    sources.0.insert("same points".to_owned(), surface(planted.clone()));
    sources.0.insert("other points".to_owned(), surface(scanned(&planted)));
    let least = |truth: Value| -> f64 {
        let (report, ..) = study_of(case.clone(), &sources, &plan, truth).unwrap();
        let map = &report.constant_maps[0];
        assert_eq!(map.best.values, [PLANTED.0, PLANTED.1], "{map:?}");
        let others = map.cells.iter().filter(|cell| cell.values != map.best.values);
        assert!(others.into_iter().all(|cell| cell.mean_mm > 2.0 * map.best.mean_mm + 0.001));
        map.best.mean_mm
    };
    assert!(least(json!({"mesh": "same points", "metric": "node_wise"})) < 1e-6);
    let by_landmarks =
        json!({"mesh": "other points", "metric": "tps_cp", "landmarks_mm": marks_of(&planted)});
    assert!(least(by_landmarks.clone()) < 1e-6);

    // The skin before the operation under the landmarks of that after it.
    sources.0.insert("before".to_owned(), surface(scanned(&rest)));
    let mut before = by_landmarks.clone();
    before["mesh"] = json!("before");
    let (_, codes, _) = study_of(case.clone(), &sources, &plan, before).unwrap();
    assert!(codes.iter().any(|code| code == "before-operation-suspect"), "{codes:?}");

    let refused =
        |truth: Value| study_of(case.clone(), &sources, &plan, truth).map(|_| ()).unwrap_err();
    let mut four = by_landmarks.clone();
    four["landmarks_mm"].as_object_mut().unwrap().remove("mark 0");
    let told = refused(four);
    assert!(told.contains("needs 5 landmarks") && told.contains("here are 4"), "{told}");
    let mut flat = by_landmarks.clone();
    for (_, mark) in flat["landmarks_mm"].as_object_mut().unwrap() {
        mark[2] = json!(0.001 * mark[2].as_f64().unwrap());
    }
    let told = refused(flat);
    assert!(told.contains("the 5 landmarks of the scan") && told.contains("mm thick"), "{told}");
    let mut unknown = by_landmarks.clone();
    unknown["landmarks_mm"]["nose"] = json!([0, 0, 0]);
    let mut few = by_landmarks.clone();
    few["landmarks_mm"] = json!({"mark 0": [0, 0, 0]});
    for (truth, place) in [
        (json!({"mesh": "other points", "metric": "node_wise"}), "/spec/truth/metric"),
        (unknown, "/spec/truth/landmarks_mm/nose"),
        (few, "/spec/truth/landmarks_mm"),
        (
            json!({"mesh": "same points", "landmarks_mm": {"a": [0, 0, 0]}}),
            "/spec/truth/landmarks_mm",
        ),
        (json!({"refine": 0, "metric": "tps_cp"}), "/spec/truth/metric"),
    ] {
        let told = refused(truth);
        assert!(told.contains(&format!("{place:?}")), "{place}: {told}");
    }
}

#[test]
fn a_registration_that_leaves_more_than_constants_change_is_told_to_determine_none() {
    let (_, done, sources, _) = twin();
    let plan = json!({"segments": [{"name": "jaw", "matrix4x4": done.matrix4()}]});
    let mut truth = by_bone();
    truth["noise_mm"] = 5.0.into();
    let (report, codes, _) = study(&sources, &plan, truth).unwrap();
    let map = &report.constant_maps[0];
    assert_eq!((map.noise_mm, map.axes[1].as_good.as_slice()), (Some(5.0), &RATIOS[..]));
    assert_eq!(codes.iter().filter(|code| *code == "constant-not-determined").count(), 2);

    // Planted at an end of what is looked at, the best may lie beyond.
    let mut sources = sources;
    let skin = predicted(&sources, (MODULI[0], PLANTED.1), &plan).surface().unwrap();
    sources.0.insert("scan".to_owned(), surface((*skin).clone()));
    let (report, codes, _) = study(&sources, &plan, json!({"mesh": "scan"})).unwrap();
    assert_eq!(report.constant_maps[0].best.values, [MODULI[0], PLANTED.1]);
    assert_eq!(report.constant_maps[0].noise_mm, None);
    assert_eq!(codes.iter().filter(|code| *code == "constant-at-end").count(), 1, "{codes:?}");

    // The skin before the operation in place of that after it.
    let rest = predicted(&sources, PLANTED, &json!({})).surface().unwrap();
    sources.0.insert("scan".to_owned(), surface((*rest).clone()));
    let (_, codes, _) = study(&sources, &plan, json!({"mesh": "scan"})).unwrap();
    assert!(codes.iter().any(|code| code == "before-operation-suspect"), "{codes:?}");
}

/// The meshes with some of them changed, each point taken elsewhere.
fn changed(sources: &Meshes, names: &[&str], to: impl Fn(&Vector) -> Vector) -> Meshes {
    let mut sources = Meshes(sources.0.clone());
    for name in names {
        let own = sources.0[*name].surface_in_mm().unwrap();
        let points = own.points.iter().map(&to).collect();
        let shape = TriangleSurface { points, ..(*own).clone() };
        sources.0.insert((*name).to_owned(), surface(shape));
    }
    sources
}

/// What a study says of whose scan its truth is: the numbers of the warnings that doubt it, by code.
fn doubts(sources: &Meshes, plan: &Value, truth: Value) -> Vec<(String, Value)> {
    let sweep = json!({"outer": {"young_modulus_kpa": [15, 30], "poisson_ratio": [0.38, 0.46]}});
    let (report, codes, _) = swept(case(PLANTED), sources, (plan, sweep), truth).unwrap();
    let told = report.scenes[0].warnings.iter().map(|own| (own.code.clone(), json!(own)));
    let told = told.filter(|(code, _)| DOUBTS.contains(&code.as_str()));
    let told: Vec<(String, Value)> = told.collect();
    assert!(told.iter().all(|(code, _)| codes.contains(code)), "{codes:?}");
    told
}

const DOUBTS: [&str; 2] = ["mirrored?", "another-person-suspect"];

#[test]
fn a_scan_with_its_sides_exchanged_or_of_somebody_else_is_named_with_its_numbers() {
    let (_, done, sources, _) = twin();
    let plan = json!({"segments": [{"name": "jaw", "matrix4x4": done.matrix4()}]});
    assert_eq!(doubts(&sources, &plan, by_bone()), []);

    // An axis that was turned round at the export, of bone and skin.
    let mirrored = changed(&sources, &["after", "scan"], |at| Vector::new(-at.x, at.y, at.z));
    let told = doubts(&mirrored, &plan, by_bone());
    let (_, warning) = told.iter().find(|(code, _)| code == DOUBTS[0]).expect("a mirror image");
    let number = |name: &str| warning[name].as_f64().unwrap();
    assert!(number("mirrored_rms_mm") < 0.7 * number("rms_mm"), "{warning}");

    // Somebody whose head is an eighth larger: bone does not fit.
    let other = changed(&sources, &["after", "scan"], |at| at * 1.12);
    let told = doubts(&other, &plan, by_bone());
    let (_, warning) = told.iter().find(|(code, _)| code == DOUBTS[1]).expect("somebody else");
    let number = |name: &str| warning[name].as_f64().unwrap();
    assert!(number("share_above_1_mm") > 0.25 && number("rms_mm") > 0.3, "{warning}");
}

#[test]
fn a_scan_that_cannot_be_the_truth_is_refused_where_it_stands() {
    let (_, _, sources, _) = twin();
    let plan = json!({"segments": [{"name": "jaw", "translation_mm": [3, 0, 0]}]});
    let refused = |truth: Value| study(&sources, &plan, truth).map(|_| ()).unwrap_err();
    let wrong = [
        (json!({"mesh": "scan", "align": "icp"}), "/spec/truth/align/method"),
        (json!({"mesh": "nowhere"}), "/spec/truth/mesh"),
        (json!({"mesh": "scan", "refine": 1}), "/spec/truth"),
        (json!({"refine": 1, "noise_mm": 1.0}), "/spec/truth/noise_mm"),
        (json!({"mesh": "scan", "noise_mm": -1.0}), "/spec/truth/noise_mm"),
        (json!({"mesh": "scan", "align": "matrix"}), "/spec/truth/align/matrix4x4"),
    ];
    for (truth, place) in wrong {
        let told = refused(truth.clone());
        assert!(told.contains(&format!("{place:?}")), "{truth}: {told}");
    }
    let two = json!({
        "kind": "study", "scenes": [{"case": "twin", "plans": [plan, {"segments": []}]}], "truth": {"mesh": "scan"}
    });
    let mut faults = Faults::default();
    let spec: StudyDocument = serde_json::from_value(two).unwrap();
    spec.check(&Limits::default(), &mut faults);
    let told = format!("{:?}", faults.into_result());
    assert!(told.contains("\"/spec/truth/mesh\""), "{told}");
}
