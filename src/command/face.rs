//! `facies face`: the generic face as files, so that a case with lips and muscles is there without data.

pub mod case;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::{Map, Value, json};

use super::claim::Claim;
use super::documents::CASE_FILE;
use super::failure::CommandError;
use crate::jobs::JobError;
use case::{SKIN_REGIONS, case_of, meshes};
use mechanics::mesh::CellShape;
use mechanics::mesh::generic_face::{FaceSettings, GenericFace, Lips, generic_face};

/// A conformation that waits for the names of a patient's surfaces.
const CONFORMATION: &str = "conform.json";

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
    let mut files = meshes(&face).map_err(JobError::from)?;
    files.push((CASE_FILE.to_owned(), format!("{:#}\n", documents(&face)).into_bytes()));
    let conformation = format!("{:#}\n", conformation(&case_of(&face)));
    files.push((CONFORMATION.to_owned(), conformation.into_bytes()));
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let claim = Claim::of(&arguments.out, &names)?;
    for (name, bytes) in files {
        claim.put(&name, bytes)?;
        println!("wrote      {}", arguments.out.join(name).display());
    }
    let (cells, muscles) = (face.mesh.cells.len(), face.muscles.len());
    println!("{cells} cells, {} landmarks, {muscles} muscles", face.landmarks.len());
    Ok(())
}

/// The case, and a plan that takes the jaw 5 mm forward.
fn documents(face: &GenericFace) -> Value {
    json!({
        "case": case_of(face),
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
