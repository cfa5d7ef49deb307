//! The generic face as a patient: its jaw moved, and its mouth as its muscles pull it.

use std::collections::BTreeMap;

use mechanics::mesh::generic_face::{FaceSettings, GenericFace, LAYERS, Lips, generic_face};
use mechanics::mesh::{CellShape, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Activation, Case, CaseSegment, Muscle, MuscleCourse, Plan, RegionNames, Settings, Sliding,
    SlidingNormal,
};

use crate::scenes::{case_of, material, set, solve};

struct Face {
    face: GenericFace,
    case: Case,
}

fn face(lips: Lips) -> Face {
    let face = generic_face(FaceSettings { lips, fineness: 1, shape: CellShape::Hex8 });
    let names = LAYERS.iter().enumerate().map(|(at, name)| (at as i64, (*name).to_owned()));
    let muscles = face.muscles.iter().map(|own| Muscle {
        name: own.name.clone(),
        course: MuscleCourse::Lines { lines: own.lines.clone(), within: own.within },
        tissue: None,
        stiffening: None,
    });
    let segment = |name: &str| CaseSegment { name: name.to_owned(), nodes: set(name) };
    let slides = |(nodes, segment): (&str, &str)| Sliding {
        nodes: set(nodes),
        normal: SlidingNormal::Surface,
        segment: Some(segment.to_owned()),
    };
    let case = Case {
        regions: Some(RegionNames { array: "layer".to_owned(), names: names.collect() }),
        skin: Some(set("skin")),
        segments: ["maxilla", "mandible"].map(segment).to_vec(),
        fixed: vec![set("skull"), set("rim")],
        sliding: [("upper_vestibule", "maxilla"), ("lower_vestibule", "mandible")]
            .map(slides)
            .to_vec(),
        muscles: muscles.collect(),
        ..case_of(face.mesh.clone(), material(15.0, 0.46))
    };
    Face { face, case }
}

impl Face {
    /// The displacement of the skin at a landmark, from the node that is nearest.
    fn at(&self, displacement: &[Vector], landmark: &str) -> Vector {
        let place = self.face.landmarks[landmark];
        // Of two lips that touch, the right one.
        let set = match landmark {
            "stomion_superius" => "upper_lip_margin",
            "stomion_inferius" => "lower_lip_margin",
            _ => "skin",
        };
        let far = |node: &&u32| (self.face.mesh.nodes[**node as usize] - place).norm();
        let nodes = self.face.mesh.node_set(set).unwrap();
        displacement[*nodes.iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap() as usize]
    }

    /// What each kPa does, in mm.
    fn pulled(&self, muscles: &[&str]) -> Vec<Vector> {
        let activation = |name: &&str| Activation { muscle: (*name).to_owned(), stress: 1.0 };
        let activations = muscles.iter().map(activation).collect();
        solve(&self.case, &Plan { activations, ..Plan::default() }, &Settings::default())
            .displacement
    }

    fn both(&self, muscle: &str) -> Vec<Vector> {
        let [left, right] = ["left", "right"].map(|side| format!("{muscle}_{side}"));
        self.pulled(&[&left, &right])
    }
}

#[test]
fn a_jaw_five_millimetres_forward_takes_chin_and_lower_lip_along_and_leaves_the_rest() {
    for lips in [Lips::Closed, Lips::Open] {
        let face = face(lips);
        let movement = RigidMovement::about_pivot(
            Vector::zeros(),
            Vector::zeros(),
            Vector::new(0.0, -5.0, 0.0),
        );
        let jaw = PlannedSegment { name: "mandible".to_owned(), movement };
        let plan = Plan { segments: vec![jaw], ..Plan::default() };
        let u = solve(&face.case, &plan, &Settings::default()).displacement;
        let forward = |landmark: &str| -face.at(&u, landmark).y;
        assert!((4.2..5.0).contains(&forward("pogonion")), "{}", forward("pogonion"));
        assert!((4.0..5.0).contains(&forward("labrale_inferius")));
        assert!(forward("labrale_superius") < 0.6 && forward("pronasale").abs() < 0.3);
        assert!(u.iter().all(|u| u.norm() < 5.5));
    }
}

#[test]
fn muscles_of_the_generic_face_move_its_mouth_as_their_names_say() {
    let mut corners = BTreeMap::new();
    let face = face(Lips::Open);
    for muscle in [
        "zygomaticus_major",
        "depressor_anguli_oris",
        "levator_labii",
        "depressor_labii",
        "buccinator",
    ] {
        let u = face.both(muscle);
        let [left, right] = ["cheilion_left", "cheilion_right"].map(|name| face.at(&u, name));
        assert!((left.x + right.x).abs() < 1e-6 && (left.z - right.z).abs() < 1e-6);
        let lips = ["stomion_superius", "stomion_inferius"].map(|name| face.at(&u, name).z);
        corners.insert(muscle, (left, lips));
    }
    let (corner, _) = corners["zygomaticus_major"];
    assert!(corner.x > 0.0 && corner.z > 0.0, "zygomaticus: {corner}");
    let (corner, _) = corners["depressor_anguli_oris"];
    assert!(corner.z < 0.0, "depressor anguli oris: {corner}");
    let (corner, _) = corners["buccinator"];
    assert!(corner.x > 0.0 && corner.y > 0.0, "buccinator: {corner}");
    let (_, [upper, _]) = corners["levator_labii"];
    assert!(upper > 0.0, "levator labii: {upper}");
    let (_, [_, lower]) = corners["depressor_labii"];
    assert!(lower < 0.0, "depressor labii: {lower}");

    let u = face.pulled(&["orbicularis_oris"]);
    let [upper, lower] = ["stomion_superius", "stomion_inferius"].map(|name| face.at(&u, name).z);
    assert!(upper < 0.0 && lower > 0.0, "orbicularis: {upper}, {lower}");
    assert!(face.at(&u, "cheilion_left").x < 0.0);
}
