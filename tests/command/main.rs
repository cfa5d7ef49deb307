//! The program as people call it: exit codes, files, numbers.

#![allow(clippy::unwrap_used)]

mod administration;
mod folders;
mod generic_face;
mod head;
mod newcomers;
#[path = "../support/program.rs"]
mod program;
#[allow(dead_code, reason = "the tests of the formats use the rest")]
#[path = "../../mechanics/tests/support/samples.rs"]
mod samples;
mod scan;
mod skin_scan;
mod study;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;

use facies::schema::predict::check::CheckDocument;
use facies::schema::predict::result::FileDocument;
use facies::schema::wire::canonical::sha256_hex;
use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Frame, Vector, sample};
use program::{block, facies, path, plan_folder, result, text};

const FORWARD: &str = r#"{"segments":[{"name":"mandible","translation_mm":[4,0,0]}]}"#;

fn predict_block(folder: &Path, out: &Path) -> Output {
    facies(&[
        "predict",
        "--mesh",
        path(&block().join("block.vtu")),
        "--plan",
        path(&folder.join("plan.json")),
        "--fixed",
        "skull",
        "--skin",
        "skin",
        "--young-modulus-kpa",
        "15",
        "--poisson-ratio",
        "0.45",
        "--out",
        path(out),
    ])
}

