//! `facies study`: reports, outcomes and their exit codes.

use std::fs;
use std::path::Path;

use facies::schema::study::report::{OutcomeName, ReportDocument, RowStatus};
use serde_json::{Value, json};

use crate::program::{block, facies, path, text};

/// The slab at its coarsest with a truth that takes a moment.
fn spec() -> Value {
    json!({
        "kind": "study",
        "scenes": ["slab"],
        "plans": ["patch 4 mm"],
        "methods": ["fem_linear"],
        "materials": [{"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}}],
        "truth": {"refine": 1, "element": "quadratic"},
        "repeats": 1,
    })
}

/// Exit code, what was told, and the report where one was written.
fn study(folder: &Path, spec: &Value, more: &[&str]) -> (i32, String, Option<ReportDocument>) {
    let (file, out) = (folder.join("study.json"), folder.join("out"));
    fs::write(&file, spec.to_string()).unwrap();
    let arguments = ["study", "--spec", path(&file), "--out", path(&out)];
    let output = facies(&[&arguments, more].concat());
    let report = fs::read(out.join("report.json")).ok();
    let report = report.map(|bytes| serde_json::from_slice(&bytes).unwrap());
    (output.status.code().unwrap(), text(&output.stderr) + &text(&output.stdout), report)
}

#[test]
fn a_study_writes_its_report_in_every_form_and_ends_well() {
    let folder = tempfile::tempdir().unwrap();
    let (code, told, report) = study(folder.path(), &spec(), &["--level", "0"]);
    let report = report.unwrap();
    assert_eq!((code, report.verdict.outcome), (0, OutcomeName::Pass), "{told}");
    assert!(report.rows.iter().all(|row| row.status == RowStatus::Solved && row.level == 0));
    assert!(report.rows.len() >= 3, "{} variants", report.rows.len());
    for row in &report.rows {
        assert!(told.contains(&row.label), "{told}");
    }
    for file in ["report.json", "report.csv", "report.junit.xml", "chart.svg", "result.json"] {
        assert!(fs::metadata(folder.path().join("out").join(file)).unwrap().len() > 100, "{file}");
    }
}

#[test]
fn a_method_that_is_named_twice_is_one_mistake() {
    let folder = tempfile::tempdir().unwrap();
    let mut twice = spec();
    twice["methods"] = json!(["fem_linear", "fem_linear"]);
    let (code, told, _) = study(folder.path(), &twice, &[]);
    assert_eq!((code, told.matches("/spec/methods: two variants").count()), (2, 1), "{told}");
}

#[test]
fn the_exit_code_is_that_of_the_outcome() {
    let folder = tempfile::tempdir().unwrap();
    let of = |spec: &Value, more: &[&str]| {
        let (code, told, report) = study(folder.path(), spec, more);
        (code, told, report)
    };
    let (code, told, _) = of(&spec(), &["--threshold-p95-mm", "1e-6"]);
    assert_eq!(code, 1, "{told}");
    assert!(told.contains("worse than allowed"), "{told}");

    let missing = folder.path().join("nowhere.json");
    let (code, told, _) = of(&spec(), &["--baseline", path(&missing)]);
    assert_eq!(code, 5, "{told}");

    let mut hasty = spec();
    hasty["budget"] = json!({"wall_s": 1e-3});
    let (code, told, report) = of(&hasty, &[]);
    assert!(code == 4 && report.unwrap().verdict.solved < 3, "{told}");

    let mut unknown = spec();
    unknown["scenes"] = json!(["nowhere"]);
    let (code, told, _) = of(&unknown, &[]);
    assert!(code == 2 && told.contains("/spec/scenes/0"), "{told}");
    let (code, told, _) = of(&spec(), &["--method", "nonsense"]);
    assert_eq!(code, 2, "{told}");
}

#[test]
fn a_study_is_not_worse_than_itself_and_worse_than_one_with_half_its_errors() {
    let folder = tempfile::tempdir().unwrap();
    let (code, told, report) = study(folder.path(), &spec(), &[]);
    assert_eq!(code, 0, "{told}");
    let mut report = report.unwrap();
    // Times of a busy machine say nothing.
    report.rows.iter_mut().filter_map(|row| row.numbers.as_mut()).for_each(|n| n.wall_s = 1e3);
    let baseline = folder.path().join("baseline.json");
    fs::write(&baseline, serde_json::to_string(&report).unwrap()).unwrap();
    let (code, told, _) = study(folder.path(), &spec(), &["--baseline", path(&baseline)]);
    assert_eq!(code, 0, "{told}");
    report.rows.iter_mut().filter_map(|row| row.numbers.as_mut()).for_each(|n| n.p95_mm /= 2.0);
    fs::write(&baseline, serde_json::to_string(&report).unwrap()).unwrap();
    let (code, told, _) = study(folder.path(), &spec(), &["--baseline", path(&baseline)]);
    assert_eq!(code, 1, "{told}");
    let own = folder.path().join("out/report.json");
    let before = fs::read(&own).unwrap();
    let (code, told, _) = study(folder.path(), &spec(), &["--baseline", path(&own)]);
    assert!(code == 2 && told.contains("give another folder"), "{code}: {told}");
    assert_eq!(fs::read(&own).unwrap(), before);
}

#[test]
fn rows_that_are_kept_are_judged_again_and_not_solved_again() {
    let folder = tempfile::tempdir().unwrap();
    let kept = folder.path().join("kept");
    let keep =
        |more: &[&str]| study(folder.path(), &spec(), &[&["--keep", path(&kept)], more].concat());
    let (code, told, first) = keep(&[]);
    assert_eq!(code, 0, "{told}");
    let cost =
        "the truth of slab is solved by `fem_linear` on 2 meshes, once on each, the finest with";
    assert!(told.contains(cost) && told.contains("s on one thread"), "{told}");
    let (code, told, second) = keep(&["--threshold-p95-mm", "1e-6"]);
    assert_eq!(code, 1, "{told}");
    assert!(told.contains("rows       kept in") && !told.contains(cost), "{told}");
    let (first, second) = (first.unwrap(), second.unwrap());
    assert_eq!(second.rows_of, Some(first.source()));
    // Times too are those of the first.
    let times = |report: &ReportDocument| -> Vec<f64> {
        report.rows.iter().filter_map(|row| row.numbers.as_ref()).map(|n| n.wall_s).collect()
    };
    assert_eq!(times(&first), times(&second));
    let (_, _, third) = keep(&["--repeats", "2"]);
    assert_eq!(third.unwrap().rows_of, None);
}

#[test]
fn cases_from_files_have_each_their_own_plan() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut arguments =
        ["study", "--method", "fem_linear", "--level", "0", "--repeats", "1"].to_vec();
    arguments.extend(["--out", path(&out)]);
    let mut files = Vec::new();
    for (name, length) in [("near", 1.0), ("far", 3.0)] {
        let inside = folder.path().join(name);
        fs::create_dir(&inside).unwrap();
        fs::copy(block().join("block.vtu"), inside.join("block.vtu")).unwrap();
        let case = json!({
            "case": {
                "units": "mm",
                "volume": "block.vtu",
                "segments": [{"name": "jaw", "nodes": {"node_set": "mandible"}}],
                "fixed": [{"node_set": "skull"}],
                "skin": {"node_set": "skin"},
                "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}},
            },
            "plan": {"segments": [{"name": "jaw", "translation_mm": [length, 0, 0]}]},
        });
        let file = inside.join(format!("{name}.json"));
        fs::write(&file, case.to_string()).unwrap();
        files.push(file);
    }
    for file in &files {
        arguments.extend(["--case", path(file)]);
    }
    let output = facies(&arguments);
    // Elements that the cells of the block cannot be do not apply, and judge nothing.
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let report: ReportDocument =
        serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    let scenes: Vec<&str> = report.scenes.iter().map(|scene| scene.name.as_str()).collect();
    assert_eq!(scenes, ["near", "far"]);
    let moved = |scene: &str| {
        let solved = report.rows.iter().filter(|row| row.scene == scene);
        solved.filter_map(|row| row.numbers.as_ref()).map(|n| n.skin_mean_mm).next().unwrap()
    };
    // Linear tissue: three times the movement, three times the skin.
    assert!((moved("far") / moved("near") - 3.0).abs() < 1e-5);

    let wrong = fs::read_to_string(&files[1]).unwrap().replace("skull", "skul");
    fs::write(&files[1], wrong).unwrap();
    let output = facies(&arguments);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("/cases/far/fixed/0: the mesh has no node set"), "{told}");
}

