//! The JSON documents: what is refused, where, and what becomes of what is accepted.

use std::collections::BTreeMap;
use std::sync::Arc;

use facies::jobs::{MeshSize, StoredShape};
use facies::schema::case::conversion::ConvertedCase;
use facies::schema::case::document::{CaseMeshes, NamedMesh};
use facies::schema::cohort::stored::StoredCohortDocument;
use facies::schema::hashes;
use facies::schema::job_document::{JobDocument, JobKind};
use facies::schema::plan::document::PlanContext;
use facies::schema::wire::{canonical, strict};
use facies::schema::{
    CaseDocument, CohortDocument, Faults, Limits, PlanDocument, Pointer, PredictDocument, Problem,
    StudyDocument,
};
use mechanics::mesh::{CellShape, Frame, Vector, VolumeMesh};
use mechanics::prediction::{Method, Plan};
use serde_json::json;

pub fn parse<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, Problem> {
    strict::parse(text.as_bytes(), &Limits::default())
}

/// A plan for a case in LPS whose mesh has its centre at (0, -50, 0).
pub fn plan(text: &str) -> Result<Plan, Problem> {
    plan_in(Frame::Lps, text)
}

pub fn plan_in(frame: Frame, text: &str) -> Result<Plan, Problem> {
    let document: PlanDocument = parse(text)?;
    let limits = Limits::default();
    let context =
        PlanContext { frame, centre: Some(Vector::new(0.0, -50.0, 0.0)), limits: &limits };
    let mut faults = Faults::default();
    let plan = document.to_plan(&Pointer::root().key("plan"), &context, &mut faults);
    faults.into_result().map(|()| plan)
}

pub fn settings(text: &str) -> Result<PredictDocument, Problem> {
    let document: PredictDocument = parse(text)?;
    let mut faults = Faults::default();
    document.to_settings(&Limits::default(), &mut faults);
    faults.into_result().map(|()| document)
}

/// One tetrahedron of 100 mm with a cell array `band` of the value 1.
fn tetrahedron(frame: Option<Frame>) -> CaseMeshes {
    let mut mesh = VolumeMesh {
        nodes: vec![Vector::zeros(), Vector::x() * 100.0, Vector::y() * 100.0, Vector::z() * 100.0],
        ..VolumeMesh::default()
    };
    mesh.cells.push(CellShape::Tet4, &[0, 1, 2, 3]);
    mesh.cell_labels.insert("band".to_owned(), vec![1]);
    CaseMeshes {
        volume: NamedMesh { mesh: Arc::new(mesh), frame },
        surfaces: BTreeMap::new(),
        image: None,
    }
}

pub fn case_with(
    text: &str,
    spec: &str,
    mark: Option<Frame>,
) -> Result<(mechanics::prediction::Case, Vec<&'static str>), Problem> {
    let document: CaseDocument = parse(text)?;
    let spec: PredictDocument = parse(spec)?;
    let mut faults = Faults::default();
    let meshes = tetrahedron(mark);
    let limits = Limits::default();
    let converted = document.to_case(&meshes, spec.materials.as_ref(), &limits, &mut faults);
    let ConvertedCase { case, warnings, .. } = converted;
    faults.into_result().map(|()| (case, warnings.iter().map(|warning| warning.code).collect()))
}

pub fn case(text: &str) -> Result<(mechanics::prediction::Case, Vec<&'static str>), Problem> {
    case_with(text, "{}", None)
}

fn method_of(document: &PredictDocument) -> Method {
    document.to_settings(&Limits::default(), &mut Faults::default()).method
}

/// The codes and places of a refusal.
pub fn refused<T>(result: Result<T, Problem>) -> (String, Vec<(String, String)>) {
    let problem = result.err().expect("the document is refused");
    let errors =
        problem.errors.into_iter().map(|error| (error.code.name().to_owned(), error.pointer));
    (problem.code.name().to_owned(), errors.collect())
}

pub fn one(code: &str, error: &str, pointer: &str) -> (String, Vec<(String, String)>) {
    (code.to_owned(), vec![(error.to_owned(), pointer.to_owned())])
}

