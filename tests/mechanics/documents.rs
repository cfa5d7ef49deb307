//! The JSON documents: what is refused, where, and what becomes of what is accepted (BAD_INPUTS B).

use std::collections::BTreeMap;
use std::sync::Arc;

use facies::mesh::{CellShape, Frame, Vector, VolumeMesh};
use facies::prediction::{Load, Method, Plan, Prescribed};
use facies::schema::case::{CaseMeshes, NamedMesh};
use facies::schema::plan::PlanContext;
use facies::schema::spec::JobDocument;
use facies::schema::{
    CaseDocument, Faults, Limits, PlanDocument, Pointer, PredictDocument, Problem, canonical,
    strict,
};

fn parse<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, Problem> {
    strict::parse(text.as_bytes(), &Limits::default())
}

/// A plan for a case in LPS whose mesh has its centre at (0, -50, 0).
fn plan(text: &str) -> Result<Plan, Problem> {
    plan_in(Frame::Lps, text)
}

fn plan_in(frame: Frame, text: &str) -> Result<Plan, Problem> {
    let document: PlanDocument = parse(text)?;
    let limits = Limits::default();
    let context = PlanContext { frame, centre: Vector::new(0.0, -50.0, 0.0), limits: &limits };
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
    CaseMeshes { volume: NamedMesh { mesh: Arc::new(mesh), frame }, surfaces: BTreeMap::new() }
}

pub fn case_with(
    text: &str,
    spec: &str,
    mark: Option<Frame>,
) -> Result<(facies::prediction::Case, Vec<&'static str>), Problem> {
    let document: CaseDocument = parse(text)?;
    let spec: PredictDocument = parse(spec)?;
    let mut faults = Faults::default();
    let meshes = tetrahedron(mark);
    let limits = Limits::default();
    let (case, warnings) = document.to_case(&meshes, spec.materials.as_ref(), &limits, &mut faults);
    faults.into_result().map(|()| (case, warnings.iter().map(|warning| warning.code).collect()))
}

pub fn case(text: &str) -> Result<(facies::prediction::Case, Vec<&'static str>), Problem> {
    case_with(text, "{}", None)
}

/// The codes and places of a refusal.
fn method_of(document: &PredictDocument) -> Method {
    document.to_settings(&Limits::default(), &mut Faults::default()).method
}

pub fn refused<T>(result: Result<T, Problem>) -> (String, Vec<(String, String)>) {
    let problem = result.err().expect("the document is refused");
    let errors = problem.errors.into_iter().map(|error| (error.code, error.pointer));
    (problem.code.to_owned(), errors.collect())
}

pub fn one(code: &str, error: &str, pointer: &str) -> (String, Vec<(String, String)>) {
    (code.to_owned(), vec![(error.to_owned(), pointer.to_owned())])
}

