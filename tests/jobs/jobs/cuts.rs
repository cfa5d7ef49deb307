//! Cuts through the bone of a scan: their paths for navigation, and how clear they keep of what must not be sawn.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs;

use facies::jobs::{JobContext, JobInput, MeshingInput, StoredMesh, work};
use facies::schema::Limits;
use facies::schema::meshing::cuts::CutPathDocument;
use facies::schema::predict::result::ResultDocument;
use mechanics::format::{self, ReadLimits};
use mechanics::mesh::Vector;
use mechanics::progress::Unobserved;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::samples::ball_ct;
use crate::sources::Meshes;

/// A ball of bone of 30 mm around (60, 55, 60) mm in a scan with voxels of 4 mm, cut 12 mm below its middle.
fn meshed(risks: Value) -> Result<(ResultDocument, TempDir), String> {
    meshed_by(json!({
        "cuts": [{"name": "low", "point_mm": [0, 0, 48], "normal": [0, 0, 2], "kerf_mm": 1}],
        "segments": [{"name": "jaw, lower", "below": ["low"]}], "risks": risks}))
}

fn meshed_by(osteotomy: Value) -> Result<(ResultDocument, TempDir), String> {
    meshed_finely(osteotomy, json!([]))
}

fn meshed_finely(osteotomy: Value, fine: Value) -> Result<(ResultDocument, TempDir), String> {
    let read = format::read(&ball_ct(), &ReadLimits::default()).unwrap();
    let scan = StoredMesh::new(read, None, "scan".to_owned());
    let sources = Meshes(BTreeMap::from([("scan".to_owned(), scan)]));
    let spec = json!({
        "kind": "mesh", "scan": "scan", "thresholds_hu": {"skin": -480, "bone": 620}, "size": {"tetrahedra": 8000, "fine": fine},
        "osteotomy": osteotomy
    });
    let spec = serde_json::from_value(spec).unwrap();
    let input = JobInput::Meshing(MeshingInput { job: None, queue_s: None, spec, case: None });
    let folder = tempfile::tempdir().unwrap();
    let place = JobContext { sources: &sources, limits: &Limits::default(), out: folder.path() };
    let done = work(&input, &place, &Unobserved).map_err(|error| format!("{error:?}"))?;
    Ok((done.result, folder))
}

fn line(name: &str, points: Value, clearance_mm: f64) -> Value {
    json!({"name": name, "points_mm": points, "radius_mm": 1.5, "clearance_mm": clearance_mm})
}

#[test]
fn a_cut_has_the_outline_of_the_bone_and_its_distance_from_a_nerve() {
    // A nerve along y 6 mm below the cut, and one that goes through it.
    let nerve = line("nerve", json!([[60, 20, 42], [60, 90, 42]]), 5.0);
    let far = line("far", json!([[60, 20, 42], [60, 90, 42]]), 3.0);
    let through = line("through", json!([[50, 55, 30], [50, 55, 70]]), 0.0);
    let (result, folder) = meshed(json!([nerve, far, through])).unwrap();
    let cuts: &[CutPathDocument] = &result.meshing.as_ref().unwrap().cuts;
    let [cut] = cuts else { panic!("{cuts:?}") };
    assert_eq!((cut.cut.as_str(), cut.segment.as_str()), ("low", "jaw, lower"));
    // sqrt(30² - 12²) mm around the axis, to half a voxel.
    let radius = (900.0_f64 - 144.0).sqrt();
    assert!((cut.area_mm2 / (PI * radius * radius) - 1.0).abs() < 0.12, "{}", cut.area_mm2);
    assert_eq!((cut.normal.0, cut.paths_mm.len()), ([0.0, 0.0, 1.0], 1));
    for &point in &cut.paths_mm[0] {
        let from_axis = Vector::from(point) - Vector::new(60.0, 55.0, 48.0);
        assert!((from_axis.norm() - radius).abs() < 2.0 && from_axis.z.abs() < 1e-9);
    }
    let distances: Vec<f64> = cut.clearances.iter().map(|own| own.distance_mm).collect();
    // 6 mm less half of the saw and the radius of the nerve.
    for (found, expected) in distances.iter().zip([4.0, 4.0, -2.0]) {
        assert!((found - expected).abs() < 1e-9, "{distances:?}");
    }
    let near: Vec<&str> = result
        .warnings
        .iter()
        .filter(|warning| warning.code == "cut-near-risk")
        .map(|warning| warning.detail.as_str())
        .collect();
    let [first, second] = near[..] else { panic!("{near:?}") };
    assert!(first.contains("too near to \"nerve\"") && second.contains("goes through \"through\""));
    read_again(&folder, cut);
}

