//! A real CT and the surfaces that were taken from it.

use std::fs;

use facies::jobs::JobContext;
use facies::jobs::{JobInput, PredictInput, StoredShape, work};
use facies::schema::Limits;
use mechanics::format::Mesh;
use mechanics::image::{ImageVolume, Voxels};
use mechanics::mesh::half_head::half_head;
use mechanics::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};
use mechanics::progress::Unobserved;
use serde_json::{Value, json};

use crate::samples::{read_default, surface};
use crate::sources::{Meshes, stored};
use crate::support::external::{Missing, shared_data, trials};

trials! {
    a_real_ct_has_one_value_everywhere_on_each_surface_that_was_taken_from_it
    a_real_ct_gives_a_prediction_its_materials
}

const CT: &str = "head_ct/headsq_quarter_hu.nrrd";

/// The image, and the frame that its file names.
struct Scan {
    image: ImageVolume,
    frame: Option<Frame>,
}

fn ct() -> Result<Scan, Missing> {
    let read = read_default(&fs::read(shared_data(CT)?).unwrap());
    let frame = read.frame;
    let Mesh::Image(image) = read.mesh else { panic!("an image was expected") };
    Ok(Scan { image, frame })
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

fn a_real_ct_has_one_value_everywhere_on_each_surface_that_was_taken_from_it() -> Result<(), Missing>
{
    let Scan { image, frame } = ct()?;
    assert_eq!((image.size(), frame), ([64, 64, 93], Some(Frame::Lps)));
    assert_eq!((image.spacing(), image.range()), ([3.2, 3.2, 1.5], (-1024.0, 2902.0)));
    // The thresholds of the surfaces; what a surface encloses in cm³, flat triangles and open edges included,
    // lies this close to what whole voxels above the threshold fill.
    for (file, threshold, closeness) in [("skin", -524.0, 0.05), ("bone", 226.0, 0.08)] {
        let path = shared_data(&format!("head_ct/headsq_quarter_{file}.stl"))?;
        let surface = surface(read_default(&fs::read(path).unwrap()));
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
    Ok(())
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

fn a_real_ct_gives_a_prediction_its_materials() -> Result<(), Missing> {
    let Scan { image, frame } = ct()?;
    let volume = stored(StoredShape::Volume(head_in_the_ct().into()), None);
    let image = stored(StoredShape::Image(image.into()), frame);
    let sources = Meshes([("head".to_owned(), volume), ("ct".to_owned(), image)].into());
    // Muscle in embedding tissue (docs/methods.md#tissue-from-images).
    let mut case = json!({
        "units": "mm", "frame": "LPS", "volume": "head", "skin": {"node_set": "skin"},
        "segments": [{"name": "bone", "nodes": {"node_set": "mandible"}}],
        "fixed": [{"node_set": "skull"}, {"node_set": "maxilla"}, {"node_set": "rim"}],
        "materials": {"*": {"young_modulus_kpa": 50, "poisson_ratio": 0.455}},
    });
    let skin = |case: &Value| {
        let out = tempfile::tempdir().unwrap();
        let spec = json!({"outputs": ["skin.vtp"]});
        let plan = json!({"segments": [{"name": "bone", "translation_mm": [0, -6, 0]}]});
        let input = PredictInput {
            job: None,
            queue_s: None,
            case: serde_json::from_value(case.clone()).unwrap(),
            plan: serde_json::from_value(plan).unwrap(),
            spec: serde_json::from_value(spec).unwrap(),
        };
        let place = JobContext { sources: &sources, limits: &Limits::default(), out: out.path() };
        let done = work(&JobInput::Predict(input), &place, &Unobserved).unwrap();
        let file = fs::read(out.path().join("skin.vtp")).unwrap();
        (surface(read_default(&file)).points, done.result)
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
    Ok(())
}
