//! Materials from an image, from the documents to the result files; and a real CT.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use facies::jobs::{
    JobError, JobInput, JobOutput, MeshSource, PredictInput, SourceError, StoredMesh, StoredShape,
    Workplace, check, work,
};
use facies::schema::Limits;
use facies::schema::case::document::LengthUnit;
use mechanics::format::{Mesh, ReadLimits, ReadMesh, read};
use mechanics::image::{ImageVolume, Placement, Voxels};
use mechanics::mesh::half_head::half_head;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Frame, TriangleSurface, Vector, VolumeMesh};
use mechanics::prediction::Unobserved;
use serde_json::{Value, json};

use crate::shared::shared_data;

struct Meshes(BTreeMap<String, StoredMesh>);

impl MeshSource for Meshes {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        self.0.get(id).cloned().ok_or_else(|| SourceError::Unknown { id: id.to_owned() })
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        self.mesh(job)
    }
}

fn stored(shape: StoredShape, frame: Option<Frame>) -> StoredMesh {
    let units = (!matches!(shape, StoredShape::Image(_))).then_some(LengthUnit::Mm);
    StoredMesh { shape, frame, units, warnings: Vec::new(), sha256: format!("sha {frame:?}") }
}

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
    let place = Workplace { sources, limits: &Limits::default(), out };
    work(&JobInput::Predict(input(case, &spec)), &place, &Unobserved).unwrap()
}

/// The code and the place of the one thing that is wrong with a changed case.
fn refused(change: impl Fn(&mut Value)) -> (String, String) {
    let mut case = case();
    change(&mut case);
    let found = check(&input(&case, &json!({})), &meshes(), &Limits::default());
    let Some(JobError::Refused(problem)) = found.err() else { panic!("{case} is refused") };
    assert_eq!(problem.errors.len(), 1, "{:?}", problem.errors);
    (problem.errors[0].code.clone(), problem.errors[0].pointer.clone())
}

#[test]
fn what_is_wrong_with_windows_is_told_with_its_place() {
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
fn a_region_with_fibres_is_labelled_and_not_mixed() {
    let fibred = |mixing: &'static str| {
        move |case: &mut Value| {
            case["hounsfield"]["mixing"] = json!(mixing);
            case["materials"]["*"]["fibre"] =
                json!({"young_modulus_kpa": 60, "direction": [1, 0, 0]});
        }
    };
    let place = "/case/hounsfield/mixing".to_owned();
    assert_eq!(refused(fibred("fraction")), ("method-not-available".to_owned(), place));
    let mut labelled = case();
    fibred("mean")(&mut labelled);
    assert!(check(&input(&labelled, &json!({})), &meshes(), &Limits::default()).is_ok());
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
    let found = check(&input(&case(), &spec), &meshes(), &Limits::default());
    let Some(JobError::Refused(problem)) = found.err() else { panic!("an image has no surface") };
    assert_eq!(problem.code, "validation-failed");
    assert_eq!(problem.errors[0].code, "wrong-mesh");
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
    let points = |bytes: &[u8]| surface_of(read(bytes, &ReadLimits::default()).unwrap()).points;
    assert_eq!(points(&skin), points(&fs::read(out.path().join("skin.vtp")).unwrap()));
    // Taken as it stands, it lies beside the mesh.
    other["frame"] = json!("unspecified");
    let mut unmarked = meshes();
    unmarked.0.get_mut("ct in RAS").unwrap().frame = None;
    let found = check(&input(&other, &json!({})), &unmarked, &Limits::default());
    assert!(found.err().unwrap().to_string().contains("no cell lies inside the image"));
}