/// Steps along x at 44 mm and, beyond the middle of the ball, at 52 mm, each between two layers of voxels, so deep into the bone from
/// before it.
fn steps(depth_mm: f64) -> Value {
    json!({
        "polylines": [{
            "name": "steps", "polyline_mm": [[20, 15, 44], [60, 15, 44], [60, 15, 52], [100, 15, 52]],
            "direction": [0, 2, 0], "depth_mm": depth_mm
        }],
        "segments": [{"name": "jaw", "below": ["steps"], "seeds_mm": [[60, 55, 36]]}]
    })
}

#[test]
fn a_stepped_cut_is_meshed_and_each_of_its_pieces_has_the_area_of_the_bone_there() {
    let (result, _folder) = meshed_by(steps(80.0)).unwrap();
    let meshing = result.meshing.as_ref().unwrap();
    let named: Vec<&str> = meshing.cuts.iter().map(|cut| cut.cut.as_str()).collect();
    assert_eq!(named, ["steps, piece 1", "steps, piece 2", "steps, piece 3"]);
    // Half a disc on each tread; on the riser the chords of the ball around x = 60 from 44 to 52 mm.
    let half = |height: f64| 0.5 * PI * (900.0 - (60.0 - height).powi(2));
    let chord = |z: f64| 2.0 * (900.0 - (60.0 - z).powi(2)).sqrt();
    let riser = 8.0 / 6.0 * (chord(44.0) + 4.0 * chord(48.0) + chord(52.0));
    for (cut, wanted) in meshing.cuts.iter().zip([half(44.0), riser, half(52.0)]) {
        assert!((cut.area_mm2 / wanted - 1.0).abs() < 0.2, "{} {wanted}", cut.area_mm2);
        let [x, y, z] = cut.normal.0;
        let along_x = cut.cut.ends_with('2');
        assert!(if along_x { (x.abs() - 1.0).abs() < 1e-12 } else { (z - 1.0).abs() < 1e-12 });
        assert_eq!(y, 0.0);
    }
    // A cap of the ball below 44 mm, and half of the slice from there to 52 mm.
    let cap = |h: f64| PI * h * h * (30.0 - h / 3.0);
    let (low, high) = (cap(14.0), cap(22.0));
    let [segment] = &meshing.segments[..] else { panic!("{:?}", meshing.segments) };
    let wanted = (low + 0.5 * (high - low)) / 1000.0;
    assert!((segment.volume_ml / wanted - 1.0).abs() < 0.08, "{segment:?} {wanted}");
}

#[test]
fn a_wide_saw_is_not_told_to_touch_bone_that_stays_as_its_dust_does() {
    let (result, _folder) = meshed_by(json!({
        "cuts": [{"name": "low", "point_mm": [0, 0, 48], "normal": [0, 0, 2], "kerf_mm": 9}],
        "segments": [{"name": "jaw", "below": ["low"]}]}))
    .unwrap();
    let codes: Vec<&str> = result.warnings.iter().map(|warning| warning.code.as_str()).collect();
    assert!(!codes.contains(&"bones-touch"), "{:?}", result.warnings);
}

