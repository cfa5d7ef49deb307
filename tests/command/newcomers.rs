//! Commands beside `predict`: responses, inverse plans, sweeps, selections by arrays, progress, help.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use facies::schema::plan::document::PlanDocument;
use facies::schema::study::report::ReportDocument;
use mechanics::format::VolumeOutput;
use mechanics::format::vtk::vtu;
use mechanics::mesh::{CellShape, Frame, Vector, sample};
use serde_json::{Value, json};

use crate::program::{block, facies, path, result, text};

#[test]
fn a_response_is_built_without_a_server() {
    let out = tempfile::tempdir().unwrap();
    let case = block().join("case.json");
    let done = facies(&["response", "--case", path(&case), "--output", path(out.path())]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let read = fs::read(out.path().join("response.json")).unwrap();
    let description: Value = serde_json::from_slice(&read).unwrap();
    assert_eq!(description["segments"][0]["name"], "mandible");
    // 12 columns of 25 nodes of the skin.
    assert_eq!(fs::metadata(out.path().join("response.f32")).unwrap().len(), 12 * 25 * 3 * 4);
    let twice = ["response", "--case", path(&case), "--order", "2", "--out", path(out.path())];
    assert_eq!(facies(&twice).status.code(), Some(0));
    // The 78 pairs of 12 numbers.
    let second = fs::metadata(out.path().join("response_second_order.i16")).unwrap();
    assert_eq!(second.len(), 78 * 25 * 3 * 2);
    let none = ["response", "--case", path(&case), "--only", "nose", "--out", path(out.path())];
    let refused = facies(&none);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("/spec/segments/0"), "{}", text(&refused.stderr));
}

#[test]
fn a_file_larger_than_the_limit_on_files_is_an_error_that_names_it() {
    let out = tempfile::tempdir().unwrap();
    let case = block().join("case.json");
    let program = env!("CARGO_BIN_EXE_facies");
    let arguments = ["--fsize=2000", program, "predict", "--case", path(&case), "--out"];
    let mut limited = std::process::Command::new("prlimit");
    let done = limited.args(arguments).arg(out.path()).output().unwrap();
    // SIGXFSZ would have left no code.
    assert_eq!(done.status.code(), Some(3), "{:?} {}", done.status, text(&done.stderr));
    let errors = text(&done.stderr);
    let errors: Vec<&str> = errors.lines().filter(|line| line.starts_with("error: ")).collect();
    let [error] = &errors[..] else { panic!("{errors:?}") };
    assert!(error.contains("skin.vtp") && error.contains("too large"), "{error}");
}

#[test]
fn a_database_that_cannot_be_made_is_named_with_what_may_be_the_reason() {
    let data = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_facies");
    let mut limited = std::process::Command::new("prlimit");
    limited.args(["--fsize=200000", program, "serve", "--bind", "127.0.0.1:0", "--data"]);
    let done = limited.arg(data.path()).output().unwrap();
    assert_eq!(done.status.code(), Some(78), "{:?} {}", done.status, text(&done.stderr));
    let error = text(&done.stderr);
    let file = data.path().join("facies.db");
    assert!(error.contains(path(&file)) && error.contains("ulimit -f"), "{error}");
}

#[test]
fn standard_output_on_a_full_disk_is_an_error_in_one_line() {
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_facies"));
    let done = program.arg("materials").stdout(full).output().unwrap();
    assert_eq!(done.status.code(), Some(3), "{:?}", done.status);
    let error = text(&done.stderr);
    assert!(
        error.starts_with("error: could not write to stdout") && error.lines().count() == 1,
        "{error}"
    );
}

