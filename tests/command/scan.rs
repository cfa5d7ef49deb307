//! From a scan to a predicted skin in one command.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};

use crate::program::{facies, path, result, text};
use crate::samples::{
    BONE_BALL, SKIN_BALL, SampleBall, ball_ct, ball_ct_with, ball_labels, ball_stl,
};
use mechanics::mesh::Vector;

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
fn a_plan_that_moves_what_is_not_cut_is_refused_before_anything_is_meshed() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("ct.nrrd"), ball_ct()).unwrap();
    let mut wrong = plan();
    wrong["segments"][0]["name"] = json!("maxilla");
    fs::write(file("plan.json"), wrong.to_string()).unwrap();
    let (scan, plan, out) = (file("ct.nrrd"), file("plan.json"), file("out"));
    let done =
        facies(&["predict", "--scan", path(&scan), "--plan", path(&plan), "--out", path(&out)]);
    assert_eq!(done.status.code(), Some(2));
    let told = text(&done.stderr);
    assert!(told.contains("/plan/segments/0/name") && told.contains("jaw"), "{told}");
    assert!(!out.exists());
}

#[test]
fn what_has_no_meaning_where_a_scan_is_meshed_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("ct.nrrd"), ball_ct()).unwrap();
    fs::write(file("plan.json"), plan().to_string()).unwrap();
    let (scan, plan, out) = (file("ct.nrrd"), file("plan.json"), file("out"));
    let rest = ["--scan", path(&scan), "--plan", path(&plan), "--out", path(&out)];
    for (command, argument, value) in [
        ("predict", "--fixed", "skull"),
        ("predict", "--segment", "jaw=nosuch"),
        ("predict", "--skin", "nosuchset"),
        ("predict", "--frame", "RAS"),
        ("predict", "--units", "um"),
        ("mesh", "--skin", "skin.stl"),
        ("mesh", "--units", "m"),
    ] {
        let refused = facies(&[&[command, argument, value], &rest[..]].concat());
        let told = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{command} {argument}: {told}");
        assert!(told.contains(&format!("{argument} has no meaning")), "{argument}: {told}");
        assert!(!out.exists(), "{argument}");
    }
}

/// Replaces a line of the header of a NRRD file.
fn with_space(scan: &[u8], space: &str) -> Vec<u8> {
    let at = scan.windows(6).position(|bytes| bytes == b"space:").unwrap();
    let end = at + scan[at..].iter().position(|byte| *byte == b'\n').unwrap();
    [&scan[..at], b"space: ", space.as_bytes(), &scan[end..]].concat()
}

#[test]
fn the_axes_of_a_scan_that_states_none_are_stated_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("ct.nrrd"), with_space(&ball_ct(), "3D-right-handed")).unwrap();
    fs::write(file("plan.json"), plan().to_string()).unwrap();
    let mut unstated = plan();
    unstated.as_object_mut().unwrap().remove("frame");
    fs::write(file("unstated.json"), unstated.to_string()).unwrap();
    let (scan, out) = (file("ct.nrrd"), file("out"));
    let asked = |command: &str, plan: &str, more: &[&str]| {
        let plan = file(plan);
        let rest = ["--scan", path(&scan), "--plan", path(&plan), "--out", path(&out)];
        facies(&[&[command, "--tetrahedra", "20000"], &rest[..], more].concat())
    };
    let doubtful = |folder: &std::path::Path| {
        let told = result(folder).warnings.into_iter();
        told.filter(|warning| warning.code == "image-place-doubtful").count()
    };
    let frame_of = |file: &std::path::Path| {
        let case: Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
        case["case"]["frame"].clone()
    };
    let refused = asked("mesh", "plan.json", &[]);
    let told = text(&refused.stderr);
    assert!(refused.status.code() == Some(2) && told.contains("--frame LPS"), "{told}");
    for (command, folder) in [("mesh", out.clone()), ("predict", out.join("mesh"))] {
        let done = asked(command, "plan.json", &["--frame", "LPS"]);
        assert_eq!(done.status.code(), Some(0), "{command}: {}", text(&done.stderr));
        assert_eq!((doubtful(&folder), frame_of(&out.join("case.json"))), (0, json!("LPS")));
    }
    let meshed = asked("mesh", "unstated.json", &[]);
    assert_eq!(meshed.status.code(), Some(0), "{}", text(&meshed.stderr));
    assert_eq!((doubtful(&out), frame_of(&out.join("case.json"))), (1, json!("unspecified")));
}

