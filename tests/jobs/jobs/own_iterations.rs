//! Iterations of the mass-tensor's own, asked for in documents.

use std::collections::BTreeMap;

use facies::jobs::{JobContext, JobInput, PredictInput, StoredMesh, StoredShape, work};
use facies::schema::Limits;
use facies::schema::predict::result::ResultDocument;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector};
use mechanics::progress::Unobserved;
use serde_json::json;

use crate::sources::{Meshes, stored};

fn predicted(iterations: &str) -> Result<ResultDocument, String> {
    let volume = block(Vector::new(30.0, 20.0, 10.0), [6, 4, 2], CellShape::Tet4);
    let volume = StoredMesh { frame: None, ..stored(StoredShape::Volume(volume.into()), None) };
    let sources = Meshes(BTreeMap::from([("block".to_owned(), volume)]));
    let case = json!({
        "units": "mm", "volume": "block", "skin": {"node_set": "z_max"}, "fixed": [{"node_set": "x_min"}],
        "segments": [{"name": "jaw", "nodes": {"node_set": "x_max"}}],
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.43,
                            "fibre": {"young_modulus_kpa": 60, "direction": [1, 0, 0]}}}
    });
    let plan = json!({"segments": [{"name": "jaw", "translation_mm": [1, 0, 2]}]});
    let own = json!({"iterations": iterations});
    let spec = json!({"outputs": ["skin.vtp"], "method": "mtm_ti", "mtm_ti": own});
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(case).unwrap(),
        plan: serde_json::from_value(plan).unwrap(),
        spec: serde_json::from_value(spec).unwrap(),
    };
    let folder = tempfile::tempdir().unwrap();
    let (limits, out) = (Limits::default(), folder.path());
    let done = work(
        &JobInput::Predict(input),
        &JobContext { sources: &sources, limits: &limits, out },
        &Unobserved,
    );
    done.map(|done| done.result).map_err(|error| format!("{error:?}"))
}

#[test]
fn tissue_with_fibres_is_brought_to_rest_as_its_document_asks() {
    let fast = predicted("fast").unwrap();
    let by_node = predicted("gauss_seidel").unwrap();
    let mean = |of: &ResultDocument| of.statistics.as_ref().unwrap().skin.nodes.mean;
    assert!((mean(&fast) - mean(&by_node)).abs() < 1e-5);
    let iterations = |of: &ResultDocument| of.provenance.solver.as_ref().unwrap().iterations;
    assert!(iterations(&by_node) > 10 && iterations(&fast) < iterations(&by_node));
    assert!(by_node.nonlinearity_unknown.is_some() && fast.nonlinearity_mm.is_some());
    let refused = predicted("jacobi").unwrap_err();
    assert!(refused.to_lowercase().contains("diverge"), "{refused}");
}
