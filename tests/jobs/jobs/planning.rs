//! Plans before anything is predicted, and plans of operations that were performed.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use facies::jobs::{
    JobContext, JobInput, PredictInput, ReproduceInput, StoredMesh, StoredShape, check, work,
};
use facies::schema::case::norm::{NormDocuments, check_norms};
use facies::schema::compare::document::StartName;
use facies::schema::predict::check::CheckDocument;
use facies::schema::predict::result::ResultDocument;
use facies::schema::reproduce::result::ReproductionDocument;
use facies::schema::{Faults, Limits, Matrix4x4, Pointer};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Frame, TriangleSurface, Vector};
use mechanics::plan::RigidMovement;
use mechanics::progress::{StopQuery, Unobserved};
use serde_json::{Value, json};

use crate::sources::{Meshes, stored};
use crate::transforms;

fn brick(size: [f64; 3], cells: [usize; 3], corner: [f64; 3]) -> TriangleSurface {
    let mesh = block(Vector::from(size), cells, CellShape::Hex8);
    let mut surface = mesh.surface_of(&mesh.boundary_faces());
    surface.node_ids = None;
    surface.points.iter_mut().for_each(|point| *point += Vector::from(corner));
    surface
}

/// Bone without any symmetry, from what is a brick.
fn shaped(mut bone: TriangleSurface) -> TriangleSurface {
    for point in &mut bone.points {
        let (x, y) = (point.x, point.y);
        point.z += 4.0 * (x / 9.0).sin() + 3.0 * (y / 7.0).cos();
        point.x += 0.1 * y + 2.0 * (y / 5.0).sin();
    }
    bone
}

pub fn moved(surface: &TriangleSurface, by: &RigidMovement) -> TriangleSurface {
    let points = surface.points.iter().map(|point| by.apply(point)).collect();
    TriangleSurface { points, ..surface.clone() }
}

fn joined(a: &TriangleSurface, b: &TriangleSurface) -> TriangleSurface {
    let offset = a.points.len() as u32;
    let shifted = b.triangles.iter().map(|corners| corners.map(|corner| corner + offset));
    TriangleSurface {
        points: [a.points.as_slice(), &b.points].concat(),
        triangles: a.triangles.iter().copied().chain(shifted).collect(),
        node_ids: None,
    }
}

pub fn surface(shape: TriangleSurface) -> StoredMesh {
    StoredMesh { frame: None, ..stored(StoredShape::Surface(shape.into()), None) }
}

pub fn reproduced(sources: &Meshes, spec: Value) -> Result<ReproductionDocument, String> {
    result_of(sources, spec).map(|result| result.reproduction.unwrap())
}

pub fn result_of(sources: &Meshes, spec: Value) -> Result<ResultDocument, String> {
    let folder = tempfile::tempdir().unwrap();
    let spec = serde_json::from_value(spec).unwrap();
    let input = JobInput::Reproduce(ReproduceInput { job: None, queue_s: None, spec });
    let place = JobContext { sources, limits: &Limits::default(), out: folder.path() };
    let done = work(&input, &place, &Unobserved).map_err(|error| format!("{error:?}"))?;
    Ok(done.result)
}

/// A jaw that was moved, scans of it before and after in frames of their own, and the document that asks for the movement.
pub fn performed() -> (RigidMovement, Meshes, Value) {
    let base = shaped(brick([60.0, 40.0, 15.0], [30, 20, 8], [0.0; 3]));
    let jaw = shaped(brick([40.0, 20.0, 10.0], [20, 10, 5], [5.0, 0.0, -25.0]));
    let turn = Vector::new(0.0, 0.03, 0.02);
    let done = RigidMovement::about_pivot(
        turn,
        Vector::new(20.0, 10.0, -20.0),
        Vector::new(3.0, -1.0, 0.5),
    );
    let scan = RigidMovement::about_pivot(
        Vector::new(0.05, 0.1, -0.05),
        Vector::zeros(),
        Vector::new(9.0, 4.0, -6.0),
    );
    let after = moved(&joined(&base, &moved(&jaw, &done)), &scan.inverse());
    let sources = Meshes(BTreeMap::from([
        ("before".to_owned(), surface(joined(&base, &jaw))),
        ("after".to_owned(), surface(after)),
        ("jaw".to_owned(), surface(jaw)),
    ]));
    let spec = json!({
        "kind": "reproduce", "before": {"mesh": "before"}, "after": {"mesh": "after"},
        "base": {"mask": {"box_mm": [-50, -50, -8, 150, 100, 60]}},
        "segments": [{"name": "jaw", "before": {"mesh": "jaw"}}],
        "planned": {"segments": [{"name": "jaw", "translation_mm": [3, 0, 0]}]}
    });
    (done, sources, spec)
}

