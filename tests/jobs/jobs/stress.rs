//! Stress as documents ask for it: arrays of `volume.vtu`, numbers by region, frames, and what is refused.

use std::fs;
use std::io::Read;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use facies::schema::predict::stress::StrainMeasure;
use facies::schema::{Faults, Limits, PredictDocument};
use serde_json::{Value, json};

use super::results::predict;

/// A block of 80 x 60 x 40 mm between walls that is pressed by 1 % from below; E 15 kPa, nu .4.
fn case(volume: &str, frame: &str) -> Value {
    let wall = |set: &str, normal: [i32; 3]| json!({"nodes": {"node_set": set}, "normal": normal});
    json!({
        "units": "mm", "volume": volume, "frame": frame, "skin": {"node_set": "y_max"}, "fixed": [{"node_set": "z_max"}],
        "segments": [{"name": "base", "nodes": {"node_set": "z_min"}}],
        "sliding": [wall("x_min", [1, 0, 0]), wall("x_max", [1, 0, 0]), wall("y_min", [0, 1, 0]), wall("y_max", [0, 1, 0])],
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.4}}
    })
}

fn plan(translation: [f64; 3]) -> String {
    json!({"segments": [{"name": "base", "translation_mm": translation}]}).to_string()
}

/// The numbers of an array of a VTU file, in the section that is named.
fn array(file: &str, section: &str, name: &str) -> Vec<f64> {
    let (_, rest) = file.split_once(&format!("<{section}>")).unwrap();
    let (_, rest) = rest.split_once(&format!("Name=\"{name}\"")).unwrap();
    let (_, rest) = rest.split_once(">\n").unwrap();
    let (text, _) = rest.split_once('\n').unwrap();
    // The first number of the header says how many blocks there are, three and one for each block it has in all.
    let first = STANDARD.decode(&text[..32]).unwrap();
    let blocks = u64::from_le_bytes(first[..8].try_into().unwrap()) as usize;
    let header = (8 * (3 + blocks)).div_ceil(3) * 4;
    let sizes = STANDARD.decode(&text[..header]).unwrap();
    let data = STANDARD.decode(&text[header..]).unwrap();
    let (mut at, mut bytes) = (0, Vec::new());
    for block in 0..blocks {
        let place = 8 * (3 + block);
        let size = u64::from_le_bytes(sizes[place..place + 8].try_into().unwrap()) as usize;
        flate2::read::ZlibDecoder::new(&data[at..at + size]).read_to_end(&mut bytes).unwrap();
        at += size;
    }
    bytes.chunks(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect()
}

fn volume(out: &Path) -> String {
    String::from_utf8(fs::read(out.join("volume.vtu")).unwrap()).unwrap()
}

#[test]
fn a_pressed_block_has_its_stress_in_the_file_and_in_the_result() {
    // lambda + 2 mu = 32.142857, lambda = 21.428571 kPa.
    let stress = [-0.214_285_7, -0.214_285_7, -0.321_428_6, 0.0, 0.0, 0.0];
    let strain = [0.0, 0.0, -0.01, 0.0, 0.0, 0.0];
    for volume_name in ["block", "bricks"] {
        let out = tempfile::tempdir().unwrap();
        let spec = r#"{"method":"fem_linear","stress":true,"outputs":["volume.vtu"]}"#;
        let case = case(volume_name, "LPS").to_string();
        let done = predict(&case, &plan([0.0, 0.0, 0.4]), spec, out.path()).unwrap();
        let file = volume(out.path());
        assert!(file.contains(
            r#"Name="stress_kpa" NumberOfComponents="6" ComponentName0="xx" ComponentName1="yy" ComponentName2="zz" ComponentName3="xy""#
        ));
        for section in ["PointData", "CellData"] {
            for (name, expected) in [("stress_kpa", stress), ("strain", strain)] {
                for tensor in array(&file, section, name).chunks(6) {
                    let pairs = tensor.iter().zip(expected);
                    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(off < 1e-6, "{volume_name} {section} {name}: {tensor:?}");
                }
            }
            let pressures = array(&file, section, "pressure_kpa");
            assert!(pressures.iter().all(|p| (p - 0.25).abs() < 1e-6), "{pressures:?}");
            let mises = array(&file, section, "von_mises_kpa");
            assert!(mises.iter().all(|p| (p - 0.107_142_9).abs() < 1e-6), "{mises:?}");
        }
        let told = done.result.stress.unwrap();
        assert_eq!(told.strain, StrainMeasure::Small);
        let tissue = &told.regions["tissue"];
        assert!((tissue.pressure_kpa.mean - 0.25).abs() < 1e-6);
        assert!((tissue.von_mises_kpa.max - 0.107_142_9).abs() < 1e-6);
    }
}

#[test]
fn tensors_are_written_in_the_frame_of_the_file() {
    let stress = |frame: &str| {
        let out = tempfile::tempdir().unwrap();
        let spec = r#"{"method":"fem_linear","stress":true,"outputs":["volume.vtu"]}"#;
        let case = case("bricks", frame).to_string();
        predict(&case, &plan([2.0, 1.0, 0.4]), spec, out.path()).unwrap();
        array(&volume(out.path()), "CellData", "stress_kpa")
    };
    let (lps, ras) = (stress("LPS"), stress("RAS"));
    // The same numbers are another body in RAS, whose file is turned by half about z: yz and xz change their sign.
    let largest = lps.iter().copied().fold(0.0_f64, |most, s| most.max(s.abs()));
    let mut shear = 0.0_f64;
    for (own, other) in lps.chunks(6).zip(ras.chunks(6)) {
        for (k, sign) in [1.0, 1.0, 1.0, 1.0, -1.0, -1.0].into_iter().enumerate() {
            assert!((own[k] - sign * other[k]).abs() < 1e-9 * largest, "{own:?} {other:?}");
        }
        shear = shear.max(own[5].abs());
    }
    assert!(shear > 0.1 * largest);
}

#[test]
fn finite_strain_and_auto_have_stress_too() {
    for (method, measure) in [
        ("fem_nonlinear", Some(StrainMeasure::Green)),
        ("mtm", Some(StrainMeasure::Small)),
        ("auto", None),
    ] {
        let out = tempfile::tempdir().unwrap();
        let spec = json!({"method": method, "stress": true, "outputs": ["volume.vtu"]}).to_string();
        let case = case("block", "LPS").to_string();
        let done = predict(&case, &plan([0.0, 0.0, 4.0]), &spec, out.path()).unwrap();
        let told = done.result.stress.unwrap();
        assert!(measure.is_none_or(|measure| measure == told.strain), "{method}: {told:?}");
        let pressure = told.regions["tissue"].pressure_kpa.mean;
        // Linear: 2.5 kPa at 10 %.
        assert!((2.4..2.9).contains(&pressure), "{method}: {pressure}");
    }
}

fn refusal(spec: &str) -> Vec<(String, String)> {
    let document: PredictDocument = serde_json::from_str(spec).unwrap();
    let mut faults = Faults::default();
    document.to_settings(&Limits::default(), &mut faults);
    let problem = faults.into_result().err();
    let errors = problem.into_iter().flat_map(|problem| problem.errors);
    errors.map(|error| (error.code.name().to_owned(), error.pointer)).collect()
}

#[test]
fn stress_that_no_file_would_hold_or_no_method_has_is_refused() {
    let at = |code: &str| vec![(code.to_owned(), "/spec/stress".to_owned())];
    for method in ["msm", "dvs", "thickness_warp", "mtm_nonlinear"] {
        let spec = json!({"method": method, "stress": true, "outputs": ["volume.vtu"]});
        assert_eq!(refusal(&spec.to_string()), at("method-mismatch"), "{method}");
    }
    assert_eq!(refusal(r#"{"method":"fem_linear","stress":true}"#), at("one-of"));
    let refined = r#"{"stress":true,"outputs":["volume.vtu"],"refine":{"accept_mm":0.1}}"#;
    assert_eq!(refusal(refined), at("one-of"));
    assert!(refusal(r#"{"stress":true,"outputs":["volume.vtu"]}"#).is_empty());
    // What is not asked for does not change the hash of a job.
    assert!(PredictDocument::default().content().get("stress").is_none());
}
