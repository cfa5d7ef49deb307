//! From a job document to result files, without a server: what a job writes, and how it ends when it cannot.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::stop_at::StopAt;
use facies::jobs::{
    CompareInput, JobContext, JobError, JobInput, JobOutput, MeshSource, PredictInput, SourceError,
    StoredMesh, StoredShape, work,
};
use facies::schema::case::document::LengthUnit;
use facies::schema::job::ErrorClass;
use facies::schema::predict::result::ResultDocument;
use facies::schema::{CaseDocument, CompareDocument, Limits, PlanDocument, PredictDocument};
use mechanics::format::{self, Mesh, ReadLimits};
use mechanics::mesh::{CellShape, Frame, TriangleSurface, Vector, VolumeMesh, sample};
use mechanics::progress::{Phase, Progress, Unobserved};

/// Meshes held in memory.
pub struct Meshes(BTreeMap<&'static str, StoredMesh>);

impl MeshSource for Meshes {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        self.0.get(id).cloned().ok_or_else(|| SourceError::Unknown { id: id.to_owned() })
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        self.mesh(job)
    }
}

fn stored(shape: StoredShape, sha256: &str) -> StoredMesh {
    StoredMesh {
        shape,
        of_points: Default::default(),
        frame: None,
        units: Some(LengthUnit::Mm),
        warnings: Vec::new(),
        told: Vec::new(),
        sha256: sha256.to_owned(),
        identity: sha256.to_owned(),
    }
}

/// A block of 80 x 60 x 40 in some unit: held at z = 0, skin at z = 40.
fn block(factor: f64) -> VolumeMesh {
    sample::block(Vector::new(80.0, 60.0, 40.0) * factor, [4, 3, 2], CellShape::Tet4)
}

/// The same block of hexahedra.
fn bricks() -> VolumeMesh {
    sample::block(Vector::new(80.0, 60.0, 40.0), [4, 3, 2], CellShape::Hex8)
}

/// A triangle of bone, shared by the tests that need one.
fn plate() -> TriangleSurface {
    TriangleSurface {
        points: vec![Vector::zeros(), Vector::x() * 10.0, Vector::y() * 10.0],
        triangles: vec![[0, 2, 1]],
        node_ids: None,
    }
}

/// A bone of 10 x 10 x 10 mm inside the block, its lowest corner at (x, 20, 20).
fn cube(x: f64) -> TriangleSurface {
    let mesh = sample::block(Vector::new(10.0, 10.0, 10.0), [2, 2, 2], CellShape::Hex8);
    let mut surface = mesh.surface_of(&mesh.boundary_faces());
    surface.points.iter_mut().for_each(|point| *point += Vector::new(x, 20.0, 20.0));
    surface.node_ids = None;
    surface
}

pub fn meshes() -> Meshes {
    let volume = |factor, name| stored(StoredShape::Volume(block(factor).into()), name);
    Meshes(BTreeMap::from([
        ("bricks", stored(StoredShape::Volume(bricks().into()), "sha of bricks")),
        ("block", volume(1.0, "sha of block")),
        (
            "block in m",
            StoredMesh { units: Some(LengthUnit::M), ..volume(1e-3, "sha of block in m") },
        ),
        ("plate", stored(StoredShape::Surface(plate().into()), "sha of plate")),
        ("left cube", stored(StoredShape::Surface(cube(20.0).into()), "sha of left cube")),
        ("right cube", stored(StoredShape::Surface(cube(32.0).into()), "sha of right cube")),
    ]))
}

const CASE: &str = r#"{"units":"mm","volume":"block","allow_unfixed":true,"bones":[{"name":"base","mesh":"plate"}],
    "skin":{"node_set":"z_max"},"segments":[{"name":"base","nodes":{"node_set":"z_min"}}],
    "landmarks":{"tip":[40,30,40]},
    "materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.4}}}"#;
