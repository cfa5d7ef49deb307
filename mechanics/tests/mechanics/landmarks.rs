//! Landmarks and parts of a face made in code.

use mechanics::anatomy::surfaces::part_by_cuts;
use mechanics::anatomy::{AnatomyRules, build};
use mechanics::domain::SurfaceDomain;
use mechanics::landmarks::{
    FaceAxes, MidPlane, Profile, ProfileError, ProfileLandmarks, skin_regions,
};
use mechanics::mesh::{Frame, TriangleSurface, Vector};
use mechanics::meshing::{MeshingSettings, RegionShape, SizeField, SizeRegion};
use mechanics::osteotomy::Osteotomy;
use mechanics::progress::Unobserved;

use crate::surfaces::{map, unit_sphere};

/// How far a nose, lips and a chin stand out in front, in mm: height, how much, how high and how wide.
const BUMPS: [[f64; 4]; 3] =
    [[0.0, 25.0, 7.0, 9.0], [-25.0, 9.0, 5.0, 20.0], [-52.0, 16.0, 9.0, 18.0]];

/// A head in LPS that looks to -y, its mid-plane at x = `aside`.
fn head(aside: f64, bumps: &[[f64; 4]]) -> TriangleSurface {
    map(&unit_sphere(6), |d| {
        let [x, z] = [70.0 * d.x, 110.0 * d.z];
        let bump = |&[height, much, high, wide]: &[f64; 4]| {
            let across = (x / wide).powi(2) + ((z - height) / high).powi(2);
            if d.y < 0.0 { much * (-across / 2.0).exp() } else { 0.0 }
        };
        Vector::new(x + aside, 90.0 * d.y - bumps.iter().map(bump).sum::<f64>(), z)
    })
}

fn plane_of(skin: &TriangleSurface) -> MidPlane {
    MidPlane::of(skin, FaceAxes::of(Frame::Lps).unwrap()).unwrap()
}

fn landmarks(skin: &TriangleSurface) -> Result<ProfileLandmarks, ProfileError> {
    Profile::of(skin, &plane_of(skin)).landmarks()
}

#[test]
fn the_mid_plane_of_a_face_is_found_wherever_the_head_is() {
    for aside in [-13.0, 0.0, 31.0] {
        let plane = plane_of(&head(aside, &BUMPS));
        let [lateral, ..] = plane.coordinates(&Vector::new(aside, 0.0, 0.0));
        // Half a cell of the view from the front.
        assert!(lateral.abs() <= 1.5, "{aside}: {lateral}");
    }
    assert_eq!(FaceAxes::of(Frame::Unspecified), None);
}

#[test]
fn landmarks_are_where_the_profile_turns() {
    let found = landmarks(&head(5.0, &BUMPS)).unwrap();
    for (height, wanted) in [
        (found.pogonion.height, -51.0),
        (found.sublabiale.height, -37.0),
        (found.subnasale.height, -16.0),
        (found.pronasale.unwrap().height, 0.0),
    ] {
        assert!((height - wanted).abs() < 3.0, "{found:?}");
    }
    assert!((found.pronasale.unwrap().advance - 115.0).abs() < 1.5, "{found:?}");
}

#[test]
fn a_head_without_lips_or_without_anything_has_no_landmarks_and_says_how_it_turns() {
    let told = |bumps: &[[f64; 4]]| landmarks(&head(0.0, bumps)).unwrap_err();
    assert_eq!(told(&[BUMPS[0], BUMPS[2]]), ProfileError::NoFace { forward: 2, back: 1 });
    assert_eq!(told(&[]), ProfileError::NoFace { forward: 1, back: 0 });
    let axes = FaceAxes::of(Frame::Lps).unwrap();
    let beside = MidPlane { axes, offset: 500.0 };
    let nothing = Profile::of(&head(0.0, &BUMPS), &beside).landmarks().unwrap_err();
    assert_eq!(nothing, ProfileError::Empty);
}

#[test]
fn a_face_under_a_bandage_is_refused_and_not_guessed() {
    let bandage = [40.0, 25.0, 30.0, 40.0];
    let found = landmarks(&head(0.0, &[bandage, BUMPS[1], BUMPS[2]])).unwrap_err();
    let ProfileError::NoNose { above_mm } = found else { panic!("{found:?}") };
    assert!(above_mm > 40.0, "{above_mm}");
}

