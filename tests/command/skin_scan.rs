//! A camera's surface scan as skin over a CT, and surfaces made simpler, from the command line.

use std::fs;

use serde_json::{Value, json};

use crate::program::{facies, path, result, text};
use crate::samples::{BONE_BALL, SKIN_BALL, SampleBall, ball_ct, ball_ct_with, ball_stl};

/// The half of a ball that looks forward, moved: a camera sees no more, and stands elsewhere.
fn scan(ball: SampleBall, moved: [f64; 3]) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| ball.centre[axis] + moved[axis]);
    let whole = ball_stl(SampleBall { centre: [x, y, z], radius: ball.radius });
    let whole = String::from_utf8(whole).unwrap();
    let looks_forward = |facet: &&str| {
        let mut corners = facet.lines().filter_map(|line| line.strip_prefix("vertex "));
        corners.all(|at| at.split(' ').nth(1).unwrap().parse::<f64>().unwrap() < y + 1e-6)
    };
    let facets = whole.split_inclusive("endfacet\n").filter(|part| part.contains("vertex"));
    let facets: String = facets.filter(looks_forward).collect();
    format!("solid face\n{}endsolid face\n", facets.replace("solid ball\n", ""))
}

fn thresholds() -> Value {
    json!({"skin": -480, "bone": 620})
}

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
fn a_scan_and_a_plan_and_a_face_give_a_predicted_skin_in_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("ct.nrrd"), ball_ct()).unwrap();
    fs::write(file("face.stl"), scan(SKIN_BALL, [4.0, -3.0, 5.0])).unwrap();
    fs::write(file("plan.json"), plan().to_string()).unwrap();
    let spec = json!({"thresholds_hu": thresholds(), "size": {"tetrahedra": 20_000}});
    fs::write(file("spec.json"), spec.to_string()).unwrap();
    let (ct, face, plan) = (file("ct.nrrd"), file("face.stl"), file("plan.json"));
    let (spec, out) = (file("spec.json"), file("out"));
    let asked = ["--scan", path(&ct), "--skin-scan", path(&face), "--mesh-spec", path(&spec)];
    let rest = ["--plan", path(&plan), "--out", path(&out)];
    let done = facies(&[&["predict"], &asked[..], &rest[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let told = text(&done.stdout);
    assert!(told.contains("skin scan  "), "{told}");
    let made = result(&out.join("mesh")).meshing.unwrap();
    let fitted = made.skin_scan.unwrap();
    // Back to where it was taken from; a ball may turn as it likes.
    let matrix = fitted.matrix4x4.0;
    let centre = [64.0, 57.0, 65.0];
    for axis in 0..3 {
        let row = &matrix[4 * axis..4 * axis + 4];
        let at: f64 = (0..3).map(|n| row[n] * centre[n]).sum::<f64>() + row[3];
        assert!((at - 60.0).abs() < 0.4, "axis {axis}: {at}");
    }
    assert!(fitted.mean_mm < 0.4 && fitted.share_above_3_mm == 0.0, "{fitted:?}");
    assert!((made.volume_ml / 410.5 - 1.0).abs() < 0.02, "{}", made.volume_ml);
    assert!(out.join("mesh/skin-scan.vtp").is_file() && out.join("skin.vtp").is_file());
    let roles: Vec<String> =
        result(&out.join("mesh")).provenance.inputs.into_iter().map(|input| input.role).collect();
    assert_eq!(roles, ["scan", "skin scan"]);

    // Inside out it is turned, and told.
    let face_text = fs::read_to_string(file("face.stl")).unwrap();
    let lines: Vec<&str> = face_text.lines().collect();
    let is_last = |at: usize| lines.get(at + 1).is_some_and(|next| next.contains("endloop"));
    let is_second = |at: usize| lines.get(at + 2).is_some_and(|next| next.contains("endloop"));
    let turned = (0..lines.len()).map(|at| match at {
        at if is_last(at) => lines[at - 1],
        at if is_second(at) => lines[at + 1],
        at => lines[at],
    });
    fs::write(file("face.stl"), turned.collect::<Vec<_>>().join("\n")).unwrap();
    let done = facies(&[&["mesh"], &asked[..], &rest[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let again = result(&out);
    let volumes = [again.meshing.unwrap().volume_ml, made.volume_ml];
    assert!((volumes[0] / volumes[1] - 1.0).abs() < 1e-3, "{volumes:?}");
    assert!(again.warnings.iter().any(|warning| warning.code == "surface-turned"));
}

#[test]
fn a_jaw_is_closed_before_the_tissue_on_it_is_meshed() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    // Between the halves of the bone there is tissue 8 mm high, which the lower half is moved up by.
    let open = |at: mechanics::mesh::Vector| {
        let is_gap = (60.0..68.0).contains(&at.z);
        let is_bone = (at - mechanics::mesh::Vector::new(60.0, 55.0, 60.0)).norm() < 36.0;
        (is_gap && is_bone).then_some(40)
    };
    fs::write(file("ct.nrrd"), ball_ct_with(open)).unwrap();
    fs::write(file("face.stl"), scan(SKIN_BALL, [0.0; 3])).unwrap();
    fs::write(file("plan.json"), plan().to_string()).unwrap();
    let close = json!({"segment": "jaw", "movement": {"translation_mm": [0, 0, 6]}});
    let spec = |jaw: Value| {
        json!({"thresholds_hu": thresholds(), "size": {"tetrahedra": 20_000},
            "skin_scan": {"mesh": "", "jaw": jaw}})
    };
    let (ct, face, plan) = (file("ct.nrrd"), file("face.stl"), file("plan.json"));
    let meshed = |spec: Value, out: &str| {
        fs::write(file("spec.json"), spec.to_string()).unwrap();
        let (spec, out) = (file("spec.json"), file(out));
        let asked = ["mesh", "--scan", path(&ct), "--skin-scan", path(&face)];
        let rest = ["--mesh-spec", path(&spec), "--plan", path(&plan), "--out", path(&out)];
        let done = facies(&[&asked[..], &rest[..]].concat());
        (done, out)
    };
    let mut without = spec(close.clone());
    without["skin_scan"].as_object_mut().unwrap().remove("jaw");
    let (done, open) = meshed(without, "open");
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let (done, closed) = meshed(spec(close.clone()), "closed");
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let [open, closed] = [open, closed].map(|out| result(&out).meshing.unwrap());
    let up = closed.segments[0].centre_mm.0[2] - open.segments[0].centre_mm.0[2];
    assert!((up - 6.0).abs() < 1.0, "{up}");
    // As much bone as before, so as much tissue.
    assert!(
        (closed.volume_ml / open.volume_ml - 1.0).abs() < 0.02,
        "{} {}",
        closed.volume_ml,
        open.volume_ml
    );
    assert_eq!(closed.cuts, open.cuts, "cuts are where the scan has them");

    // Turned about the axis of its ball a jaw lies where it did, and all of the tissue on it goes with it.
    let turn = json!({"segment": "jaw", "movement": {"rotation_deg": [0, 0, 5], "pivot_mm": [60, 55, 60]}});
    let (done, turned) = meshed(spec(turn), "turned");
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let turned = result(&turned).meshing.unwrap();
    let on_jaw = [&open, &turned].map(|found| found.node_sets["jaw"] as f64);
    assert!((on_jaw[1] / on_jaw[0] - 1.0).abs() < 0.1, "{on_jaw:?}");

    let mut unknown = spec(close);
    unknown["skin_scan"]["jaw"]["segment"] = json!("chin");
    let (refused, out) = meshed(unknown, "unknown");
    let told = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{told}");
    assert!(
        told.contains("/spec/skin_scan/jaw/segment") && told.contains("unknown-segment"),
        "{told}"
    );
    assert!(!out.exists());
}

#[test]
fn a_face_that_is_not_that_of_the_scan_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("ct.nrrd"), ball_ct()).unwrap();
    fs::write(file("face.stl"), scan(SKIN_BALL, [0.0; 3])).unwrap();
    let other = SampleBall { radius: 30.0, ..SKIN_BALL };
    fs::write(file("other.stl"), scan(other, [0.0; 3])).unwrap();
    let small = SampleBall { radius: 12.0, ..SKIN_BALL };
    fs::write(file("small.stl"), scan(small, [0.0; 3])).unwrap();
    let metres =
        SampleBall { centre: SKIN_BALL.centre.map(|x| x * 1e-3), radius: SKIN_BALL.radius * 1e-3 };
    fs::write(file("metres.stl"), scan(metres, [0.0; 3])).unwrap();
    let (ct, out) = (file("ct.nrrd"), file("out"));
    for (name, code) in [
        ("other.stl", "skin-scan-misfit"),
        ("small.stl", "skin-scan-small"),
        ("metres.stl", "units-suspect"),
        ("ct.nrrd", "wrong-mesh"),
        ("nosuch.stl", "unknown-mesh"),
    ] {
        let face = file(name);
        let asked = ["mesh", "--scan", path(&ct), "--skin-scan", path(&face), "--out", path(&out)];
        let refused = facies(&asked);
        let told = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{name}: {told}");
        assert!(told.contains("/spec/skin_scan/mesh") && told.contains(code), "{name}: {told}");
    }
    let face = file("metres.stl");
    let asked = ["mesh", "--scan", path(&ct), "--skin-scan", path(&face), "--units", "m"];
    let done = facies(&[&asked[..], &["--tetrahedra", "5000", "--out", path(&out)]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));

    // Without a scan it has no meaning, and with one of a document alone no file.
    let refused = facies(&["mesh", "--skin-scan", path(&face), "--out", path(&out)]);
    assert_eq!(refused.status.code(), Some(2));
    let few = json!({"skin_scan": {"landmarks": {
        "nose": {"scan_mm": [0, 0, 0], "ct_mm": [1, 1, 1]}}}});
    fs::write(file("spec.json"), few.to_string()).unwrap();
    let (face, spec) = (file("face.stl"), file("spec.json"));
    let asked = ["mesh", "--scan", path(&ct), "--mesh-spec", path(&spec), "--out", path(&out)];
    let refused = facies(&asked);
    assert!(text(&refused.stderr).contains("--skin-scan"), "{}", text(&refused.stderr));
    let refused = facies(&[&asked[..], &["--skin-scan", path(&face)]].concat());
    let told = text(&refused.stderr);
    assert!(told.contains("/spec/skin_scan/landmarks") && told.contains("at least 3"), "{told}");
    let beside = json!({"skin_scan": {"mask": {"sphere_mm": [900, 0, 0, 10]}}});
    fs::write(&spec, beside.to_string()).unwrap();
    let refused = facies(&[&asked[..], &["--skin-scan", path(&face)]].concat());
    let told = text(&refused.stderr);
    assert!(told.contains("/spec/skin_scan/mask: the mask holds no skin of the CT"), "{told}");
}

#[test]
fn a_surface_is_made_simpler_within_a_bound_and_tells_how_far_it_went() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    fs::write(file("skin.stl"), ball_stl(SKIN_BALL)).unwrap();
    fs::write(file("bone.stl"), ball_stl(BONE_BALL)).unwrap();
    let (skin, bone) = (file("skin.stl"), file("bone.stl"));
    let (out, report) = (file("simple.stl"), file("report.json"));
    let asked = ["simplify", path(&skin), "--out", path(&out), "--report", path(&report)];
    let bound = ["--max-deviation-mm", "0.5", "--thickness-to", path(&bone)];
    let done = facies(&[&asked[..], &bound[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let told: Value = serde_json::from_slice(&fs::read(&report).unwrap()).unwrap();
    let number = |place: &str| told.pointer(place).unwrap().as_f64().unwrap();
    assert_eq!(number("/given/triangles"), 3120.0);
    assert!(number("/simplified/triangles") < 1600.0, "{told}");
    assert_eq!(number("/simplified/open_edges"), 0.0);
    assert!(number("/both_mm/max") < 0.575, "{told}");
    let shares = told["histogram"]["shares"].as_array().unwrap().iter();
    let sum: f64 = shares.map(|share| share.as_f64().unwrap()).sum();
    assert!((sum + number("/histogram/above") - 1.0).abs() < 1e-9);
    // What was written is what was told.
    let again = facies(&["simplify", path(&out), "--out", path(&file("again.vtp"))]);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    assert!(text(&again.stdout).contains(&format!("of {} in", number("/simplified/triangles"))));

    for (wrong, word) in [
        (["--max-deviation-mm", "0"], "more than 0"),
        (["--out", "simple.xyz"], "neither in .stl"),
        (["--longest-edge-mm", "-1"], "--longest-edge-mm is -1"),
    ] {
        let out = file("wrong.stl");
        let plain = ["simplify", path(&skin), "--out", path(&out)];
        let asked =
            if wrong[0] == "--out" { vec!["simplify", path(&skin)] } else { plain.to_vec() };
        let wrong_one = format!("{}={}", wrong[0], wrong[1]);
        let asked = [&asked[..], &[&wrong_one]].concat();
        let refused = facies(&asked);
        let told = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{wrong:?}: {told}");
        assert!(told.contains(word), "{told}");
        assert!(!out.exists());
    }
}
