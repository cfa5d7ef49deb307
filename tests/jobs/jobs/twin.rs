//! A synthetic twin of Zachow et al. 2006 and Kim et al. 2012: an operation is planted, and its scans are all that is known of it.
//!
//! Bone before and after gives the way back of the scan and the plan; the predicted skin of each pair of constants is held against the
//! scan of the skin, which lies elsewhere, has other triangles and a hole. What was planted has to come back.

use std::fs;

use facies::jobs::{CompareInput, JobInput, PredictInput, StoredMesh, Workplace, work};
use facies::schema::compare::result::ComparisonDocument;
use facies::schema::reproduce::result::ReproductionDocument;
use facies::schema::{Limits, Matrix4x4};
use mechanics::format::{self, ReadLimits};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, TriangleSurface, Vector, VolumeMesh};
use mechanics::plan::RigidMovement;
use mechanics::progress::Unobserved;
use serde_json::{Value, json};

use super::planning::{moved, performed, reproduced, surface};
use crate::sources::{Meshes, stored};

/// Young's modulus of the outer layer in kPa, where that of the inner one is 15, and Poisson's ratio of both.
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

fn case((young_modulus, poisson_ratio): (f64, f64)) -> Value {
    json!({
        "units": "mm", "volume": "tissue", "skin": {"node_set": "z_max"}, "fixed": [{"node_set": "rest"}],
        "segments": [{"name": "jaw", "nodes": {"node_set": "jaw"}}],
        "regions": {"array": "layer", "names": {"0": "deep", "1": "outer"}},
        "materials": {
            "deep": {"young_modulus_kpa": 15, "poisson_ratio": poisson_ratio},
            "outer": {"young_modulus_kpa": young_modulus, "poisson_ratio": poisson_ratio}}
    })
}

/// The predicted skin, as its file is read.
fn predicted(sources: &Meshes, constants: (f64, f64), plan: &Value) -> StoredMesh {
    let folder = tempfile::tempdir().unwrap();
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(case(constants)).unwrap(),
        plan: serde_json::from_value(plan.clone()).unwrap(),
        spec: serde_json::from_value(
            json!({"method": "fem_linear", "estimate": "none", "outputs": ["skin.vtp"]}),
        )
        .unwrap(),
    };
    let place = Workplace { sources, limits: &Limits::default(), out: folder.path() };
    work(&JobInput::Predict(input), &place, &Unobserved).unwrap();
    let bytes = fs::read(folder.path().join("skin.vtp")).unwrap();
    let read = format::read(&bytes, &ReadLimits::default()).unwrap();
    StoredMesh::new(read, None, format!("skin {constants:?}"))
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

fn comparison(sources: &Meshes, way_back: Matrix4x4) -> ComparisonDocument {
    let folder = tempfile::tempdir().unwrap();
    let spec = serde_json::from_value(json!({
        "prediction": {"mesh": "skin"}, "actual": {"mesh": "scan"},
        "align": {"method": "matrix", "matrix4x4": way_back},
        "regions": {"moved": {"moved_by_more_than_mm": 0.5}}
    }));
    let input = CompareInput { job: None, queue_s: None, spec: spec.unwrap() };
    let place = Workplace { sources, limits: &Limits::default(), out: folder.path() };
    let done = work(&JobInput::Compare(input), &place, &Unobserved).unwrap();
    done.result.comparison.unwrap()
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
    let (scan, done, mut sources, spec) = twin();
    // 1. Bone says where the scan lies and what was done.
    let ReproductionDocument { plan, base, segments } = reproduced(&sources, spec).unwrap();
    assert_near(&base.matrix4x4, &scan, "where the scan lies");
    assert_near(&segments[0].matrix4x4, &done, "what was done");
    let plan = serde_json::to_value(&plan).unwrap();

    // 2. D of each pair of constants, where the operation moves the skin.
    let mut grid = Vec::new();
    for young_modulus in MODULI {
        for poisson_ratio in RATIOS {
            let constants = (young_modulus, poisson_ratio);
            let skin = predicted(&sources, constants, &plan);
            sources.0.insert("skin".to_owned(), skin);
            let found = comparison(&sources, base.matrix4x4);
            grid.push((found.regions["moved"].to_prediction.mean, constants));
        }
    }
    grid.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(least, best), (next, _), ..] = grid[..] else { panic!("a grid") };
    assert_eq!(best, PLANTED, "{grid:?}");
    assert!(least < 0.02, "{grid:?}");
    // No other pair is as near: the data determine the constants.
    assert!(next > 2.0 * least && next > 0.005, "{grid:?}");
}
