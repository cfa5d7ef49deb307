//! Comparisons as documents: bone decides where a scan goes, regions and landmarks where it is measured.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use facies::jobs::{
    CompareInput, JobContext, JobError, JobInput, JobOutput, PredictInput, StoredMesh, StoredShape,
    work,
};
use facies::schema::compare::result::ComparisonDocument;
use facies::schema::{CompareDocument, Limits};
use mechanics::format::{self, ReadLimits};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Frame, TriangleSurface, Vector};
use mechanics::plan::RigidMovement;
use mechanics::progress::Unobserved;
use mechanics::registration::RigidTransform;
use serde_json::{Value, json};

use crate::sources::{Meshes, stored};

/// A block of 80 x 60 x 40 mm that is held at its left end and whose right half's ground moves.
fn case() -> Value {
    json!({
        "units": "mm", "volume": "block", "skin": {"node_set": "z_max"}, "fixed": [{"node_set": "x_min"}],
        "segments": [{"name": "jaw", "nodes": {"node_set": "x_max"}}],
        "skin_regions": {"top": {"node_set": "z_max"}},
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.4}}
    })
}

fn sources() -> Meshes {
    let volume = block(Vector::new(80.0, 60.0, 40.0), [16, 12, 4], CellShape::Hex8);
    let volume = stored(StoredShape::Volume(volume.into()), Some(Frame::Lps));
    Meshes(BTreeMap::from([("block".to_owned(), StoredMesh { frame: None, ..volume })]))
}

fn surface(shape: &TriangleSurface) -> StoredMesh {
    StoredMesh { frame: None, ..stored(StoredShape::Surface(shape.clone().into()), None) }
}

/// A bone without any symmetry.
fn bone() -> TriangleSurface {
    let mesh = block(Vector::new(30.0, 20.0, 10.0), [12, 8, 4], CellShape::Hex8);
    let mut bone = mesh.surface_of(&mesh.boundary_faces());
    bone.node_ids = None;
    for point in &mut bone.points {
        point.z += 4.0 * (point.x / 9.0).sin() + 3.0 * (point.y / 7.0).cos();
        point.x += 0.1 * point.y;
    }
    bone
}

fn moved(surface: &TriangleSurface, by: &RigidTransform) -> TriangleSurface {
    let points = surface.points.iter().map(|point| by.apply(point)).collect();
    TriangleSurface { points, ..surface.clone() }
}

/// A predicted skin as its file is read, with what it says of its points.
fn predicted(sources: &Meshes, folder: &Path) -> (StoredMesh, TriangleSurface) {
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(case()).unwrap(),
        plan: serde_json::from_value(
            json!({"segments": [{"name": "jaw", "translation_mm": [4, 0, 0]}]}),
        )
        .unwrap(),
        spec: serde_json::from_value(json!({"outputs": ["skin.vtp"], "method": "fem_linear"}))
            .unwrap(),
    };
    run(sources, &JobInput::Predict(input), folder).unwrap();
    let read = format::read(&fs::read(folder.join("skin.vtp")).unwrap(), &ReadLimits::default());
    let skin = StoredMesh::new(read.unwrap(), None, "sha of skin".to_owned());
    let shape = (*skin.surface().unwrap()).clone();
    (skin, shape)
}

fn run(sources: &Meshes, input: &JobInput, out: &Path) -> Result<JobOutput, JobError> {
    work(input, &JobContext { sources, limits: &Limits::default(), out }, &Unobserved)
}

fn compared(sources: &Meshes, spec: &Value, out: &Path) -> Result<JobOutput, JobError> {
    let spec: CompareDocument = serde_json::from_value(spec.clone()).unwrap();
    run(sources, &JobInput::Compare(CompareInput { job: None, queue_s: None, spec }), out)
}

fn comparison(sources: &Meshes, spec: &Value, out: &Path) -> ComparisonDocument {
    compared(sources, spec, out).unwrap().result.comparison.unwrap()
}

#[test]
fn bone_takes_the_scan_to_the_prediction_and_says_how_well_it_fits() {
    let folder = tempfile::tempdir().unwrap();
    let mut sources = sources();
    let (skin, shape) = predicted(&sources, folder.path());
    let angles = Vector::new(0.1, -0.05, 0.15);
    let turn = RigidMovement::about_pivot(angles, Vector::zeros(), Vector::new(5.0, -3.0, 2.0));
    let turn = RigidTransform { rotation: *turn.rotation(), translation: turn.translation() };
    let back = turn.inverse();
    sources.0.insert("skin".to_owned(), skin);
    sources.0.insert("scan".to_owned(), surface(&moved(&shape, &back)));
    sources.0.insert("bone".to_owned(), surface(&bone()));
    sources.0.insert("bone after".to_owned(), surface(&moved(&bone(), &back)));
    let spec = json!({
        "prediction": {"mesh": "skin"}, "actual": {"mesh": "scan"},
        "align": {"method": "surfaces", "fixed": {"mesh": "bone"}, "moving": {"mesh": "bone after"}},
    });
    let done = compared(&sources, &spec, folder.path()).unwrap();
    let roles: Vec<&str> = done.result.provenance.inputs.iter().map(|i| i.role.as_str()).collect();
    assert_eq!(roles, ["prediction", "actual", "fixed", "moving"]);
    let found = done.result.comparison.unwrap();
    assert!(found.both.max < 1e-3, "{}", found.both.max);
    assert_eq!(found.alignment.method, "surfaces");
    assert_eq!(found.alignment.share_above_1_mm, Some(0.0));
    // What it found aligns as a matrix, too.
    let matrix = found.alignment.matrix4x4;
    let mut by_matrix = spec.clone();
    by_matrix["align"] = json!({"method": "matrix", "matrix4x4": matrix});
    let again = comparison(&sources, &by_matrix, folder.path());
    assert_eq!((again.both, again.alignment.matrix4x4), (found.both, matrix));
    // Turned the other way round it is no alignment.
    let turned: Vec<f64> = back.matrix4().to_vec();
    by_matrix["align"]["matrix4x4"] = json!(turned);
    assert!(comparison(&sources, &by_matrix, folder.path()).both.max > 5.0);
}