#[test]
fn plans_of_a_study_stand_over_that_of_a_case_file() {
    let folder = tempfile::tempdir().unwrap();
    let plan =
        |name: &str, x: f64| json!({"segments": [{"name": name, "translation_mm": [x, 0, 0]}]});
    let case = json!({
        "case": {
            "units": "mm",
            "volume": block().join("block.vtu"),
            "segments": [{"name": "jaw", "nodes": {"node_set": "mandible"}}],
            "fixed": [{"node_set": "skull"}],
            "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.46}},
        },
        "plan": plan("jaw", 1.0),
    });
    fs::write(folder.path().join("case.json"), case.to_string()).unwrap();
    let spec = |scene: Value| {
        json!({
            "scenes": [scene], "plans": [plan("jaw", 1.0), plan("jaw", 2.0)], "repeats": 1,
            "methods": [{"method": "fem_linear", "label": "fem"}],
            "truth": {"refine": 1, "element": "mean_dilatation"},
        })
    };
    let (code, told, report) =
        study(folder.path(), &spec(json!({"case": "case.json"})), &["--level", "0"]);
    assert_eq!(code, 0, "{told}");
    let moved: Vec<f64> =
        report.unwrap().rows.iter().map(|row| row.numbers.as_ref().unwrap().skin_mean_mm).collect();
    assert_eq!(moved.len(), 2, "{told}");
    assert!((moved[1] / moved[0] - 2.0).abs() < 1e-5, "{moved:?}");

    let own = json!({"case": "case.json", "plans": [plan("jaw", 1.0)]});
    let (code, told, _) = study(folder.path(), &spec(own), &["--level", "0"]);
    assert_eq!(code, 2, "{told}");
    assert!(told.contains("every case of `scenes` states `plans` of its own"), "{told}");
}