const TURN: &str = r#"{"segments":[{"name":"base","translation_mm":[1,2,3],"rotation_deg":[0,0,10],"pivot_mm":[5,5,0]}]}"#;
const ALL: &str = r#"{"outputs":["skin.vtp","skin.stl","skin.ply","skin.glb","skin.csv","volume.vtu","bones.vtp"]}"#;

pub fn predict_input(case: &str, plan: &str, spec: &str) -> PredictInput {
    let case: CaseDocument = serde_json::from_str(case).unwrap();
    let plan: PlanDocument = serde_json::from_str(plan).unwrap();
    let spec: PredictDocument = serde_json::from_str(spec).unwrap();
    PredictInput { job: None, queue_s: None, case, plan, spec }
}

fn run(input: JobInput, out: &Path, progress: &dyn Progress) -> Result<JobOutput, JobError> {
    let (sources, limits) = (meshes(), Limits::default());
    work(&input, &JobContext { sources: &sources, limits: &limits, out }, progress)
}

pub fn predict(case: &str, plan: &str, spec: &str, out: &Path) -> Result<JobOutput, JobError> {
    run(JobInput::Predict(predict_input(case, plan, spec)), out, &Unobserved)
}

fn surface(path: &Path) -> TriangleSurface {
    match format::read(&fs::read(path).unwrap(), &ReadLimits::default()).unwrap().mesh {
        Mesh::Surface(surface) => surface,
        _ => panic!("a surface"),
    }
}

#[test]
fn a_job_writes_the_same_bytes_on_any_number_of_threads() {
    let digests = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let out = tempfile::tempdir().unwrap();
        let done = pool.install(|| predict(CASE, TURN, ALL, out.path())).unwrap();
        done.result.files.into_iter().map(|file| file.sha256).collect::<Vec<_>>()
    };
    let alone = digests(1);
    assert_eq!(alone.len(), 7);
    assert_eq!(alone, digests(1));
    assert_eq!(alone, digests(4));
}