#[test]
fn a_line_that_begins_beside_the_bone_is_one_cut_and_reported_once_where_all_of_it_is_there() {
    let told = |line: Value| -> Vec<(String, Value)> {
        let mut asked = steps(80.0);
        asked["polylines"][0]["polyline_mm"] = line;
        let (result, _folder) = meshed_by(asked).unwrap();
        let missed = result.warnings.into_iter().filter(|own| own.code == "cut-meets-no-bone");
        missed.map(|own| (own.detail, json!(own.numbers))).collect()
    };
    let beside = json!([
        [0, 15, 44],
        [20, 15, 44],
        [60, 15, 44],
        [60, 15, 52],
        [100, 15, 52],
        [120, 15, 52]
    ]);
    assert_eq!(told(beside), []);
    let nowhere = told(json!([[20, 15, 144], [60, 15, 144], [60, 15, 152], [100, 15, 152]]));
    let [(detail, numbers)] = &nowhere[..] else { panic!("{nowhere:?}") };
    assert!(
        detail.starts_with("cut `steps` meets no bone of a segment with any of its 3 pieces"),
        "{detail}"
    );
    assert_eq!(numbers["pieces"], json!(3.0));
}

#[test]
fn a_cut_along_the_end_of_the_bone_has_no_path_and_one_that_another_repeats_has_one() {
    let both = json!([{"name": "one", "below": ["c", "d"]}]);
    let by = |second: f64, segments: &Value| {
        let cut = |name: &str, z: f64| json!({"name": name, "point_mm": [60, 55, z], "normal": [0, 0, 1]});
        let asked = json!({"cuts": [cut("c", 48.0), cut("d", second)], "segments": segments});
        let (result, _folder) = meshed_by(asked).unwrap();
        let paths: Vec<String> =
            result.meshing.unwrap().cuts.into_iter().map(|path| path.cut).collect();
        let missed = result.warnings.into_iter().filter(|own| own.code == "cut-meets-no-bone");
        (paths, missed.map(|own| own.detail).collect::<Vec<String>>())
    };
    // The ball ends at 90 mm, within a voxel of the second cut.
    let (paths, missed) = by(91.0, &both);
    assert_eq!(paths, ["c"]);
    let [detail] = &missed[..] else { panic!("{missed:?}") };
    assert!(detail.starts_with("cut `d` meets no bone of a segment: bone reaches"), "{detail}");
    let (_, missed) = by(910.0, &both);
    assert!(missed[0].contains("and lies outside the image of the bone"), "{missed:?}");
    let apart = json!([{"name": "one", "below": ["c"]}, {"name": "other", "above": ["d"]}]);
    let (paths, missed) = by(48.0, &apart);
    assert_eq!((paths.len(), missed.len()), (2, 0), "{paths:?} {missed:?}");
}

#[test]
fn a_place_that_is_to_be_fine_and_holds_no_tissue_is_reported() {
    let fine = json!([{"sphere_mm": [60, 55, 92, 4]}, {"box_mm": [500, 0, 0, 520, 20, 20]}, {"sphere_mm": [60, 55, -400, 5]}]);
    let (result, _folder) = meshed_finely(steps(80.0), fine).unwrap();
    let told = result.warnings.iter().filter(|own| own.code == "fine-place-empty");
    let places: Vec<&Value> = told.map(|own| &own.numbers["place"]).collect();
    assert_eq!(places, [&json!(1.0), &json!(2.0)], "{:?}", result.warnings);
}

