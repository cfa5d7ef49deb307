//! Measures of a head by its landmarks, with numbers that another program computed: docs/verification.md#cephalometry.

use std::collections::BTreeMap;

use mechanics::cephalometry::{Landmarks, MEASURES, MidSagittal, NORMS, z_score};
use mechanics::mesh::generic_face::{FaceSettings, Lips, generic_face};
use mechanics::mesh::{CellShape, Frame, Vector};

type Named = BTreeMap<String, Vector>;

/// In LPS, mm.
fn example() -> Named {
    let points = [
        ("S", [0.0, 20.0, 60.0]),
        ("N", [0.0, -48.0, 70.0]),
        ("A", [0.0, -52.0, 18.0]),
        ("B", [0.0, -46.0, -28.0]),
        ("Me", [0.0, -38.0, -52.0]),
        ("Go_L", [45.0, 18.0, -24.0]),
        ("Go_R", [-45.0, 18.0, -24.0]),
        ("Po_L", [55.0, 38.0, 38.0]),
        ("Po_R", [-55.0, 38.0, 38.0]),
        ("Or_L", [35.0, -38.0, 36.0]),
        ("Or_R", [-35.0, -38.0, 36.0]),
        ("ANS", [0.0, -54.0, 22.0]),
        ("U1", [0.0, -57.0, -6.0]),
        ("L1", [0.0, -53.0, -5.0]),
        ("Oc", [0.0, -10.0, -4.0]),
    ];
    points.into_iter().map(|(name, at)| (name.to_owned(), Vector::from(at))).collect()
}

fn measure(name: &str, landmarks: &Named) -> Option<f64> {
    MEASURES.iter().find(|measure| measure.name == name).unwrap().of(&Landmarks(landmarks))
}

fn assert_measures(landmarks: &Named, wanted: &[(&str, f64)]) {
    for (name, wanted) in wanted {
        let found = measure(name, landmarks).unwrap();
        assert!((found - wanted).abs() < 1e-8, "{name}: {found} instead of {wanted}");
    }
}

const EXAMPLE: [(&str, f64); 13] = [
    ("sna", 86.032_819_231_0),
    ("snb", 80.464_974_548_1),
    ("anb", 5.567_844_682_9),
    ("fma", 25.057_615_418_3),
    ("sn_to_frankfort", 9.873_321_882_8),
    ("wits", 4.038_898_079_4),
    ("overjet", 4.024_922_359_5),
    ("overbite", 0.894_427_191_0),
    ("overjet_occlusal", 4.038_898_079_4),
    ("overbite_occlusal", 0.829_036_974_2),
    ("upper_face_height", 48.373_546_489_8),
    ("lower_face_height", 75.709_972_923_0),
    ("lower_face_share", 0.618_499_294_6),
];

#[test]
fn the_measures_of_the_example_are_those_of_another_program() {
    assert_measures(&example(), &EXAMPLE);
    let up = Landmarks(&example()).head().unwrap().up;
    assert!((up - Vector::new(0.0, -0.026_306_68, 0.999_653_92)).amax() < 1e-8, "{up}");
}

#[test]
fn a_mandible_four_millimetres_forward_changes_what_hangs_on_it() {
    let mut planned = example();
    for name in ["B", "Me", "L1", "Go_L", "Go_R"] {
        planned.get_mut(name).unwrap().y -= 4.0;
    }
    assert_measures(&planned, &[("snb", 82.803_253_203_9), ("anb", 3.229_566_027_1)]);
    // Along Frankfort, which is not quite along y.
    let [before, after] = [example(), planned].map(|l| measure("overjet", &l).unwrap());
    assert!((before - after - 4.0 * 0.999_653_92).abs() < 1e-7);
}

#[test]
fn the_measures_do_not_depend_on_where_the_head_lies_or_how_it_is_turned() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.7, 1.9);
    let moved: Named = example()
        .into_iter()
        .map(|(name, at)| (name, turn * at + Vector::new(300.0, -20.0, 7.0)))
        .collect();
    assert_measures(&moved, &EXAMPLE);
    // And in RAS they are the same.
    let ras: Named =
        example().into_iter().map(|(n, at)| (n, Vector::new(-at.x, -at.y, at.z))).collect();
    assert_measures(&ras, &EXAMPLE);
    assert!(Landmarks(&ras).swapped_sides(Frame::Ras).is_empty());
}

