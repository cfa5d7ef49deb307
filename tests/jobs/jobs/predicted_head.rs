//! A head in numbers as it is predicted: movements of the skin are planted, so that every measure is known.

use facies::jobs::{JobContext, JobInput, PredictInput, StoredShape, work};
use facies::schema::Limits;
use facies::schema::predict::planned::{MeasureDocument, SymmetryDocument, TissueName};
use facies::schema::predict::result::ResultDocument;
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Frame, Vector, VolumeMesh};
use mechanics::progress::Unobserved;
use serde_json::{Value, json};

use crate::sources::{Meshes, stored};

/// Landmarks of the skin, each on a node of the front of a block, and where a prediction is to take them, in mm.
const LANDMARKS: [(&str, [f64; 3], [f64; 3]); 11] = [
    ("glabella", [40.0, 0.0, 40.0], [0.0; 3]),
    ("nasion", [40.0, 0.0, 30.0], [0.0; 3]),
    ("subnasale", [40.0, 0.0, 20.0], [0.0, -2.0, 0.0]),
    ("pogonion", [40.0, 0.0, 10.0], [0.0; 3]),
    ("menton", [40.0, 0.0, 0.0], [3.0, 0.0, 0.0]),
    ("exocanthion_left", [60.0, 0.0, 30.0], [0.0; 3]),
    ("exocanthion_right", [20.0, 0.0, 30.0], [0.0; 3]),
    ("endocanthion_left", [50.0, 0.0, 30.0], [0.0; 3]),
    ("endocanthion_right", [30.0, 0.0, 30.0], [0.0; 3]),
    ("cheilion_left", [50.0, 0.0, 10.0], [1.5, -0.5, 1.0]),
    ("cheilion_right", [30.0, 0.0, 10.0], [0.0; 3]),
];

/// Where the patient's left lies along +x, and the face looks along -y.
const BONE: [(&str, [f64; 3]); 3] =
    [("S", [40.0, 60.0, 60.0]), ("N", [40.0, 2.0, 65.0]), ("A", [40.0, 0.0, 20.0])];

/// The block, whose boundary but for one side goes where it is told.
fn tissue() -> VolumeMesh {
    let mut mesh = block(Vector::new(80.0, 60.0, 40.0), [8, 6, 4], CellShape::Hex8);
    let moved = |at: &Vector| {
        let own = LANDMARKS.iter().find(|(_, place, _)| (at - Vector::from(*place)).norm() < 1e-9);
        own.map_or(Vector::zeros(), |(_, _, by)| Vector::from(*by))
    };
    let field = mesh.nodes.iter().map(moved).collect();
    let faces = mesh.boundary_faces();
    let mut told: Vec<u32> = faces.iter().flat_map(|face| face.nodes().to_vec()).collect();
    told.retain(|&node| mesh.nodes[node as usize].x < 79.0);
    told.sort_unstable();
    told.dedup();
    mesh.node_vectors.insert("u_mm".to_owned(), field);
    mesh.node_sets.insert("told".to_owned(), told);
    mesh
}

fn places(
    of: impl Iterator<Item = (&'static str, [f64; 3])>,
    with: impl Fn(&str) -> bool,
) -> Value {
    of.filter(|(name, _)| with(name)).map(|(name, at)| (name.to_owned(), json!(at))).collect()
}

/// The prediction of a case with some of the landmarks, and with those of bone or without.
fn predicted(with: impl Fn(&str) -> bool, bone: Value) -> ResultDocument {
    let landmarks = places(LANDMARKS.iter().map(|(name, at, _)| (*name, *at)), with);
    let case = json!({
        "units": "mm", "frame": "LPS", "volume": "block", "skin": {"node_set": "y_min"},
        "segments": [{"name": "jaw", "nodes": {"node_set": "x_max"}}],
        "landmarks": landmarks, "bone_landmarks": bone,
        "materials": {"*": {"young_modulus_kpa": 15, "poisson_ratio": 0.4}}
    });
    let plan = json!({
        "segments": [{"name": "jaw", "translation_mm": [0, -3, 0]}],
        "prescribed": [{"nodes": {"node_set": "told"}, "array": "u_mm"}]
    });
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: serde_json::from_value(case).unwrap(),
        plan: serde_json::from_value(plan).unwrap(),
        spec: serde_json::from_value(json!({"method": "fem_linear", "estimate": "none"})).unwrap(),
    };
    let volume = stored(StoredShape::Volume(tissue().into()), Some(Frame::Lps));
    let sources = Meshes([("block".to_owned(), volume)].into());
    let folder = tempfile::tempdir().unwrap();
    let place = JobContext { sources: &sources, limits: &Limits::default(), out: folder.path() };
    work(&JobInput::Predict(input), &place, &Unobserved).unwrap().result
}