#[test]
fn a_base_that_holds_the_bone_that_was_moved_is_reported() {
    let (_, sources, mut spec) = performed();
    let told = |spec: &Value| -> Vec<String> {
        let warnings = result_of(&sources, spec.clone()).unwrap().warnings;
        warnings.into_iter().map(|warning| warning.code).collect()
    };
    assert!(!told(&spec).contains(&"base-unmasked".to_owned()));
    spec["base"] = json!({});
    assert!(told(&spec).contains(&"base-unmasked".to_owned()));
}

#[test]
fn the_start_of_a_registration_is_tried_where_none_is_stated_and_told() {
    let (done, mut sources, mut spec) = performed();
    let near = reproduced(&sources, spec.clone()).unwrap();
    assert_eq!(near.base.start, Some(StartName::None));
    let off = RigidMovement::about_pivot(
        Vector::new(0.3, 0.2, 2.6),
        Vector::zeros(),
        Vector::new(20.0, -15.0, 29.0),
    );
    let after = sources.0["after"].surface_in_mm().unwrap();
    sources.0.insert("after".to_owned(), surface(moved(&after, &off)));
    let found = reproduced(&sources, spec.clone()).unwrap();
    assert!(matches!(found.base.start, Some(StartName::Boxes | StartName::Inertia)), "{found:?}");
    assert!(found.base.fit.share_above_1_mm < 0.01, "{found:?}");
    let Matrix4x4(matrix) = found.segments[0].matrix4x4;
    for (found, wanted) in matrix.iter().zip(done.matrix4()) {
        assert!((found - wanted).abs() < 1e-3, "{matrix:?} instead of {:?}", done.matrix4());
    }
    // A stated start is taken alone, also where it misses.
    spec["base"]["start"] = "none".into();
    if let Ok(missed) = reproduced(&sources, spec) {
        assert_eq!(missed.base.start, Some(StartName::None));
        assert!(missed.base.fit.share_above_1_mm > 0.05, "{missed:?}");
    }
}

#[test]
fn a_performed_operation_becomes_a_plan_and_is_held_against_what_was_planned() {
    let (done, sources, spec) = performed();
    let found = reproduced(&sources, spec.clone()).unwrap();
    let Matrix4x4(matrix) = found.segments[0].matrix4x4;
    for (found, wanted) in matrix.iter().zip(done.matrix4()) {
        assert!((found - wanted).abs() < 1e-3, "{matrix:?} instead of {:?}", done.matrix4());
    }
    assert_eq!(found.plan.segments[0].matrix4x4, Some(Matrix4x4(matrix)));
    assert!(found.base.fit.rms_mm < 1e-3 && found.base.fit.share_above_1_mm < 0.01);
    assert!(found.segments[0].fit.share_above_1_mm < 0.01);
    let beyond = found.segments[0].from_planned.unwrap();
    assert!((beyond.rotation_deg - done.angle().to_degrees()).abs() < 0.01, "{beyond:?}");
    assert!((beyond.displacement_mm.0[1] + 1.0).abs() < 0.5, "{beyond:?}");

    // The mistakes that a client makes, each at its place.
    for (change, at) in [
        (json!({"segments": []}), "/spec/segments"),
        (json!({"segments": [{"name": "jaw"}]}), "/spec/segments/0"),
        (
            json!({"segments": [{"name": "jaw", "before": {"mesh": "none"}}]}),
            "/spec/segments/0/before/mesh",
        ),
        (json!({"base": {"start": "landmarks"}}), "/spec/base/landmarks"),
        (
            json!({"segments": [{"name": "jaw", "before": {"mesh": "jaw"}, "start": "boxes"}]}),
            "/spec/segments/0/start",
        ),
    ] {
        let mut wrong = spec.clone();
        wrong.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
        let refused = reproduced(&sources, wrong).unwrap_err();
        assert!(refused.contains(at), "{change}: {refused}");
    }
}

