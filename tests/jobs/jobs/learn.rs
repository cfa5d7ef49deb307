//! Learning without a server: what mechanics misses alike is learned and added, and bad cohorts are named.

use std::collections::{BTreeMap, BTreeSet};

use facies::jobs::{
    JobContext, JobError, JobInput, JobOutput, LearnInput, LearnedCase, MeshSource, PredictInput,
    SourceError, StoredMesh, StoredShape, work,
};
use facies::schema::Limits;
use mechanics::mesh::half_head::{LAYERS, half_head};
use mechanics::mesh::{CellShape, TriangleSurface, Vector, VolumeMesh, sample};
use mechanics::prediction::{equilibrium, predict};
use mechanics::progress::{Phase, StopQuery, Unobserved};
use serde_json::{Value, json};

use super::stop_at::StopAt;
use crate::sources::stored;

/// Meshes, and what was learned.
struct Sources {
    meshes: BTreeMap<String, StoredMesh>,
    model: Vec<u8>,
}

impl MeshSource for Sources {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        self.meshes.get(id).cloned().ok_or_else(|| SourceError::Unknown { id: id.to_owned() })
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        self.mesh(job)
    }

    fn model(&self, _job: &str) -> Result<Vec<u8>, SourceError> {
        Ok(self.model.clone())
    }
}

fn block(cells: [usize; 3]) -> VolumeMesh {
    sample::block(Vector::new(60.0, 60.0, 30.0), cells, CellShape::Hex8)
}

fn volume(mesh: VolumeMesh) -> StoredMesh {
    StoredMesh { frame: None, ..stored(StoredShape::Volume(mesh.into()), None) }
}

/// A block whose bone moves by `x` mm along x.
fn prediction(x: f64, spec: Value) -> PredictInput {
    let document = json!({
        "case": {
            "schema": 1, "units": "mm", "volume": "block",
            "segments": [{"name": "bone", "nodes": {"node_set": "z_min"}}],
            "fixed": [{"node_set": "z_max"}],
        },
        "plan": {"segments": [{"name": "bone", "translation_mm": [x, 0, 0]}]},
        "spec": spec, "job": null, "queue_s": null,
    });
    serde_json::from_value(document).unwrap()
}

fn linear() -> Value {
    json!({"method": "fem_linear"})
}

/// Four operations, after each of which the tissue lies 0.5 mm higher than mechanics says.
fn operated() -> (Sources, LearnInput) {
    operated_beside(&|_, _| Vector::new(0.0, 0.0, 0.5))
}

/// Four operations, of which mechanics misses so much at each node.
fn operated_beside(missed: &dyn Fn(usize, usize) -> Vector) -> (Sources, LearnInput) {
    let mut meshes = BTreeMap::from([("block".to_owned(), volume(block([4, 4, 2])))]);
    let mut cases = Vec::new();
    let mut named = Vec::new();
    for number in 1..=4 {
        let prediction = prediction(number as f64, linear());
        let sources = Sources { meshes: meshes.clone(), model: Vec::new() };
        let scene =
            prediction.prepare(&sources, &Limits::default(), &StopQuery::never()).unwrap().scene;
        let (solved, _) = equilibrium(&scene, &Unobserved).unwrap();
        let mut after = block([4, 4, 2]);
        let moved = after.nodes.iter_mut().zip(&solved.displacement).enumerate();
        moved.for_each(|(place, (node, u))| *node += u + missed(number, place));
        meshes.insert(format!("after {number}"), volume(after));
        named.push(
            json!({"prediction": format!("p {number}"), "actual": format!("after {number}")}),
        );
        cases.push(LearnedCase { case: None, spec_hash: None, prediction });
    }
    let spec = serde_json::from_value(json!({"cases": named})).unwrap();
    (
        Sources { meshes, model: Vec::new() },
        LearnInput { job: None, queue_s: None, spec, cohort: None, cases },
    )
}

fn done(input: JobInput, sources: &Sources) -> Result<(JobOutput, tempfile::TempDir), JobError> {
    let out = tempfile::tempdir().unwrap();
    let place = JobContext { sources, limits: &Limits::default(), out: out.path() };
    work(&input, &place, &Unobserved).map(|done| (done, out))
}