#[test]
fn a_root_as_a_surface_has_its_distance_from_the_saw() {
    // A tetrahedron with its tip 4 mm below the cut.
    let root = json!({"name": "root", "points_mm": [[60, 55, 44], [56, 51, 38], [64, 51, 38], [60, 61, 38]],
        "triangles": [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], "clearance_mm": 4});
    let (result, _folder) = meshed(json!([root])).unwrap();
    let [clearance] = &result.meshing.as_ref().unwrap().cuts[0].clearances[..] else { panic!() };
    assert!((clearance.distance_mm - 3.5).abs() < 1e-9, "{clearance:?}");
    assert_eq!(clearance.at_mm.0, [60.0, 55.0, 44.0]);
    assert!(result.warnings.iter().any(|warning| warning.code == "cut-near-risk"));
}

#[test]
fn a_line_that_saws_nothing_is_refused_where_it_stands() {
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut asked = steps(80.0);
        change(&mut asked);
        meshed_by(asked).map(|_| ()).unwrap_err()
    };
    let line = "/polylines/0";
    for (change, place) in [
        (&|a: &mut Value| a["polylines"][0]["depth_mm"] = json!(0), "/depth_mm"),
        (&|a: &mut Value| a["polylines"][0]["direction"] = json!([0, 0, 0]), "/direction"),
        (&|a: &mut Value| a["polylines"][0]["direction"] = json!([1, 0, 0]), "/polyline_mm"),
        (&|a: &mut Value| a["polylines"][0]["polyline_mm"] = json!([[1, 2, 3]]), "/polyline_mm"),
        (&|a: &mut Value| a["polylines"][0]["kerf_mm"] = json!(11), "/kerf_mm"),
    ] as [(&dyn Fn(&mut Value), &str); 5]
    {
        let told = changed(change);
        assert!(told.contains(&format!("/spec/osteotomy{line}{place}")), "{place}: {told}");
    }
    let shallow = meshed_by(steps(40.0)).map(|_| ()).unwrap_err();
    let told = ["cut-leaves-bridge", "CutLeavesBridge"].iter().any(|code| shallow.contains(code));
    assert!(told && shallow.contains("/spec/osteotomy/polylines/0"), "{shallow}");
}

/// The table has the same bits.
fn read_again(folder: &TempDir, cut: &CutPathDocument) {
    let table = fs::read_to_string(folder.path().join("cut-paths.csv")).unwrap();
    let rows =
        table.lines().skip(1).map(|row| row.strip_prefix("LPS,low,\"jaw, lower\",1,").unwrap());
    let points: Vec<[u64; 3]> = rows
        .map(|row| {
            let numbers: Vec<f64> = row.split(',').map(|number| number.parse().unwrap()).collect();
            assert_eq!(numbers[3..], cut.normal.0);
            [0, 1, 2].map(|axis| numbers[axis].to_bits())
        })
        .collect();
    let told: Vec<[u64; 3]> =
        cut.paths_mm[0].iter().map(|point| point.0.map(f64::to_bits)).collect();
    assert_eq!(points, told);
}

#[test]
fn a_structure_that_is_no_line_is_refused_where_it_stands() {
    let good = || line("nerve", json!([[60, 20, 42], [60, 90, 42]]), 5.0);
    let mut short = good();
    short["points_mm"] = json!([[60, 20, 42]]);
    let mut thick = good();
    thick["radius_mm"] = json!(-1);
    let mut clearance = good();
    clearance["clearance_mm"] = json!(51);
    let mut beyond = good();
    beyond["points_mm"][1][2] = json!(1e9);
    let mut beyond_points = good();
    beyond_points["triangles"] = json!([[0, 1, 2]]);
    for (risks, place) in [
        (json!([beyond_points]), "risks/0/triangles/0"),
        (json!([short]), "risks/0/points_mm"),
        (json!([good(), thick]), "risks/1/radius_mm"),
        (json!([clearance]), "risks/0/clearance_mm"),
        (json!([beyond]), "risks/0/points_mm/1/2"),
        (json!([good(), good()]), "risks/1"),
    ] {
        let told = meshed(risks).map(|_| ()).unwrap_err();
        assert!(told.contains(&format!("/spec/osteotomy/{place}")), "{place}: {told}");
    }
}
