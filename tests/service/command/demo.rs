//! `facies demo` as a user runs it: the binary, twice, in a folder of its own.

use std::path::Path;
use std::process::{Command, Output};

fn demo(out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_facies"))
        .args(["demo", "--out"])
        .arg(out)
        .output()
        .expect("the binary starts")
}

/// The line of the table that begins with a word, as numbers.
fn numbers(table: &str, name: &str) -> Vec<f64> {
    let line = table.lines().find(|line| line.trim_start().starts_with(name));
    let line = line.unwrap_or_else(|| panic!("no line {name} in {table}"));
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn the_demo_predicts_a_face_and_says_how_good_the_numbers_are_twice() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("demo");
    for run in ["the first run", "the second run"] {
        let Output { status, stdout, stderr } = demo(&out);
        let [table, errors] =
            [stdout, stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        assert!(status.success(), "{run}: {errors}");
        assert_eq!(errors, "", "{run}");
        assert_eq!(table.contains("known from an earlier run"), run == "the second run");
        assert!(table.lines().all(|line| line.chars().count() <= 80 || line.contains('/')));

        // No skin moves farther than the bone that moves it: the mandible by |(0, 6, 2)| = 6.325 mm.
        let [_, mean, median, p95, max] = numbers(&table, "whole skin")[..] else {
            panic!("{table}")
        };
        assert!(0.0 < mean && median < p95 && p95 < max && max < 6.325, "{table}");
        // The chin follows the mandible back and up; in a symmetric face nothing goes aside.
        let [aside, back, up] = numbers(&table, "pogonion")[..] else { panic!("{table}") };
        assert!(aside == 0.0 && (4.0..6.0).contains(&back) && up > 0.0, "{table}");
        // Halving every edge moves the answer by far less than the answer: a tenth, for the mean.
        let refined = numbers(&table, "same node");
        assert!(0.0 < refined[0] && refined[0] < 0.1 * mean, "{table}");

        for name in ["skin.vtp", "skin.glb", "volume.vtu", "displacement.svg", "result.json"] {
            let bytes = std::fs::metadata(out.join(name)).map_or(0, |file| file.len());
            assert!(bytes > 1000, "{run}: {name} has {bytes} bytes");
        }
    }
}

#[test]
fn the_demo_replaces_no_file_that_no_command_wrote() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let own = folder.path().join("skin.vtp");
    std::fs::write(&own, "mine").expect("a file");
    let Output { status, stderr, .. } = demo(folder.path());
    let told = String::from_utf8_lossy(&stderr);
    assert!(status.code() == Some(2) && told.contains("give another folder"), "{told}");
    let left: Vec<_> = std::fs::read_dir(folder.path()).expect("the folder").collect();
    assert_eq!((left.len(), std::fs::read(&own).expect("the file")), (1, b"mine".to_vec()));
}