#[test]
fn parts_of_the_face_lie_at_their_landmarks_and_no_node_is_in_two() {
    let skin = head(5.0, &BUMPS);
    let plane = plane_of(&skin);
    let found = landmarks(&skin).unwrap();
    let all: Vec<u32> = (0..skin.points.len() as u32).collect();
    let regions = skin_regions(&skin.points, &all, &plane, &found);
    let names: Vec<&str> = regions.keys().map(String::as_str).collect();
    assert_eq!(names, ["cheeks", "chin", "lips", "nose"]);
    let mut seen = vec![false; skin.points.len()];
    for &node in regions.values().flatten() {
        assert!(!std::mem::replace(&mut seen[node as usize], true), "{node}");
    }
    let nearest = |x: f64, z: f64| {
        let off = |node: &u32| {
            let place = skin.points[*node as usize];
            if place.y > 0.0 { f64::INFINITY } else { (place.x - x).hypot(place.z - z) }
        };
        all.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
    };
    for (x, z, region) in [
        (5.0, 0.0, Some("nose")),
        (5.0, -25.0, Some("lips")),
        (20.0, -25.0, Some("lips")),
        (5.0, -50.0, Some("chin")),
        (45.0, -15.0, Some("cheeks")),
        (-35.0, -15.0, Some("cheeks")),
        (5.0, 60.0, None),
        (5.0, -90.0, None),
    ] {
        let node = nearest(x, z);
        let of = regions.iter().find(|(_, nodes)| nodes.binary_search(&node).is_ok());
        assert_eq!(of.map(|(name, _)| name.as_str()), region, "{x} {z}");
    }
}

#[test]
fn a_gap_in_the_face_is_reported_and_the_back_of_the_head_is_no_face() {
    let mut skin = head(0.0, &BUMPS);
    let is_nose = |x: &Vector| x.y < 0.0 && x.x.abs() < 12.0 && (-12.0..-2.0).contains(&x.z);
    let points = skin.points.clone();
    skin.triangles
        .retain(|corners| !corners.iter().any(|&corner| is_nose(&points[corner as usize])));
    let found = landmarks(&skin).unwrap_err();
    assert!(matches!(found, ProfileError::Gap { mm } if mm > 6.0), "{found:?}");
}

#[test]
fn what_stands_far_before_the_base_of_its_nose_is_no_face() {
    let trunk = [[0.0, 60.0, 7.0, 9.0], BUMPS[1], BUMPS[2]];
    let found = landmarks(&head(0.0, &trunk)).unwrap_err();
    let ProfileError::NoBase { behind_mm } = found else { panic!("{found:?}") };
    assert!((40.0..62.0).contains(&behind_mm), "{behind_mm}");
}

/// A nose, an upper lip, and a lower lip and a chin with a fold between them that is less than 1.5 mm deep, and with none.
const SHALLOW: [[f64; 4]; 4] =
    [BUMPS[0], [-22.0, 8.0, 3.5, 20.0], [-36.0, 7.0, 4.0, 20.0], [-54.0, 18.0, 12.0, 18.0]];
const FLAT: [[f64; 4]; 4] =
    [BUMPS[0], SHALLOW[1], [-36.0, 5.0, 5.0, 20.0], [-54.0, 18.0, 10.0, 18.0]];

#[test]
fn a_shallow_fold_of_the_lower_lip_bounds_the_chin_and_not_the_mouth() {
    let found = landmarks(&head(0.0, &SHALLOW)).unwrap();
    assert!((found.pogonion.height + 50.0).abs() < 2.5, "{found:?}");
    assert!((found.sublabiale.height + 44.0).abs() < 2.5, "{found:?}");
    let depth = found.shallow_fold.unwrap();
    assert!((depth - 1.05).abs() < 0.3, "{depth}");
    // The mouth is at -29 mm, and its lower lip down to -41.
    let found = landmarks(&head(0.0, &FLAT)).unwrap();
    assert!((found.sublabiale.height + 41.5).abs() < 2.5, "{found:?}");
    assert_eq!(found.shallow_fold, Some(0.0));
    assert_eq!(landmarks(&head(0.0, &BUMPS)).unwrap().shallow_fold, None);
}

#[test]
fn a_doubtful_border_of_chin_and_lips_is_told_with_the_landmarks() {
    let skin = head(0.0, &SHALLOW);
    let domain = SurfaceDomain::new(&skin, &[], &[]).unwrap();
    let parted = part_by_cuts(&domain, &Osteotomy::default()).unwrap();
    let shape = RegionShape::Ball { centre: Vector::new(0.0, -95.0, -35.0), radius: 32.0 };
    let size = SizeField {
        coarsest: 16.0,
        regions: vec![SizeRegion { shape, size: 2.0 }],
        ..SizeField::uniform(2.0)
    };
    let meshing = MeshingSettings { size, ..MeshingSettings::default() };
    let rules = AnatomyRules { meshing, frame: Frame::Lps, ..AnatomyRules::default() };
    let made = build(&domain, parted, &rules, &Unobserved).unwrap();
    let of = made.warnings.iter().find(|warning| warning.code == "fold-shallow");
    let told = of.unwrap_or_else(|| panic!("{:?} {:?}", made.warnings, made.landmarks));
    assert!((0.4..1.5).contains(&told.numbers[0].1), "{told:?}");
    assert!((made.landmarks["sublabiale"].z + 44.0).abs() < 3.0, "{:?}", made.landmarks);
    for &node in &made.volume.node_sets["skin_chin"] {
        assert!(made.volume.nodes[node as usize].z < -40.0);
    }
}