#[test]
fn learning_that_is_cancelled_ends_in_every_phase_and_keeps_no_model() {
    for phase in [Phase::Solve, Phase::Compare] {
        let (sources, input) = operated();
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let place = JobContext { sources: &sources, limits: &Limits::default(), out: &out };
        let progress = StopAt::phase(phase);
        let error = work(&JobInput::Learn(input), &place, &progress).unwrap_err();
        assert_eq!(error.kind().name(), "cancelled", "{phase:?}");
        assert!(!out.exists(), "{phase:?}");
    }
}

#[test]
fn what_mechanics_misses_alike_is_added_to_the_next_prediction() {
    let (mut sources, input) = operated();
    let (output, out) = done(JobInput::Learn(input), &sources).unwrap();
    let found = output.result.learning.unwrap();
    let error = |name: &str| found.table.iter().find(|own| own.name == name).unwrap().mean;
    assert!((error("fem_linear") - 0.5).abs() < 1e-6, "{found:?}");
    assert!(error("fem_linear + GRNN") < 1e-6 && error("fem_linear + SDM") < 1e-6, "{found:?}");
    assert!(error("GRNN") > 0.1 && found.helps);
    // Four cases give no less than 1/8.
    let test = found.tests.iter().find(|test| test.second == "fem_linear + GRNN").unwrap();
    assert_eq!((test.p, test.smallest_p), (Some(0.125), 0.125));
    let picture = std::fs::read_to_string(out.path().join("learning.svg")).unwrap();
    assert!(picture.contains("linear FEM + GRNN") && !picture.contains("fem_linear"), "{picture}");
    let errors = std::fs::read_to_string(out.path().join("errors.vtp")).unwrap();
    for array in ["no_movement", "fem_linear", "GRNN", "fem_linear_GRNN", "fem_linear_SDM"] {
        assert!(errors.contains(&format!("Name=\"mean_error_{array}_mm\"")), "{array}");
    }
    assert!(!errors.contains("tuned") && errors.contains("NumberOfPoints=\"66\""), "{errors}");
    sources.model = std::fs::read(out.path().join("model.json")).unwrap();

    let spec = json!({"method": "fem_linear", "correction": {"model": "any"}});
    let asked = |x: f64| done(JobInput::Predict(prediction(x, spec.clone())), &sources).unwrap();
    let (output, out) = asked(2.5);
    let corrected = output.result.correction.unwrap();
    assert!((corrected.changed_mm.unwrap() - 0.5).abs() < 1e-6, "{corrected:?}");
    assert!(corrected.helps && corrected.band_mm.is_none() && corrected.refused.is_none());
    assert!(out.path().join("corrected.vtp").exists() && out.path().join("skin.vtp").exists());

    let (output, out) = asked(12.0);
    let refused = output.result.correction.unwrap();
    assert!(refused.refused.is_some() && refused.changed_mm.is_none(), "{refused:?}");
    assert!(output.result.warnings.iter().any(|own| own.code == "out-of-distribution"));
    assert!(!out.path().join("corrected.vtp").exists() && out.path().join("skin.vtp").exists());
}

#[test]
fn the_table_has_a_row_for_each_patient_with_class_and_largest_movement_of_bone() {
    let (sources, mut input) = operated();
    input.spec.cases[1].class = Some("forward, far".to_owned());
    input.spec.cases[2].class = Some("=1+1".to_owned());
    let (output, out) = done(JobInput::Learn(input), &sources).unwrap();
    let found = output.result.learning.unwrap();
    for (number, patient) in (1..).zip(&found.patients) {
        assert!((patient.largest_bone_movement_mm - f64::from(number)).abs() < 1e-9, "{patient:?}");
    }
    assert_eq!((found.patients[0].class.as_str(), found.patients.len()), ("1 moved", 4));
    let table = std::fs::read_to_string(out.path().join("learning.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[0].starts_with(
        "patient,class,largest_bone_movement_mm,no movement mean_mm,no movement p95_mm,fem_linear mean_mm"
    ));
    assert!(rows[2].starts_with("2,\"forward, far\",2") && rows.len() == 6, "{table}");
    assert!(rows[3].starts_with("3,'=1+1,3"), "no formula: {table}");
    let last: Vec<&str> = rows[5].split(',').collect();
    let mean: f64 = last[5].parse().unwrap();
    assert!(last[..3] == ["mean", "", "2.5"] && (mean - 0.5).abs() < 1e-6, "{table}");
}