#[test]
fn a_lower_jaw_in_front_has_a_negative_anb() {
    let mut third = example();
    third.get_mut("B").unwrap().y -= 15.0;
    let anb = measure("anb", &third).unwrap();
    assert!((-4.0..-2.0).contains(&anb), "{anb}");
}

#[test]
fn swapped_sides_are_reported_with_how_far() {
    let mut swapped = example();
    assert!(Landmarks(&swapped).swapped_sides(Frame::Lps).is_empty());
    let [left, right] = ["Po_L", "Po_R"].map(|name| swapped[name]);
    swapped.insert("Po_L".to_owned(), right);
    swapped.insert("Po_R".to_owned(), left);
    let found = Landmarks(&swapped).swapped_sides(Frame::Lps);
    assert_eq!((found.len(), found[0].by, found[0].left.as_str()), (1, 110.0, "Po_L"));
    assert!(Landmarks(&swapped).swapped_sides(Frame::Unspecified).is_empty());
}

#[test]
fn what_lacks_a_landmark_is_left_out_and_the_rest_is_reported() {
    let mut few = example();
    few.remove("Or_L");
    assert_eq!(measure("overjet", &few), None);
    assert!((measure("sna", &few).unwrap() - 86.032_819_231).abs() < 1e-8);
    assert_eq!(measure("facial_convexity", &few), None);
}

#[test]
fn a_profile_is_convex_above_zero_and_concave_below() {
    let profile = |chin: [f64; 3]| {
        let at = |name: &str, at: [f64; 3]| (name.to_owned(), Vector::from(at));
        [
            at("glabella", [0.0, -60.0, 75.0]),
            at("subnasale", [0.0, -60.0, 10.0]),
            at("pogonion", chin),
        ]
    };
    let angle = 0.2_f64.atan().to_degrees();
    let chins =
        [([0.0, -50.0, -40.0], angle), ([0.0, -70.0, -40.0], -angle), ([10.0, -60.0, -40.0], 0.0)];
    for (chin, wanted) in chins {
        let mut skin = Named::from(profile(chin));
        // Nothing says yet where the front is.
        assert_eq!(measure("facial_convexity", &skin), None);
        let of_bone: Named = example().into_iter().chain(skin.clone()).collect();
        let found = measure("facial_convexity", &of_bone).unwrap();
        assert!((found - wanted).abs() < 1e-9, "{chin:?}: {found}, not {wanted}");
        // The tip of the nose says it where bone does not.
        skin.insert("pronasale".to_owned(), Vector::new(0.0, -80.0, 20.0));
        let found = measure("facial_convexity", &skin).unwrap();
        assert!((found - wanted).abs() < 1e-9, "{chin:?}: {found}, not {wanted}");
    }
}

/// To the patient's left, up and forwards in mm, of each pair and each landmark of the middle, against the plane of the example.
fn asymmetry(name: &str, base: &Named, landmarks: &Named) -> [f64; 3] {
    let (base, own) = (Landmarks(base), Landmarks(landmarks));
    let plane = MidSagittal::of(&base).unwrap();
    let symmetric = own.symmetric();
    let of = symmetric.iter().find(|of| of.name == name).unwrap();
    let found = plane.asymmetry(of, &own).unwrap();
    [found.left, found.up, found.forwards]
}