/// Two bones of 10 mm cubes 2 mm apart, of which the right one moves, under a block of tissue.
fn cubes(case: Value, plan: Value, spec: Value) -> (Meshes, PredictInput) {
    let volume = block(Vector::new(80.0, 60.0, 40.0), [8, 6, 4], CellShape::Hex8);
    let sources = Meshes(BTreeMap::from([
        (
            "block".to_owned(),
            StoredMesh {
                frame: None,
                ..stored(StoredShape::Volume(volume.into()), Some(Frame::Lps))
            },
        ),
        ("left".to_owned(), surface(brick([10.0; 3], [2, 2, 2], [20.0, 20.0, 20.0]))),
        ("right".to_owned(), surface(brick([10.0; 3], [2, 2, 2], [32.0, 20.0, 20.0]))),
    ]));
    let mut whole = json!({
        "units": "mm", "frame": "LPS", "volume": "block", "fixed": [{"node_set": "x_min"}],
        "segments": [{"name": "right", "nodes": {"node_set": "x_max"}}],
        "bones": [{"name": "left", "mesh": "left"}, {"name": "right", "mesh": "right"}],
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.4}}
    });
    whole.as_object_mut().unwrap().extend(case.as_object().unwrap().clone());
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(whole).unwrap(),
        plan: serde_json::from_value(plan).unwrap(),
        spec: serde_json::from_value(spec).unwrap(),
    };
    (sources, input)
}

fn checked(case: Value, plan: Value) -> CheckDocument {
    let (sources, input) = cubes(case, plan, json!({}));
    check(&input, &sources, &Limits::default(), &StopQuery::never()).unwrap().document
}