#[test]
fn the_search_of_a_width_and_the_modes_of_a_deformation_model_are_reported() {
    let (sources, input) = operated();
    let found = done(JobInput::Learn(input), &sources).unwrap().0.result.learning.unwrap();
    let climb = found.width.unwrap().climb.unwrap();
    assert!(climb.rmse < 1e-6 && climb.width > 0.0, "{climb:?}");
    let modes = |name: &str| {
        let own = found.validation.iter().find(|own| own.method == name).unwrap();
        own.modes.unwrap()
    };
    // Bone moves along one line: one mode of two that four cases permit.
    let own = modes("SDM of 95 %");
    assert_eq!((own.count, own.most, own.is_limited_by_cases), (1, 2, false));
    // One of one that is chosen by leaving cases out.
    let own = modes("SDM");
    assert_eq!((own.count, own.most), (1, 1));
    assert!(found.validation.iter().all(|own| own.other_classes.is_none()), "there is one class");
}

#[test]
fn a_model_of_noise_is_told_to_be_of_no_use_when_it_is_learned_and_when_it_corrects() {
    let noise = |number: usize, node: usize| {
        let wave = |axis: usize| {
            ((7 * number + 3 * axis) as f64 + 1.7 * node as f64 * number as f64).sin()
        };
        0.3 * Vector::new(wave(0), wave(1), wave(2))
    };
    let (mut sources, input) = operated_beside(&noise);
    let (output, out) = done(JobInput::Learn(input), &sources).unwrap();
    let harms = |output: &JobOutput| {
        output.result.warnings.iter().any(|own| own.code == "learning-does-not-help")
    };
    assert!(harms(&output) && !output.result.learning.unwrap().helps);
    sources.model = std::fs::read(out.path().join("model.json")).unwrap();
    let spec = json!({"method": "fem_linear", "correction": {"model": "any"}});
    let (output, _out) = done(JobInput::Predict(prediction(2.5, spec)), &sources).unwrap();
    assert!(harms(&output) && !output.result.correction.unwrap().helps);
    assert!(output.result.provenance.timing.correction_s > 0.0);
}

#[test]
fn a_model_corrects_what_it_was_learned_on_and_nothing_else() {
    let (mut sources, input) = operated();
    let (_, out) = done(JobInput::Learn(input), &sources).unwrap();
    sources.model = std::fs::read(out.path().join("model.json")).unwrap();
    let refused = |mut input: PredictInput, sources: &Sources| {
        input.spec.correction = Some(serde_json::from_value(json!({"model": "any"})).unwrap());
        first_fault(done(JobInput::Predict(input), sources).map(|_| ()))
    };
    let mtm = prediction(2.0, json!({"method": "fem_nonlinear"}));
    let at = "/spec/correction/model".to_owned();
    assert_eq!(refused(mtm, &sources), (at.clone(), "method-mismatch".to_owned()));
    sources.meshes.insert("block".to_owned(), volume(block([3, 4, 2])));
    let other = prediction(2.0, linear());
    assert_eq!(refused(other, &sources), (at.clone(), "not-corresponding".to_owned()));
    // As many nodes of bone on the same mesh, at its other end.
    sources.meshes.insert("block".to_owned(), volume(block([4, 4, 2])));
    assert_eq!(refused(turned(2.0), &sources), (at, "not-corresponding".to_owned()));
}

/// The block with its bone where the others are held.
fn turned(x: f64) -> PredictInput {
    let mut own = prediction(x, linear());
    let set = |name: &str| serde_json::from_value(json!({"node_set": name})).unwrap();
    own.case.segments[0].nodes = set("z_max");
    own.case.fixed = vec![set("z_min")];
    own
}

