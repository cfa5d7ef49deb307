//! The generic face as files: a case that checks and predicts as it stands.

use std::fs;

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