fn surface_of(read: ReadMesh) -> TriangleSurface {
    match read.mesh {
        Mesh::Surface(surface) => surface,
        _ => panic!("a surface was expected"),
    }
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

// The real CT.

const CT: &str = "head_ct/headsq_quarter_hu.nrrd";

fn ct() -> Option<(ImageVolume, Option<Frame>)> {
    let read = read(&fs::read(shared_data(CT)?).unwrap(), &ReadLimits::default()).unwrap();
    let frame = read.frame;
    match read.mesh {
        Mesh::Image(image) => Some((image, frame)),
        _ => panic!("an image was expected"),
    }
}

/// What a closed surface encloses, in cm³.
fn enclosed(surface: &TriangleSurface) -> f64 {
    let cone = |corners: [Vector; 3]| corners[0].dot(&corners[1].cross(&corners[2])) / 6.0;
    (0..surface.triangles.len()).map(|t| cone(surface.corners(t))).sum::<f64>() / 1000.0
}

/// What lies above a threshold, in cm³: whole voxels.
fn above(image: &ImageVolume, threshold: f64) -> f64 {
    let count = match image.voxels() {
        Voxels::I16(values) => values.iter().filter(|&&v| f64::from(v) >= threshold).count(),
        Voxels::F32(values) => values.iter().filter(|&&v| f64::from(v) >= threshold).count(),
    };
    count as f64 * image.voxel_volume() / 1000.0
}

#[test]
fn a_real_ct_has_one_value_everywhere_on_each_surface_that_was_taken_from_it() {
    let Some((image, frame)) = ct() else { return };
    assert_eq!((image.size(), frame), ([64, 64, 93], Some(Frame::Lps)));
    assert_eq!((image.spacing(), image.range()), ([3.2, 3.2, 1.5], (-1024.0, 2902.0)));
    // The thresholds of the surfaces; what a surface encloses in cm³, flat triangles and open edges included,
    // lies this close to what whole voxels above the threshold fill.
    for (file, threshold, closeness) in [("skin", -524.0, 0.05), ("bone", 226.0, 0.08)] {
        let Some(path) = shared_data(&format!("head_ct/headsq_quarter_{file}.stl")) else { return };
        let surface = surface_of(read(&fs::read(path).unwrap(), &ReadLimits::default()).unwrap());
        let mut off: Vec<f64> = surface.points.iter().filter_map(|x| image.at(x)).collect();
        off.iter_mut().for_each(|value| *value = (*value - threshold).abs());
        off.sort_by(f64::total_cmp);
        let (inside, all) = (off.len(), surface.points.len());
        // The rest caps the cut at the ends of the scan, half a voxel beyond the last centres.
        assert!(inside * 10 > all * 9, "{file}: {inside} of {all}");
        let (surface, voxels) = (enclosed(&surface), above(&image, threshold));
        println!(
            "{file}: {inside} of {all} points, off {threshold} HU by {:.1e} (median) and {:.1e} (p95); \
             {surface:.1} cm3 enclosed, {voxels:.1} cm3 of voxels",
            off[inside / 2],
            off[inside * 95 / 100],
        );
        // Single precision of positions in a gradient of hundreds of HU a mm.
        assert!(off[inside * 95 / 100] < 0.01, "{file}: {}", off[inside * 95 / 100]);
        assert!((surface / voxels - 1.0).abs() < closeness, "{file}: {surface} {voxels}");
    }
}

/// The made half head, stretched over the front of the head that was scanned.
fn head_in_the_ct() -> VolumeMesh {
    let mut mesh = half_head(4).mesh;
    let first = mesh.nodes[0];
    let bounds = mesh.nodes.iter().fold((first, first), |(a, b), x| (a.inf(x), b.sup(x)));
    let (low, high) = (Vector::new(24.0, 20.0, 1.0), Vector::new(184.0, 110.0, 137.0));
    let scale = (high - low).component_div(&(bounds.1 - bounds.0));
    mesh.nodes.iter_mut().for_each(|x| *x = low + (*x - bounds.0).component_mul(&scale));
    mesh
}

#[test]
fn a_real_ct_gives_a_prediction_its_materials() {
    let Some((image, frame)) = ct() else { return };
    let volume = stored(StoredShape::Volume(head_in_the_ct().into()), None);
    let image = stored(StoredShape::Image(image.into()), frame);
    let sources = Meshes([("head".to_owned(), volume), ("ct".to_owned(), image)].into());
    // METHODS row 16: muscle in embedding tissue.
    let mut case = json!({
        "units": "mm", "frame": "LPS", "volume": "head", "skin": {"node_set": "skin"},
        "segments": [{"name": "bone", "nodes": {"node_set": "mandible"}}],
        "fixed": [{"node_set": "skull"}, {"node_set": "maxilla"}, {"node_set": "rim"}],
        "materials": {"*": {"young_modulus_kpa": 50, "poisson_ratio": 0.455}},
    });
    let skin = |case: &Value| {
        let out = tempfile::tempdir().unwrap();
        let spec = json!({"outputs": ["skin.vtp"]});
        let mut input = input(case, &spec);
        input.plan = serde_json::from_value(
            json!({"segments": [{"name": "bone", "translation_mm": [0, -6, 0]}]}),
        )
        .unwrap();
        let place = Workplace { sources: &sources, limits: &Limits::default(), out: out.path() };
        let done = work(&JobInput::Predict(input), &place, &Unobserved).unwrap();
        let file = fs::read(out.path().join("skin.vtp")).unwrap();
        (surface_of(read(&file, &ReadLimits::default()).unwrap()).points, done.result)
    };
    let (plain, _) = skin(&case);
    for mixing in ["mean", "fraction"] {
        case["hounsfield"] = json!({"image": "ct", "samples": 512, "mixing": mixing, "tissues": [
            {"name": "muscle", "from_hu": -30, "to_hu": 100,
             "material": {"young_modulus_kpa": 300, "poisson_ratio": 0.44}}]});
        let (points, result) = skin(&case);
        let imaged = result.statistics.unwrap().imaged.unwrap();
        assert_eq!(imaged.outside_cells, 0);
        let share = imaged.tissues["muscle"].volume_share;
        assert!(share > 0.1 && share < 0.9, "{share}");
        let mut apart: Vec<f64> =
            points.iter().zip(&plain).map(|(x, other)| (x - other).norm()).collect();
        apart.sort_by(f64::total_cmp);
        let at = |percent: usize| apart[(apart.len() - 1) * percent / 100];
        println!(
            "{mixing}: {:.1} % muscle; skin apart from that of one material by {:.3} mm (median), \
             {:.3} (p95), {:.3} (largest), jaw 6 mm forward",
            100.0 * share,
            at(50),
            at(95),
            at(100)
        );
        // Different, and by less than the jaw moves.
        assert!(at(95) > 0.05 && at(100) < 6.0, "{} {}", at(95), at(100));
    }
}
