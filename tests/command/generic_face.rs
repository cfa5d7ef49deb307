//! The generic face as files: a case that checks and predicts as it stands.

use std::collections::BTreeSet;
use std::fs;

use mechanics::format::vtk::vtp;
use mechanics::format::{self, Mesh, ReadLimits, SurfaceOutput};
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
        // Both sides of seven muscles, and the orbicularis, each a patch and a name.
        let picture = fs::read_to_string(out.join("muscles.svg")).unwrap();
        assert_eq!(picture.matches("largest share of").count(), 8, "{lips}");
        assert!(picture.contains("15 muscles in") && picture.contains("zygomaticus major<"));
    }
}

#[test]
fn the_volume_says_which_muscle_has_the_largest_share_of_each_cell() {
    let folder = tempfile::tempdir().unwrap();
    let face = folder.path().join("face");
    assert!(facies(&["face", "--out", path(&face)]).status.success());
    let (case, out) = (face.join("case.json"), folder.path().join("result"));
    let mut document: Value = serde_json::from_slice(&fs::read(&case).unwrap()).unwrap();
    document["spec"]["outputs"] = json!(["volume.vtu"]);
    fs::write(&case, document.to_string()).unwrap();
    let done = facies(&["predict", "--case", path(&case), "--out", path(&out)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let read = format::read(&fs::read(out.join("volume.vtu")).unwrap(), &ReadLimits::default());
    let Mesh::Volume(volume) = read.unwrap().mesh else { panic!("no volume") };
    let muscle = &volume.cell_labels["muscle"];
    assert_eq!(muscle.len(), 5616);
    let names: BTreeSet<i64> = muscle.iter().copied().collect();
    assert_eq!(names, (-1..15).collect());
    // The corners of a mesh that is symmetric mirror each other, and so do their muscles.
    let count = |number: i64| muscle.iter().filter(|own| **own == number).count();
    assert_eq!(count(0), count(1), "zygomaticus major of both sides");
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

/// A surface of a patient of a number, larger by some percent, and after an operation where the jaw goes forward and all skin
/// half a millimetre further than it goes with it.
fn scanned(sets: &[&str], number: usize, forward: Option<f64>) -> Vec<u8> {
    let face =
        generic_face(FaceSettings { lips: Lips::Closed, fineness: 1, shape: CellShape::Hex8 });
    let mesh = &face.mesh;
    let has = |node: &u32| sets.iter().any(|set| mesh.node_sets[*set].binary_search(node).is_ok());
    let faces = mesh.boundary_faces().into_iter();
    let faces: Vec<_> = faces.filter(|own| own.nodes().iter().all(has)).collect();
    let mut surface = mesh.surface_of(&faces);
    surface.points.iter_mut().for_each(|x| *x = of_scanned(x, number, forward));
    vtp::write(&SurfaceOutput::plain(&surface, Frame::Lps)).unwrap()
}

/// Where a point of the generic face is in that patient.
fn of_scanned(x: &Vector, number: usize, forward: Option<f64>) -> Vector {
    let below = 1.0 / (1.0 + ((x.z + 20.0) / 8.0).exp());
    let moved = forward.map_or(0.0, |forward| forward * below + 0.5);
    *x * (1.02 + 0.02 * number as f64) - Vector::new(0.0, moved, 0.0)
}

/// How far points of the generic face went in the mean by the operation of a patient, in mm.
fn went<'a>(points: impl Iterator<Item = &'a Vector>, number: usize) -> f64 {
    let moved = points.map(|x| {
        let [a, b] = [None, Some(1.5 + number as f64)].map(|own| of_scanned(x, number, own));
        (b - a).norm()
    });
    let moved: Vec<f64> = moved.collect();
    moved.iter().sum::<f64>() / moved.len() as f64
}

/// docs/learning.md#scans-that-were-made-after-operations.
#[test]
fn skins_that_were_scanned_before_and_after_operations_are_learned_from_through_one_template() {
    let folder = tempfile::tempdir().unwrap();
    let face = folder.path().join("face");
    assert!(facies(&["face", "--out", path(&face)]).status.success());
    let template: Value =
        serde_json::from_slice(&fs::read(face.join("conform.json")).unwrap()).unwrap();
    let generic =
        generic_face(FaceSettings { lips: Lips::Closed, fineness: 1, shape: CellShape::Hex8 });
    let conformed = |name: &str, number: usize, forward: Option<f64>| {
        let bone = ["maxilla", "mandible", "skull"];
        for (part, sets) in [("skin", &["skin"][..]), ("bone", &bone)] {
            let file = face.join(format!("{name}_{part}.vtp"));
            fs::write(file, scanned(sets, number, forward)).unwrap();
        }
        let mut spec = template.clone();
        spec["patient"] =
            json!({"skin": format!("{name}_skin.vtp"), "bone": format!("{name}_bone.vtp")});
        let pair = |(name, x): (&String, &Vector)| {
            let of = of_scanned(x, number, forward);
            let pair = json!({"template_mm": [x.x, x.y, x.z], "patient_mm": [of.x, of.y, of.z]});
            (name.clone(), pair)
        };
        // Too few for any of them to be doubted, which takes long.
        let some = generic.landmarks.iter().step_by(7);
        spec["landmarks"] = Value::Object(some.map(pair).collect());
        let file = face.join(format!("{name}.json"));
        fs::write(&file, spec.to_string()).unwrap();
        let out = folder.path().join(name);
        let done = facies(&["conform", "--spec", path(&file), "--out", path(&out)]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    };
    let cases = (1..=3).map(|number| {
        let forward = 1.5 + number as f64;
        let [before, after] = ["before", "after"].map(|time| format!("{time}_{number}"));
        conformed(&before, number, None);
        conformed(&after, number, Some(forward));
        let read = fs::read(folder.path().join(&before).join("case.json")).unwrap();
        let mut case: Value = serde_json::from_slice(&read).unwrap();
        case["case"]["volume"] = json!(format!("{before}/volume.vtu"));
        case["plan"] =
            json!({"segments": [{"name": "mandible", "translation_mm": [0, -forward, 0]}]});
        case["spec"] = json!({"method": "fem_linear"});
        fs::write(folder.path().join(format!("{before}.json")), case.to_string()).unwrap();
        json!({"prediction": format!("{before}.json"), "actual": format!("{after}/volume.vtu")})
    });
    let spec = json!({"cases": cases.collect::<Vec<_>>()});
    let file = folder.path().join("learn.json");
    fs::write(&file, spec.to_string()).unwrap();
    let model = folder.path().join("model");
    let done = facies(&["learn", "--spec", path(&file), "--out", path(&model)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let found = result(&model).learning.unwrap();
    let of = |name: &str| found.table.iter().find(|own| own.name == name).unwrap();
    // How far the skin went is known, to what the conformation misses of it.
    let skin = &generic.mesh.node_sets["skin"];
    for (number, case) in (1..).zip(&of("no movement").cases) {
        let skin = skin.iter().map(|&node| &generic.mesh.nodes[node as usize]);
        let expected = went(skin, number);
        assert!((case.mean - expected).abs() < 0.2, "{number}: {} of {expected}", case.mean);
    }
    assert!(of("fem_linear + GRNN").mean < of("fem_linear").mean, "{:?}", found.table);
    assert!(text(&done.stdout).contains("fem_linear + GRNN"), "{}", text(&done.stdout));
}
