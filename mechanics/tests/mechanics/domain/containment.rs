//! Bones of other frames, and skins that leave no tissue.

use mechanics::anatomy::surfaces::outside;
use mechanics::domain::{SurfaceDomain, SurfaceDomainError, SurfaceName};
use mechanics::mesh::{Vector, Warning};

use super::sphere;

const RINGS: usize = 24;

fn body(skin_radius: f64, bone_radius: f64, bone_at: f64) -> Result<SurfaceDomain, String> {
    let skin = sphere(Vector::zeros(), skin_radius, RINGS);
    let bone = sphere(Vector::x() * bone_at, bone_radius, RINGS);
    SurfaceDomain::new(&skin, &[&bone], &[]).map_err(|error| error.to_string())
}

fn number(warning: &Warning, name: &str) -> f64 {
    warning.numbers.iter().find(|(other, _)| *other == name).unwrap().1
}

#[test]
fn a_bone_of_another_frame_is_refused_with_both_places() {
    let told = body(70.0, 40.0, 200.0).unwrap_err();
    for part in ["bone 1: 100 %", "outside the skin", "(160, -40, -40)", "(240, 40, 40)", "frame"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    // The second of two bones, by its number, and how far it is from the skin.
    let skin = sphere(Vector::zeros(), 70.0, RINGS);
    let [near, far] = [0.0, 200.0].map(|x| sphere(Vector::x() * x, 40.0, RINGS));
    let Err(SurfaceDomainError::BoneOutside { surface, nearest, .. }) =
        SurfaceDomain::new(&skin, &[&near, &far], &[])
    else {
        panic!("a bone 90 mm from the skin was taken");
    };
    assert_eq!(surface, SurfaceName::Bone(1));
    assert!((90.0..96.0).contains(&nearest), "{nearest}");
}

#[test]
fn a_bone_that_reaches_out_of_the_skin_is_reported_with_its_share_and_its_distance() {
    // The lens of two balls of radii a > b: (a + b - d)² (d² + 2 d (a + b) - 3 (a - b)²) / (16 d b³) of b is inside.
    for (x, out) in [(60.0, 0.4263), (40.0, 0.0789), (29.0, 0.0)] {
        let warnings = outside(&body(70.0, 40.0, x).unwrap());
        let told: Vec<f64> = warnings.iter().map(|warning| number(warning, "outside")).collect();
        if out == 0.0 {
            assert!(told.is_empty(), "{warnings:?}");
            continue;
        }
        assert_eq!(warnings[0].code, "bone-outside-skin");
        assert!((told[0] - out).abs() < 0.02, "{x}: {told:?}, {out} in a closed form");
        let farthest = number(&warnings[0], "farthest_mm");
        assert!((x - 36.0..x - 29.5).contains(&farthest), "{x}: {farthest}");
    }
}

#[test]
fn a_skin_that_is_all_bone_and_one_that_was_exchanged_leave_no_tissue() {
    let told = body(40.0, 70.0, 0.0).unwrap_err();
    assert!(told.contains("100.0 %") && told.contains("exchanged"), "{told}");
    let told = body(70.0, 70.0, 0.0).unwrap_err();
    assert!(told.contains("leaves no tissue"), "{told}");
    // A millimetre of tissue is tissue.
    body(70.0, 69.0, 0.0).unwrap();
}