#[test]
fn the_example_runs_and_its_files_are_those_of_its_manifest() {
    let out = tempfile::tempdir().unwrap();
    let case = block().join("case.json");
    let done = facies(&["predict", "--case", path(&case), "--out", path(out.path())]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let result = result(out.path());
    for file in &result.files {
        let bytes = fs::read(out.path().join(&file.name)).unwrap();
        assert_eq!((bytes.len() as u64, sha256_hex(&bytes)), (file.bytes, file.sha256.clone()));
    }
    let names: BTreeSet<&str> = result.files.iter().map(|file| file.name.as_str()).collect();
    let wanted = [
        "bones.vtp",
        "classes.svg",
        "displacement.svg",
        "skin.csv",
        "skin.glb",
        "skin.vtp",
        "volume.vtu",
    ];
    assert_eq!(names, wanted.into());
    // No node of the plate goes farther than the turn at 40 mm from the pivot, 3.5 mm, and the
    // translation, 4.2 mm, together.
    let moved = &result.statistics.unwrap().skin.nodes;
    assert!(moved.max > 1.0 && moved.max < 7.7, "{}", moved.max);
}

#[test]
fn load_steps_are_asked_for_by_an_argument_and_printed_one_by_one() {
    let out = tempfile::tempdir().unwrap();
    let case = block().join("case.json");
    let asked = ["predict", "--case", path(&case), "--load-steps", "4", "--out", path(out.path())];
    let done = facies(&[&asked[..], &["--method", "fem_nonlinear"]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let shown = text(&done.stdout);
    for printed in [
        "load steps    share steps",
        "              0.250 ",
        "              0.750 ",
        "              1.000 ",
    ] {
        assert!(shown.contains(printed), "{printed:?} is not in {shown}");
    }
    assert_eq!(result(out.path()).load_steps.len(), 4);
    let other = facies(&[&asked[..], &["--method", "fem_linear"]].concat());
    assert!(text(&other.stderr).contains("method-mismatch"), "{}", text(&other.stderr));
}

#[test]
fn stress_and_a_material_of_the_literature_are_asked_for_by_arguments() {
    let listed = facies(&["materials"]);
    assert_eq!(listed.status.code(), Some(0), "{}", text(&listed.stderr));
    assert!(text(&listed.stdout).contains("Kim, Jürgens, Reyes 2012, table 2"));
    let json: serde_json::Value =
        serde_json::from_slice(&facies(&["materials", "--json"]).stdout).unwrap();
    assert_eq!(json["presets"].as_array().unwrap().len(), 11);
    let (folder, out) = (plan_folder(FORWARD), tempfile::tempdir().unwrap());
    let (mesh, plan) = (block().join("block.vtu"), folder.path().join("plan.json"));
    let asked = ["predict", "--mesh", path(&mesh), "--plan", path(&plan), "--fixed", "skull"];
    let rest =
        ["--skin", "skin", "--stress", "--preset", "muscle_zachow_2006", "--out", path(out.path())];
    let done = facies(&asked.into_iter().chain(rest).collect::<Vec<_>>());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let shown = text(&done.stdout);
    assert!(shown.contains("stress       tissue: Mises"), "{shown}");
    let result = result(out.path());
    let used = &result.provenance.presets["*"];
    assert_eq!((used.material.young_modulus_kpa, used.source.year), (Some(300.0), 2006));
    assert!(result.warnings.iter().any(|warning| warning.code == "preset-doubt"));
    assert!(result.files.iter().any(|file| file.name == "volume.vtu"));
    let wrong = facies(&["predict", "--preset", "muscle", "--out", "x"]);
    assert!(text(&wrong.stderr).contains("there are tissue_chabanas_2003"));
}

#[test]
fn what_is_held_is_reported_before_anything_is_solved() {
    let case = block().join("case.json");
    let out = tempfile::tempdir().unwrap();
    let done = facies(&["check", "--case", path(&case), "--out", path(out.path())]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    // Three of five columns of nodes and one of five rows of five lie over the plates.
    let shown = text(&done.stdout);
    assert!(shown.contains("joined     15 nodes to mandible"), "{shown}");
    assert!(shown.contains("fixed      10 nodes"), "{shown}");
    let check: CheckDocument =
        serde_json::from_slice(&fs::read(out.path().join("check.json")).unwrap()).unwrap();
    assert_eq!((check.classes.free, check.unknowns), (50, 150));
    assert_eq!((check.skin.nodes, check.skin.area_mm2), (25, 4800.0));
    assert!(fs::read_to_string(out.path().join("classes.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn a_segment_on_the_set_of_another_bone_is_reported_by_the_check() {
    let folder = tempfile::tempdir().unwrap();
    let read = fs::read_to_string(block().join("case.json")).unwrap();
    let mut documents: serde_json::Value = serde_json::from_str(&read).unwrap();
    for name in ["block.vtu", "mandible.stl"] {
        fs::copy(block().join(name), folder.path().join(name)).unwrap();
    }
    let case = folder.path().join("case.json");
    let shown = |documents: &serde_json::Value| {
        fs::write(&case, documents.to_string()).unwrap();
        let done = facies(&["check", "--case", path(&case)]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        text(&done.stdout) + &text(&done.stderr)
    };
    assert!(!shown(&documents).contains("from the bone of its name"));
    documents["case"]["segments"][0]["nodes"]["node_set"] = "skull".into();
    documents["case"]["fixed"][0]["node_set"] = "mandible".into();
    let told = shown(&documents);
    assert!(told.contains(r#"the nodes of segment "mandible" lie"#), "{told}");
}

#[test]
fn a_command_that_has_no_store_refuses_to_keep_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let read = fs::read_to_string(block().join("case.json")).unwrap();
    let mut documents: serde_json::Value = serde_json::from_str(&read).unwrap();
    documents["spec"]["keep"] = serde_json::json!(["skin"]);
    let (case, out) = (folder.path().join("case.json"), folder.path().join("out"));
    fs::write(&case, documents.to_string()).unwrap();
    let done = facies(&["predict", "--case", path(&case), "--out", path(&out)]);
    assert_eq!(done.status.code(), Some(2));
    assert!(text(&done.stderr).contains("`keep` asks to store meshes"), "{}", text(&done.stderr));
    assert!(!out.exists(), "nothing is written");
}

#[test]
fn a_mesh_with_a_plan_and_the_documents_written_from_them_give_the_same_bits() {
    let folder = plan_folder(FORWARD);
    let (first, second) = (folder.path().join("first"), folder.path().join("second"));
    let done = predict_block(folder.path(), &first);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let documents = first.join("case.json");
    let done = facies(&["predict", "--case", path(&documents), "--out", path(&second)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let (a, b) = (result(&first), result(&second));
    assert_eq!(a.provenance.spec_hash, b.provenance.spec_hash);
    // Reports bear their date.
    let same = |files: &[FileDocument]| -> Vec<FileDocument> {
        files.iter().filter(|file| !file.name.starts_with("report.")).cloned().collect()
    };
    assert_eq!((same(&a.files), a.files.len()), (same(&b.files), b.files.len()));
    assert_eq!(a.statistics, b.statistics);
    assert!(second.join("case.json").exists());
}

#[test]
fn wrong_use_ends_with_code_2() {
    for arguments in [
        &["predict"][..],
        &["predict", "--case", "a", "--mesh", "b", "--out", "c"],
        &["compare", "--prediction", "a"],
        &["dance"],
        &[],
    ] {
        assert_eq!(facies(arguments).status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn every_mistake_in_the_documents_has_a_line_with_its_place() {
    let plan = r#"{"segments":[{"name":"mandible","translation_mm":[500,0,0]},{"name":"jaw","rotation_deg":[0,5,0]}]}"#;
    let folder = plan_folder(plan);
    let done = predict_block(folder.path(), &folder.path().join("out"));
    assert_eq!(done.status.code(), Some(2));
    let lines = text(&done.stderr);
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[0].starts_with("error: /plan/segments/0/translation_mm: moves by 500 mm"));
    assert!(lines[1].starts_with("error: /plan/segments/1/pivot_mm: "));
    assert!(!folder.path().join("out").exists(), "nothing is written for a refused job");
}

#[test]
fn a_number_out_of_range_hides_no_name_that_the_mesh_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let read = fs::read_to_string(block().join("case.json")).unwrap();
    let mut documents: serde_json::Value = serde_json::from_str(&read).unwrap();
    let lacks = serde_json::json!({"node_set": "nowhere"});
    documents["case"]["volume"] = path(&block().join("block.vtu")).into();
    documents["case"]["bones"] = serde_json::json!([]);
    documents["case"]["materials"]["deep"]["young_modulus_kpa"] = (-1).into();
    documents["case"]["fixed"] = serde_json::json!([{"node_set": "skull"}, lacks]);
    let load = serde_json::json!({"force_millinewton": [0, 0, 1], "nodes": lacks});
    documents["plan"]["loads"] = serde_json::json!([load]);
    documents["plan"]["growth"] = serde_json::json!([{"region": "none", "volume_change": 0.1}]);
    let case = folder.path().join("case.json");
    fs::write(&case, documents.to_string()).unwrap();
    let done = facies(&["check", "--case", path(&case)]);
    let told = text(&done.stderr);
    let places: BTreeSet<&str> = told.lines().filter_map(|line| line.split(": ").nth(1)).collect();
    let wanted = [
        "/case/fixed/1",
        "/case/materials/deep/young_modulus_kpa",
        "/plan/growth/0/region",
        "/plan/loads/0/nodes",
    ];
    assert_eq!((done.status.code(), places), (Some(2), wanted.into()), "{told}");
}

#[test]
fn a_segment_that_is_nowhere_and_a_mesh_that_is_not_there_are_refused() {
    let folder = plan_folder(r#"{"segments":[{"name":"jaw","translation_mm":[1,0,0]}]}"#);
    let done = predict_block(folder.path(), &folder.path().join("out"));
    assert_eq!(done.status.code(), Some(2));
    let line = text(&done.stderr);
    assert!(line.contains("/plan/segments/0/name") && line.contains("unknown-segment"), "{line}");
    let done = facies(&["check", "--mesh", "nowhere.vtu"]);
    assert_eq!(done.status.code(), Some(2));
    assert!(text(&done.stderr).contains("/case/volume: there is no mesh"));
}

#[test]
fn a_plan_that_is_not_json_is_refused_with_line_and_column() {
    let folder = plan_folder("{\"segments\": [\n  {\"name\": jaw}]}");
    let done = predict_block(folder.path(), &folder.path().join("out"));
    assert_eq!(done.status.code(), Some(2));
    let line = text(&done.stderr);
    assert!(line.contains("line 2 column 12") && line.contains("malformed-json"), "{line}");
}

#[test]
fn a_folder_that_cannot_be_made_ends_with_code_3() {
    let folder = plan_folder(FORWARD);
    let done = predict_block(folder.path(), &folder.path().join("plan.json/out"));
    assert_eq!(done.status.code(), Some(3), "{}", text(&done.stderr));
}

#[test]
fn a_job_that_needs_more_memory_than_it_may_take_fails_with_code_1() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = sample::block(Vector::repeat(100.0), [12, 12, 12], CellShape::Hex8);
    let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap();
    fs::write(folder.path().join("block.vtu"), bytes).unwrap();
    let set = mesh.node_sets.keys().next().unwrap();
    let file = format!(
        r#"{{"case":{{"units":"mm","volume":"block.vtu","fixed":[{{"node_set":"{set}"}}]}},
           "plan":{{"loads":[{{"gravity_m_per_s2":[0,0,-9.81]}}]}},"spec":{{"budget":{{"memory_mb":1}}}}}}"#
    );
    fs::write(folder.path().join("case.json"), file).unwrap();
    let case = folder.path().join("case.json");
    let out = folder.path().join("out");
    let done = facies(&["predict", "--case", path(&case), "--out", path(&out)]);
    assert_eq!(done.status.code(), Some(1), "{}", text(&done.stderr));
    assert!(text(&done.stderr).contains("budget-exceeded"), "{}", text(&done.stderr));
}

#[test]
fn a_mesh_that_no_head_measures_is_refused_in_every_command_unless_any_scale_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = sample::block(Vector::repeat(166_000.0), [2, 2, 2], CellShape::Hex8);
    let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap();
    let file = folder.path().join("face.vtu");
    fs::write(&file, bytes).unwrap();
    let case = r#"{"case":{"units":"mm","volume":"face.vtu","fixed":[{"node_set":"z_min"}]},
        "plan":{"segments":[{"name":"z_max","translation_mm":[1,0,0]}]}}"#;
    let documents = folder.path().join("case.json");
    fs::write(&documents, case).unwrap();
    let (mesh, out) = (path(&file), folder.path().join("out"));
    let out = path(&out);
    for command in [
        &["check", "--mesh", mesh, "--fixed", "z_min"][..],
        &["predict", "--case", path(&documents), "--out", out],
        &["compare", "--prediction", mesh, "--actual", mesh, "--out", out],
        &[
            "study",
            "--case",
            path(&documents),
            "--method",
            "fem_linear",
            "--level",
            "0",
            "--out",
            out,
        ],
    ] {
        let done = facies(command);
        assert_eq!(done.status.code(), Some(2), "{command:?}: {}", text(&done.stderr));
        let line = text(&done.stderr);
        assert!(line.contains("units-suspect") && line.contains("287520"), "{command:?}: {line}");
        assert!(line.contains("in um it would fit"), "{line}");
    }
    let done = facies(&["check", "--mesh", mesh, "--fixed", "z_min", "--allow-any-scale"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(!text(&done.stdout).contains("units-suspect"), "{}", text(&done.stdout));
    let done = facies(&["check", "--mesh", mesh, "--fixed", "z_min", "--units", "um"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
}

#[test]
fn a_folder_in_the_place_of_a_mesh_is_refused_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, out) = (path(folder.path()), folder.path().join("out"));
    let done = facies(&["compare", "--prediction", mesh, "--actual", mesh, "--out", path(&out)]);
    let told = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{told}");
    assert!(told.contains(&format!("{mesh} is a folder")), "{told}");
}

#[test]
fn a_surface_has_no_distance_from_itself() {
    let folder = plan_folder(FORWARD);
    let out = folder.path().join("out");
    assert_eq!(predict_block(folder.path(), &out).status.code(), Some(0));
    let skin = out.join("skin.vtp");
    let compared = folder.path().join("compared");
    let done = facies(&[
        "compare",
        "--prediction",
        path(&skin),
        "--actual",
        path(&skin),
        "--out",
        path(&compared),
    ]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let comparison = result(&compared).comparison.unwrap();
    // Rounding of a projection onto a triangle of 80 mm.
    assert!(comparison.both.max < 1e-12 && comparison.both.share_below_1_mm == 1.0);
    assert_eq!(comparison.node_wise.unwrap().nodes.max, 0.0);
}

#[test]
fn a_result_takes_no_place_of_what_it_is_made_of() {
    let folder = plan_folder(FORWARD);
    let out = folder.path().join("out");
    assert_eq!(predict_block(folder.path(), &out).status.code(), Some(0));
    let skin = out.join("skin.vtp");
    let before = fs::read(&skin).unwrap();
    let asked =
        ["compare", "--prediction", path(&skin), "--actual", path(&skin), "--out", path(&out)];
    let done = facies(&asked);
    let told = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{told}");
    assert!(told.contains("skin.vtp") && told.contains("give another folder"), "{told}");
    assert!(out.join("result.json").is_file());
    assert_eq!(fs::read(&skin).unwrap(), before);
}

#[test]
fn movements_of_an_earlier_check_do_not_stay() {
    let folder = plan_folder(FORWARD);
    let out = folder.path().join("check");
    let head = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/head");
    for file in ["case.json", "face.vtu", "mandible.vtp", "maxilla.vtp"] {
        fs::copy(head.join(file), folder.path().join(file)).unwrap();
    }
    let case = folder.path().join("case.json");
    let read = fs::read_to_string(&case).unwrap();
    let mut documents: serde_json::Value = serde_json::from_str(&read).unwrap();
    let mut check = |plan: serde_json::Value| {
        documents["plan"] = plan;
        fs::write(&case, documents.to_string()).unwrap();
        let done = facies(&["check", "--case", path(&case), "--out", path(&out)]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        ["mandible.txt", "mandible.tfm", "maxilla.txt", "maxilla.tfm"]
            .map(|file| out.join(file).exists())
    };
    let moved = |name: &str| serde_json::json!({"name": name, "translation_mm": [0, -2, 0]});
    assert_eq!(
        check(serde_json::json!({"segments": [moved("mandible"), moved("maxilla")]})),
        [true; 4]
    );
    assert_eq!(
        check(serde_json::json!({"segments": [moved("mandible")]})),
        [true, true, false, false]
    );
}

#[test]
fn alignment_takes_back_a_rigid_movement() {
    let folder = tempfile::tempdir().unwrap();
    let lifted = fs::read_to_string(block().join("mandible.stl")).unwrap().replace(" 0\n", " 2\n");
    fs::write(folder.path().join("lifted.stl"), lifted).unwrap();
    let (plate, lifted) = (block().join("mandible.stl"), folder.path().join("lifted.stl"));
    let compare = |align: &str| {
        let out = folder.path().join(align);
        let files = ["--prediction", path(&plate), "--actual", path(&lifted)];
        let done =
            facies(&[&["compare", "--align", align, "--out", path(&out)][..], &files[..]].concat());
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        result(&out).comparison.unwrap()
    };
    assert!((compare("none").both.mean - 2.0).abs() < 1e-12, "the plates are 2 mm apart");
    let aligned = compare("icp");
    assert!(aligned.both.max < 1e-6, "{}", aligned.both.max);
    assert!((aligned.unaligned.unwrap().both.mean - 2.0).abs() < 1e-12);
    // A file says what arguments do not, with paths from its own folder.
    let spec = r#"{"kind":"compare","prediction":{"mesh":"lifted.stl"},"actual":{"mesh":"lifted.stl"},
        "align":{"method":"matrix","matrix4x4":[1,0,0,0,0,1,0,0,0,0,1,-2,0,0,0,1]},"histogram_edges_mm":[0,1]}"#;
    let (file, out) = (folder.path().join("spec.json"), folder.path().join("by file"));
    fs::write(&file, spec).unwrap();
    let done = facies(&[
        "compare",
        "--spec",
        path(&file),
        "--prediction",
        path(&plate),
        "--out",
        path(&out),
    ]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let by_file = result(&out).comparison.unwrap();
    assert!(by_file.both.max < 1e-12 && by_file.histogram.unwrap().unsigned.shares == [1.0]);
}

/// A block of 40 x 20 x 10 mm with its documents.
fn documents(change: impl Fn(&mut serde_json::Value)) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mesh = sample::block(Vector::new(40.0, 20.0, 10.0), [4, 2, 2], CellShape::Tet4);
    let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap();
    fs::write(folder.path().join("block.vtu"), bytes).unwrap();
    let mut file = serde_json::json!({
        "case": {"units": "mm", "volume": "block.vtu",
            "segments": [{"name": "jaw", "nodes": {"node_set": "x_min"}}],
            "fixed": [{"node_set": "x_max"}]},
        "plan": {"segments": [{"name": "jaw", "translation_mm": [-5, 0, 0]}]},
    });
    change(&mut file);
    fs::write(folder.path().join("case.json"), file.to_string()).unwrap();
    folder
}

fn predicted(folder: &Path) -> Output {
    let (case, out) = (folder.join("case.json"), folder.join("out"));
    facies(&["predict", "--case", path(&case), "--out", path(&out)])
}

type Change<'a> = &'a dyn Fn(&mut serde_json::Value);

#[test]
fn a_face_that_nothing_holds_a_case_without_a_plan_and_constants_of_no_unit_end_with_code_2() {
    let cases: [(Change, &str); 3] = [
        (&|file| file["case"]["fixed"] = serde_json::json!([]), "(nothing-held)"),
        (&|file| _ = file.as_object_mut().unwrap().remove("plan"), "there is no plan"),
        (
            &|file| {
                let stiffness = serde_json::json!({"young_modulus_kpa": 1e-170});
                file["spec"] = serde_json::json!({"materials": {"*": stiffness}});
            },
            "at least 1e-9 and at most 1e9 kPa",
        ),
    ];
    for (change, words) in cases {
        let folder = documents(change);
        let done = predicted(folder.path());
        assert_eq!(done.status.code(), Some(2), "{}", text(&done.stderr));
        assert!(text(&done.stderr).contains(words), "{}", text(&done.stderr));
    }
    let folder = documents(|file| file["case"]["allow_unfixed"] = serde_json::json!(true));
    assert_eq!(predicted(folder.path()).status.code(), Some(0));
}

#[test]
fn what_looks_like_a_mistake_is_reported_by_check_and_by_predict() {
    let folder = documents(|file| {
        file["plan"]["segments"][0]["translation_mm"] = serde_json::json!([-0.005, 0, 0]);
        file["case"]["sliding"] = serde_json::json!([{"nodes": {"node_set": "y_min"}}]);
        file["case"]["segments"][0]["nodes"] = serde_json::json!({"node_set": "z_min"});
        file["spec"] = serde_json::json!({"materials": {"*": {"young_modulus_kpa": 0.015}}});
    });
    let case = folder.path().join("case.json");
    let checked = facies(&["check", "--case", path(&case)]);
    for done in [&checked, &predicted(folder.path())] {
        let shown = text(&done.stdout);
        for code in ["(plan-units-suspect)", "(constant-suspect)"] {
            assert!(shown.contains(code), "{shown}");
        }
        // The jaw goes along this wall.
        assert!(!shown.contains("(sliding-beside-segment)"), "{shown}");
    }
}
