//! Folders and files of results: what a command may remove and replace.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use facies::schema::wire::canonical::sha256_hex;
use serde_json::{Value, json};

use crate::program::{block, facies, path, text};

/// Predicts the block into a folder.
fn predict(out: &Path) -> (Option<i32>, String) {
    let case = block().join("case.json");
    let asked = ["predict", "--case", path(&case), "--outputs", "skin.vtp", "--out", path(out)];
    let done = facies(&asked);
    (done.status.code(), text(&done.stderr))
}

#[test]
fn a_record_that_names_files_of_other_folders_is_refused_and_they_stay() {
    let folder = tempfile::tempdir().unwrap();
    let (out, other) = (folder.path().join("out"), folder.path().join("keep.txt"));
    fs::create_dir(&out).unwrap();
    fs::write(&other, "keep").unwrap();
    let case = block().join("case.json");
    for name in ["../keep.txt", path(&other)] {
        let record = format!("{}  {name}\n", sha256_hex(b"keep"));
        fs::write(out.join(".facies"), &record).unwrap();
        let (code, told) = predict(&out);
        assert!(code == Some(2) && told.contains("no record that facies wrote"), "{told}");
        let check = facies(&["check", "--case", path(&case), "--out", path(&out)]);
        assert_eq!(check.status.code(), Some(2), "{}", text(&check.stderr));
        assert_eq!(fs::read(&other).unwrap(), b"keep", "{name}");
        assert_eq!(fs::read_to_string(out.join(".facies")).unwrap(), record);
    }
}

#[test]
fn nothing_is_written_through_a_link_nor_over_a_record_of_somebody_else() {
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("precious");
    fs::write(&other, "precious").unwrap();
    let away = folder.path().join("away");
    let out = |name: &str| {
        let out = folder.path().join(name);
        fs::create_dir(&out).unwrap();
        out
    };
    let (linked, noted, dangling) = (out("linked"), out("noted"), out("dangling"));
    symlink(&other, linked.join(".facies")).unwrap();
    fs::write(noted.join(".facies"), "my own notes").unwrap();
    symlink(&away, dangling.join("skin.vtp")).unwrap();
    for (out, file) in [(&linked, ".facies"), (&noted, ".facies"), (&dangling, "skin.vtp")] {
        let (code, told) = predict(out);
        let file = out.join(file);
        assert!(code == Some(2) && told.contains(&format!("{} is there", path(&file))), "{told}");
        assert_eq!(fs::read_dir(out).unwrap().count(), 1, "{told}");
    }
    assert_eq!(fs::read(&other).unwrap(), b"precious");
    assert_eq!(fs::read(noted.join(".facies")).unwrap(), b"my own notes");
    assert!(!away.exists());
}

#[test]
fn a_result_that_could_not_be_written_leaves_nothing_of_the_one_before() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    assert_eq!(predict(&out).0, Some(0));
    let before: Vec<_> = ["case.json", "skin.vtp"].map(|name| fs::read(out.join(name)).ok()).into();
    assert!(before.iter().all(Option::is_some) && out.join("result.json").is_file());
    let mut documents: Value =
        serde_json::from_slice(&fs::read(block().join("case.json")).unwrap()).unwrap();
    documents["case"]["volume"] = json!(path(&block().join("block.vtu")));
    documents["case"]["bones"] = json!([]);
    documents["plan"]["segments"][0]["translation_mm"] = json!([0, 0, 2]);
    let file = folder.path().join("other.json");
    fs::write(&file, documents.to_string()).unwrap();
    // Too large a file breaks it off, as a kill does.
    let mut limited = Command::new("prlimit");
    limited.args(["--fsize=2000", env!("CARGO_BIN_EXE_facies"), "predict", "--case", path(&file)]);
    let done = limited.args(["--outputs", "skin.vtp", "--out", path(&out)]).output().unwrap();
    assert_eq!(done.status.code(), Some(3), "{}", text(&done.stderr));
    assert!(!out.join("case.json").exists() && !out.join("result.json").exists());
    assert_ne!(fs::read(out.join("skin.vtp")).ok(), before[1]);
    // Nor does the broken one leave anything to the next.
    let case = ["predict", "--case", path(&file), "--outputs", "skin.csv", "--out", path(&out)];
    assert_eq!(facies(&case).status.code(), Some(0));
    let there = |name: &str| out.join(name).exists();
    assert!(there("case.json") && there("skin.csv") && there("result.json"));
    assert!(!there("skin.vtp"));
}

#[test]
fn a_surface_is_not_simplified_into_itself() {
    let folder = tempfile::tempdir().unwrap();
    let given = folder.path().join("given.stl");
    fs::copy(block().join("mandible.stl"), &given).unwrap();
    let before = fs::read(&given).unwrap();
    let [link, hard] = ["link.stl", "hard.stl"].map(|name| folder.path().join(name));
    symlink(&given, &link).unwrap();
    fs::hard_link(&given, &hard).unwrap();
    let other = folder.path().join("other.stl");
    for out in [&given, &link, &hard] {
        for to in [
            ["--out", path(out), "--report", path(&other)],
            ["--out", path(&other), "--report", path(out)],
        ] {
            let done = facies(&[&["simplify", path(&given)][..], &to].concat());
            let (code, told) = (done.status.code(), text(&done.stderr));
            assert!(code == Some(2) && told.contains("is read"), "{told}");
        }
    }
    let twice = ["simplify", path(&given), "--out", path(&other), "--report", path(&other)];
    assert_eq!(facies(&twice).status.code(), Some(2));
    assert!(fs::read(&given).unwrap() == before && !other.exists());
}