#[test]
fn a_symmetric_head_is_told_to_be_symmetric_however_it_lies() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.7, 1.9);
    let moved: Named = example()
        .into_iter()
        .map(|(name, at)| (name, turn * at + Vector::new(300.0, -20.0, 7.0)))
        .collect();
    for head in [example(), moved] {
        let landmarks = Landmarks(&head);
        let names: Vec<String> = landmarks.symmetric().into_iter().map(|of| of.name).collect();
        // Oc is no landmark of the middle, and poria, orbitalia and gonia are pairs.
        let wanted = ["A", "ANS", "B", "Go", "L1", "Me", "N", "Or", "Po", "S", "U1"];
        assert_eq!(names, wanted);
        for name in wanted {
            let off = asymmetry(name, &head, &head);
            assert!(off.iter().all(|off| off.abs() < 1e-10), "{name}: {off:?}");
        }
    }
}

#[test]
fn what_is_moved_on_one_side_is_off_by_that() {
    let base = example();
    let axes = MidSagittal::of(&Landmarks(&base)).unwrap();
    assert!((axes.left - Vector::x()).norm() < 1e-12);
    let mut planned = example();
    // The left gonion 2 mm to the left, 3 mm up and 1 mm back; the chin 4 mm to the right.
    *planned.get_mut("Go_L").unwrap() += axes.left * 2.0 + axes.up * 3.0 - axes.forwards;
    *planned.get_mut("Me").unwrap() -= axes.left * 4.0;
    for (name, wanted) in [("Go", [2.0, 3.0, -1.0]), ("Me", [-4.0, 0.0, 0.0]), ("Or", [0.0; 3])] {
        let off = asymmetry(name, &base, &planned);
        let error = off.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-10, "{name}: {off:?}");
    }
}

#[test]
fn the_skin_of_the_generic_face_has_its_plane_in_the_middle_however_it_lies() {
    let settings = FaceSettings { lips: Lips::Closed, fineness: 1, shape: CellShape::Hex8 };
    let face: Named = generic_face(settings).landmarks.into_iter().collect();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.7, 1.9);
    let shift = Vector::new(300.0, -20.0, 7.0);
    for (turn, shift) in [(nalgebra::Rotation3::identity(), Vector::zeros()), (turn, shift)] {
        let lies = |at: &Vector| turn * at + shift;
        let moved: Named = face.iter().map(|(name, at)| (name.clone(), lies(at))).collect();
        let plane = MidSagittal::of_skin(&Landmarks(&moved)).unwrap();
        assert!((plane.left - turn * Vector::x()).norm() < 1e-12);
        assert!((lies(&Vector::zeros()) - plane.through).dot(&plane.left).abs() < 1e-10);
        // It looks along -y, and its chin lies below its eyes.
        assert!(plane.forwards.dot(&(turn * -Vector::y())) > 0.9);
        assert!(plane.up.dot(&(turn * Vector::z())) > 0.9);
        // What the operation is to change does not turn the plane: it hangs on no pair below the eyes.
        let mut operated = moved.clone();
        for name in ["cheilion_left", "gonion_left", "alare_left"] {
            *operated.get_mut(name).unwrap() += Vector::new(4.0, 3.0, 2.0);
        }
        assert_eq!(MidSagittal::of_skin(&Landmarks(&operated)), Some(plane));
    }
}

#[test]
fn norms_are_of_measures_that_there_are_and_count_standard_deviations() {
    for norm in NORMS {
        assert!(MEASURES.iter().any(|measure| measure.name == norm.measure), "{}", norm.measure);
        assert!(norm.sd > 0.0 && norm.source.contains("1980"));
    }
    assert_eq!(z_score(16.0, 12.0, 4.0), 1.0);
    assert_eq!(z_score(86.0, 102.0, 8.0), -2.0);
}

#[test]
fn proportions_of_the_skin_are_those_of_its_lengths() {
    let points = [
        ("glabella", [0.0, -50.0, 60.0]),
        ("subnasale", [0.0, -50.0, 0.0]),
        ("stomion_superius", [0.0, -50.0, -20.0]),
        ("stomion_inferius", [0.0, -50.0, -22.0]),
        ("menton", [0.0, -50.0, -62.0]),
    ];
    let skin: Named = points.into_iter().map(|(name, at)| (name.to_owned(), at.into())).collect();
    assert_measures(&skin, &[("face_height_ratio", 60.0 / 62.0), ("lip_chin_ratio", 0.5)]);
}
