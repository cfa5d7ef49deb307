//! Names of regions, landmarks and tissues: one name means one thing.

use super::documents::{case, case_with, one, refused};

#[test]
fn a_region_has_no_name_that_is_the_number_of_a_value_without_one() {
    let document = |names: &str| {
        format!(r#"{{"units":"mm","volume":"v","regions":{{"array":"band","names":{names}}}}}"#)
    };
    let wanted = one("validation-failed", "duplicate-name", "/case/regions/names/0");
    assert_eq!(refused(case(&document(r#"{"0":"1"}"#))), wanted);
    assert_eq!(refused(case(&document(r#"{"0":" 1 "}"#))), wanted);
    // Both have a name, or no value is called so.
    case(&document(r#"{"0":"1","1":"fat"}"#)).expect("accepted");
    case(&document(r#"{"0":"2"}"#)).expect("accepted");
}

#[test]
fn names_of_landmarks_and_parts_of_the_skin_differ_in_more_than_spaces_around_them() {
    let landmarks = r#"{"units":"mm","volume":"v","landmarks":{"chin":[0,0,0],"chin ":[1,0,0]}}"#;
    let wanted = one("validation-failed", "duplicate-name", "/case/landmarks/chin ");
    assert_eq!(refused(case(landmarks)), wanted);
    let parts = r#"{"units":"mm","volume":"v","skin_regions":{" lip":{"node_set":"a"},"lip":{"node_set":"b"}}}"#;
    let wanted = one("validation-failed", "duplicate-name", "/case/skin_regions/lip");
    assert_eq!(refused(case(parts)), wanted);
}

#[test]
fn a_material_of_a_spec_is_refused_where_a_region_and_a_tissue_of_the_image_have_its_name() {
    let document = |tissue: &str| {
        format!(
            r#"{{"units":"mm","volume":"v","regions":{{"array":"band","names":{{"1":"fat"}}}},
            "hounsfield":{{"image":"ct","tissues":[{{"name":"{tissue}","from_hu":-200,"to_hu":-30,
            "material":{{"young_modulus_kpa":3,"poisson_ratio":0.4}}}}]}}}}"#
        )
    };
    let spec = r#"{"materials":{"fat":{"young_modulus_kpa":9}}}"#;
    let wanted = one("validation-failed", "duplicate-name", "/spec/materials/fat");
    assert_eq!(refused(case_with(&document("fat"), spec, None)), wanted);
    case_with(&document("muscle"), spec, None).expect("accepted");
    case_with(&document("fat"), "{}", None).expect("accepted");
}
