//! The generic face as files: a case that checks and predicts as it stands.

use std::fs;

use mechanics::format::SurfaceOutput;
use mechanics::format::vtk::vtp;
use mechanics::mesh::generic_face::{FaceSettings, Lips, generic_face};
use mechanics::mesh::{CellShape, Frame, Vector};
use serde_json::{Value, json};

use crate::program::{facies, path, result, text};

#[test]
fn the_generic_face_is_a_case_that_predicts_a_jaw_and_a_smile_as_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    for lips in ["closed", "open"] {
        let face = folder.path().join(lips);
        let done = facies(&["face", "--lips", lips, "--out", path(&face)]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        assert!(text(&done.stdout).contains("5616 cells, 32 landmarks, 15 muscles"));
        let case = face.join("case.json");
        let out = folder.path().join("result");
        let done = facies(&["predict", "--case", path(&case), "--out", path(&out)]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        let moved = result(&out).statistics.unwrap();
        let chin = moved.landmarks["pogonion"];
        assert!((-5.0..-4.2).contains(&chin.0[1]), "{lips}: {chin:?}");

        let mut smile: Value = serde_json::from_slice(&fs::read(&case).unwrap()).unwrap();
        let pulls =
            |side: &str| json!({"muscle": format!("zygomaticus_major_{side}"), "stress_kpa": 10});
        smile["plan"] = json!({"activations": [pulls("left"), pulls("right")]});
        fs::write(&case, smile.to_string()).unwrap();
        let done = facies(&["predict", "--case", path(&case), "--out", path(&out)]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        let corner = result(&out).statistics.unwrap().landmarks["cheilion_left"];
        assert!(corner.0[0] > 0.2 && corner.0[2] > 0.2, "{lips}: {corner:?}");
    }
}

/// The skin or bone of the generic face on a patient who is larger by 7 % and 1.5 mm bent.
fn surface_of_patient(sets: &[&str]) -> Vec<u8> {
    let face =
        generic_face(FaceSettings { lips: Lips::Closed, fineness: 1, shape: CellShape::Hex8 });
    let mesh = &face.mesh;
    let has = |node: &u32| sets.iter().any(|set| mesh.node_sets[*set].binary_search(node).is_ok());
    let faces = mesh.boundary_faces().into_iter();
    let faces: Vec<_> = faces.filter(|own| own.nodes().iter().all(has)).collect();
    let mut surface = mesh.surface_of(&faces);
    for x in &mut surface.points {
        *x = *x * 1.07 + Vector::new(0.0, 1.5 * (x.z * 0.05).sin(), 4.0);
    }
    vtp::write(&SurfaceOutput::plain(&surface, Frame::Lps)).unwrap()
}

#[test]
fn the_generic_face_conforms_to_a_patient_whose_case_smiles() {
    let folder = tempfile::tempdir().unwrap();
    let face = folder.path().join("face");
    let done = facies(&["face", "--out", path(&face)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    fs::write(face.join("skin.vtp"), surface_of_patient(&["skin"])).unwrap();
    let bone = surface_of_patient(&["maxilla", "mandible", "skull"]);
    fs::write(face.join("bone.vtp"), bone).unwrap();
    let spec = face.join("conform.json");
    let mut document: Value = serde_json::from_slice(&fs::read(&spec).unwrap()).unwrap();
    document["patient"] = json!({"skin": "skin.vtp", "bone": "bone.vtp"});
    fs::write(&spec, document.to_string()).unwrap();
    let patient = folder.path().join("patient");
    let done = facies(&["conform", "--spec", path(&spec), "--out", path(&patient)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("muscles    15, their lines"), "{}", text(&done.stdout));
    assert!(!text(&done.stdout).contains("made-case-refused"), "{}", text(&done.stdout));

    let case = patient.join("case.json");
    let mut smile: Value = serde_json::from_slice(&fs::read(&case).unwrap()).unwrap();
    assert_eq!(smile["case"]["sliding"].as_array().unwrap().len(), 2);
    let pulls =
        |side: &str| json!({"muscle": format!("zygomaticus_major_{side}"), "stress_kpa": 10});
    smile["plan"] = json!({"activations": [pulls("left"), pulls("right")]});
    smile["case"]["landmarks"] = json!({"corner": smile["case"]["muscles"][0]["lines_mm"][0]
        .as_array().unwrap().last().unwrap()});
    fs::write(&case, smile.to_string()).unwrap();
    let out = folder.path().join("smile");
    let done = facies(&["predict", "--case", path(&case), "--out", path(&out)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let corner = result(&out).statistics.unwrap().landmarks["corner"];
    assert!(corner.0[0] > 0.2 && corner.0[2] > 0.2, "{corner:?}");
}