fn of_bone() -> Value {
    let landmark = |(name, at): &(&str, [f64; 3])| {
        let own = match *name {
            "A" => json!({"position_mm": at, "segment": "jaw"}),
            _ => json!({"position_mm": at}),
        };
        ((*name).to_owned(), own)
    };
    BONE.iter().map(landmark).collect()
}

fn measure<'a>(found: &'a ResultDocument, name: &str) -> &'a MeasureDocument {
    found.cephalometry.iter().find(|own| own.name == name).unwrap()
}

fn symmetry<'a>(found: &'a ResultDocument, name: &str) -> &'a SymmetryDocument {
    found.symmetry.iter().find(|own| own.landmark == name).unwrap()
}

/// The angle at N between the lines to S and to a place, in degrees.
fn angle_at_nasion(of: [f64; 3]) -> f64 {
    let [s, n, _] = BONE.map(|(_, at)| Vector::from(at));
    let (one, other) = ((s - n).normalize(), (Vector::from(of) - n).normalize());
    one.dot(&other).acos().to_degrees()
}

#[test]
fn measures_of_skin_are_told_as_predicted_and_those_of_bone_as_planned() {
    let found = predicted(|_| true, of_bone());

    // The profile is straight before. Predicted, subnasale lies 2 mm in front of glabella 20 mm above and of pogonion 10 mm below.
    let convexity = measure(&found, "facial_convexity");
    let wanted = (2.0_f64 / 20.0).atan().to_degrees() + (2.0_f64 / 10.0).atan().to_degrees();
    assert_eq!((convexity.tissue, convexity.planned), (TissueName::Skin, None));
    assert!(convexity.before.abs() < 1e-9, "{convexity:?}");
    assert!((convexity.predicted.unwrap() - wanted).abs() < 1e-6, "{convexity:?}");
    // Legan and Burstone's 12 with 4.
    let norm = convexity.norm.as_ref().unwrap();
    assert!((norm.before_z + 3.0).abs() < 1e-9 && norm.planned_z.is_none(), "{norm:?}");
    assert!((norm.predicted_z.unwrap() - (wanted - 12.0) / 4.0).abs() < 1e-6, "{norm:?}");

    let heights = measure(&found, "face_height_ratio");
    let wanted = (404.0_f64 / (400.0 + 4.0 + 9.0)).sqrt();
    assert!((heights.before - 1.0).abs() < 1e-9, "{heights:?}");
    assert!((heights.predicted.unwrap() - wanted).abs() < 1e-7, "{heights:?}");

    let sna = measure(&found, "sna");
    let [before, planned] = [[40.0, 0.0, 20.0], [40.0, -3.0, 20.0]].map(angle_at_nasion);
    assert_eq!((sna.tissue, sna.predicted), (TissueName::Bone, None));
    assert!((sna.before - before).abs() < 1e-9 && planned - before > 2.0, "{sna:?}");
    assert!((sna.planned.unwrap() - planned).abs() < 1e-9, "{sna:?}");
}

#[test]
fn the_symmetry_of_a_skin_is_told_without_landmarks_of_bone() {
    // Two pairs of the eyes make the plane; bone that has none of its own changes nothing.
    for bone in [json!({}), of_bone()] {
        let found = predicted(|_| true, bone);
        for (name, wanted) in
            [("cheilion", [1.5, 1.0, 0.5]), ("menton", [3.0, 0.0, 0.0]), ("nasion", [0.0; 3])]
        {
            let own = symmetry(&found, name);
            assert_eq!((own.tissue, own.plane), (TissueName::Skin, TissueName::Skin));
            assert!(own.before.length_mm < 1e-9 && own.planned.is_none(), "{own:?}");
            let off = own.predicted.unwrap();
            let off = Vector::new(off.left_mm, off.up_mm, off.forwards_mm);
            assert!((off - Vector::from(wanted)).amax() < 1e-7, "{own:?}");
        }
    }
    // One pair is not enough, and neither is a skin whose up nobody knows.
    for missing in ["exocanthion", "menton"] {
        let found = predicted(|name| !name.starts_with(missing), json!({}));
        assert!(found.symmetry.is_empty(), "{missing}: {:?}", found.symmetry);
    }
}
