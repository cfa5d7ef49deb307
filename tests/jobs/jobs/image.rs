//! Materials from an image, from the documents to the result files.

use std::fs;
use std::path::Path;

use facies::jobs::{
    JobContext, JobError, JobInput, JobOutput, PredictInput, StoredShape, check, work,
};
use facies::schema::Limits;
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Frame, Vector};
use mechanics::progress::{Phase, Progress as _, StopQuery, Unobserved};
use serde_json::{Value, json};

use super::stop_at::StopAt;
use crate::samples::{read_default, surface};
use crate::sources::{Meshes, stored};

/// 0 HU up to x = 30 and 100 HU beyond, in the frame LPS; the same place in RAS.
fn image(frame: Frame) -> ImageVolume {
    let placement = Placement {
        origin: Vector::new(-0.5, -1.0, -1.0),
        steps: [Vector::x(), Vector::y() * 50.0, Vector::z() * 50.0],
    };
    let values = (0..62 * 4).map(|n| if n % 62 > 30 { 100 } else { 0 }).collect();
    let placement = placement.turned(Frame::Lps, frame);
    ImageVolume::new([62, 2, 2], placement, Voxels::I16(values)).unwrap()
}

fn meshes() -> Meshes {
    let volume = block(Vector::new(60.0, 40.0, 30.0), [4, 3, 2], CellShape::Tet4);
    let surface = volume.surface_of(&volume.boundary_faces());
    let image = |frame| stored(StoredShape::Image(image(frame).into()), Some(frame));
    let all = [
        ("block", stored(StoredShape::Volume(volume.into()), None)),
        ("skin", stored(StoredShape::Surface(surface.into()), None)),
        ("ct", image(Frame::Lps)),
        ("ct in RAS", image(Frame::Ras)),
    ];
    Meshes(all.map(|(id, mesh)| (id.to_owned(), mesh)).into())
}

fn case() -> Value {
    json!({
        "units": "mm", "frame": "LPS", "volume": "block", "skin": {"node_set": "z_max"},
        "segments": [{"name": "bone", "nodes": {"node_set": "z_min"}}],
        "fixed": [{"node_set": "x_max"}],
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.4}},
        "hounsfield": {"image": "ct", "samples": 64, "tissues": [
            {"name": "fat", "from_hu": -100, "to_hu": 50,
             "material": {"young_modulus_kpa": 3, "poisson_ratio": 0.46}},
            {"name": "muscle", "from_hu": 50, "to_hu": 200,
             "material": {"young_modulus_kpa": 300, "poisson_ratio": 0.43}}]},
    })
}

fn input(case: &Value, spec: &Value) -> PredictInput {
    PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(case.clone()).unwrap(),
        plan: serde_json::from_value(
            json!({"segments": [{"name": "bone", "translation_mm": [0, 0, 2]}]}),
        )
        .unwrap(),
        spec: serde_json::from_value(spec.clone()).unwrap(),
    }
}

fn run(sources: &Meshes, case: &Value, out: &Path) -> JobOutput {
    let spec = json!({"outputs": ["skin.vtp", "volume.vtu"]});
    let place = JobContext { sources, limits: &Limits::default(), out };
    work(&JobInput::Predict(input(case, &spec)), &place, &Unobserved).unwrap()
}

/// The code and the place of the one thing that is wrong with a changed case.
fn refused(change: impl Fn(&mut Value)) -> (String, String) {
    let mut case = case();
    change(&mut case);
    let found =
        check(&input(&case, &json!({})), &meshes(), &Limits::default(), &StopQuery::never());
    let Some(JobError::Refused(problem)) = found.err() else { panic!("{case} is refused") };
    assert_eq!(problem.errors.len(), 1, "{:?}", problem.errors);
    (problem.errors[0].code.name().to_owned(), problem.errors[0].pointer.clone())
}