#[test]
fn percentiles_of_a_few_landmarks_are_interpolated() {
    let folder = tempfile::tempdir().unwrap();
    let mut sources = sources();
    sources.0.insert("bone".to_owned(), surface(&bone()));
    let mark = |off: f64| json!({"prediction_mm": [off, 5, 5], "actual_mm": [off, 5, 5.0 + off]});
    let spec = json!({
        "prediction": {"mesh": "bone"}, "actual": {"mesh": "bone"}, "align": {"method": "none"},
        "landmarks": {"a": mark(0.0), "b": mark(1.0), "c": mark(2.0), "d": mark(10.0)},
    });
    let found = comparison(&sources, &spec, folder.path()).landmark_statistics.unwrap();
    let told = format!("{found:?}");
    // As numpy's percentiles.
    for (one, other) in [(found.p25, 0.75), (found.median, 1.5), (found.p75, 4.0)] {
        assert!((one - other).abs() < 1e-12, "{told}");
    }
}

#[test]
fn a_scan_is_measured_where_the_plan_moves_the_skin_and_at_landmarks() {
    let folder = tempfile::tempdir().unwrap();
    let mut sources = sources();
    let (skin, shape) = predicted(&sources, folder.path());
    sources.0.insert("skin".to_owned(), skin);
    let lifted = RigidTransform { translation: Vector::z(), ..RigidTransform::identity() };
    sources.0.insert("scan".to_owned(), surface(&moved(&shape, &lifted)));
    let mark =
        |x: f64, y: f64, z: f64| json!({"prediction_mm": [x, y, z], "actual_mm": [x, y, z + 1.0]});
    let mut spec = json!({
        "prediction": {"mesh": "skin"}, "actual": {"mesh": "scan"},
        "regions": {"moved": {"moved_by_more_than_mm": 2}, "top": {"skin_region": "top"}},
        "landmarks": {"a": mark(0.0, 0.0, 40.0), "b": mark(80.0, 0.0, 40.0), "c": mark(0.0, 60.0, 40.0),
                      "d": mark(80.0, 60.0, 40.0), "e": mark(40.0, 30.0, 20.0)},
        "histogram_edges_mm": [-1.5, -0.5, 0.5, 1.5],
    });
    let found = comparison(&sources, &spec, folder.path());
    let names: Vec<&str> = found.regions.keys().map(String::as_str).collect();
    assert_eq!(names, ["moved", "top"]);
    assert!(found.regions["moved"].to_actual.count < found.to_actual.count);
    assert_eq!(found.regions["top"].to_actual.count, found.to_actual.count);
    let histogram = found.histogram.unwrap();
    // The scan lies 1 mm above the prediction, which is below its outside.
    assert_eq!(histogram.signed.shares, [1.0, 0.0, 0.0]);
    assert_eq!(histogram.unsigned.shares, [0.0, 0.0, 1.0]);
    assert!((found.landmark_errors["e"].distance_mm - 1.0).abs() < 1e-12);
    assert!((found.landmark_statistics.unwrap().max - 1.0).abs() < 1e-12);
    let tps_cp = found.tps_cp.unwrap();
    assert_eq!((tps_cp.landmarks, tps_cp.is_affine), (5, false));
    assert!((tps_cp.nodes.mean - 1.0).abs() < 1e-9, "{}", tps_cp.nodes.mean);
    // The skin is pulled thin, so that what is straight above is not always nearest.
    assert!(found.both.min > 0.9 && found.both.p25 <= found.both.p75, "{:?}", found.both);
    assert!(found.both.max <= 1.0 + 1e-9, "{:?}", found.both);

    spec["regions"] = json!({"lips": {"skin_region": "lips"}});
    let refused = format!("{:?}", compared(&sources, &spec, folder.path()).unwrap_err());
    assert!(
        refused.contains("/spec/regions/lips/skin_region") && refused.contains("top"),
        "{refused}"
    );
    // A mesh without the array cannot say where it was moved.
    spec["prediction"] = json!({"mesh": "scan"});
    spec["regions"] = json!({"moved": {"moved_by_more_than_mm": 2}});
    let refused = format!("{:?}", compared(&sources, &spec, folder.path()).unwrap_err());
    let at = "/spec/regions/moved/moved_by_more_than_mm";
    assert!(refused.contains(at) && refused.contains("NoDisplacement"), "{refused}");
}