#[test]
fn a_folder_holds_the_files_of_one_answer_and_the_plan_that_it_answers() {
    let out = tempfile::tempdir().unwrap();
    let own = out.path().join("notes.txt");
    fs::write(&own, "mine").unwrap();
    let file = out.path().join("mine.json");
    let moved = |by: f64, outputs: &[&str]| {
        let read = fs::read(block().join("case.json")).unwrap();
        let mut documents: Value = serde_json::from_slice(&read).unwrap();
        documents["case"]["volume"] = json!(path(&block().join("block.vtu")));
        documents["case"]["bones"] = json!([]);
        documents["plan"]["segments"][0]["translation_mm"] = json!([0, 0, by]);
        documents["spec"]["outputs"] = json!(outputs);
        fs::write(&file, documents.to_string()).unwrap();
        let done = facies(&["predict", "--case", path(&file), "--out", path(out.path())]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        result(out.path()).provenance.plan.unwrap().segments[0].clone()
    };
    let first = moved(1.0, &["skin.vtp", "skin.csv"]);
    assert!(out.path().join("skin.csv").is_file());
    let second = moved(2.0, &["skin.vtp"]);
    assert!(first != second, "{second:?}");
    assert!(out.path().join("skin.vtp").is_file() && !out.path().join("skin.csv").exists());
    assert!(own.is_file() && file.is_file());
}

#[test]
fn a_file_that_no_command_wrote_is_not_replaced_and_a_folder_has_one_command_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let case = block().join("case.json");
    let refused = |out: &Path, words: &str| {
        let asked = ["predict", "--case", path(&case), "--outputs", "skin.vtp", "--out", path(out)];
        let done = facies(&asked);
        let told = text(&done.stderr);
        assert_eq!((done.status.code(), told.contains(words)), (Some(2), true), "{told}");
    };
    for name in ["case.json", "skin.vtp", "result.json"] {
        let out = folder.path().join(name).with_extension("folder");
        fs::create_dir(&out).unwrap();
        fs::write(out.join(name), "{}").unwrap();
        refused(&out, "give another folder");
        assert_eq!(fs::read_dir(&out).unwrap().count(), 1, "{name}");
        assert_eq!(fs::read(out.join(name)).unwrap(), b"{}");
    }
    let out = folder.path().join("held");
    fs::create_dir(&out).unwrap();
    let held = fs::File::open(&out).unwrap();
    held.lock().unwrap();
    refused(&out, "another command is writing");
    drop(held);
    let done = facies(&["face", "--out", path(&out)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert_eq!(facies(&["face", "--lips", "open", "--out", path(&out)]).status.code(), Some(0));
}

#[test]
fn a_file_that_was_edited_is_neither_replaced_nor_removed() {
    let folder = tempfile::tempdir().unwrap();
    let (face, out) = (folder.path().join("face"), folder.path().join("out"));
    let case = block().join("case.json");
    let make = ["face", "--out", path(&face)];
    let predict = ["predict", "--case", path(&case), "--outputs", "skin.csv", "--out", path(&out)];
    for (command, file) in [(&make[..], face.join("case.json")), (&predict, out.join("skin.csv"))] {
        for _ in 0..2 {
            assert_eq!(facies(command).status.code(), Some(0), "{command:?}");
        }
        let edited = fs::read_to_string(&file).unwrap() + "\n";
        fs::write(&file, &edited).unwrap();
        let told = facies(command);
        let (code, told) = (told.status.code(), text(&told.stderr));
        let line = format!("{} was changed since", path(&file));
        assert!(code == Some(2) && told.contains(&line), "{told}");
        assert_eq!(told.matches("error: ").count(), 1, "{told}");
        assert_eq!(fs::read_to_string(&file).unwrap(), edited);
    }
    assert!(out.join("result.json").is_file());
}

#[test]
fn a_check_and_a_prediction_of_different_plans_do_not_stand_in_one_folder() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = |command: &str, by: f64| {
        let read = fs::read(block().join("case.json")).unwrap();
        let mut documents: Value = serde_json::from_slice(&read).unwrap();
        documents["case"]["volume"] = json!(path(&block().join("block.vtu")));
        documents["case"]["bones"] = json!([]);
        documents["plan"]["segments"][0]["translation_mm"] = json!([0, 0, by]);
        documents["spec"]["outputs"] = json!(["skin.vtp"]);
        let file = folder.path().join("mine.json");
        fs::write(&file, documents.to_string()).unwrap();
        facies(&[command, "--case", path(&file), "--out", path(&out)])
    };
    let names = ["check.json", "classes.svg", "mandible.txt", "mandible.tfm"];
    let of_check = || names.map(|name| out.join(name).exists());
    assert_eq!(run("check", 1.0).status.code(), Some(0));
    assert_eq!(of_check(), [true; 4]);
    assert_eq!(run("predict", 2.0).status.code(), Some(0));
    assert_eq!(of_check(), [false; 4]);
    let refused = run("check", 1.0);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("of another plan"), "{}", text(&refused.stderr));
    assert_eq!((run("check", 2.0).status.code(), of_check()), (Some(0), [true; 4]));
}