#[test]
fn a_check_that_is_stopped_is_cancelled_and_reports_nothing() {
    let impatient = StopAt::phase(Phase::Validate);
    let found =
        |stop: &StopQuery| check(&input(&case(), &json!({})), &meshes(), &Limits::default(), stop);
    assert!(found(&StopQuery::of(&impatient)).is_ok());
    impatient.phase(Phase::Validate);
    let stopped = found(&StopQuery::of(&impatient));
    assert!(matches!(stopped.err(), Some(JobError::Cancelled)));
}

#[test]
fn what_is_wrong_with_windows_is_reported_with_its_place() {
    let at = |code: &str, place: &str| (code.to_owned(), format!("/case/hounsfield{place}"));
    let tissue = |number: usize, name: &'static str, value: Value| {
        move |case: &mut Value| case["hounsfield"]["tissues"][number][name] = value.clone()
    };
    for samples in [0, 513] {
        let changed = refused(|case| case["hounsfield"]["samples"] = json!(samples));
        assert_eq!(changed, at("out-of-range", "/samples"));
    }
    assert_eq!(refused(tissue(1, "from_hu", json!(49))), at("windows-overlap", "/tissues"));
    assert_eq!(refused(tissue(1, "to_hu", json!(50))), at("out-of-range", "/tissues/1"));
    assert_eq!(refused(tissue(1, "to_hu", json!(1e7))), at("out-of-range", "/tissues/1/to_hu"));
    assert_eq!(refused(tissue(1, "name", json!("fat"))), at("duplicate-name", "/tissues/1/name"));
    let half = json!({"young_modulus_kpa": 3});
    let place = "/tissues/0/material/poisson_ratio";
    assert_eq!(refused(tissue(0, "material", half)), at("missing-field", place));
    let none = refused(|case| case["hounsfield"]["tissues"] = json!([]));
    assert_eq!(none, at("out-of-range", "/tissues"));
}

#[test]
fn a_region_with_fibres_is_labelled_and_mixed_and_one_with_a_law_is_labelled_only() {
    let with = |mixing: &'static str, name: &'static str, value: Value| {
        move |case: &mut Value| {
            case["hounsfield"]["mixing"] = json!(mixing);
            case["materials"]["*"][name] = value.clone();
        }
    };
    let fibre = json!({"young_modulus_kpa": 60, "direction": [1, 0, 0]});
    let law = json!({"kind": "neo_hookean"});
    let is_sound = |change: &dyn Fn(&mut Value)| {
        let mut changed = case();
        change(&mut changed);
        check(&input(&changed, &json!({})), &meshes(), &Limits::default(), &StopQuery::never())
            .is_ok()
    };
    for mixing in ["mean", "fraction"] {
        assert!(is_sound(&with(mixing, "fibre", fibre.clone())), "{mixing}");
    }
    assert!(is_sound(&with("mean", "law", law.clone())));
    let place = "/case/hounsfield/mixing".to_owned();
    assert_eq!(refused(with("fraction", "law", law)), ("method-not-available".to_owned(), place));
}

#[test]
fn an_image_is_no_mesh_and_a_mesh_no_image() {
    let wrong = |place: &str| ("wrong-mesh".to_owned(), place.to_owned());
    let image = "/case/hounsfield/image";
    for mesh in ["block", "skin"] {
        assert_eq!(refused(|case| case["hounsfield"]["image"] = json!(mesh)), wrong(image));
    }
    assert_eq!(refused(|case| case["volume"] = json!("ct")), wrong("/case/volume"));
    let bone = json!([{"name": "jaw", "mesh": "ct"}]);
    assert_eq!(refused(|case| case["bones"] = bone.clone()), wrong("/case/bones/0/mesh"));
    let near = json!([{"surface": "ct", "within_mm": 1}]);
    assert_eq!(refused(|case| case["fixed"] = near.clone()), wrong("/case/fixed/0/surface"));
    let unknown = refused(|case| case["hounsfield"]["image"] = json!("mri"));
    assert_eq!(unknown, ("unknown-mesh".to_owned(), image.to_owned()));
    let spec = json!({"compare_to": {"actual": {"mesh": "ct"}}});
    let found = check(&input(&case(), &spec), &meshes(), &Limits::default(), &StopQuery::never());
    let Some(JobError::Refused(problem)) = found.err() else { panic!("an image has no surface") };
    assert_eq!(problem.code.name(), "validation-failed");
    assert_eq!(problem.errors[0].code.name(), "wrong-mesh");
}