#[test]
fn a_label_map_is_meshed_in_its_regions_and_says_which_labels_it_was_not_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("labels.nrrd"), ball_labels()).unwrap();
    let classes = json!([
        {"label": "1", "is": "tissue", "name": "muscle"},
        {"label": "2", "is": "tissue", "name": "fat"},
        {"label": "3", "is": "bone", "name": "jaw"},
    ]);
    let (labels, spec, out) = (file("labels.nrrd"), file("spec.json"), file("out"));
    let asked = ["mesh", "--labels", path(&labels), "--mesh-spec", path(&spec)];
    let asked = [&asked[..], &["--out", path(&out)]].concat();
    let document = json!({"labels": {"classes": classes}, "size": {"tetrahedra": 20_000}});
    let mut short = document.clone();
    short["labels"]["classes"].as_array_mut().unwrap().remove(1);
    fs::write(&spec, short.to_string()).unwrap();
    let refused = facies(&asked);
    let told = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{told}");
    assert!(told.contains("/spec/labels/classes") && told.contains("2 ("), "{told}");
    fs::write(&spec, document.to_string()).unwrap();
    let of_a_ct =
        ["mesh", "--scan", path(&labels), "--mesh-spec", path(&spec), "--out", path(&out)];
    let told = text(&facies(&of_a_ct).stderr);
    assert!(told.contains("--labels FILE"), "{told}");
    let done = facies(&asked);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let case: Value = serde_json::from_slice(&fs::read(out.join("case.json")).unwrap()).unwrap();
    let regions = json!({"array": "region", "names": {"0": "muscle", "1": "fat"}});
    assert_eq!(case["case"]["regions"], regions);
    assert_eq!(case["case"]["segments"][0]["name"], "jaw");
}

#[test]
fn a_frame_or_cuts_that_two_documents_state_differently_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("ct.nrrd"), ball_ct()).unwrap();
    let cut = |z: f64| {
        json!({"cuts": [{"name": "middle", "point_mm": [60, 55, z], "normal": [0, 0, 1]}],
        "segments": [{"name": "jaw", "below": ["middle"]}]})
    };
    let plan = json!({"frame": "LPS", "osteotomy": cut(60.0), "segments": [{"name": "jaw"}]});
    fs::write(file("plan.json"), plan.to_string()).unwrap();
    let (ct, plan, spec, out) =
        (file("ct.nrrd"), file("plan.json"), file("spec.json"), file("out"));
    for (member, stated) in [("frame", json!("RAS")), ("osteotomy", cut(50.0))] {
        fs::write(&spec, json!({member: stated}).to_string()).unwrap();
        let asked =
            ["mesh", "--scan", path(&ct), "--plan", path(&plan), "--mesh-spec", path(&spec)];
        let refused = facies(&[&asked[..], &["--out", path(&out)]].concat());
        let told = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{told}");
        assert!(told.contains(&format!("`{member}` of --mesh-spec differs")), "{told}");
    }
}

/// The same ball in m.
fn in_metres(ball: SampleBall) -> SampleBall {
    SampleBall { centre: ball.centre.map(|x| x * 1e-3), radius: ball.radius * 1e-3 }
}

#[test]
fn surfaces_in_metres_are_meshed_where_the_unit_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("skin.stl"), ball_stl(in_metres(SKIN_BALL))).unwrap();
    fs::write(file("bone.stl"), ball_stl(in_metres(BONE_BALL))).unwrap();
    let (skin, bone, out) = (file("skin.stl"), file("bone.stl"), file("out"));
    let asked = ["mesh", "--skin", path(&skin), "--bone", path(&bone), "--tetrahedra", "8000"];
    let asked = [&asked[..], &["--out", path(&out)]].concat();
    let refused = facies(&asked);
    assert_eq!(refused.status.code(), Some(2));
    let told = text(&refused.stderr);
    assert!(told.contains("in m it would fit") && told.contains("--allow-any-scale"), "{told}");
    let done = facies(&[&asked[..], &["--units", "m"]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let meshed = result(&out).meshing.unwrap();
    // Between balls of 50 and 30 mm.
    assert!((400.0..420.0).contains(&meshed.volume_ml), "{}", meshed.volume_ml);
    // The advice of the refusal is taken: what comes now is about the tissue and not about the scale.
    let taken = facies(&[&asked[..], &["--allow-any-scale"]].concat());
    assert!(!text(&taken.stderr).contains("units-suspect"), "{}", text(&taken.stderr));
}

#[test]
fn a_scan_whose_file_states_a_wrong_unit_is_refused_with_what_replaces_it() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, out) = (folder.path().join("ct.nrrd"), folder.path().join("out"));
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 4 4\n\
                  space directions: (50,0,0) (0,50,0) (0,0,50)\nspace units: \"m\" \"m\" \"m\"\nspace origin: (0,0,0)\n\
                  encoding: raw\n\n";
    fs::write(&scan, [header.as_bytes(), &[0; 64]].concat()).unwrap();
    let refused = facies(&["mesh", "--scan", path(&scan), "--out", path(&out)]);
    assert_eq!(refused.status.code(), Some(2));
    let told = text(&refused.stderr);
    assert!(told.contains("units-suspect") && told.contains("`space units`"), "{told}");
    assert!(!told.contains("state the unit by --units"), "{told}");
}