#[test]
fn a_plan_that_was_found_without_a_server_is_one_that_predict_takes() {
    let folder = tempfile::tempdir().unwrap();
    let targets = json!({
        "targets": [{"nodes": {"node_set": "skin"}, "displacement_mm": [1, null, null]}],
        "bounds": {"mandible": {"translation_mm": [[-10, 10], [0, 0], [-5, 5]]}},
    });
    let file = folder.path().join("targets.json");
    fs::write(&file, targets.to_string()).unwrap();
    let (case, out) = (block().join("case.json"), folder.path().join("found"));
    let asked = ["optimise", "--case", path(&case), "--spec", path(&file), "--out", path(&out)];
    let done = facies(&asked);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let plan: PlanDocument =
        serde_json::from_slice(&fs::read(out.join("plan.json")).unwrap()).unwrap();
    assert_eq!(Some(plan), result(&out).optimisation.map(|found| found.plan));
    let shown = text(&done.stdout);
    assert!(shown.contains("target 0   residual") && shown.contains("plan.json"), "{shown}");

    let mesh = block().join("block.vtu");
    let (plan, again) = (out.join("plan.json"), folder.path().join("again"));
    let scene = ["--mesh", path(&mesh), "--frame", "LPS", "--fixed", "skull", "--skin", "skin"];
    let rest = ["--plan", path(&plan), "--out", path(&again)];
    let done = facies(&[&["predict"][..], &scene[..], &rest[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
}

#[test]
fn a_mistake_in_a_spec_of_the_command_line_is_reported_with_its_file_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("targets.json");
    fs::write(&file, r#"{"targets":{},"bounds":{}}"#).unwrap();
    let case = block().join("case.json");
    let out = folder.path().join("out");
    let asked = ["optimise", "--case", path(&case), "--spec", path(&file), "--out", path(&out)];
    let done = facies(&asked);
    let told = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{told}");
    assert!(told.contains("targets.json: /targets: expected an array, found an object"), "{told}");
}

/// The case file of the block with another spec, in a folder.
fn block_with(folder: &Path, spec: &Value) -> PathBuf {
    let read = fs::read(block().join("case.json")).unwrap();
    let mut file: Value = serde_json::from_slice(&read).unwrap();
    for mesh in ["/case/volume", "/case/bones/0/mesh"] {
        let name = file.pointer_mut(mesh).unwrap();
        *name = json!(block().join(name.as_str().unwrap()));
    }
    file["spec"] = spec.clone();
    let path = folder.join("case.json");
    fs::write(&path, file.to_string()).unwrap();
    path
}

#[test]
fn every_command_uses_the_spec_of_a_case_file_or_refuses_it() {
    let folder = tempfile::tempdir().unwrap();
    let (targets, out) = (folder.path().join("targets.json"), folder.path().join("out"));
    let mut wanted = json!({
        "targets": [{"nodes": {"node_set": "skin"}, "displacement_mm": [1, null, null]}],
        "bounds": {"mandible": {"translation_mm": [[-10, 10], [0, 0], [0, 0]]}}, "verify": false,
    });
    let optimised = |case: &Path, wanted: &Value| {
        fs::write(&targets, wanted.to_string()).unwrap();
        let done = facies(&[
            "optimise",
            "--case",
            path(case),
            "--spec",
            path(&targets),
            "--out",
            path(&out),
        ]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        result(&out).provenance.spec_hash
    };
    let soft = json!({"deep": {"young_modulus_kpa": 5}});
    let plain = optimised(&block_with(folder.path(), &json!({"kind": "predict"})), &wanted);
    let of_file = json!({"materials": soft, "element": "stabilised", "outputs": ["skin.vtp"]});
    let softer = optimised(&block_with(folder.path(), &of_file), &wanted);
    wanted["materials"] = soft;
    wanted["element"] = json!("stabilised");
    let stated = optimised(&block_with(folder.path(), &json!({"element": "plain"})), &wanted);
    assert_eq!(softer, stated);
    assert_ne!(softer, plain);

    let spec = ["--spec", path(&targets)];
    for (stated, place) in [
        (json!({"contact": "none", "tags": ["x"]}), "contact"),
        (json!({"refine": {"accept_mm": 0.1}, "tags": ["x"]}), "refine"),
        (json!({"accept_mm": 0.2, "tags": ["x"]}), "accept_mm"),
        (json!({"accept_regions_mm": {"chin": 0.2}, "tags": ["x"]}), "accept_regions_mm"),
        (json!({"plan_id": "a", "tags": ["x"]}), "plan_id"),
    ] {
        let case = block_with(folder.path(), &stated);
        for (command, more) in [
            ("response", &[][..]),
            ("optimise", &spec),
            ("study", &["--method", "fem_linear", "--level", "0"]),
        ] {
            let asked = [command, "--case", path(&case), "--out", path(&out)];
            let done = facies(&[&asked, more].concat());
            let told = text(&done.stderr);
            assert_eq!(done.status.code(), Some(2), "{command}: {told}");
            let refused = format!("case.json: /spec/{place}: ");
            assert!(told.contains(&refused) && !told.contains("/spec/tags"), "{told}");
        }
    }
    // What decides no number of it is not used, which is said.
    let case = block_with(folder.path(), &json!({"outputs": ["skin.vtp"], "estimate": "none"}));
    let done = facies(&["response", "--case", path(&case), "--out", path(&out)]);
    let told = text(&done.stderr);
    assert_eq!(done.status.code(), Some(0), "{told}");
    assert!(told.contains("not used   `estimate`, `outputs` of the spec of"), "{told}");
}

#[test]
fn a_plan_within_the_spec_of_a_file_is_refused_where_the_file_has_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let plan = json!({"segments": [{"name": "mandible", "translation_mm": [9, 0, 0]}]});
    let case = block_with(folder.path(), &json!({"plan": plan}));
    for command in ["predict", "check"] {
        let done = facies(&[command, "--case", path(&case), "--out", path(&out)]);
        let told = text(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{command}: {told}");
        assert!(told.contains("case.json: /spec/plan: "), "{told}");
    }
}

#[test]
fn a_plan_is_no_argument_of_commands_that_answer_or_find_plans() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, plan) = (block().join("block.vtu"), folder.path().join("plan.json"));
    fs::write(&plan, r#"{"segments":[{"name":"mandible","translation_mm":[4,0,0]}]}"#).unwrap();
    let out = folder.path().join("out");
    let scene = ["--mesh", path(&mesh), "--fixed", "skull", "--skin", "skin"];
    let jaw = ["--segment", "mandible=mandible", "--out", path(&out)];
    for command in ["response", "optimise"] {
        let done = facies(&[&[command][..], &scene, &jaw, &["--plan", path(&plan)]].concat());
        let told = text(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{command}: {told}");
        assert!(told.contains("unexpected argument '--plan'"), "{command}: {told}");
    }
    let done = facies(&[&["response"][..], &scene, &jaw].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
}

#[test]
fn a_sweep_makes_a_row_of_every_combination() {
    let folder = tempfile::tempdir().unwrap();
    let spec =
        json!({"kind": "study", "truth": {"refine": 1, "element": "quadratic"}, "repeats": 1});
    let (file, out) = (folder.path().join("study.json"), folder.path().join("out"));
    fs::write(&file, spec.to_string()).unwrap();
    let asked =
        ["study", "--spec", path(&file), "--scene", "slab", "--method", "dvs", "--out", path(&out)];
    let sweeps = ["--sweep", "young_modulus_kpa=10,20,40", "--sweep", "poisson_ratio=0.43,0.46"];
    let done = facies(&[&asked[..], &sweeps[..]].concat());
    let report = fs::read(out.join("report.json"));
    let report = report.unwrap_or_else(|_| panic!("{}", text(&done.stderr)));
    let report: ReportDocument = serde_json::from_slice(&report).unwrap();
    let materials: BTreeSet<&str> = report.rows.iter().map(|row| row.material.as_str()).collect();
    assert_eq!(materials.len(), 6, "{materials:?}");
    let wrong =
        facies(&["study", "--scene", "slab", "--sweep", "stiffness=1", "--out", path(&out)]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("a sweep is"), "{}", text(&wrong.stderr));
}

#[test]
fn nodes_are_selected_by_the_value_of_an_array() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = sample::block(Vector::new(80.0, 60.0, 20.0), [4, 3, 2], CellShape::Hex8);
    let tag = |node: &Vector| match node.z {
        0.0 => 4 + i64::from(node.x > 30.0),
        z if z > 19.0 => 7,
        _ => 0,
    };
    mesh.node_labels.insert("tag".to_owned(), mesh.nodes.iter().map(tag).collect());
    mesh.node_sets.clear();
    let (file, plan) = (folder.path().join("block.vtu"), folder.path().join("plan.json"));
    fs::write(&file, vtu::write(&VolumeOutput::plain(&mesh, Frame::Unspecified)).unwrap()).unwrap();
    fs::write(&plan, r#"{"segments":[{"name":"jaw","translation_mm":[2,0,0]}]}"#).unwrap();
    let scene = ["check", "--mesh", path(&file), "--plan", path(&plan)];
    let nodes = ["--fixed", "tag=4", "--skin", "tag=7", "--segment", "jaw=tag=5"];
    let done = facies(&[&scene[..], &nodes[..]].concat());
    let shown = text(&done.stdout);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    // Two of five columns of nodes on the left, three on the right, four rows.
    assert!(shown.contains("joined     12 nodes to jaw"), "{shown}");
    assert!(
        shown.contains("fixed      8 nodes") && shown.contains("skin       20 nodes"),
        "{shown}"
    );
    let wrong = facies(&["check", "--mesh", path(&file), "--fixed", "skull"]);
    let told = text(&wrong.stderr);
    assert!(told.contains("select nodes by `array` with `value`: tag"), "{told}");
}

#[test]
fn progress_is_reported_on_standard_error_and_the_result_on_standard_output() {
    let out = tempfile::tempdir().unwrap();
    let case = block().join("case.json");
    let done = facies(&["predict", "--case", path(&case), "--output", path(out.path())]);
    let phases: Vec<String> = text(&done.stderr)
        .lines()
        .filter_map(|line| line.split_once(" s  ").map(|(_, phase)| phase.to_owned()))
        .collect();
    let solve = phases.iter().position(|phase| phase == "solve");
    let write = phases.iter().position(|phase| phase == "write");
    assert!(solve.is_some() && solve < write, "{phases:?}");
    assert!(!text(&done.stdout).contains("assemble\n"), "{}", text(&done.stdout));
}

#[test]
fn the_help_lists_every_command_once_in_its_group_and_arguments_in_theirs() {
    let help = text(&facies(&["--help"]).stdout);
    for heading in ["Predict and plan:", "Serve:", "Options:"] {
        assert!(help.contains(heading), "{help}");
    }
    let commands = [
        "demo",
        "check",
        "predict",
        "response",
        "optimise",
        "reproduce",
        "compare",
        "cohort",
        "learn",
        "study",
        "serve",
        "worker",
        "migrate",
        "admin",
        "config",
        "health",
        "openapi",
    ];
    for command in commands {
        let lines = help.lines().filter(|line| line.starts_with(&format!("  {command} ")));
        let lines: Vec<&str> = lines.collect();
        assert!(lines.len() == 1 && lines[0].len() > 25, "{command}: {lines:?}");
        assert!(facies(&[command, "--help"]).status.success(), "{command}");
    }
    let predict = text(&facies(&["predict", "--help"]).stdout);
    for heading in ["What is predicted:", "What holds and moves it:", "Tissue:", "Result:"] {
        assert!(predict.contains(heading), "{predict}");
    }
    let serve = text(&facies(&["serve", "--help"]).stdout);
    for heading in ["Where things are kept:", "Requests:", "Jobs:", "Logs and traces:"] {
        assert!(serve.contains(heading), "{serve}");
    }
}

#[test]
fn a_reader_who_goes_ends_a_command_without_a_panic() {
    for command in ["materials", "openapi"] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_facies"));
        let output = program.arg(command).stdout(writer).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), told.as_ref()), (Some(141), ""), "{command}");
    }
}

#[test]
fn a_negative_constant_is_refused_as_one_that_is_out_of_range() {
    let mesh = block().join("block.vtu");
    for (option, value) in [("--poisson-ratio", "-0.3"), ("--young-modulus-kpa", "-15")] {
        let done = facies(&["check", "--mesh", path(&mesh), "--units", "mm", option, value]);
        let error = text(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{error}");
        assert!(error.contains("has to be at least") && error.contains(value), "{error}");
    }
}