fn first_fault(result: Result<(), JobError>) -> (String, String) {
    match result {
        Err(JobError::Refused(problem)) => {
            let error = &problem.errors[0];
            (error.pointer.to_string(), error.code.name().to_owned())
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn bad_cohorts_are_named_with_their_place() {
    let faults = |change: &dyn Fn(&mut LearnInput, &mut Sources)| {
        let (mut sources, mut input) = operated();
        change(&mut input, &mut sources);
        first_fault(done(JobInput::Learn(input), &sources).map(|_| ()))
    };
    let told = |at: &str, code: &str| (at.to_owned(), code.to_owned());
    let few = faults(&|input, _| {
        input.spec.cases.truncate(1);
        input.cases.truncate(1);
    });
    assert_eq!(few, told("/spec/cases", "out-of-range"));
    let twice = faults(&|input, _| input.spec.cases[2].actual = "after 1".to_owned());
    assert_eq!(twice, told("/spec/cases/2/actual", "duplicate-name"));
    // The same patient under another name is seen by what was measured.
    let copied = faults(&|input, sources| {
        sources.meshes.insert("copy".to_owned(), sources.meshes["after 1"].clone());
        input.spec.cases[3].actual = "copy".to_owned();
    });
    assert_eq!(copied, told("/spec/cases/3", "duplicate-name"));
    let other_mesh = faults(&|input, sources| {
        sources.meshes.insert("other".to_owned(), volume(block([3, 4, 2])));
        input.cases[1].prediction.case.volume = "other".to_owned();
    });
    assert_eq!(other_mesh, told("/spec/cases/1/prediction", "not-corresponding"));
    let other_bone = faults(&|input, _| input.cases[2].prediction = turned(3.0));
    assert_eq!(other_bone, told("/spec/cases/2/prediction", "not-corresponding"));
    let other_name = faults(&|input, _| {
        input.cases[2].prediction.case.segments[0].name = "jaw".to_owned();
        let plan = json!({"segments": [{"name": "jaw", "translation_mm": [3, 0, 0]}]});
        input.cases[2].prediction.plan = serde_json::from_value(plan).unwrap();
    });
    assert_eq!(other_name, told("/spec/cases/2/prediction", "not-corresponding"));
    let other_points = faults(&|_, sources| {
        sources.meshes.insert("after 3".to_owned(), volume(block([3, 4, 2])));
    });
    assert_eq!(other_points, told("/spec/cases/2/actual", "not-corresponding"));
    let frames = faults(&|input, _| {
        let frame = serde_json::from_value(json!("RAS")).unwrap();
        input.cases[1].prediction.case.frame = frame;
    });
    assert_eq!(frames, told("/spec/cases/1/prediction", "frame-conflict"));
    let methods = faults(&|input, _| {
        let spec = json!({"method": "fem_nonlinear"});
        input.cases[1].prediction.spec = serde_json::from_value(spec).unwrap();
    });
    assert_eq!(methods, told("/spec/cases/1/prediction", "method-mismatch"));
}

#[test]
fn virtual_patients_are_the_same_for_the_same_seed() {
    let learned = |seed: u64| {
        let made = json!({"virtual": {"patients": 4, "seed": seed, "fineness": 1}});
        let spec = serde_json::from_value(made).unwrap();
        let input = LearnInput { job: None, queue_s: None, spec, cohort: None, cases: Vec::new() };
        let none = Sources { meshes: BTreeMap::new(), model: Vec::new() };
        done(JobInput::Learn(input), &none).unwrap().0.result.learning.unwrap()
    };
    let one = learned(1);
    assert_eq!(one, learned(1));
    let error = |name: &str| one.table.iter().find(|own| own.name == name).unwrap().mean;
    // Nobody is nearer than what happened, which mapping and registration hide.
    assert!(
        error("what happened") < error("fem_linear") && error("fem_linear") < error("no movement")
    );
    assert_ne!(one.table, learned(2).table);
}

#[test]
fn a_mapping_that_is_worse_is_a_floor_that_is_higher() {
    let learned = |mapping: f64| {
        let made = json!({"virtual": {"patients": 3, "fineness": 1, "mapping_mm": mapping}});
        let spec = serde_json::from_value(made).unwrap();
        let input = LearnInput { job: None, queue_s: None, spec, cohort: None, cases: Vec::new() };
        let none = Sources { meshes: BTreeMap::new(), model: Vec::new() };
        done(JobInput::Learn(input), &none)
    };
    let floor = |mapping: f64| {
        let found = learned(mapping).unwrap().0.result.learning.unwrap();
        found.table.iter().find(|own| own.name == "what happened").unwrap().mean
    };
    // Of two mappings of 1 mm each, and a registration.
    assert!(floor(0.0) < 0.35 && (1.0..1.9).contains(&floor(1.0)), "{} {}", floor(0.0), floor(1.0));
    let fault = first_fault(learned(6.0).map(|_| ()));
    assert_eq!(fault, ("/spec/virtual/mapping_mm".to_owned(), "out-of-range".to_owned()));
}

/// Four operations on tissue of Rubin and Bodner's law, whose bulk modulus is twice its shear modulus at theta 1.
fn operated_with_theta(truth: f64) -> (Sources, LearnInput) {
    let mut meshes = BTreeMap::from([("block".to_owned(), volume(block([4, 4, 2])))]);
    let law = |theta: f64| json!({"*": {"law": {"kind": "rubin_bodner", "eps0_kpa": 100.0, "p": 2.0, "eta1": 0.1, "eta2": 0.05, "theta": theta}}});
    let of = |x: f64, theta: f64| {
        let mut own = prediction(x, json!({"method": "fem_nonlinear", "materials": law(theta)}));
        own.plan = serde_json::from_value(
            json!({"segments": [{"name": "bone", "translation_mm": [x, 0, -x]}]}),
        )
        .unwrap();
        own
    };
    let (mut cases, mut named) = (Vec::new(), Vec::new());
    for number in 1..=4 {
        let x = 2.0 * f64::from(number);
        let sources = Sources { meshes: meshes.clone(), model: Vec::new() };
        let scene =
            of(x, truth).prepare(&sources, &Limits::default(), &StopQuery::never()).unwrap().scene;
        let (solved, _) = equilibrium(&scene, &Unobserved).unwrap();
        let mut after = block([4, 4, 2]);
        after.nodes.iter_mut().zip(&solved.displacement).for_each(|(node, u)| *node += u);
        meshes.insert(format!("after {number}"), volume(after));
        named.push(json!({"prediction": format!("p {number}"), "actual": format!("after {number}"), "class": "both jaws"}));
        cases.push(LearnedCase { case: None, spec_hash: None, prediction: of(x, 1.0) });
    }
    let spec = serde_json::from_value(json!({"cases": named, "theta": true})).unwrap();
    (
        Sources { meshes, model: Vec::new() },
        LearnInput { job: None, queue_s: None, spec, cohort: None, cases },
    )
}

#[test]
fn theta_of_a_class_is_fitted_to_its_cases() {
    let (sources, input) = operated_with_theta(0.8);
    let found = done(JobInput::Learn(input), &sources).unwrap().0.result.learning.unwrap();
    let [theta] = found.thetas.as_slice() else { panic!("{:?}", found.thetas) };
    assert_eq!((theta.class.as_str(), theta.patients), ("both jaws", 4));
    assert!((theta.theta - 0.8).abs() < 0.02 && theta.is_determined, "{theta:?}");
    let error = |name: &str| found.table.iter().find(|own| own.name == name).unwrap().mean;
    assert!(error("Rubin-Bodner") < 0.1 * error("fem_nonlinear"), "{:?}", found.table);
}

#[test]
fn theta_is_of_one_law_only() {
    let (sources, mut input) = operated();
    input.spec.theta = true;
    let fault = first_fault(done(JobInput::Learn(input), &sources).map(|_| ()));
    assert_eq!(fault, ("/spec/cases/0/prediction".to_owned(), "law-mismatch".to_owned()));
}

/// The places of a list in another order.
fn shuffled(count: usize) -> Vec<usize> {
    (0..count).map(|place| (place * 7 + 3) % count).collect()
}

/// The skin of the block as it was measured, its points in another order.
fn measured_skin(sources: &Sources, number: usize, with_ids: bool) -> TriangleSurface {
    let scene = prediction(1.0, linear())
        .prepare(sources, &Limits::default(), &StopQuery::never())
        .unwrap()
        .scene;
    let StoredShape::Volume(after) = &sources.meshes[&format!("after {number}")].shape else {
        panic!("it is a volume")
    };
    let (skin, nodes) = (&scene.skin.surface, scene.skin.nodes());
    let order = shuffled(nodes.len());
    assert_eq!(order.iter().collect::<BTreeSet<_>>().len(), nodes.len());
    let place = |point: u32| order.iter().position(|own| *own == point as usize).unwrap() as u32;
    TriangleSurface {
        points: order.iter().map(|&own| after.nodes[nodes[own] as usize]).collect(),
        triangles: skin.triangles.iter().map(|corners| corners.map(place)).collect(),
        node_ids: with_ids.then(|| order.iter().map(|&own| nodes[own]).collect()),
    }
}

fn surface(surface: TriangleSurface) -> StoredMesh {
    StoredMesh { frame: None, ..stored(StoredShape::Surface(surface.into()), None) }
}

#[test]
fn measured_points_are_taken_by_node_ids_and_refused_where_nothing_tells_which_correspond() {
    let learned = |change: &dyn Fn(&mut Sources)| {
        let (mut sources, input) = operated();
        change(&mut sources);
        done(JobInput::Learn(input), &sources).map(|(output, _out)| output)
    };
    let by_ids = learned(&|sources| {
        let own = measured_skin(sources, 1, true);
        sources.meshes.insert("after 1".to_owned(), surface(own));
    });
    let table = by_ids.unwrap().result.learning.unwrap().table;
    let mechanics = table.iter().find(|own| own.name == "fem_linear").unwrap();
    assert!((mechanics.mean - 0.5).abs() < 1e-6, "{mechanics:?}");

    let told = ("/spec/cases/0/actual".to_owned(), "not-corresponding".to_owned());
    let without = learned(&|sources| {
        let own = measured_skin(sources, 1, false);
        sources.meshes.insert("after 1".to_owned(), surface(own));
    });
    assert_eq!(first_fault(without.map(|_| ())), told);
    // A volume whose nodes are numbered otherwise has other cells.
    let renumbered = learned(&|sources| {
        let mut own = sample::block(Vector::new(30.0, 60.0, 60.0), [2, 4, 4], CellShape::Hex8);
        own.nodes.iter_mut().for_each(|node| *node = Vector::new(node.z, node.y, node.x));
        sources.meshes.insert("after 1".to_owned(), volume(own));
    });
    assert_eq!(first_fault(renumbered.map(|_| ())), told);
}

#[test]
fn cases_are_predicted_as_their_jobs_were_asked_or_refused() {
    let (mut sources, mut input) = operated();
    for (number, case) in (1..).zip(&mut input.cases) {
        let spec = json!({"method": "fem_linear", "corrected": true});
        case.prediction.spec = serde_json::from_value(spec).unwrap();
        let scene = case
            .prediction
            .prepare(&sources, &Limits::default(), &StopQuery::never())
            .unwrap()
            .scene;
        let asked = predict(&scene, &Unobserved).unwrap().displacement;
        let (plain, _) = equilibrium(&scene, &Unobserved).unwrap();
        let differs = asked.iter().zip(&plain.displacement).map(|(a, b)| (a - b).norm());
        assert!(differs.fold(0.0, f64::max) > 1e-3, "nothing is corrected");
        let mut after = block([4, 4, 2]);
        after.nodes.iter_mut().zip(&asked).for_each(|(node, u)| *node += u);
        after.nodes.iter_mut().for_each(|node| node.z += 0.5);
        sources.meshes.insert(format!("after {number}"), volume(after));
    }
    let found = done(JobInput::Learn(input), &sources).unwrap().0.result.learning.unwrap();
    let mechanics = found.table.iter().find(|own| own.name == "fem_linear").unwrap();
    assert!((mechanics.mean - 0.5).abs() < 1e-6, "{mechanics:?}");

    let told = ("/spec/cases/2/prediction".to_owned(), "method-mismatch".to_owned());
    for spec in [
        json!({"method": "auto"}),
        json!({"method": "fem_linear", "refine": {"accept_mm": 0.1}}),
        json!({"method": "fem_linear", "corrected": true}),
        json!({"method": "fem_linear", "element": "plain"}),
        json!({"method": "fem_linear", "contact": "none"}),
        json!({"method": "fem_linear", "membrane": {}}),
    ] {
        let (sources, mut input) = operated();
        input.cases[2].prediction.spec = serde_json::from_value(spec.clone()).unwrap();
        let fault = first_fault(done(JobInput::Learn(input), &sources).map(|_| ()));
        assert_eq!(fault, told, "{spec}");
    }
}

/// The same with a correction, and the codes of its warnings that speak of that.
fn asked_of_model(
    sources: &Sources,
    x: f64,
    change: &dyn Fn(&mut PredictInput),
) -> Result<(JobOutput, Vec<String>), JobError> {
    let mut input = prediction(x, linear());
    change(&mut input);
    input.spec.correction = Some(serde_json::from_value(json!({"model": "any"})).unwrap());
    let (output, _out) = done(JobInput::Predict(input), sources)?;
    let of_learning = [
        "learned-otherwise",
        "skin-unlike-learned",
        "nothing-to-correct",
        "correction-above-movement",
        "out-of-distribution",
    ];
    let codes = output.result.warnings.iter().map(|own| own.code.clone());
    let codes = codes.filter(|code| of_learning.contains(&code.as_str())).collect();
    Ok((output, codes))
}

#[test]
fn a_correction_is_added_to_predictions_of_the_kind_that_it_was_learned_from() {
    let (mut sources, input) = operated();
    let (_, out) = done(JobInput::Learn(input), &sources).unwrap();
    sources.model = std::fs::read(out.path().join("model.json")).unwrap();
    let at = ("/spec/correction/model".to_owned(), "method-mismatch".to_owned());
    for spec in [
        json!({"method": "fem_linear", "corrected": true}),
        json!({"method": "fem_linear", "refine": {"accept_mm": 0.1}}),
        json!({"method": "fem_linear", "element": "plain"}),
        json!({"method": "fem_linear", "contact": "none"}),
        json!({"method": "fem_linear", "membrane": {}}),
    ] {
        let other = |own: &mut PredictInput| {
            own.spec = serde_json::from_value(spec.clone()).unwrap();
        };
        let refused = asked_of_model(&sources, 2.5, &other);
        assert_eq!(first_fault(refused.map(|_| ())), at, "{spec}");
    }

    let codes =
        |x: f64, change: &dyn Fn(&mut PredictInput)| asked_of_model(&sources, x, change).unwrap().1;
    assert!(codes(2.5, &|_| ()).is_empty());
    let softer = |own: &mut PredictInput| {
        let materials = json!({"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.2}});
        own.spec.materials = Some(serde_json::from_value(materials).unwrap());
    };
    assert!(codes(2.5, &softer).contains(&"learned-otherwise".to_owned()));
    let grown = |own: &mut PredictInput| {
        own.plan.growth =
            serde_json::from_value(json!([{"region": "*", "volume_change": 0.001}])).unwrap();
    };
    assert!(codes(2.5, &grown).contains(&"learned-otherwise".to_owned()));
    // Other nodes are held than in all that was learned from.
    let mut model: Value = serde_json::from_slice(&sources.model).unwrap();
    for case in model["cases"].as_array_mut().unwrap() {
        case["mechanics"]["held"]["fixed"].as_array_mut().unwrap().pop();
    }
    let model = serde_json::to_vec(&model).unwrap();
    let others = Sources { meshes: sources.meshes.clone(), model };
    assert_eq!(asked_of_model(&others, 2.5, &|_| ()).unwrap().1, ["learned-otherwise"]);

    // Less than is added, and nothing at all.
    assert_eq!(codes(0.3, &|_| ()), ["correction-above-movement"]);
    let (output, told) = asked_of_model(&sources, 0.0, &|_| ()).unwrap();
    assert_eq!(told, ["nothing-to-correct"]);
    let correction = output.result.correction.unwrap();
    assert!(correction.refused.is_some() && correction.changed_mm.is_none());
    assert!(output.files.iter().all(|file| file.name != "corrected.vtp"));

    // The same cells, turned by a right angle.
    let mut turned = block([4, 4, 2]);
    turned.nodes.iter_mut().for_each(|node| *node = Vector::new(-node.y, node.x, node.z));
    sources.meshes.insert("block".to_owned(), volume(turned));
    let told = asked_of_model(&sources, 2.5, &|_| ()).unwrap().1;
    assert!(told.contains(&"skin-unlike-learned".to_owned()), "{told:?}");
}

#[test]
fn scans_of_before_the_operation_and_beside_the_case_are_suspected_with_their_place() {
    let told = |sources: &Sources, input: LearnInput| -> Vec<(String, String)> {
        let output = done(JobInput::Learn(input), sources).unwrap().0;
        let suspects = output.result.warnings.into_iter();
        let suspects = suspects.filter(|own| own.code != "learning-does-not-help");
        let place = |detail: &str| detail.split(' ').next().unwrap_or_default().to_owned();
        suspects.map(|own| (own.code, place(&own.detail))).collect()
    };
    let (sources, input) = operated();
    assert_eq!(told(&sources, input), []);
    let beside = |number: usize, _| match number {
        2 => Vector::new(60.0, 0.0, 0.0),
        _ => Vector::new(0.0, 0.0, 0.5),
    };
    let (mut sources, input) = operated_beside(&beside);
    sources.meshes.insert("after 3".to_owned(), volume(block([4, 4, 2])));
    let at = |code: &str, place: &str| (code.to_owned(), place.to_owned());
    let expected = [
        at("before-operation-suspect", "/spec/cases/2"),
        at("unregistered-suspect", "/spec/cases/1"),
    ];
    assert_eq!(told(&sources, input.clone()), expected);

    // What it corrects names the model and repeats them.
    let (_, out) = done(JobInput::Learn(input), &sources).unwrap();
    sources.model = std::fs::read(out.path().join("model.json")).unwrap();
    let spec = json!({"method": "fem_linear", "correction": {"model": "of a ward"}});
    let (output, _out) = done(JobInput::Predict(prediction(2.5, spec)), &sources).unwrap();
    let suspect = output.result.warnings.iter().find(|own| own.code == "model-suspect").unwrap();
    for word in ["\"of a ward\"", "/spec/cases/2 (3)", "before-operation-suspect, unregistered"] {
        assert!(suspect.detail.contains(word), "{suspect:?}");
    }
    assert_eq!(suspect.numbers["suspicions"], 2.0);
}

/// The half head of virtual patients as a case, with a plan that moves its jaw.
fn half_head_case(spec: Value) -> PredictInput {
    let document = json!({
        "case": {
            "schema": 1, "units": "mm", "frame": "LPS", "volume": "head", "skin": {"node_set": "skin"},
            "regions": {"array": "layer", "names": {"0": "other", "1": "muscle"}},
            "segments": [
                {"name": "maxilla", "nodes": {"node_set": "maxilla"}},
                {"name": "mandible", "nodes": {"node_set": "mandible"}}],
            "fixed": [{"node_set": "skull"}, {"node_set": "rim"}],
            "materials": {"*": {"young_modulus_kpa": 50, "poisson_ratio": 0.455},
                          "muscle": {"young_modulus_kpa": 300, "poisson_ratio": 0.44}},
        },
        "plan": {"segments": [{"name": "mandible", "translation_mm": [0, -3.5, 0.4]}]},
        "spec": spec, "job": null, "queue_s": null,
    });
    serde_json::from_value(document).unwrap()
}

#[test]
fn a_model_of_virtual_patients_corrects_the_kind_of_prediction_that_it_was_learned_from() {
    let made = json!({"virtual": {"patients": 4, "seed": 1, "fineness": 1}});
    let spec = serde_json::from_value(made).unwrap();
    let input = LearnInput { job: None, queue_s: None, spec, cohort: None, cases: Vec::new() };
    let mut head = half_head(1).mesh;
    for label in head.cell_labels.get_mut("layer").unwrap() {
        *label = i64::from(LAYERS[*label as usize] == "muscle");
    }
    let meshes = BTreeMap::from([("head".to_owned(), volume(head))]);
    let mut sources = Sources { meshes, model: Vec::new() };
    let (_, out) = done(JobInput::Learn(input), &sources).unwrap();
    sources.model = std::fs::read(out.path().join("model.json")).unwrap();
    let asked = |more: Value| {
        let mut spec = json!({"method": "fem_linear", "correction": {"model": "any"}});
        spec.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        done(JobInput::Predict(half_head_case(spec)), &sources)
    };
    let (output, _out) = asked(json!({})).unwrap();
    assert!(output.result.correction.is_some(), "{:?}", output.result.warnings);
    let codes: Vec<&str> = output.result.warnings.iter().map(|own| own.code.as_str()).collect();
    assert!(!codes.contains(&"learned-otherwise"), "{codes:?}");
    for other in
        [json!({"contact": "unilateral"}), json!({"element": "plain"}), json!({"corrected": true})]
    {
        let fault = first_fault(asked(other.clone()).map(|_| ()));
        let expected = ("/spec/correction/model".to_owned(), "method-mismatch".to_owned());
        assert_eq!(fault, expected, "{other}");
    }
    let soft = json!({"materials": {"muscle": {"young_modulus_kpa": 90}}});
    let (output, _out) = asked(soft).unwrap();
    assert!(output.result.warnings.iter().any(|own| own.code == "learned-otherwise"));
}
