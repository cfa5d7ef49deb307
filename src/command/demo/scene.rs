//! Documents of the demo: the half head and the generic face as cases, their plans, and the jobs.

use serde_json::{Value, json};

use super::client::Part;
use crate::command::face::case::{case_of, meshes};
use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput, WriteError};
use mechanics::mesh::generic_face::GenericFace;
use mechanics::mesh::half_head::{HalfHead, LAYERS};
use mechanics::mesh::{Frame, VolumeMesh};

/// What is asked for besides `result.json`, and fetched.
pub const FILES: [&str; 7] = [
    "skin.vtp",
    "skin.glb",
    "skin.stl",
    "volume.vtu",
    "bones.vtp",
    "classes.svg",
    "displacement.svg",
];

/// The same of the face that smiles.
pub const FACE_FILES: [&str; 4] = ["skin.vtp", "skin.glb", "displacement.svg", "muscles.svg"];

/// The form that `POST /v1/cases` takes: the case and its meshes. `volume` is that of the head, or a
/// finer one with the same sets.
pub fn case_form(
    head: &HalfHead,
    volume: &VolumeMesh,
    name: &str,
) -> Result<Vec<Part>, WriteError> {
    let mut parts = vec![
        Part { name: "case".into(), bytes: case_document(head, name).to_string().into_bytes() },
        Part {
            name: "volume".into(),
            bytes: vtu::write(&VolumeOutput::plain(volume, Frame::Lps))?,
        },
    ];
    for (bone, surface) in &head.bones {
        let bytes = vtp::write(&SurfaceOutput::plain(surface, Frame::Lps))?;
        parts.push(Part { name: bone_part(bone), bytes });
    }
    Ok(parts)
}

fn bone_part(bone: &str) -> String {
    format!("bone_{bone}")
}

/// Young's moduli are those of Zachow et al. 2006 (docs/methods.md#papers), table 1: skin from
/// Holzapfel (0.1 to 2 MPa), fat from Krouskop and Ophir; muscle and the tissue around it are the
/// optimum that the paper found in section 3 (above 300 kPa at ν 0.43 to 0.45, below 50 kPa at
/// 0.44 to 0.47), with ν where plain tetrahedra do not lock.
fn case_document(head: &HalfHead, name: &str) -> Value {
    let layers: serde_json::Map<String, Value> =
        LAYERS.iter().enumerate().map(|(label, layer)| (label.to_string(), json!(layer))).collect();
    let bones: Vec<Value> =
        head.bones.keys().map(|bone| json!({"name": bone, "mesh": bone_part(bone)})).collect();
    let landmarks: serde_json::Map<String, Value> = head
        .landmarks
        .iter()
        .map(|(name, point)| ((*name).to_owned(), json!([point.x, point.y, point.z])))
        .collect();
    json!({
        "schema": 1,
        "name": name,
        "tags": ["demo"],
        "units": "mm",
        "frame": "LPS",
        "volume": "volume",
        "bones": bones,
        "landmarks": landmarks,
        "regions": {"array": "layer", "names": layers},
        "skin": {"node_set": "skin"},
        "skin_regions": {
            "nose": {"node_set": "nose"},
            "lips": {"node_set": "lips"},
            "chin": {"node_set": "chin"},
        },
        "segments": [
            {"name": "maxilla", "nodes": {"node_set": "maxilla"}},
            {"name": "mandible", "nodes": {"node_set": "mandible"}},
        ],
        "fixed": [{"node_set": "skull"}, {"node_set": "rim"}],
        "materials": {
            "skin": {"young_modulus_kpa": 100, "poisson_ratio": 0.45, "density_g_per_cm3": 1.1},
            "fat": {"young_modulus_kpa": 20, "poisson_ratio": 0.45, "density_g_per_cm3": 0.92},
            "muscle": {"young_modulus_kpa": 300, "poisson_ratio": 0.44, "density_g_per_cm3": 1.06},
            "deep": {"young_modulus_kpa": 50, "poisson_ratio": 0.45, "density_g_per_cm3": 1.04},
        },
    })
}

/// Mandible 6 mm back and 2 mm up, maxilla 4 mm forward: y points to the back, z up.
fn plan() -> Value {
    json!({
        "segments": [
            {"name": "mandible", "translation_mm": [0, 6, 2]},
            {"name": "maxilla", "translation_mm": [0, -4, 0]},
        ],
        "frame": "LPS",
    })
}

/// The job document of the prediction of a case. The demo holds two meshes against each other: one model on both.
pub fn prediction_of(case: &str, files: &[&str]) -> Value {
    json!({
        "kind": "predict",
        "case": case,
        "method": "fem_linear",
        "plan": plan(),
        "outputs": files,
        "tags": ["demo"],
    })
}

/// The form of the generic face as a case.
pub fn face_form(face: &GenericFace) -> Result<Vec<Part>, WriteError> {
    let mut case = case_of(face);
    case["tags"] = json!(["demo"]);
    let case = Part { name: "case".into(), bytes: case.to_string().into_bytes() };
    let meshes = meshes(face)?.into_iter().map(|(name, bytes)| Part { name, bytes });
    Ok(std::iter::once(case).chain(meshes).collect())
}

/// The job document of a smile with the mandible 5 mm forward.
pub fn smile_of(case: &str) -> Value {
    let smiles = ["left", "right"]
        .map(|side| json!({"muscle": format!("zygomaticus_major_{side}"), "stress_kpa": 10}));
    json!({
        "kind": "predict",
        "case": case,
        "method": "fem_linear",
        "plan": {
            "segments": [{"name": "mandible", "translation_mm": [0, -5, 0]}],
            "activations": smiles,
            "frame": "LPS",
        },
        "outputs": FACE_FILES,
        "tags": ["demo"],
    })
}

/// The job document that compares a predicted skin with the mesh of another.
pub fn comparison_of(job: &str, mesh: &str) -> Value {
    json!({
        "kind": "compare",
        "prediction": {"job": job},
        "actual": {"mesh": mesh},
        "align": {"method": "none"},
        "tags": ["demo"],
    })
}