/// The colours of an image within an SVG, by its place among them.
fn pixels(svg: &str, panel: usize) -> Vec<[u8; 4]> {
    let text = svg.split("data:image/png;base64,").nth(panel + 1).unwrap();
    let bytes = STANDARD.decode(&text[..text.find('"').unwrap()]).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let shape = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((shape.color_type, shape.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
    pixels.chunks_exact(4).map(|pixel| pixel.try_into().unwrap()).collect()
}

fn share(pixels: &[[u8; 4]], is: fn(&[u8; 4]) -> bool) -> f64 {
    pixels.iter().filter(|pixel| pixel[3] > 200 && is(pixel)).count() as f64 / pixels.len() as f64
}

/// What lies inside other bone, and what is 2 to 5 mm from it.
fn is_red([r, g, b, _]: &[u8; 4]) -> bool {
    u16::from(*r) > 2 * u16::from(*g) && u16::from(*r) > 2 * u16::from(*b)
}

fn is_blue([r, _, b, _]: &[u8; 4]) -> bool {
    u16::from(*b) > u16::from(*r) + 15
}

#[test]
fn a_picture_shows_how_bones_meet_before_and_as_planned() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = |plan: Value| {
        let spec = json!({"method": "thickness_warp", "outputs": ["skin.vtp", "gaps.svg"]});
        let (sources, input) = cubes(json!({}), plan, spec);
        let place =
            JobContext { sources: &sources, limits: &Limits::default(), out: folder.path() };
        let done = work(&JobInput::Predict(input), &place, &Unobserved).unwrap();
        let is_there = done.result.files.iter().any(|file| file.name == "gaps.svg");
        is_there.then(|| std::fs::read_to_string(folder.path().join("gaps.svg")).unwrap())
    };
    let by = |x: f64| json!({"segments": [{"name": "right", "translation_mm": [x, 2, 2]}]});
    let picture = drawn(by(-2.5)).unwrap();
    for words in
        ["left, from ", "right, from ", "moved: right", "As planned", "gap, mm", "frame LPS"]
    {
        assert!(picture.contains(words), "{words}");
    }
    // Of each bone before and as planned: gaps of 2 mm before, half a millimetre inside each other then.
    for (panel, is_planned) in [(0, false), (1, true), (2, false), (3, true)] {
        let seen = pixels(&picture, panel);
        let [red, blue] = [is_red, is_blue].map(|is| share(&seen, is));
        assert!(
            is_planned == (red > 0.02) && (is_planned || (red == 0.0 && blue > 0.02)),
            "{panel}: {red} {blue}"
        );
    }
    assert_eq!(picture.matches("data:image/png;base64,").count(), 4);
    // Nothing moves against anything, so that there is nothing to see.
    assert_eq!(drawn(json!({})), None);
}

#[test]
fn a_check_names_bones_that_a_plan_moves_into_each_other_before_anything_is_solved() {
    let by = |x: f64| json!({"segments": [{"name": "right", "translation_mm": [x, 2, 2]}]});
    let found = checked(json!({}), by(-5.0));
    let [collision] = &found.collisions[..] else { panic!("{:?}", found.collisions) };
    assert!((collision.depth_mm - 3.0).abs() < 1e-9 && collision.depth_before_mm == 0.0);
    let overlap = collision.overlap.unwrap();
    // A block of 3 x 8 x 8 mm.
    assert!((overlap.volume_mm3 - 192.0).abs() < 10.0, "{overlap:?}");
    assert!((overlap.middle_mm.0[0] - 28.5).abs() < 0.5, "{overlap:?}");
    let codes: Vec<&str> = found.warnings.iter().map(|warning| warning.code.as_str()).collect();
    assert!(codes.contains(&"bones-overlap"), "{codes:?}");
    let apart = checked(json!({}), by(-1.5));
    assert!(apart.collisions.is_empty());
    assert!(apart.warnings.iter().all(|warning| warning.code != "bones-overlap"));
}

#[test]
fn a_check_maps_where_bones_touch_before_and_as_planned() {
    let by = |x: f64| json!({"segments": [{"name": "right", "translation_mm": [x, 2, 2]}]});
    let contacts = |plan: Value| checked(json!({}), plan).contacts;
    // Nearly touching: faces of 8 x 8 mm, 0.1 mm apart.
    let found = contacts(by(-1.9));
    let [contact] = &found[..] else { panic!("{found:?}") };
    assert_eq!((contact.bones.join(" "), contact.before.count), ("left right".to_owned(), 0));
    let [region] = contact.planned.regions[..] else { panic!("{contact:?}") };
    // 0.28 mm beyond two edges of the face, and 0.2 mm up the sides there, by samples.
    let beside = 2.0 * 8.0 * (0.08_f64.sqrt() + 0.2);
    assert!((region.area_mm2 - 64.0 - beside).abs() < 1.5, "{region:?}");
    assert!((region.least_gap_mm - 0.1).abs() < 1e-9 && region.overlap_area_mm2 == 0.0);
    let middle = Vector::from(region.middle_mm);
    assert!((middle - Vector::new(30.0, 26.0, 26.0)).norm() < 0.3, "{region:?}");
    // Pushed into each other: the face and 3 mm of four sides lie inside.
    let found = contacts(by(-5.0));
    let planned = &found[0].planned;
    assert!((planned.depth_mm - 3.0).abs() < 1e-9 && planned.count == 1, "{planned:?}");
    assert!((planned.overlap_area_mm2 - (64.0 + 2.0 * 24.0)).abs() < 3.0, "{planned:?}");
    assert!(contacts(by(1.0)).is_empty(), "apart before and as planned");
    assert!(contacts(json!({})).is_empty(), "nothing moves against anything");
}

#[test]
fn a_check_tells_movements_for_navigation_that_read_again_are_equal_to_the_bit() {
    let plan = json!({"segments": [{"name": "right", "translation_mm": [1, 0.3, -0.2],
        "rotation_deg": [0, 3, 0], "pivot_mm": [70, 30, 20], "restrict_to": {"plane_normal": [0, 1, 0]}}]});
    let found = checked(json!({}), plan.clone());
    let [movement] = &found.movements[..] else { panic!("{:?}", found.movements) };
    let Matrix4x4(matrix) = movement.matrix4x4;
    let text = transforms::of_matrix_text(&movement.matrix_text);
    assert_eq!(text.matrix4().map(f64::to_bits), matrix.map(f64::to_bits));
    // The plane leaves nothing along y, and the turn about it.
    assert!((matrix[7]).abs() < 1e-12 && (movement.rotation_deg - 3.0).abs() < 1e-9);
    let itk = transforms::of_itk_text(movement.itk_transform.as_ref().unwrap());
    let at = Vector::new(70.0, 30.0, 20.0);
    assert!((itk.apply(&at) - at - Vector::new(1.0, 0.0, -0.2)).norm() < 1e-12);
    // The file is in LPS whatever the case is in.
    let ras = checked(json!({"frame": "RAS"}), plan);
    let in_lps = transforms::of_itk_text(ras.movements[0].itk_transform.as_ref().unwrap());
    let Matrix4x4(in_ras) = ras.movements[0].matrix4x4;
    assert!((in_lps.matrix4()[3] + in_ras[3]).abs() < 1e-12);
    let unstated = checked(
        json!({"frame": "unspecified"}),
        json!({"segments": [{"name": "right", "translation_mm": [1, 0, 0]}]}),
    );
    assert_eq!(unstated.movements[0].itk_transform, None);
}

#[test]
fn a_check_measures_the_head_before_and_as_planned() {
    let at = |x: f64, y: f64, z: f64| json!({"position_mm": [x, y, z]});
    let on_right = |x: f64, y: f64, z: f64| json!({"position_mm": [x, y, z], "segment": "right"});
    let landmarks = json!({
        "S": at(0.0, 20.0, 60.0), "N": at(0.0, -48.0, 70.0), "A": at(0.0, -52.0, 18.0),
        "B": on_right(0.0, -46.0, -28.0), "Me": on_right(0.0, -38.0, -52.0),
        "Go_L": on_right(45.0, 18.0, -24.0), "Go_R": on_right(-45.0, 18.0, -24.0),
        "Po_L": at(55.0, 38.0, 38.0), "Po_R": at(-55.0, 38.0, 38.0),
        "Or_L": at(35.0, -38.0, 36.0), "Or_R": at(-35.0, -38.0, 36.0),
        "U1": at(0.0, -57.0, -6.0), "L1": on_right(0.0, -53.0, -5.0)
    });
    let plan = json!({"segments": [{"name": "right", "translation_mm": [0, -4, 0]}]});
    let found = checked(json!({"bone_landmarks": landmarks}), plan.clone());
    let measure = |name: &str| found.cephalometry.iter().find(|m| m.name == name).unwrap();
    // docs/verification.md#cephalometry.
    for (name, before, planned) in [
        ("sna", 86.032_819_231_0, 86.032_819_231_0),
        ("snb", 80.464_974_548_1, 82.803_253_203_9),
        ("anb", 5.567_844_682_9, 3.229_566_027_1),
        ("overjet", 4.024_922_359_5, 4.024_922_359_5 - 4.0 * 0.999_653_92),
    ] {
        assert!((measure(name).before - before).abs() < 1e-8, "{:?}", measure(name));
        assert!((measure(name).planned.unwrap() - planned).abs() < 1e-7, "{:?}", measure(name));
        assert_eq!(measure(name).predicted, None);
    }
    assert!(found.cephalometry.iter().all(|measure| measure.name != "wits"), "Oc is not there");
    assert!(measure("sna").norm.is_none(), "no norm of bone is built in");
    let me = found.symmetry.iter().find(|own| own.landmark == "Me").unwrap();
    // The head lies 4 mm along its own plane: nothing leaves the middle.
    assert!(me.before.length_mm < 1e-9 && me.planned.unwrap().length_mm < 1e-9);

    let swapped = json!({"Po_L": at(-55.0, 38.0, 38.0), "Po_R": at(55.0, 38.0, 38.0)});
    let found = checked(json!({"bone_landmarks": swapped}), plan);
    assert!(found.warnings.iter().any(|warning| warning.code == "landmarks-swapped"));
}

#[test]
fn landmarks_of_bone_in_metres_or_far_from_the_mesh_are_reported() {
    let plan = json!({"segments": [{"name": "right", "translation_mm": [0, -4, 0]}]});
    let told = |nasion: [f64; 3]| -> Vec<String> {
        let landmarks =
            json!({"S": {"position_mm": [0, 0.02, 0.06]}, "N": {"position_mm": nasion}});
        let found = checked(json!({"bone_landmarks": landmarks}), plan.clone());
        let codes = found.warnings.into_iter().map(|own| own.code);
        codes.filter(|code| code.starts_with("landmark")).collect()
    };
    assert_eq!(told([0.0, -48.0, 10.0]), [""; 0]);
    assert_eq!(told([0.0, -0.048, 0.07]), ["landmarks-crowded"]);
    assert_eq!(told([0.0, -480.0, 70.0]), ["landmark-far"]);
}

#[test]
fn a_landmark_far_from_the_tissue_is_told_before_anything_is_solved() {
    let plan = json!({"segments": [{"name": "right", "translation_mm": [0, -4, 0]}]});
    let found = checked(json!({"landmarks": {"astray": [0, 0, 400]}}), plan.clone());
    let far: Vec<_> = found.warnings.iter().filter(|own| own.code == "landmark-far").collect();
    assert_eq!(far.len(), 1, "{:?}", found.warnings);
    assert!(far[0].detail.contains("astray"), "{}", far[0].detail);
    let (sources, input) =
        cubes(json!({"landmarks": {"astray": [0, 0, 400]}}), plan, json!({"method": "fem_linear"}));
    let out = tempfile::tempdir().unwrap();
    let place = JobContext { sources: &sources, limits: &Limits::default(), out: out.path() };
    let told = work(&JobInput::Predict(input), &place, &Unobserved).unwrap().result.warnings;
    assert_eq!(told.iter().find(|own| own.code == "landmark-far"), Some(far[0]));
}

#[test]
fn norms_that_a_case_states_stand_beside_its_measures_and_unknown_ones_are_refused() {
    let at = |x: f64, y: f64, z: f64| json!({"position_mm": [x, y, z]});
    let landmarks =
        json!({"S": at(0.0, 20.0, 60.0), "N": at(0.0, -48.0, 70.0), "A": at(0.0, -52.0, 18.0)});
    let norms = json!({"sna": {"mean": 82.0, "sd": 2.0, "source": "a clinic"}});
    let plan = json!({"segments": [{"name": "right", "translation_mm": [0, -4, 0]}]});
    let found = checked(json!({"bone_landmarks": landmarks, "norms": norms}), plan);
    let norm = found.cephalometry[0].norm.clone().unwrap();
    assert_eq!((norm.mean, norm.sd, norm.source.as_str()), (82.0, 2.0, "a clinic"));
    assert!((norm.before_z - (86.032_819_231 - 82.0) / 2.0).abs() < 1e-8, "{norm:?}");
    assert_eq!(norm.planned_z, Some(norm.before_z));
    let mut faults = Faults::default();
    let stated = json!({"sno": {"mean": 82.0, "sd": 0.0, "source": "a clinic"}});
    let norms: NormDocuments = serde_json::from_value(stated).unwrap();
    check_norms(&norms, &Pointer::root().key("norms"), &Limits::default(), &mut faults);
    let errors = faults.into_result().err().unwrap().errors;
    let places: Vec<&str> = errors.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(places, ["/norms/sno", "/norms/sno/sd"]);
}

#[test]
fn a_reproduction_tells_measures_and_symmetry_as_they_were_performed() {
    let (done, sources, mut spec) = performed();
    let at = |place: [f64; 3], segment: &str| match segment {
        "" => json!({"position_mm": place}),
        segment => json!({"position_mm": place, "segment": segment}),
    };
    spec["bone_landmarks"] = json!({
        "S": at([0.0, 20.0, 60.0], ""), "N": at([0.0, -48.0, 70.0], ""), "B": at([0.0, -46.0, -28.0], "jaw"),
        "Me": at([0.0, -38.0, -52.0], "jaw"), "Po_L": at([55.0, 38.0, 38.0], ""), "Po_R": at([-55.0, 38.0, 38.0], ""),
        "Or_L": at([35.0, -38.0, 36.0], ""), "Or_R": at([-35.0, -38.0, 36.0], "")
    });
    let result = result_of(&sources, spec).unwrap();
    let snb = result.cephalometry.iter().find(|measure| measure.name == "snb").unwrap();
    let angle = |b: Vector| {
        let (n, s) = (Vector::new(0.0, -48.0, 70.0), Vector::new(0.0, 20.0, 60.0));
        let (one, other) = ((s - n).normalize(), (b - n).normalize());
        one.dot(&other).acos().to_degrees()
    };
    let before = Vector::new(0.0, -46.0, -28.0);
    assert!((snb.before - angle(before)).abs() < 1e-9);
    assert!((snb.planned.unwrap() - angle(before + Vector::x() * 3.0)).abs() < 1e-9);
    assert!((snb.performed.unwrap() - angle(done.apply(&before))).abs() < 1e-3);
    let me = result.symmetry.iter().find(|own| own.landmark == "Me").unwrap();
    assert!((me.planned.unwrap().left_mm - 3.0).abs() < 1e-9);
    let moved = done.apply(&Vector::new(0.0, -38.0, -52.0));
    assert!((me.performed.unwrap().left_mm - moved.x).abs() < 1e-2, "{me:?} {moved}");
}