#[test]
fn an_image_in_the_other_frame_shows_the_same_tissue() {
    let out = tempfile::tempdir().unwrap();
    let here = run(&meshes(), &case(), out.path());
    let skin = fs::read(out.path().join("skin.vtp")).unwrap();
    let mut other = case();
    other["hounsfield"]["image"] = json!("ct in RAS");
    let there = run(&meshes(), &other, out.path());
    let of = |done: &JobOutput| done.result.statistics.clone().unwrap();
    assert_eq!(of(&here), of(&there));
    // The hash tells them apart, and with it the field data of their files.
    assert_ne!(here.result.provenance.spec_hash, there.result.provenance.spec_hash);
    let points = |bytes: &[u8]| surface(read_default(bytes)).points;
    assert_eq!(points(&skin), points(&fs::read(out.path().join("skin.vtp")).unwrap()));
    // Taken as it stands, it lies beside the mesh.
    other["frame"] = json!("unspecified");
    let mut unmarked = meshes();
    unmarked.0.get_mut("ct in RAS").unwrap().frame = None;
    let found =
        check(&input(&other, &json!({})), &unmarked, &Limits::default(), &StopQuery::never());
    assert!(found.err().unwrap().to_string().contains("no cell lies inside the image"));
}

#[test]
fn an_image_without_a_frame_is_doubtful_beside_meshes_with_one() {
    let codes = |case: &Value| {
        let mut unmarked = meshes();
        unmarked.0.get_mut("ct").unwrap().frame = None;
        let found =
            check(&input(case, &json!({})), &unmarked, &Limits::default(), &StopQuery::never())
                .unwrap();
        found.document.warnings.into_iter().map(|warning| warning.code).collect::<Vec<_>>()
    };
    let doubtful = "image-place-doubtful";
    assert_eq!(codes(&case()).iter().filter(|code| *code == doubtful).count(), 1);
    let mut unstated = case();
    unstated["frame"] = json!("unspecified");
    assert!(!codes(&unstated).iter().any(|code| code == doubtful));
}

#[test]
fn the_result_tells_how_much_of_each_tissue_there_is() {
    let out = tempfile::tempdir().unwrap();
    let done = run(&meshes(), &case(), out.path());
    let imaged = done.result.statistics.clone().unwrap().imaged.unwrap();
    let [fat, muscle] = ["fat", "muscle"].map(|name| imaged.tissues[name]);
    // The block ends at 60 and its middle plane runs between cells of 15 mm.
    assert_eq!((fat.cells, muscle.cells, imaged.outside_cells), (72, 72, 0));
    assert!((fat.volume_share - 0.5).abs() < 1e-12 && (muscle.volume_share - 0.5).abs() < 1e-12);
    let roles: Vec<&str> =
        done.result.provenance.inputs.iter().map(|input| input.role.as_str()).collect();
    assert_eq!(roles, ["volume", "image"]);
    assert_eq!(done.result.provenance.inputs[1].voxels, Some(248));
    let file = fs::read(out.path().join("volume.vtu")).unwrap();
    let file = String::from_utf8_lossy(&file);
    for array in ["hounsfield_mean", "tissue", "young_modulus_kpa", "tissue_names"] {
        assert!(file.contains(&format!("Name=\"{array}\"")), "{array}");
    }
    let mut plain = case();
    plain.as_object_mut().unwrap().remove("hounsfield");
    let without = run(&meshes(), &plain, out.path());
    assert!(without.result.statistics.unwrap().imaged.is_none());
    assert_ne!(without.result.provenance.spec_hash, done.result.provenance.spec_hash);
}
