//! The generic face as a case: its document and its meshes.

use serde_json::{Map, Value, json};

use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput, WriteError};
use mechanics::mesh::generic_face::{GenericFace, LAYERS};
use mechanics::mesh::{Frame, Vector};

pub const SKIN_REGIONS: [&str; 5] = ["nose", "upper_lip", "lower_lip", "chin", "cheeks"];

const VOLUME: &str = "face.vtu";

/// The volume and the bones by the names that the case has for them.
pub fn meshes(face: &GenericFace) -> Result<Vec<(String, Vec<u8>)>, WriteError> {
    let volume = vtu::write(&VolumeOutput::plain(&face.mesh, Frame::Lps))?;
    let mut meshes = vec![(VOLUME.to_owned(), volume)];
    for (bone, surface) in &face.bones {
        let bytes = vtp::write(&SurfaceOutput::plain(surface, Frame::Lps))?;
        meshes.push((bone_file(bone), bytes));
    }
    Ok(meshes)
}

fn bone_file(bone: &str) -> String {
    format!("{bone}.vtp")
}

/// Tissue has 15 kPa and a Poisson ratio of 0.49, muscle at rest 6.2 kPa: Chabanas et al. 2003 (docs/methods.md#papers), section
/// 3.4.2, after Fung 1993 and Duck 1990. The mucosa before the teeth slides on them, which the jaws carry.
pub fn case_of(face: &GenericFace) -> Value {
    let set = |name: &str| json!({"node_set": name});
    let by_name = |name: &&str| ((*name).to_owned(), set(name));
    let layers: Map<String, Value> =
        LAYERS.iter().enumerate().map(|(label, name)| (label.to_string(), json!(name))).collect();
    let bones: Vec<Value> =
        face.bones.keys().map(|bone| json!({"name": bone, "mesh": bone_file(bone)})).collect();
    let skin_regions: Map<String, Value> = SKIN_REGIONS.iter().map(by_name).collect();
    let landmarks: Map<String, Value> =
        face.landmarks.iter().map(|(name, point)| (name.clone(), rounded(point))).collect();
    let slides = |nodes: &str, segment: &str| json!({"nodes": set(nodes), "normal": "surface", "segment": segment});
    json!({
        "schema": 1,
        "name": "generic face",
        "units": "mm",
        "frame": "LPS",
        "volume": VOLUME,
        "bones": bones,
        "landmarks": landmarks,
        "regions": {"array": "layer", "names": layers},
        "skin": set("skin"),
        "skin_regions": skin_regions,
        "segments": [
            {"name": "maxilla", "nodes": set("maxilla")},
            {"name": "mandible", "nodes": set("mandible")},
        ],
        "fixed": [set("skull"), set("rim")],
        "sliding": [slides("upper_vestibule", "maxilla"), slides("lower_vestibule", "mandible")],
        "materials": {
            "*": {"young_modulus_kpa": 15, "poisson_ratio": 0.49, "density_g_per_cm3": 1.04},
            "muscle": {"young_modulus_kpa": 6.2, "poisson_ratio": 0.49, "density_g_per_cm3": 1.06},
        },
        "muscles": muscles(face),
    })
}

fn muscles(face: &GenericFace) -> Vec<Value> {
    let line = |line: &Vec<Vector>| line.iter().map(rounded).collect::<Vec<Value>>();
    let muscles = face.muscles.iter();
    muscles
        .map(|own| {
            let lines: Vec<Vec<Value>> = own.lines.iter().map(line).collect();
            json!({"name": own.name, "lines_mm": lines, "within_mm": own.within})
        })
        .collect()
}

/// To 0.001 mm, to be read.
fn rounded(point: &Vector) -> Value {
    json!([0, 1, 2].map(|axis| (point[axis] * 1e3).round() / 1e3))
}