#[test]
fn the_volume_of_a_case_in_ras_is_written_in_lps_where_its_skin_is() {
    let out = tempfile::tempdir().unwrap();
    let case = CASE.replacen('{', r#"{"frame":"RAS","#, 1);
    predict(&case, TURN, ALL, out.path()).unwrap();
    let bytes = fs::read(out.path().join("volume.vtu")).unwrap();
    let volume = format::read(&bytes, &ReadLimits::default()).unwrap();
    let skin = fs::read(out.path().join("skin.vtp")).unwrap();
    let skin = format::read(&skin, &ReadLimits::default()).unwrap();
    assert_eq!((volume.frame, skin.frame), (Some(Frame::Lps), Some(Frame::Ras)));
    let (Mesh::Volume(volume), Mesh::Surface(skin)) = (volume.mesh, skin.mesh) else {
        panic!("a volume and a surface");
    };
    let moved = &volume.node_vectors["displacement_mm"];
    let rest = block(1.0);
    let turned = |x: &Vector| Vector::new(-x.x, -x.y, x.z);
    for (point, &node) in skin.points.iter().zip(skin.node_ids.as_ref().unwrap()) {
        assert_eq!(turned(point), volume.nodes[node as usize]);
        let back = volume.nodes[node as usize] - moved[node as usize];
        // Rounding of one sum and one difference of numbers below 100.
        assert!((turned(&rest.nodes[node as usize]) - back).norm() < 1e-13);
    }
}

#[test]
fn skin_and_bone_follow_a_rigid_movement_of_everything_that_is_held() {
    // Only the base is held, so the whole block moves with it, exactly in the limit of small turns.
    let plan = r#"{"segments":[{"name":"base","translation_mm":[1,2,3]}]}"#;
    let out = tempfile::tempdir().unwrap();
    let spec = ALL.replacen('{', r#"{"tolerance":{"relative_residual":1e-12},"#, 1);
    let done = predict(CASE, plan, &spec, out.path()).unwrap();
    let moved = Vector::new(1.0, 2.0, 3.0);
    let skin = surface(&out.path().join("skin.vtp"));
    let rest = block(1.0);
    for (point, &node) in skin.points.iter().zip(skin.node_ids.as_ref().unwrap()) {
        // The residual of the job is 1e-12 of the forces that hold 3.7 mm.
        assert!((point - rest.nodes[node as usize] - moved).norm() < 1e-10);
    }
    let bone = surface(&out.path().join("bones.vtp"));
    for (point, before) in bone.points.iter().zip(plate().points) {
        assert!((point - before - moved).norm() < 1e-12);
    }
    let statistics = done.result.statistics.unwrap();
    let length = moved.norm();
    assert!((statistics.skin.nodes.mean - length).abs() < 1e-9);
    assert!((statistics.skin.area.p95 - length).abs() < 1e-9);
    assert!((Vector::from(statistics.landmarks["tip"]) - moved).norm() < 1e-9);
    // Nothing is strained, so nothing pulls: 1e-6 mN of some 1e5 mN/mm times mm.
    assert!(Vector::from(done.result.reaction_millinewton["base"]).norm() < 1e-6);
    assert_eq!(done.result.reaction_mn, done.result.reaction_millinewton);
}

#[test]
fn an_identity_plan_moves_nothing() {
    let plan = r#"{"segments":[{"name":"base","matrix4x4":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]}"#;
    let out = tempfile::tempdir().unwrap();
    let done = predict(CASE, plan, "{}", out.path()).unwrap();
    assert!(done.result.statistics.unwrap().skin.nodes.max <= 1e-12);
}

#[test]
fn a_mesh_in_metres_gives_the_same_millimetres() {
    let out = tempfile::tempdir().unwrap();
    let in_metres = CASE
        .replace("\"mm\"", "\"m\"")
        .replace("\"block\"", "\"block in m\"")
        .replace(r#""bones":[{"name":"base","mesh":"plate"}],"#, "");
    let millimetres = predict(CASE, TURN, "{}", &out.path().join("mm")).unwrap();
    let metres = predict(&in_metres, TURN, "{}", &out.path().join("m")).unwrap();
    let of = |done: &JobOutput| done.result.statistics.clone().unwrap().skin.nodes.max;
    // Rounding of 0.08 * 1000.
    assert!((of(&millimetres) - of(&metres)).abs() < 1e-9);
}

#[test]
fn the_manifest_is_what_stands_in_the_folder() {
    let out = tempfile::tempdir().unwrap();
    let along = r#"{"segments":[{"name":"base","translation_mm":[1,2,3]}]}"#;
    let done = predict(CASE, along, "{}", out.path()).unwrap();
    let bytes = fs::read(out.path().join("result.json")).unwrap();
    let read: ResultDocument = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(read, done.result);
    let names: Vec<&str> = done.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["skin.vtp", "skin.glb", "bones.vtp", "result.json"]);
    let provenance = read.provenance;
    let solver = provenance.solver.unwrap();
    assert!(solver.relative_residual <= solver.wanted_residual);
    let roles: Vec<&str> = provenance.inputs.iter().map(|input| input.role.as_str()).collect();
    assert_eq!(roles, ["volume", "bone base"]);
    let adequacy = read.adequacy.unwrap();
    assert_eq!(adequacy.accepted_mm, 0.1);
    assert_eq!(provenance.why.unwrap(), adequacy.why());
}

#[test]
fn a_job_says_which_method_and_elements_it_used() {
    let out = tempfile::tempdir().unwrap();
    let fibred = CASE.replace(
        r#""poisson_ratio":0.4"#,
        r#""poisson_ratio":0.4,"fibre":{"young_modulus_kpa":60,"direction":[1,0,0]}"#,
    );
    let spec = r#"{"method":"mtm_ti","membrane":{},"outputs":["skin.ply"]}"#;
    let done = predict(&fibred, TURN, spec, out.path()).unwrap();
    let provenance = done.result.provenance;
    assert_eq!(provenance.method.unwrap(), "mtm_ti");
    assert_eq!(provenance.solver.unwrap().elements, ["tet4 plain", "tri3 membrane"]);
    assert!(done.result.warnings.iter().all(|warning| warning.code != "fibres-missing"));
}

/// The base stays and the top is drawn aside, so that the mesh has something to leave out.
const SHEAR: &str = r#"{"segments":[{"name":"base","translation_mm":[4,0,0]}]}"#;
const HELD: &str = r#"{"units":"mm","volume":"block","fixed":[{"node_set":"x_max"}],
    "skin":{"node_set":"z_max"},"segments":[{"name":"base","nodes":{"node_set":"x_min"}}],
    "skin_regions":{"far end":{"node_set":"y_max"}},"landmarks":{"tip":[40,30,40]},
    "materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.4}}}"#;

#[test]
fn a_prediction_tells_the_error_of_its_mesh_for_skin_parts_landmarks_and_nodes() {
    let out = tempfile::tempdir().unwrap();
    let spec = r#"{"method":"fem_linear","outputs":["skin.vtp","volume.vtu","skin.csv"]}"#;
    let done = predict(HELD, SHEAR, spec, out.path()).unwrap();
    let error = done.result.numerical_error_mm.clone().unwrap();
    assert!(0.0 < error.mean && error.mean <= error.p95 && error.p95 <= error.max);
    assert!(error.regions["far end"].max <= error.max && error.regions["far end"].mean > 0.0);
    assert!(error.landmarks["tip"] > 0.0 && !error.corrected);
    assert_eq!(done.result.numerical_error_unknown, None);
    assert!(done.result.provenance.timing.estimate_s > 0.0);
    let csv = fs::read_to_string(out.path().join("skin.csv")).unwrap();
    assert!(csv.lines().next().unwrap().contains("numerical_error_mm"));
    for file in ["skin.vtp", "volume.vtu"] {
        let bytes = fs::read(out.path().join(file)).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("Name=\"numerical_error_mm\""), "{file}");
        assert!(text.contains("Name=\"missing_mm\""), "{file}");
    }
}

#[test]
fn a_corrected_prediction_moves_its_skin_by_what_was_missing() {
    let out = tempfile::tempdir().unwrap();
    let skin = |spec: &str| {
        let done = predict(HELD, SHEAR, spec, out.path()).unwrap();
        let bytes = fs::read_to_string(out.path().join("result.json")).unwrap();
        assert!(bytes.contains("numerical_error_mm"));
        (surface(&out.path().join("skin.vtp")).points, done.result.numerical_error_mm.unwrap())
    };
    let (plain, error) = skin(r#"{"method":"fem_linear"}"#);
    let (corrected, added) = skin(r#"{"method":"fem_linear","corrected":true}"#);
    assert!(added.corrected && (added.mean, added.max) == (error.mean, error.max));
    let moved = plain.iter().zip(&corrected).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    // Rounding of a sum of numbers below 100.
    assert!((moved - error.max).abs() < 1e-12, "{moved} {}", error.max);
}

#[test]
fn what_a_correction_adds_stands_beside_the_answer_without_it() {
    let out = tempfile::tempdir().unwrap();
    let tissue = |spec: &str| {
        predict(HELD, SHEAR, spec, out.path()).unwrap();
        let bytes = fs::read(out.path().join("volume.vtu")).unwrap();
        match format::read(&bytes, &ReadLimits::default()).unwrap().mesh {
            Mesh::Volume(mesh) => mesh,
            _ => panic!("a volume"),
        }
    };
    let plain = tissue(r#"{"method":"fem_linear","outputs":["volume.vtu"]}"#);
    let corrected = tissue(r#"{"method":"fem_linear","outputs":["volume.vtu"],"corrected":true}"#);
    let missing = &plain.node_vectors["missing_mm"];
    assert!(missing.iter().map(Vector::norm).fold(0.0, f64::max) > 1e-3);
    let pairs = plain.nodes.iter().zip(&corrected.nodes).zip(missing);
    let off = pairs.map(|((before, after), missing)| (before + missing - after).norm());
    // Rounding of a sum of numbers below 100.
    assert!(off.fold(0.0, f64::max) < 1e-12);
}

#[test]
fn an_error_that_is_not_known_is_null_with_its_reason_and_never_zero() {
    let out = tempfile::tempdir().unwrap();
    for (spec, reason) in [
        (r#"{"estimate":"none"}"#, "not asked for"),
        (r#"{"method":"msm"}"#, "springs"),
        (r#"{"method":"thickness_warp"}"#, "warp"),
        (r#"{"element":"quadratic"}"#, "quadratic"),
    ] {
        let done = predict(HELD, SHEAR, spec, out.path()).unwrap();
        assert_eq!(done.result.numerical_error_mm, None, "{spec}");
        let told = done.result.numerical_error_unknown.unwrap();
        assert!(told.contains(reason), "{spec}: {told}");
        let bytes = fs::read(out.path().join("skin.vtp")).unwrap();
        assert!(!String::from_utf8_lossy(&bytes).contains("numerical_error_mm"), "{spec}");
    }
    let both = r#"{"estimate":"none","corrected":true}"#;
    let refused = predict(HELD, SHEAR, both, out.path()).unwrap_err();
    assert!(format!("{refused:?}").contains("/spec/corrected"), "{refused:?}");
}

#[test]
fn a_skin_is_compared_within_its_own_job() {
    let out = tempfile::tempdir().unwrap();
    let first = out.path().join("first");
    predict(CASE, TURN, "{}", &first).unwrap();
    let skin = surface(&first.join("skin.vtp"));
    let mut sources = meshes();
    sources.0.insert("scan", stored(StoredShape::Surface(skin.into()), "sha of scan"));
    let spec = r#"{"compare_to":{"actual":{"mesh":"scan"}}}"#;
    let input = JobInput::Predict(predict_input(CASE, TURN, spec));
    let second = out.path().join("second");
    let limits = Limits::default();
    let place = JobContext { sources: &sources, limits: &limits, out: &second };
    let done = work(&input, &place, &Unobserved).unwrap();
    let comparison = done.result.comparison.unwrap();
    // The scan is the prediction itself.
    assert!(comparison.both.max < 1e-9 && comparison.node_wise.unwrap().nodes.max < 1e-12);
    let written = fs::read(second.join("skin.vtp")).unwrap();
    let read = format::read(&written, &ReadLimits::default()).unwrap();
    assert!(read.ignored.names().iter().any(|name| name.contains("signed_distance_mm")));
    assert_eq!(done.result.provenance.inputs.last().unwrap().role, "actual");
}

fn compare(sources: &Meshes, text: &str, out: &Path) -> Result<JobOutput, JobError> {
    let spec: CompareDocument = serde_json::from_str(text).unwrap();
    let input = JobInput::Compare(CompareInput { job: None, queue_s: None, spec });
    let limits = Limits::default();
    work(&input, &JobContext { sources, limits: &limits, out }, &Unobserved)
}

#[test]
fn surfaces_in_different_frames_are_not_compared() {
    let mut sources = meshes();
    for (name, frame) in [("left", Frame::Lps), ("right", Frame::Ras)] {
        let mesh = stored(StoredShape::Surface(plate().into()), name);
        sources.0.insert(name, StoredMesh { frame: Some(frame), ..mesh });
    }
    let out = tempfile::tempdir().unwrap();
    let text = r#"{"prediction":{"mesh":"left"},"actual":{"mesh":"right"}}"#;
    let error = compare(&sources, text, out.path()).unwrap_err();
    assert_eq!((error.kind().name(), error.class()), ("frame-conflict", ErrorClass::Input));
}

#[test]
fn landmarks_that_are_too_few_or_on_a_line_or_far_away_align_nothing() {
    let out = tempfile::tempdir().unwrap();
    let landmark = |n: usize, x: f64, y: f64| {
        format!(r#""l{n}":{{"prediction_mm":[{x},{y},0],"actual_mm":[{x},{y},0]}}"#)
    };
    let on_a_line = [landmark(0, 0.0, 0.0), landmark(1, 1.0, 1.0), landmark(2, 2.0, 2.0)];
    let far = [landmark(0, 0.0, 0.0), landmark(1, 9.0, 0.0), landmark(2, 0.0, 900.0)];
    let good = [landmark(0, 0.0, 0.0), landmark(1, 9.0, 0.0), landmark(2, 0.0, 9.0)];
    let align = |landmarks: &[String]| {
        let text = format!(
            r#"{{"prediction":{{"mesh":"plate"}},"actual":{{"mesh":"plate"}},
               "align":{{"method":"landmarks","landmarks":{{{}}}}}}}"#,
            landmarks.join(",")
        );
        compare(&meshes(), &text, out.path())
    };
    for landmarks in [&good[..2], &on_a_line, &far] {
        assert_eq!(
            align(landmarks).unwrap_err().kind().name(),
            "alignment-failed",
            "{landmarks:?}"
        );
    }
    assert!(align(&good).unwrap().result.comparison.unwrap().both.max < 1e-9);
}

#[test]
fn a_job_that_is_cancelled_stops_in_every_phase_and_writes_nothing() {
    for phase in [Phase::Validate, Phase::Assemble, Phase::Solve, Phase::Surface, Phase::Compare] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let progress = StopAt::phase(phase);
        let input = JobInput::Predict(predict_input(CASE, TURN, "{}"));
        let error = run(input, &out, &progress).unwrap_err();
        assert_eq!(
            (error.kind().name(), error.class()),
            ("cancelled", ErrorClass::Cancelled),
            "{phase:?}"
        );
        assert!(!out.exists(), "{phase:?}");
    }
}

#[test]
fn a_job_tells_where_a_mesh_is_missing_or_of_the_wrong_kind() {
    let out = tempfile::tempdir().unwrap();
    let place = |case: &str, plan: &str| match predict(case, plan, "{}", out.path()) {
        Err(JobError::Refused(problem)) => problem
            .errors
            .into_iter()
            .map(|error| (error.pointer, error.code.name().to_owned()))
            .collect::<Vec<_>>(),
        other => panic!("{other:?}"),
    };
    let one = |at: &str, code: &str| vec![(at.to_owned(), code.to_owned())];
    let missing = CASE.replace("\"plate\"", "\"none\"");
    assert_eq!(place(&missing, TURN), one("/case/bones/0/mesh", "unknown-mesh"));
    let flat = CASE.replace("\"block\"", "\"plate\"");
    assert_eq!(place(&flat, TURN), one("/case/volume", "wrong-mesh"));
    let near =
        r#"{"prescribed":[{"nodes":{"surface":"none","within_mm":1},"displacement_mm":[1,0,0]}]}"#;
    assert_eq!(place(CASE, near), one("/plan/prescribed/0/nodes/surface", "unknown-mesh"));
    let elsewhere = r#"{"segments":[{"name":"jaw","translation_mm":[1,0,0]}]}"#;
    assert_eq!(place(CASE, elsewhere), one("/plan/segments/0/name", "unknown-segment"));
}

#[test]
fn a_bone_has_a_name_as_a_segment_has() {
    let out = tempfile::tempdir().unwrap();
    for name in [String::new(), " ".into(), "base\\u0000".into(), "b".repeat(129)] {
        let case = CASE.replacen("\"base\"", &format!("\"{name}\""), 1);
        let Err(JobError::Refused(problem)) = predict(&case, TURN, "{}", out.path()) else {
            panic!("{name:?} is taken for a name")
        };
        let errors: Vec<(&str, &str)> =
            problem.errors.iter().map(|error| (error.code.name(), &*error.pointer)).collect();
        assert_eq!(errors, [("bad-name", "/case/bones/0/name")], "{name:?}");
    }
}

#[test]
fn a_selection_may_name_a_bone_of_the_case() {
    let out = tempfile::tempdir().unwrap();
    let case = CASE.replace(r#"{"node_set":"z_min"}"#, r#"{"surface":"base","within_mm":200}"#);
    assert!(predict(&case, TURN, "{}", out.path()).is_ok());
}

#[test]
fn a_queued_job_survives_being_written_and_read() {
    let input = JobInput::Predict(predict_input(CASE, TURN, ALL));
    let text = serde_json::to_string(&input).unwrap();
    assert_eq!(serde_json::from_str::<JobInput>(&text).unwrap(), input);
}

#[test]
fn bones_that_a_plan_pushes_together_or_through_the_skin_are_warned_of_with_their_depth() {
    let case = r#"{"units":"mm","volume":"block","skin":{"node_set":"z_max"},
        "bones":[{"name":"left","mesh":"left cube"},{"name":"right","mesh":"right cube"}],
        "segments":[{"name":"left","nodes":{"node_set":"x_min"}},{"name":"right","nodes":{"node_set":"x_max"}}],
        "materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.4}}}"#;
    let warned = |movement: &str| {
        let plan = format!(r#"{{"segments":[{{"name":"left","translation_mm":{movement}}}]}}"#);
        let out = tempfile::tempdir().unwrap();
        let warnings = predict(case, &plan, "{}", out.path()).unwrap().result.warnings;
        let about_bones = warnings.into_iter().filter(|warning| warning.code.starts_with("bone"));
        about_bones
            .map(|warning| (warning.code.clone(), warning.numbers["depth_mm"].as_f64().unwrap()))
            .collect::<Vec<_>>()
    };
    // 2 mm lie between the cubes, and 10 mm between them and the skin.
    assert_eq!(warned("[1.9,0,0]"), []);
    let pushed = warned("[5,0,0]");
    assert_eq!(pushed.len(), 1);
    assert_eq!(pushed[0].0, "bones-overlap");
    assert!((pushed[0].1 - 3.0).abs() < 1e-9, "{pushed:?}");
    // At x = 20 to 30 mm of 80 the skin follows by roughly two thirds: 45 mm take the cube through it.
    assert_eq!(warned("[0,0,20]"), []);
    let lifted = warned("[0,0,45]");
    assert_eq!(lifted.len(), 1, "{lifted:?}");
    assert!(
        lifted[0].0 == "bone-through-skin" && lifted[0].1 > 1.0 && lifted[0].1 < 15.0,
        "{lifted:?}"
    );
}

#[test]
fn a_mesh_uploaded_in_another_unit_than_the_case_states_is_refused() {
    let case = CASE.replace(r#""units":"mm""#, r#""units":"m""#);
    let out = tempfile::tempdir().unwrap();
    let error = predict(&case, TURN, "{}", out.path()).unwrap_err();
    assert!(error.to_string().contains("uploaded in mm"), "{error}");
}

#[test]
fn a_plan_with_a_translation_in_metres_beside_a_rotation_says_so() {
    let out = tempfile::tempdir().unwrap();
    let told = |plan: &str| {
        let warnings = predict(CASE, plan, "{}", out.path()).unwrap().result.warnings;
        warnings.into_iter().filter(|own| own.code == "plan-units-suspect").count()
    };
    assert_eq!(told(TURN), 0);
    assert_eq!(told(&TURN.replace("[1,2,3]", "[0.001,0.002,0.003]")), 1);
}