#[test]
fn errors_of_nodes_and_of_landmarks_are_maps_over_the_skin() {
    let folder = tempfile::tempdir().unwrap();
    let mut sources = sources();
    let (skin, shape) = predicted(&sources, folder.path());
    sources.0.insert("skin".to_owned(), skin);
    let mut scan = shape.clone();
    scan.points.iter_mut().for_each(|x| x.z += 0.02 * x.x);
    sources.0.insert("scan".to_owned(), surface(&scan));
    let (a, b) = (shape.points[0], shape.points[shape.points.len() - 1]);
    let mark = |at: Vector, off: f64| json!({"prediction_mm": [at.x, at.y, at.z], "actual_mm": [at.x, at.y, at.z + off]});
    let facts = json!({"lips": "apart", "days_after_operation": 180});
    let spec = json!({
        "prediction": {"mesh": "skin"}, "actual": {"mesh": "scan"}, "acquisition": facts,
        "landmarks": {"a": mark(a, 1.0), "b": mark(b, 3.0)},
    });
    let found = comparison(&sources, &spec, folder.path());
    assert_eq!(serde_json::to_value(found.acquisition).unwrap(), facts);
    let file = fs::read_to_string(folder.path().join("skin.vtp")).unwrap();
    for name in ["signed_distance_mm", "node_error_mm", "landmark_error_mm"] {
        assert_eq!(file.matches(&format!("Name=\"{name}\"")).count(), 1, "{name}");
    }
    let nodes = found.node_wise.unwrap().nodes;
    let most = shape.points.iter().map(|x| 0.02 * x.x).fold(0.0, f64::max);
    assert!((nodes.max - most).abs() < 1e-9, "{} {most}", nodes.max);
    assert!(!folder.path().join("skin.glb").exists());
    let mut coloured = spec.clone();
    coloured["range_mm"] = json!(5);
    comparison(&sources, &coloured, folder.path());
    let ply = fs::read(folder.path().join("skin.ply")).unwrap();
    let head = String::from_utf8_lossy(&ply[..1500]).into_owned();
    assert!(head.contains("-5") && head.contains("signed_distance_mm"), "{head}");
    assert!(folder.path().join("skin.glb").exists());
    let picture = fs::read_to_string(folder.path().join("distance.svg")).unwrap();
    assert_eq!(picture.matches("data:image/png;base64,").count(), 3);
    assert_eq!(picture.matches("class=\"bin\"").count(), 20);
    for words in ["distance, mm", ">-5<", ">5<", "below the range", "Both ways, by area"] {
        assert!(picture.contains(words), "{words}");
    }
    if let Ok(kept) = std::env::var("FACIES_TEST_PICTURES") {
        fs::write(Path::new(&kept).join("distance.svg"), &picture).unwrap();
    }
    let plain =
        json!({"prediction": {"mesh": "skin"}, "actual": {"mesh": "scan"}, "node_wise": "off"});
    comparison(&sources, &plain, folder.path());
    let file = fs::read_to_string(folder.path().join("skin.vtp")).unwrap();
    assert!(!file.contains("node_error_mm") && !file.contains("landmark_error_mm"));
}

#[test]
fn an_alignment_is_told_what_it_needs_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let mut sources = sources();
    sources.0.insert("skin".to_owned(), surface(&bone()));
    let refused = |align: Value| {
        let spec =
            json!({"prediction": {"mesh": "skin"}, "actual": {"mesh": "skin"}, "align": align});
        format!("{:?}", compared(&sources, &spec, folder.path()).unwrap_err())
    };
    let identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    let mut scaled = identity;
    scaled[0] = 2;
    for (align, at) in [
        (json!({"method": "matrix"}), "/spec/align/matrix4x4"),
        (json!({"method": "matrix", "matrix4x4": scaled}), "/spec/align/matrix4x4"),
        (json!({"method": "icp", "matrix4x4": identity}), "/spec/align/matrix4x4"),
        (json!({"method": "surfaces", "fixed": {"mesh": "skin"}}), "/spec/align/moving"),
        (json!({"method": "icp", "start": "boxes"}), "/spec/align/start"),
        (json!({"method": "icp", "moving": {"mesh": "skin"}}), "/spec/align/moving"),
        (
            json!({"method": "surfaces", "fixed": {"mesh": "skin"}, "moving": {"mesh": "skin"}, "start": "landmarks"}),
            "/spec/align/landmarks",
        ),
        (
            json!({"method": "surfaces", "fixed": {"mesh": "none"}, "moving": {"mesh": "skin"}}),
            "/spec/align/fixed/mesh",
        ),
    ] {
        let refused = refused(align.clone());
        assert!(refused.contains(at), "{align}: {refused}");
    }
}