/// The table of the small study: how far each method is from the truth, in mm (p95), and how that was known before.
#[test]
fn the_small_study_has_every_method_and_their_errors_stand_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = facies(&["study", "--small", "--repeats", "1", "--out", path(&out)]);
    let told = text(&output.stderr) + &text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{told}");
    let report: ReportDocument =
        serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    let p95 = |label: &str, level: u32| {
        let mut rows = report.rows.iter().filter(|row| row.label == label && row.level == level);
        rows.next().and_then(|row| row.numbers.as_ref()).unwrap_or_else(|| panic!("{label}")).p95_mm
    };
    // Linear and mass-tensor models are one, however they are brought to rest: to the residuals of each.
    for level in [0, 1] {
        let plain = p95("fem_linear plain", level);
        for (label, within) in [
            ("mtm", 1e-6),
            ("mtm_ti", 1e-6),
            ("mtm gauss_seidel", 0.01),
            ("mtm damped_jacobi", 0.01),
        ] {
            assert!((p95(label, level) - plain).abs() < within, "{label}: {told}");
        }
        // What does not lock is better, what bends is best, and what knows no tissue is worst.
        assert!(p95("fem_linear stabilised", level) < 0.5 * plain, "{told}");
        let best = p95("fem_linear quadratic", level);
        assert!(best < 0.5 * p95("fem_linear stabilised", level), "{told}");
        assert!(p95("thickness_warp", level) > p95("dvs galerkin", level), "{told}");
    }
    assert!(p95("fem_linear quadratic", 1) < 0.1, "{told}");
    let diverged: Vec<&str> = report
        .rows
        .iter()
        .filter(|row| row.status != RowStatus::Solved)
        .map(|row| row.label.as_str())
        .collect();
    assert_eq!(diverged, ["mtm jacobi", "mtm jacobi", "mtm_nonlinear"], "{told}");
}

#[test]
fn the_terminal_names_what_fails_what_is_left_out_and_what_speaks_against_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut asked = spec();
    asked["methods"] = json!(["fem_linear", {"method": "fem_nonlinear", "label": "finite"}]);
    asked["thresholds"] = json!({"p95_mm": 0.01, "labels": ["finite"]});
    let (code, told, report) = study(folder.path(), &asked, &["--level", "0", "--level", "1"]);
    let report = report.unwrap();
    assert_eq!((code, report.verdict.outcome), (1, OutcomeName::Worse), "{told}");
    for wanted in [
        "linear-truth (2 of ",
        "fem_linear quadratic has no row: level 1 is the truth itself",
        "failing    slab, patch 4 mm, finite, ",
        "is above the threshold 0.01 mm",
    ] {
        assert!(told.contains(wanted), "{wanted}: {told}");
    }
    assert_eq!(report.verdict.failing.len(), 2);
    assert!(report.verdict.failing.iter().all(|row| row.value > row.limit));
    let row = told.lines().find(|line| line.contains(" finite ") && line.contains("linear-truth"));
    assert!(row.is_some(), "a row is printed with its warnings: {told}");
}
