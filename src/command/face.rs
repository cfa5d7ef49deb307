//! `facies face`: the generic face as files, so that a case with lips and muscles is there without data.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::{Map, Value, json};

use super::documents::write;
use super::failure::CommandError;
use crate::jobs::JobError;
use mechanics::format::vtk::{vtp, vtu};
use mechanics::format::{SurfaceOutput, VolumeOutput, WriteError};
use mechanics::mesh::generic_face::{FaceSettings, GenericFace, LAYERS, Lips, generic_face};
use mechanics::mesh::{CellShape, Frame, Vector};

const SKIN_REGIONS: [&str; 5] = ["nose", "upper_lip", "lower_lip", "chin", "cheeks"];

const VOLUME: &str = "face.vtu";

/// The finest face, with 505 440 hexahedra.
const FINEST: u64 = 9;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LipsArgument {
    Closed,
    Open,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CellArgument {
    Hex8,
    Wedge6,
    Tet4,
}

#[derive(Debug, Args)]
pub struct Arguments {
    /// Whether the lips touch or are 6 mm apart
    #[arg(long, value_enum, default_value = "closed")]
    lips: LipsArgument,
    /// 1 for 5616 hexahedra, n for n x n as many
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=FINEST))]
    fineness: u64,
    /// Hexahedra, or wedges or tetrahedra that they are cut into
    #[arg(long, value_enum, default_value = "hex8")]
    cells: CellArgument,
    /// Folder for `case.json`, its meshes, and `conform.json`, a conformation that waits for the names of a patient's surfaces
    #[arg(long, visible_alias = "output", value_name = "FOLDER")]
    out: PathBuf,
}

/// Makes the face and writes it.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let lips = match arguments.lips {
        LipsArgument::Closed => Lips::Closed,
        LipsArgument::Open => Lips::Open,
    };
    let shape = match arguments.cells {
        CellArgument::Hex8 => CellShape::Hex8,
        CellArgument::Wedge6 => CellShape::Wedge6,
        CellArgument::Tet4 => CellShape::Tet4,
    };
    let fineness = arguments.fineness as usize;
    let face = generic_face(FaceSettings { lips, fineness, shape });
    let out = &arguments.out;
    for (name, bytes) in meshes(&face).map_err(JobError::from)? {
        put(&out.join(name), bytes)?;
    }
    put(&out.join("case.json"), format!("{:#}\n", documents(&face)))?;
    put(&out.join("conform.json"), format!("{:#}\n", conformation(&case(&face))))?;
    let (cells, muscles) = (face.mesh.cells.len(), face.muscles.len());
    println!("{cells} cells, {} landmarks, {muscles} muscles", face.landmarks.len());
    Ok(())
}

fn put(path: &Path, content: impl AsRef<[u8]>) -> Result<(), CommandError> {
    write(path, content)?;
    println!("wrote      {}", path.display());
    Ok(())
}

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

/// The case, and a plan that takes the jaw 5 mm forward.
fn documents(face: &GenericFace) -> Value {
    json!({
        "case": case(face),
        "plan": {"segments": [{"name": "mandible", "translation_mm": [0, -5, 0]}], "frame": "LPS"},
        "spec": {"kind": "predict"},
    })
}

/// The face as the template of a conformation, which lacks the patient's surfaces and, where there are some, landmarks.
fn conformation(case: &Value) -> Value {
    let by_name = |name: &&str| ((*name).to_owned(), json!(name));
    let skin_regions: Map<String, Value> = SKIN_REGIONS.iter().map(by_name).collect();
    json!({
        "kind": "conform",
        "template": {
            "mesh": case["volume"],
            "skin": "skin",
            "segments": {"maxilla": "maxilla", "mandible": "mandible"},
            "fixed": "skull",
            "held": ["rim"],
            "sliding": [
                {"nodes": "upper_vestibule", "segment": "maxilla"},
                {"nodes": "lower_vestibule", "segment": "mandible"},
            ],
            "skin_regions": skin_regions,
            "regions": case["regions"],
            "materials": case["materials"],
            "muscles": case["muscles"],
        },
        "patient": {"skin": "patient_skin.stl", "bone": "patient_bone.stl"},
    })
}

/// Tissue has 15 kPa and a Poisson ratio of 0.49, muscle at rest 6.2 kPa: Chabanas et al. 2003 (docs/methods.md#papers), section
/// 3.4.2, after Fung 1993 and Duck 1990. The mucosa before the teeth slides on them, which the jaws carry.
pub fn case(face: &GenericFace) -> Value {
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
