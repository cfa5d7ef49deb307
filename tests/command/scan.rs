//! From a scan to a predicted skin in one command.

use std::fs;

use serde_json::{Value, json};

use crate::program::{facies, path, result, text};
use crate::samples::ball_ct;

fn plan() -> Value {
    json!({
        "frame": "LPS",
        "osteotomy": {
            "cuts": [{"name": "middle", "point_mm": [60, 55, 60], "normal": [0, 0, 1]}],
            "segments": [{"name": "jaw", "below": ["middle"]}],
        },
        "segments": [{"name": "jaw", "translation_mm": [0, -3, 0]}],
    })
}

#[test]
fn a_scan_and_a_plan_with_its_cuts_give_a_predicted_skin_in_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("ct.nrrd"), ball_ct()).unwrap();
    fs::write(file("plan.json"), plan().to_string()).unwrap();
    let (scan, plan, out) = (file("ct.nrrd"), file("plan.json"), file("out"));
    let small = ["--tetrahedra", "20000"];
    let asked = ["--scan", path(&scan), "--plan", path(&plan), "--out", path(&out)];
    let done = facies(&[&["predict"], &asked[..], &small[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let direct = result(&out).statistics.unwrap().skin.nodes;
    assert!((2.0..4.0).contains(&direct.max), "{direct:?}");
    for name in ["mesh/volume.vtu", "mesh/bone-1.vtp", "mesh/slices.svg", "skin.vtp"] {
        assert!(out.join(name).is_file(), "{name}");
    }

    // In two steps it is the same, and the plan is that without its cuts.
    let meshed = file("meshed");
    let asked = ["--scan", path(&scan), "--plan", path(&plan), "--out", path(&meshed)];
    let done = facies(&[&["mesh"], &asked[..], &small[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let (case, again) = (meshed.join("case.json"), file("again"));
    let done = facies(&["predict", "--case", path(&case), "--out", path(&again)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert_eq!(result(&again).statistics.unwrap().skin.nodes, direct);
    // The mesh that was handed over in memory is the one that was written.
    assert_eq!(result(&again).provenance.spec_hash, result(&out).provenance.spec_hash);
    assert_eq!(result(&again).provenance.inputs, result(&out).provenance.inputs);
    assert_eq!(fs::read(again.join("skin.vtp")).unwrap(), fs::read(out.join("skin.vtp")).unwrap());
    let same = |name: &str| {
        assert_eq!(
            fs::read(out.join("mesh").join(name)).unwrap(),
            fs::read(meshed.join(name)).unwrap()
        );
    };
    ["volume.vtu", "bone-1.vtp"].into_iter().for_each(same);
}

#[test]
fn cuts_without_a_scan_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plan.json");
    fs::write(&file, plan().to_string()).unwrap();
    let mesh = crate::program::block().join("block.vtu");
    let out = folder.path().join("out");
    let asked = ["predict", "--mesh", path(&mesh), "--plan", path(&file), "--out", path(&out)];
    let refused = facies(&asked);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("/plan/osteotomy"), "{}", text(&refused.stderr));
}