#[test]
fn a_scan_that_cannot_be_meshed_is_refused_with_what_its_check_found() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, out) = (folder.path().join("ct.nrrd"), folder.path().join("out"));
    // Values without an intercept: nothing is air.
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 20 20 20\n\
                  space directions: (5,0,0) (0,5,0) (0,0,5)\nspace origin: (0,0,0)\nencoding: raw\n\n";
    fs::write(&scan, [header.as_bytes(), &[100; 8000]].concat()).unwrap();
    let refused =
        facies(&["mesh", "--scan", path(&scan), "--tetrahedra", "8000", "--out", path(&out)]);
    assert_ne!(refused.status.code(), Some(0));
    let told = text(&refused.stderr);
    assert!(told.contains("could not be meshed") && told.contains("(no-hounsfield)"), "{told}");
}

#[test]
fn a_skin_and_a_bone_give_what_their_scan_gives_and_segments_need_no_cuts() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("skin.stl"), ball_stl(SKIN_BALL)).unwrap();
    fs::write(file("bone.stl"), ball_stl(BONE_BALL)).unwrap();
    fs::write(file("plan.json"), plan().to_string()).unwrap();
    let (skin, bone, plan) = (file("skin.stl"), file("bone.stl"), file("plan.json"));
    let surfaces = ["--skin", path(&skin), "--bone", path(&bone), "--tetrahedra", "20000"];
    let (out, whole) = (file("out"), file("whole"));
    let rest = ["--plan", path(&plan), "--out", path(&out)];
    let done = facies(&[&["predict"], &surfaces[..], &rest[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let moved = result(&out).statistics.unwrap().skin.nodes;
    assert!((2.0..4.0).contains(&moved.max), "{moved:?}");

    // Bone that is a segment of its own needs no cuts.
    let named = format!("skull={}", path(&bone));
    let asked = ["mesh", "--skin", path(&skin), "--bone", &named, "--tetrahedra", "20000"];
    let done = facies(&[&asked[..], &["--out", path(&whole)]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let case: Value = serde_json::from_slice(&fs::read(whole.join("case.json")).unwrap()).unwrap();
    assert_eq!(case["case"]["segments"][0]["name"], "skull");
    assert_eq!(case["case"]["bones"], json!([{"name": "skull", "mesh": "bone-1.vtp"}]));

    let alone = facies(&["mesh", "--bone", path(&bone), "--out", path(&out)]);
    assert_eq!(alone.status.code(), Some(2));
    assert!(text(&alone.stderr).contains("--skin FILE"), "{}", text(&alone.stderr));
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

#[test]
fn files_of_a_meshing_are_there_whoever_reads_the_summary() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("ct.nrrd");
    fs::write(&scan, ball_ct()).unwrap();
    let out = folder.path().join("meshed");
    // As `facies mesh … | head -0` has it.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let asked = ["mesh", "--scan", path(&scan), "--tetrahedra", "8000", "--out", path(&out)];
    let done = Command::new(env!("CARGO_BIN_EXE_facies")).args(asked).stdout(writer).output();
    assert_eq!(done.unwrap().status.code(), Some(141), "nobody reads");
    let case: Value = serde_json::from_slice(&fs::read(out.join("case.json")).unwrap()).unwrap();
    assert!(out.join(case["case"]["volume"].as_str().unwrap()).is_file(), "{case}");
}

/// Bone of the second scan is 840 HU in place of 1200: half of a voxel of it is 440 HU in place of 620.
#[test]
fn the_threshold_of_equal_bone_volume_is_that_of_the_same_share_of_bone() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let share = |depth: f64| (depth / 4.0 + 0.5).clamp(0.0, 1.0);
    let darker = ball_ct_with(|at| {
        let bone = share(30.0 - (at - Vector::new(60.0, 55.0, 60.0)).norm());
        (bone > 0.0).then_some((40.0 + 800.0 * bone) as i16)
    });
    let (before, after) = (file("before.nrrd"), file("after.nrrd"));
    fs::write(&before, ball_ct()).unwrap();
    fs::write(&after, darker).unwrap();
    let threshold = |more: &[&str]| {
        facies(&[&["threshold", path(&before), path(&after), "--bone-hu", "620"], more].concat())
    };
    let whole = "20,20,20,100,100,100";
    let done = threshold(&["--box-before", whole, "--box-after", whole]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let told = text(&done.stdout);
    let numbers = |line: &str| -> Vec<f64> {
        line.split([' ', ':']).filter_map(|word| word.parse().ok()).collect()
    };
    let lines: Vec<Vec<f64>> = told.lines().take(2).map(numbers).collect();
    assert!((lines[1][0] - 440.0).abs() < 20.0, "{told}");
    assert_eq!(lines[0][1], lines[1][1], "{told}");
    assert!((lines[0][1] - 113.1).abs() < 1.0, "a ball of 30 mm: {told}");
    for (box_after, problem) in [
        ("900,900,900,910,910,910", "no voxel"),
        ("58,58,58,62,62,62", "no threshold"),
        ("1,2,3", "six numbers"),
    ] {
        let refused = threshold(&["--box-before", whole, "--box-after", box_after]);
        assert_eq!(refused.status.code(), Some(2), "{box_after}");
        assert!(text(&refused.stderr).contains(problem), "{}", text(&refused.stderr));
    }
}