fn matrix_plan(entries: [f64; 16]) -> String {
    format!(r#"{{"segments":[{{"name":"jaw","matrix4x4":{entries:?}}}]}}"#)
}

// Row 50.
#[test]
fn a_matrix_that_scales_shears_or_mirrors_is_not_rigid() {
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    assert!(plan(&matrix_plan(identity)).is_ok());
    for (entry, value) in [(0, 1.001), (1, 0.001), (0, -1.0), (12, 1.0), (15, 2.0), (0, 1e308)] {
        let mut matrix = identity;
        matrix[entry] = value;
        let problem = plan(&matrix_plan(matrix)).expect_err("refused");
        assert_eq!(problem.code, "plan-not-rigid", "{entry} {value}");
        assert_eq!(problem.errors[0].pointer, "/plan/segments/0/matrix4x4");
    }
}

// Row 50: the deviation is told.
#[test]
fn a_matrix_that_is_not_rigid_is_told_its_deviation() {
    let stretched =
        [1.001, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let problem = plan(&matrix_plan(stretched)).expect_err("refused");
    assert!(problem.detail.contains("2.001e-3"), "{}", problem.detail);
}

// Row 51.
#[test]
fn movements_beyond_the_published_limits_are_out_of_range() {
    let at = "/plan/segments/0";
    let out = "plan-out-of-range";
    for (movement, place) in [
        (r#""translation_mm":[500,0,0]"#, "/translation_mm"),
        (r#""translation_mm":[1e308,1e308,0]"#, "/translation_mm"),
        (r#""rotation_deg":[400,0,0],"pivot_mm":[0,0,0]"#, "/rotation_deg"),
        (r#""rotation_deg":[0,1e308,0],"pivot_mm":[0,0,0]"#, "/rotation_deg"),
        (r#""rotation_deg":[0,60,0],"pivot_mm":[500,0,0]"#, ""),
        (r#""matrix4x4":[1,0,0,1e308,0,1,0,0,0,0,1,0,0,0,0,1]"#, ""),
        (r#""matrix4x4":[-1,0,0,0,0,-1,0,0,0,0,1,0,0,0,0,1]"#, ""),
    ] {
        let text = format!(r#"{{"segments":[{{"name":"jaw",{movement}}}]}}"#);
        assert_eq!(refused(plan(&text)), one(out, out, &format!("{at}{place}")), "{movement}");
    }
}

// Row 51, through many small steps.
#[test]
fn a_sequence_may_not_go_where_one_movement_may_not() {
    let step = r#"{"translation_mm":[90,0,0]}"#;
    let text = format!(r#"{{"segments":[{{"name":"jaw","sequence":[{step},{step},{step}]}}]}}"#);
    let out = "plan-out-of-range";
    assert_eq!(refused(plan(&text)), one(out, out, "/plan/segments/0"));
}

// Row 52.
#[test]
fn what_is_not_a_number_is_refused_with_its_place() {
    for value in ["NaN", "Infinity", "1e999", "-1e999"] {
        let text = format!(r#"{{"segments":[{{"name":"jaw","translation_mm":[0,{value},0]}}]}}"#);
        let problem = plan(&text).expect_err("refused");
        assert_eq!(problem.code, "malformed-json");
        assert_eq!(problem.members["line"], 1);
        assert_eq!(problem.members["pointer"], "/segments/0/translation_mm/1", "{value}");
    }
    for value in ["null", "\"3\"", "[1]", "true"] {
        let text = format!(r#"{{"segments":[{{"name":"jaw","translation_mm":[0,{value},0]}}]}}"#);
        let place = "/segments/0/translation_mm/1";
        let wanted = one("validation-failed", "wrong-type", place);
        assert_eq!(refused(plan(&text)), wanted, "{value}");
    }
    for short in ["[0,0]", "[0,0,0,0]"] {
        let text = format!(r#"{{"segments":[{{"name":"jaw","translation_mm":{short}}}]}}"#);
        let wanted = one("validation-failed", "wrong-type", "/segments/0/translation_mm");
        assert_eq!(refused(plan(&text)), wanted, "{short}");
    }
}

#[test]
fn null_is_a_value_only_where_a_component_may_stay_free() {
    let text = r#"{"segments":[],"frame":null}"#;
    assert_eq!(refused(plan(text)), one("validation-failed", "null-value", "/frame"));
    let text = r#"{"prescribed":[{"nodes":{"node_set":"a"},"displacement_mm":[1,null,0]}]}"#;
    let Prescribed::Uniform { displacement, .. } = &plan(text).expect("accepted").prescribed[0]
    else {
        panic!("a uniform displacement");
    };
    assert_eq!(*displacement, [Some(1.0), None, Some(0.0)]);
}

// Row 53.
#[test]
fn every_misspelt_field_is_named() {
    let text = r#"{"segments":[{"name":"jaw","translation":[0,5,0]},{"name":"chin","tranlation_mm":[0,1,0]}]}"#;
    let (code, errors) = refused(plan(text));
    assert_eq!(code, "validation-failed");
    let unknown = |place: &str| ("unknown-field".to_owned(), place.to_owned());
    let wanted = [unknown("/segments/0/translation"), unknown("/segments/1/tranlation_mm")];
    assert_eq!(errors, wanted);
}

// Row 53: a segment without a movement is no movement by accident.
#[test]
fn a_segment_gives_exactly_one_form_of_movement() {
    for movement in [
        "",
        r#","translation_mm":[0,0,0],"matrix4x4":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"#,
        r#","translation_mm":[0,0,0],"sequence":[{"translation_mm":[1,0,0]}]"#,
    ] {
        let text = format!(r#"{{"segments":[{{"name":"jaw"{movement}}}]}}"#);
        let wanted = one("validation-failed", "one-of", "/plan/segments/0");
        assert_eq!(refused(plan(&text)), wanted, "{movement}");
    }
}

#[test]
fn a_rotation_needs_its_pivot() {
    let text = r#"{"segments":[{"name":"jaw","rotation_deg":[0,5,0]}]}"#;
    let wanted = one("validation-failed", "missing-field", "/plan/segments/0/pivot_mm");
    assert_eq!(refused(plan(text)), wanted);
    assert!(plan(r#"{"segments":[{"name":"jaw","rotation_deg":[0,0,0]}]}"#).is_ok());
}

// Row 54.
#[test]
fn a_repeated_key_is_refused_in_objects_and_in_maps() {
    let in_object = r#"{"segments":[{"name":"jaw","name":"chin","translation_mm":[0,0,0]}]}"#;
    let wanted = one("validation-failed", "duplicate-key", "/segments/0/name");
    assert_eq!(refused(plan(in_object)), wanted);
    let in_map =
        r#"{"materials":{"soft":{"young_modulus_kpa":15},"soft":{"young_modulus_kpa":30}}}"#;
    let wanted = one("validation-failed", "duplicate-key", "/materials/soft");
    assert_eq!(refused(settings(in_map)), wanted);
}

#[test]
fn pointers_escape_what_stands_in_names() {
    let text = r#"{"materials":{"a/b~c":{"young_modulus":1}}}"#;
    let place = "/materials/a~1b~0c/young_modulus";
    assert_eq!(refused(settings(text)), one("validation-failed", "unknown-field", place));
}

// Row 55.
#[test]
fn the_same_segment_twice_is_refused() {
    let text = r#"{"segments":[{"name":"jaw","translation_mm":[0,0,0]},{"name":" jaw ","translation_mm":[1,0,0]}]}"#;
    let wanted = one("validation-failed", "duplicate-name", "/plan/segments/1/name");
    assert_eq!(refused(plan(text)), wanted);
}

// Row 56.
#[test]
fn the_identity_in_every_form_displaces_by_exactly_nothing() {
    for movement in [
        r#""translation_mm":[0,0,0]"#,
        r#""rotation_deg":[0,0,0],"pivot_mm":[3,4,5]"#,
        r#""matrix4x4":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"#,
        r#""sequence":[{"translation_mm":[0,0,0]},{"rotation_deg":[0,0,0]}]"#,
    ] {
        let text = format!(r#"{{"segments":[{{"name":"jaw",{movement}}}]}}"#);
        let plan = plan(&text).expect("accepted");
        let point = Vector::new(12.3, -70.1, 33.3);
        assert_eq!(plan.segments[0].movement.displacement(&point), Vector::zeros(), "{movement}");
    }
}

// Row 58.
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

// Row 59.
#[test]
fn a_material_for_a_region_that_is_not_there_is_refused() {
    let text = r#"{"units":"mm","volume":"v","regions":{"array":"band","names":{"1":"stiff"}},
        "materials":{"*":{"young_modulus_kpa":1,"poisson_ratio":0.3},"soft":{"young_modulus_kpa":1,"poisson_ratio":0.3}}}"#;
    let wanted = one("validation-failed", "unknown-region", "/case/materials/soft");
    assert_eq!(refused(case(text)), wanted);
}

// Row 60.
#[test]
fn muscle_activation_is_not_a_field_yet() {
    let text = r#"{"segments":[],"muscle_activation":{"masseter_l":1.5}}"#;
    let wanted = one("validation-failed", "unknown-field", "/muscle_activation");
    assert_eq!(refused(plan(text)), wanted);
}

// Row 61.
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

// Row 62.
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

// Row 75.
#[test]
fn what_is_not_json_is_refused_with_line_and_column() {
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let utf16: Vec<u8> = "{}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let bodies: [&[u8]; 8] = [
        deep.as_bytes(),
        &utf16,
        b"\xef\xbb\xbf{}",
        b"{\"frame\":\"\xff\"}",
        br#"{"name":"\ud800"}"#,
        b"{} {}",
        b"",
        b"{\"a\":1,}",
    ];
    for body in bodies {
        let result: Result<PlanDocument, _> = strict::parse(body, &Limits::default());
        let problem = result.expect_err("refused");
        assert_eq!(problem.code, "malformed-json");
        assert!(problem.members.contains_key("line") && problem.members.contains_key("column"));
    }
}

#[test]
fn thirty_two_levels_are_read_and_thirty_three_are_not() {
    let nested = |levels: usize| format!("{}{}", "[".repeat(levels), "]".repeat(levels));
    let limits = Limits::default();
    assert!(strict::parse_value(nested(32).as_bytes(), &limits).is_ok());
    let problem = strict::parse_value(nested(33).as_bytes(), &limits).expect_err("refused");
    assert!(problem.detail.contains("deeper than 32 levels"), "{}", problem.detail);
}

#[test]
fn the_place_of_a_byte_that_is_not_utf8_is_told() {
    let problem = strict::parse_value(b"{\n \"a\":\"\xff\"}", &Limits::default()).expect_err("no");
    assert_eq!((&problem.members["line"], &problem.members["column"]), (&2.into(), &7.into()));
}

#[test]
fn a_body_larger_than_a_mebibyte_is_not_read() {
    let body = format!("{{\"a\":\"{}\"}}", "x".repeat(1 << 20));
    let problem = strict::parse_value(body.as_bytes(), &Limits::default()).expect_err("refused");
    assert_eq!((problem.code, &problem.members["limit"]), ("payload-too-large", &1_048_576.into()));
}

#[test]
fn a_plan_in_the_other_frame_moves_the_same_bone_the_same_way() {
    let lps = r#"{"frame":"LPS","segments":[{"name":"jaw","translation_mm":[1,-5,2],"rotation_deg":[3,4,5],"pivot_mm":[10,20,30]}],
        "prescribed":[{"nodes":{"node_set":"a"},"displacement_mm":[1,null,2]}],
        "loads":[{"force_mn":[1,2,3],"nodes":{"node_set":"a"}},{"gravity_m_per_s2":[0,9.81,1]}]}"#;
    let (there, here) = (plan_in(Frame::Ras, lps).expect("ok"), plan(lps).expect("ok"));
    let flip = |v: Vector| Vector::new(-v.x, -v.y, v.z);
    let point = Vector::new(12.0, -70.0, 33.0);
    let moved = there.segments[0].movement.displacement(&flip(point));
    let wanted = flip(here.segments[0].movement.displacement(&point));
    assert!((moved - wanted).norm() < 1e-12, "rounding of one rotation");
    let Prescribed::Uniform { displacement, .. } = &there.prescribed[0] else {
        panic!("a uniform displacement");
    };
    assert_eq!(*displacement, [Some(-1.0), None, Some(2.0)]);
    let Load::Force { force, .. } = &there.loads[0] else { panic!("a force") };
    assert_eq!(*force, Vector::new(-1.0, -2.0, 3.0));
    let Load::Gravity { acceleration } = &there.loads[1] else { panic!("gravity") };
    // 9.81 m/s² is 0.00981 mm/ms².
    assert!((acceleration - Vector::new(0.0, -0.00981, 0.001)).norm() < 1e-15);
}

#[test]
fn a_stated_and_an_unspecified_frame_are_in_conflict() {
    let stated = r#"{"frame":"LPS"}"#;
    let open = r#"{"frame":"unspecified"}"#;
    let wanted = one("frame-conflict", "frame-conflict", "/plan/frame");
    assert_eq!(refused(plan_in(Frame::Unspecified, stated)), wanted);
    assert_eq!(refused(plan_in(Frame::Lps, open)), wanted);
    for frame in [Frame::Unspecified, Frame::Ras] {
        assert!(plan_in(frame, "{}").is_ok(), "no frame means that of the case");
    }
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
fn everything_wrong_is_told_at_once() {
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
fn at_most_fifty_mistakes_are_listed_and_all_are_counted() {
    let segment = r#"{"name":"","translation_mm":[0,0,0]}"#;
    let text = format!(r#"{{"segments":[{}]}}"#, [segment; 60].join(","));
    let problem = plan(&text).expect_err("refused");
    assert_eq!(problem.errors.len(), 50);
    // Sixty names too short, fifty-nine of them repeated.
    assert!(problem.detail.starts_with("119 mistakes"), "{}", problem.detail);
}

#[test]
fn methods_that_are_not_built_are_refused_by_name() {
    let code = "method-not-available";
    for name in ["fem_corotational", "fem_neo_hookean", "fem_ogden", "fem_rubin_bodner"] {
        let text = format!(r#"{{"method":"{name}"}}"#);
        assert_eq!(refused(settings(&text)), one(code, code, "/spec/method"), "{name}");
    }
    let misspelt = settings(r#"{"method":"fem"}"#);
    assert_eq!(refused(misspelt), one("validation-failed", "unknown-word", "/method"));
}

#[test]
fn a_volume_spline_is_told_in_seconds_and_newtons_per_metre() {
    use facies::model::spline::stepping::{Clock, Damping, Scheme};
    use facies::model::spline::{Stiffness, VolumeSpline};
    let method = |text: &str| method_of(&settings(text).unwrap());
    let usual = Method::VolumeSpline(VolumeSpline::default());
    assert_eq!(method(r#"{"method":"dvs"}"#), usual);
    assert_eq!(method(r#"{"method":"dvs","dvs":{}}"#), usual);
    let lattice = r#"{"method":"dvs","dvs":{"stiffness":"lattice","degree":2,"control_spacing_mm":5,
        "damping_n_s_per_m":4,"stepping":"newmark","step_s":0.002,"hold_weight":20}}"#;
    let stated = VolumeSpline {
        degree: 2,
        control_spacing: Some(5.0),
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
        (r#"{"method":"dvs","element":"plain"}"#, mismatch, "/spec/element"),
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
    use facies::model::thickness_warp::ThicknessWarp;
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
fn a_job_is_told_apart_by_its_kind() {
    let parse = |text: &str| JobDocument::parse(text.as_bytes(), &Limits::default());
    let predict = parse(r#"{"kind":"predict","case":"c","plan":{}}"#);
    assert!(matches!(predict, Ok(JobDocument::Predict(_))));
    let compare = parse(r#"{"kind":"compare","prediction":{"mesh":"a"},"actual":{"mesh":"b"}}"#);
    assert!(matches!(compare, Ok(JobDocument::Compare(_))));
    let failed = "validation-failed";
    assert_eq!(refused(parse("{}")), one(failed, "missing-field", "/kind"));
    assert_eq!(refused(parse(r#"{"kind":"x"}"#)), one(failed, "unknown-word", "/kind"));
    assert_eq!(refused(parse(r#"{"kind":5}"#)), one(failed, "wrong-type", "/kind"));
    assert_eq!(refused(parse("[]")), one(failed, "missing-field", "/kind"));
    let both = parse(r#"{"kind":"predict","case":"c","plan":{},"plan_id":"p"}"#);
    assert_eq!(refused(both), one(failed, "one-of", ""));
}

fn hash(case: &str, plan: &str, spec: &str) -> String {
    let (case, plan): (CaseDocument, PlanDocument) =
        (parse(case).expect("a case"), parse(plan).expect("a plan"));
    let spec = parse(spec).expect("a spec");
    canonical::predict_hash(&case, &plan, &spec, &|id| (id != "x").then(|| format!("sha of {id}")))
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
        "sliding":[{"nodes":{"node_set":"a"},"normal":[0,0,1]},{"nodes":{"node_set":"b"},"normal":"surface"}]}"#;
    let case: CaseDocument = parse(text).expect("accepted");
    let again: CaseDocument = parse(&canonical::to_value(&case).to_string()).expect("accepted");
    assert_eq!(case, again);
}
