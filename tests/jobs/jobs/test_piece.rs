//! A block on a plate with markers on its skin: what a model leaves out shows at the markers.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use facies::jobs::{
    CompareInput, JobContext, JobInput, PredictInput, StoredMesh, StoredShape, work,
};
use facies::schema::Limits;
use facies::schema::predict::result::ResultDocument;
use mechanics::format::{self, ReadLimits};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, TriangleSurface, Vector};
use mechanics::plan::RigidMovement;
use mechanics::progress::Unobserved;
use serde_json::{Value, json};

use crate::sources::{Meshes, stored};

fn run(sources: &Meshes, input: &JobInput, out: &Path) -> ResultDocument {
    let place = JobContext { sources, limits: &Limits::default(), out };
    work(input, &place, &Unobserved).unwrap().result
}

/// The skin of the piece after the plate was moved, by one method.
fn moved_by(sources: &Meshes, method: &str, out: &Path) -> (StoredMesh, TriangleSurface) {
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(json!({
            "units": "mm", "volume": "piece", "skin": {"node_set": "z_max"}, "fixed": [{"node_set": "x_min"}],
            "segments": [{"name": "plate", "nodes": {"node_set": "x_max"}}],
            "materials": {"*": {"young_modulus_kpa": 60, "poisson_ratio": 0.45}}
        }))
        .unwrap(),
        plan: serde_json::from_value(
            json!({"segments": [{"name": "plate", "translation_mm": [-6, 0, 8]}]}),
        )
        .unwrap(),
        spec: serde_json::from_value(json!({"outputs": ["skin.vtp"], "method": method})).unwrap(),
    };
    run(sources, &JobInput::Predict(input), out);
    let read = format::read(&fs::read(out.join("skin.vtp")).unwrap(), &ReadLimits::default());
    let skin = StoredMesh::new(read.unwrap(), None, format!("sha of {method}"));
    let shape = (*skin.surface().unwrap()).clone();
    (skin, shape)
}

/// A plate without any symmetry, below the end that stays.
fn plate() -> TriangleSurface {
    let mesh = block(Vector::new(30.0, 60.0, 10.0), [10, 20, 4], CellShape::Hex8);
    let mut plate = mesh.surface_of(&mesh.boundary_faces());
    plate.node_ids = None;
    for x in &mut plate.points {
        x.z += 4.0 * (x.x / 9.0).sin() + 3.0 * (x.y / 7.0).cos() - 20.0;
        x.x += 0.1 * x.y - 30.0;
    }
    plate
}

fn mark(prediction: &Vector, actual: &Vector) -> Value {
    let [p, a] = [prediction, actual].map(|x| [x.x, x.y, x.z]);
    json!({"prediction_mm": p, "actual_mm": a})
}

#[test]
fn a_test_piece_with_markers_tells_the_error_of_its_model() {
    let folder = tempfile::tempdir().unwrap();
    let volume = block(Vector::new(80.0, 60.0, 40.0), [16, 12, 8], CellShape::Hex8);
    let piece = stored(StoredShape::Volume(volume.into()), None);
    let mut sources = Meshes(BTreeMap::from([("piece".to_owned(), piece)]));
    let (skin, predicted) = moved_by(&sources, "fem_linear", folder.path());
    let (_, truth) = moved_by(&sources, "fem_nonlinear", folder.path());
    // The scanner has a frame of its own.
    let angles = Vector::new(0.2, -0.1, 0.3);
    let scan = RigidMovement::about_pivot(angles, Vector::zeros(), Vector::new(7.0, -4.0, 2.0));
    let scanned = |x: &Vector| scan.apply(x);
    let points = truth.points.iter().map(scanned).collect();
    let surface = TriangleSurface { points, node_ids: None, ..truth.clone() };
    sources.0.insert("skin".to_owned(), skin);
    let surface = stored(StoredShape::Surface(surface.into()), None);
    sources.0.insert("scan".to_owned(), surface);

    // The plate that stays brings both together; markers of the skin are measured.
    let plate = plate();
    let points = plate.points.iter().map(scanned).collect();
    let plate_scanned = TriangleSurface { points, ..plate.clone() };
    for (name, shape) in [("plate", plate), ("plate scanned", plate_scanned)] {
        sources.0.insert(name.to_owned(), stored(StoredShape::Surface(shape.into()), None));
    }
    let chosen: Vec<usize> = (0..predicted.points.len()).step_by(23).collect();
    let markers: BTreeMap<String, Value> = chosen
        .iter()
        .map(|&at| {
            (format!("marker {at}"), mark(&predicted.points[at], &scanned(&truth.points[at])))
        })
        .collect();
    let spec = json!({
        "prediction": {"mesh": "skin"}, "actual": {"mesh": "scan"},
        "align": {"method": "surfaces", "fixed": {"mesh": "plate"}, "moving": {"mesh": "plate scanned"}},
        "landmarks": markers,
    });
    let spec = serde_json::from_value(spec).unwrap();
    let input = JobInput::Compare(CompareInput { job: None, queue_s: None, spec });
    let found = run(&sources, &input, folder.path()).comparison.unwrap();
    assert!(found.alignment.rms_mm.unwrap() < 1e-3);
    let mut most = 0.0_f64;
    for &at in &chosen {
        let off = (predicted.points[at] - truth.points[at]).norm();
        let told = found.landmark_errors[&format!("marker {at}")].distance_mm;
        assert!((told - off).abs() < 5e-3, "{told} {off}");
        most = most.max(off);
    }
    // Linear elasticity leaves a quarter of a millimetre out of this movement.
    assert!(most > 0.2 && (found.landmark_statistics.unwrap().max - most).abs() < 5e-3, "{most}");
    assert!(
        fs::read_to_string(folder.path().join("skin.vtp")).unwrap().contains("landmark_error_mm")
    );
}