#[test]
fn constants_outside_their_ranges_are_refused() {
    for (field, value) in [
        ("poisson_ratio", "0.5"),
        ("poisson_ratio", "-1"),
        ("young_modulus_kpa", "0"),
        ("young_modulus_kpa", "1e20"),
        ("density_g_per_cm3", "-1"),
    ] {
        let spec = format!(r#"{{"materials":{{"*":{{"{field}":{value}}}}}}}"#);
        let result = case_with(r#"{"units":"mm","volume":"v"}"#, &spec, None);
        let place = format!("/spec/materials/*/{field}");
        assert_eq!(refused(result), one("validation-failed", "out-of-range", &place), "{value}");
    }
}

#[test]
fn a_material_for_a_region_that_is_not_there_is_refused() {
    let text = r#"{"units":"mm","volume":"v","regions":{"array":"band","names":{"1":"stiff"}},
        "materials":{"*":{"young_modulus_kpa":1,"poisson_ratio":0.3},"soft":{"young_modulus_kpa":1,"poisson_ratio":0.3}}}"#;
    let wanted = one("validation-failed", "unknown-region", "/case/materials/soft");
    assert_eq!(refused(case(text)), wanted);
}

#[test]
fn muscle_activation_is_not_a_field_yet() {
    let text = r#"{"segments":[],"muscle_activation":{"masseter_l":1.5}}"#;
    let wanted = one("validation-failed", "unknown-field", "/muscle_activation");
    assert_eq!(refused(plan(text)), wanted);
}

#[test]
fn tolerances_and_budgets_outside_their_ranges_are_refused() {
    for (spec, place) in [
        (r#"{"tolerance":{"relative_residual":0}}"#, "/spec/tolerance/relative_residual"),
        (r#"{"tolerance":{"relative_residual":1e-300}}"#, "/spec/tolerance/relative_residual"),
        (r#"{"tolerance":{"relative_residual":0.1}}"#, "/spec/tolerance/relative_residual"),
        (r#"{"budget":{"wall_s":0}}"#, "/spec/budget/wall_s"),
        (r#"{"budget":{"memory_mb":0}}"#, "/spec/budget/memory_mb"),
    ] {
        let wanted = one("validation-failed", "out-of-range", place);
        assert_eq!(refused(settings(spec)), wanted, "{spec}");
    }
    let steps = one("validation-failed", "unknown-field", "/steps");
    assert_eq!(refused(settings(r#"{"steps":1e9}"#)), steps);
}

#[test]
fn outputs_are_known_names_only() {
    for name in ["../../x", "skin.fbx", "/etc/passwd"] {
        let text = format!(r#"{{"outputs":["skin.vtp","{name}"]}}"#);
        let wanted = one("validation-failed", "unknown-word", "/outputs/1");
        assert_eq!(refused(settings(&text)), wanted, "{name}");
    }
    let document = settings(r#"{"outputs":["skin.stl","skin.stl"]}"#).expect("accepted");
    let names: Vec<_> = document.files().iter().map(|file| file.file_name()).collect();
    assert_eq!(names, ["skin.stl", "result.json"]);
}

#[test]
fn a_file_marked_with_another_frame_is_in_conflict_with_the_case() {
    let text = r#"{"units":"mm","volume":"v","frame":"LPS"}"#;
    let wanted = one("frame-conflict", "frame-conflict", "/case/frame");
    assert_eq!(refused(case_with(text, "{}", Some(Frame::Ras))), wanted);
    assert!(case_with(text, "{}", Some(Frame::Lps)).is_ok());
}

#[test]
fn lengths_become_millimetres() {
    for (units, factor) in [("mm", 1.0), ("m", 1000.0), ("um", 0.001)] {
        let text = format!(r#"{{"units":"{units}","volume":"v"}}"#);
        let (case, warnings) = case(&text).expect("accepted");
        assert_eq!(case.volume.nodes[1].x, 100.0 * factor);
        assert_eq!(warnings.contains(&"units-suspect"), units != "mm", "{units}");
    }
}

#[test]
fn the_size_of_a_mesh_is_that_of_its_cells() {
    let mut meshes = tetrahedron(None);
    Arc::make_mut(&mut meshes.volume.mesh).nodes.push(Vector::x() * 9000.0);
    assert_eq!(meshes.volume.mesh.bounds()[1], Vector::repeat(100.0));
    let document: CaseDocument = parse(r#"{"units":"mm","volume":"v"}"#).expect("accepted");
    let size = MeshSize::of(&StoredShape::Volume(meshes.volume.mesh), document.units);
    assert!(size.check(false).is_ok_and(|warning| warning.is_none()));
}

#[test]
fn a_value_of_a_region_is_named_once() {
    let text = r#"{"units":"mm","volume":"v","regions":{"array":"band","names":{"1":"stiff","01":"soft"}}}"#;
    let (code, errors) = refused(case(text));
    assert_eq!((code.as_str(), errors.len()), ("validation-failed", 1));
    assert_eq!(errors[0].0, "duplicate-name");
    assert!(errors[0].1.starts_with("/case/regions/names/"), "{errors:?}");
}

#[test]
fn a_value_is_swept_once() {
    let text = r#"{"kind":"study","scenes":["slab"],"plans":["patch 4 mm"],"sweep":{"*":{"young_modulus_kpa":[15,30,15.0]}}}"#;
    let document: StudyDocument = parse(text).expect("accepted");
    let mut faults = Faults::default();
    document.check(&Limits::default(), &mut faults);
    let wanted = one("validation-failed", "duplicate-name", "/spec/sweep/*/young_modulus_kpa/2");
    assert_eq!(refused(faults.into_result()), wanted);
}

#[test]
fn names_of_patients_differ_in_more_than_spaces_around_them() {
    let member = |name: &str| json!({"prediction": name, "actual": name, "name": name});
    let members = ["A", "B", " A"].map(member);
    let consent = json!({"statement": "form 4", "uses": ["learn"]});
    let cohort = json!({"name": "blocks", "consent": consent, "members": members});
    let stored: StoredCohortDocument = parse(&cohort.to_string()).expect("accepted");
    let mut faults = Faults::default();
    stored.check(&Limits::default(), &mut faults);
    let (_, errors) = refused(faults.into_result());
    assert!(errors.contains(&("duplicate-name".to_owned(), "/members/2/name".to_owned())));
    let groups = json!({"kind": "cohort", "groups": {"dvs": ["a"], "dvs ": ["b"]}});
    let document: CohortDocument = parse(&groups.to_string()).expect("accepted");
    let mut faults = Faults::default();
    document.check(&Limits::default(), &mut faults);
    let (_, errors) = refused(faults.into_result());
    assert_eq!(errors, [("duplicate-name".to_owned(), "/spec/groups/dvs ".to_owned())]);
}

#[test]
fn a_star_of_the_spec_that_no_region_is_left_for_says_so() {
    let star = r#"{"materials":{"*":{"young_modulus_kpa":15000,"poisson_ratio":0.3}}}"#;
    let warned = |case: &str, spec: &str| {
        let (_, warnings) = case_with(case, spec, None).expect("accepted");
        warnings.contains(&"material-serves-nothing")
    };
    let own = r#"{"units":"mm","volume":"v","materials":{"tissue":{"young_modulus_kpa":15,"poisson_ratio":0.46}}}"#;
    assert!(warned(own, star));
    let all = r#"{"units":"mm","volume":"v","materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.46}}}"#;
    assert!(!warned(all, star));
    assert!(!warned(own, "{}"));
}

#[test]
fn a_case_without_materials_has_the_default_one_and_says_so() {
    let (case, warnings) = case(r#"{"units":"mm","volume":"v"}"#).expect("accepted");
    assert_eq!(warnings, ["default-material"]);
    let tissue = case.materials["*"];
    let constants = (tissue.young_modulus(), tissue.poisson_ratio(), tissue.density());
    assert_eq!(constants, (15.0, 0.46, 1.0));
}

#[test]
fn a_spec_changes_materials_field_by_field() {
    let text = r#"{"units":"mm","volume":"v","regions":{"array":"band"},
        "materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.4},"1":{"young_modulus_kpa":30,"poisson_ratio":0.3,"density_g_per_cm3":1.1}}}"#;
    let spec = r#"{"materials":{"1":{"poisson_ratio":0.45},"*":{"young_modulus_kpa":20}}}"#;
    let (case, _) = case_with(text, spec, None).expect("accepted");
    let of = |name: &str| {
        let material = case.materials[name];
        (material.young_modulus(), material.poisson_ratio(), material.density())
    };
    assert_eq!(of("1"), (30.0, 0.45, 1.1));
    assert_eq!(of("*"), (20.0, 0.4, 1.0));
}

#[test]
fn half_a_material_of_a_case_is_refused() {
    let text = r#"{"units":"mm","volume":"v","materials":{"*":{"young_modulus_kpa":15}}}"#;
    let wanted = one("validation-failed", "missing-field", "/case/materials/*/poisson_ratio");
    assert_eq!(refused(case(text)), wanted);
}

#[test]
fn a_selection_is_exactly_one_form() {
    for skin in [
        "{}",
        r#"{"node_set":"a","array":"b","value":1}"#,
        r#"{"any":[{"node_set":"a"}],"surface":"s","within_mm":1}"#,
    ] {
        let text = format!(r#"{{"units":"mm","volume":"v","skin":{skin}}}"#);
        assert_eq!(
            refused(case(&text)),
            one("validation-failed", "one-of", "/case/skin"),
            "{skin}"
        );
    }
}

#[test]
fn everything_wrong_is_reported_at_once() {
    let text = r#"{"schema":2,"units":"mm","volume":"v","name":"","segments":[{"name":"a","nodes":{}}],
        "sliding":[{"nodes":{"node_set":"s"},"normal":[0,0,0]}],"fixed":[{"surface":"s","within_mm":-1}]}"#;
    let (_, errors) = refused(case(text));
    let mut places: Vec<_> = errors.into_iter().map(|(_, pointer)| pointer).collect();
    places.sort();
    let wanted = [
        "/case/fixed/0/within_mm",
        "/case/name",
        "/case/schema",
        "/case/segments/0/nodes",
        "/case/sliding/0/normal",
    ];
    assert_eq!(places, wanted);
}

#[test]
fn methods_that_are_not_built_are_refused_by_name() {
    let code = "method-not-available";
    for name in ["fem_corotational", "fem_neo_hookean", "fem_ogden", "fem_rubin_bodner"] {
        let text = format!(r#"{{"method":"{name}"}}"#);
        assert_eq!(refused(settings(&text)), one(code, code, "/method"), "{name}");
    }
    let misspelt = settings(r#"{"method":"fem"}"#);
    assert_eq!(refused(misspelt), one("validation-failed", "unknown-word", "/method"));
}

#[test]
fn a_volume_spline_is_reported_in_seconds_and_newtons_per_metre() {
    use mechanics::model::spline::stepping::{Clock, Damping, Scheme};
    use mechanics::model::spline::{Bone, ControlPoints, Stiffness, VolumeSpline};
    let method = |text: &str| method_of(&settings(text).unwrap());
    let usual = Method::VolumeSpline(VolumeSpline::default());
    assert_eq!(method(r#"{"method":"dvs"}"#), usual);
    assert_eq!(method(r#"{"method":"dvs","dvs":{}}"#), usual);
    let lattice = r#"{"method":"dvs","dvs":{"stiffness":"lattice","degree":2,"control_spacing_mm":5,
        "damping_n_s_per_m":4,"stepping":"newmark","step_s":0.002,"hold_weight":20}}"#;
    let stated = VolumeSpline {
        degrees: [2; 3],
        control: ControlPoints::Spaced(5.0),
        bone: Bone::Springs,
        hold_weight: 20.0,
        stiffness: Stiffness::Lattice(80.0),
        damping: Damping { mass: 0.0, stiffness: 50.0 },
        clock: Some(Clock { scheme: Scheme::Newmark, step: 2.0, end: 10_000.0 }),
    };
    assert_eq!(method(lattice), Method::VolumeSpline(stated));

    let mismatch = "method-mismatch";
    for (text, code, at) in [
        (r#"{"dvs":{}}"#, mismatch, "/spec/dvs"),
        (r#"{"method":"dvs","thickness_warp":{}}"#, mismatch, "/spec/thickness_warp"),
        (r#"{"method":"dvs","dvs":{"step_s":0.1}}"#, mismatch, "/spec/dvs/step_s"),
        (
            r#"{"method":"dvs","dvs":{"stiffness_n_per_m":9}}"#,
            mismatch,
            "/spec/dvs/stiffness_n_per_m",
        ),
        (r#"{"method":"dvs","dvs":{"degree":4}}"#, "out-of-range", "/spec/dvs/degree"),
        (r#"{"method":"dvs","dvs":{"hold_weight":0}}"#, "out-of-range", "/spec/dvs/hold_weight"),
        (
            r#"{"method":"dvs","dvs":{"stepping":"explicit","step_s":1e-6}}"#,
            "out-of-range",
            "/spec/dvs/step_s",
        ),
    ] {
        let whole = if code == mismatch { mismatch } else { "validation-failed" };
        assert_eq!(refused(settings(text)), one(whole, code, at), "{text}");
    }
}

#[test]
fn a_warp_is_told_its_blend_radius_alone() {
    use mechanics::model::thickness_warp::ThicknessWarp;
    let text = r#"{"method":"thickness_warp","thickness_warp":{"blend_radius_mm":12}}"#;
    let stated = Method::ThicknessWarp(ThicknessWarp { blend_radius: 12.0 });
    assert_eq!(method_of(&settings(text).unwrap()), stated);
    let far = r#"{"method":"thickness_warp","thickness_warp":{"blend_radius_mm":-1}}"#;
    let at = "/spec/thickness_warp/blend_radius_mm";
    assert_eq!(refused(settings(far)), one("validation-failed", "out-of-range", at));
    let unused = refused(settings(r#"{"thickness_warp":{}}"#));
    assert_eq!(unused, one("method-mismatch", "method-mismatch", "/spec/thickness_warp"));
}

#[test]
fn a_job_is_distinguished_by_its_kind() {
    let parse = |text: &str| JobDocument::parse(text.as_bytes(), &Limits::default());
    let predict = parse(r#"{"kind":"predict","case":"c","plan":{}}"#);
    assert!(matches!(predict, Ok(JobDocument::Predict(_))));
    let compare = parse(r#"{"kind":"compare","prediction":{"mesh":"a"},"actual":{"mesh":"b"}}"#);
    assert!(matches!(compare, Ok(JobDocument::Compare(_))));
    let failed = "validation-failed";
    assert_eq!(refused(parse("{}")), one(failed, "missing-field", "/kind"));
    assert_eq!(refused(parse(r#"{"kind":"x"}"#)), one(failed, "unknown-word", "/kind"));
    assert_eq!(refused(parse(r#"{"kind":5}"#)), one(failed, "wrong-type", "/kind"));
    assert_eq!(refused(parse("[]")), one(failed, "wrong-type", ""));
    let both = parse(r#"{"kind":"predict","case":"c","plan":{},"plan_id":"p"}"#);
    assert_eq!(refused(both), one(failed, "one-of", ""));
}

#[test]
fn an_error_about_the_kind_of_a_job_lists_every_kind() {
    let detail = |text: &str| {
        let problem = JobDocument::parse(text.as_bytes(), &Limits::default()).unwrap_err();
        problem.errors[0].detail.clone()
    };
    assert_eq!(
        detail("{}"),
        "missing field `kind`: `predict`, `compare`, `response`, `optimise`, `reproduce`, `cohort`, `learn`, `conform`, `mesh`, `study` or `batch`"
    );
    assert_eq!(
        detail(r#"{"kind":"x"}"#),
        "`x` is not a kind of job; `predict`, `compare`, `response`, `optimise`, `reproduce`, `cohort`, `learn`, `conform`, `mesh`, `study` and `batch` are"
    );
}

#[test]
fn a_kind_of_job_is_stored_by_the_word_that_clients_send() {
    for kind in JobKind::ALL {
        assert_eq!(canonical::to_value(kind), kind.name());
        assert_eq!(JobKind::from_name(kind.name()), Some(*kind));
    }
    assert_eq!(JobKind::from_name("meshes"), None);
}

fn hash(case: &str, plan: &str, spec: &str) -> String {
    let (case, plan): (CaseDocument, PlanDocument) =
        (parse(case).expect("a case"), parse(plan).expect("a plan"));
    let spec = parse(spec).expect("a spec");
    hashes::predict_hash(&case, &plan, &spec, &|id| (id != "x").then(|| format!("sha of {id}")))
}

#[test]
fn the_hash_of_a_job_depends_on_what_decides_its_numbers_and_on_nothing_else() {
    let case = r#"{"units":"mm","volume":"v","name":"A17","tags":["a"]}"#;
    let spec = r#"{"method":"auto"}"#;
    let plan = r#"{"segments":[{"name":"jaw","translation_mm":[1,0,0]}]}"#;
    let first = hash(case, plan, spec);
    let renamed = r#"{"volume":"v","units":"mm","frame":"unspecified","name":"B"}"#;
    let rewritten = r#"{"segments":[{"translation_mm":[1.0,0e3,0],"name":"jaw"}]}"#;
    assert_eq!(hash(renamed, rewritten, r#"{"tags":["t"],"case":"id"}"#), first);
    let other_plan = r#"{"segments":[{"name":"jaw","translation_mm":[1,0,1e-9]}]}"#;
    assert_ne!(hash(case, other_plan, spec), first);
    assert_ne!(hash(r#"{"units":"m","volume":"v"}"#, plan, spec), first);
    assert_ne!(hash(r#"{"units":"mm","volume":"w"}"#, plan, spec), first);
    assert_ne!(hash(case, plan, r#"{"element":"plain"}"#), first);
}

#[test]
fn documents_survive_being_written_and_read() {
    let text = r#"{"units":"mm","volume":"v","landmarks":{"pogonion":[0,-70,-40]},"skin":{"node_set":"s"},
        "sliding":[{"nodes":{"node_set":"a"},"normal":[0,0,1]},{"nodes":{"node_set":"b"},"normal":"surface","segment":"jaw"}],
        "allow_unfixed":true}"#;
    let case: CaseDocument = parse(text).expect("accepted");
    let again: CaseDocument = parse(&canonical::to_value(&case).to_string()).expect("accepted");
    assert_eq!(case, again);
}

#[test]
fn a_volume_spline_is_told_its_degrees_and_control_points_axis_by_axis() {
    use mechanics::model::spline::{Bone, ControlPoints, VolumeSpline};
    let method = |text: &str| method_of(&settings(text).unwrap());
    let of_the_paper = r#"{"method":"dvs","dvs":{"degrees":[3,3,1],"control_points":[5,5,2],"bone":"control_points"}}"#;
    let stated = VolumeSpline {
        degrees: [3, 3, 1],
        control: ControlPoints::Counted([5, 5, 2]),
        bone: Bone::ControlPoints,
        ..VolumeSpline::default()
    };
    assert_eq!(method(of_the_paper), Method::VolumeSpline(stated));
    let mismatch = "method-mismatch";
    for (text, code, at) in [
        (
            r#"{"method":"dvs","dvs":{"bone":"control_points","stepping":"newmark"}}"#,
            mismatch,
            "/spec/dvs/bone",
        ),
        (
            r#"{"method":"dvs","dvs":{"degrees":[3,3,1],"control_points":[5,3,2]}}"#,
            "out-of-range",
            "/spec/dvs/control_points/1",
        ),
        (r#"{"method":"dvs","dvs":{"degrees":[3,0,1]}}"#, "out-of-range", "/spec/dvs/degrees/1"),
        (
            r#"{"method":"dvs","dvs":{"control_points":[5,5,4],"control_spacing_mm":5}}"#,
            "one-of",
            "/spec/dvs",
        ),
    ] {
        let whole = if code == mismatch { mismatch } else { "validation-failed" };
        assert_eq!(refused(settings(text)), one(whole, code, at), "{text}");
    }
}
