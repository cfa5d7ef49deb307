//! Materials of the literature in documents: what each stands for, what stands over it, and what is told of it.

use std::collections::BTreeSet;

use facies::schema::CaseDocument;
use facies::schema::case::merged::expanded_materials;
use facies::schema::case::preset::{MaterialList, used_presets};
use facies::schema::case::preset_name::PresetName;
use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::{Law, RubinBodner};

use crate::schema::documents::{case, case_with, one, parse, refused};

/// A case of one preset, with a course for its fibres where it has any.
fn with(preset: &str, beside: &str) -> String {
    let list = MaterialList::all().presets;
    let own = list.iter().find(|own| own.name.name() == preset).unwrap();
    let course = if own.needs_course { r#","fibre":{"direction":[1,0,0]}"# } else { "" };
    format!(
        r#"{{"units":"mm","volume":"v","materials":{{"*":{{"preset":"{preset}"{course}{beside}}}}}}}"#
    )
}

fn tissue(preset: &str, beside: &str) -> LinearElastic {
    case(&with(preset, beside)).unwrap().0.materials["*"]
}

#[test]
fn every_preset_is_a_material_with_the_constants_of_its_source() {
    for (name, young_modulus, poisson_ratio) in [
        ("tissue_chabanas_2003", 15.0, 0.49),
        ("muscle_at_rest_chabanas_2003", 6.2, 0.49),
        ("muscle_active_chabanas_2003", 6.2, 0.49),
        ("fat_kim_2012", 3.0, 0.46),
        ("muscle_kim_2012", 790.0, 0.43),
        ("embedding_zachow_2006", 20.0, 0.455),
        ("muscle_zachow_2006", 300.0, 0.44),
    ] {
        let found = tissue(name, "");
        assert_eq!((found.young_modulus(), found.poisson_ratio()), (young_modulus, poisson_ratio));
    }
    for (name, eps0, p, eta1, eta2, theta, density) in [
        ("muscle_mandible_zhang_2016", 3700.0, 25.0, 595.0, 0.00216, 0.95, 1.0),
        ("muscle_both_jaws_zhang_2016", 3700.0, 25.0, 595.0, 0.00216, 0.9, 1.0),
        ("other_mandible_zhang_2016", 1700.0, 36.0, 1294.0, 0.00008, 0.95, 1.1),
        ("other_both_jaws_zhang_2016", 1700.0, 36.0, 1294.0, 0.00008, 0.9, 1.1),
    ] {
        let found = tissue(name, "");
        let law = Law::RubinBodner(RubinBodner { eps0, p, eta1, eta2, theta });
        assert_eq!((found.stated_law(), found.density()), (Some(&law), density), "{name}");
    }
    let all: BTreeSet<&str> = PresetName::ALL.iter().map(|preset| preset.name()).collect();
    assert_eq!(all.len(), 11);
}

#[test]
fn a_name_of_a_document_is_the_name_of_the_list() {
    for preset in PresetName::ALL {
        assert_eq!(serde_json::to_value(preset).unwrap(), preset.name());
    }
}

#[test]
fn what_stands_beside_a_preset_stands_over_it() {
    let found = tissue("fat_kim_2012", r#","young_modulus_kpa":4"#);
    assert_eq!((found.young_modulus(), found.poisson_ratio()), (4.0, 0.46));
}

#[test]
fn a_preset_of_the_spec_takes_the_place_of_the_case_and_a_number_that_of_the_preset() {
    let law = r#"{"units":"mm","volume":"v","materials":{"*":{"law":{"kind":"neo_hookean","mu_kpa":5,"lambda_kpa":40},
        "density_g_per_cm3":1.2}}}"#;
    let spec = r#"{"materials":{"*":{"preset":"fat_kim_2012"}}}"#;
    let (found, _) = case_with(law, spec, None).unwrap();
    let fat = found.materials["*"];
    assert_eq!((fat.young_modulus(), fat.poisson_ratio(), fat.density()), (3.0, 0.46, 1.0));
    assert!(fat.stated_law().is_none());
    let spec = r#"{"materials":{"*":{"young_modulus_kpa":5}}}"#;
    let (found, _) = case_with(&with("fat_kim_2012", ""), spec, None).unwrap();
    let fat = found.materials["*"];
    assert_eq!((fat.young_modulus(), fat.poisson_ratio()), (5.0, 0.46));
    // Of the case the course of fibres is left.
    let fibred = r#"{"units":"mm","volume":"v","materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.3,
        "fibre":{"young_modulus_kpa":20,"direction":[0,1,0]}}}}"#;
    let spec = r#"{"materials":{"*":{"preset":"muscle_active_chabanas_2003"}}}"#;
    let (found, _) = case_with(fibred, spec, None).unwrap();
    assert_eq!((found.materials["*"].young_modulus(), found.fibres.len()), (6.2, 1));
}

#[test]
fn a_preset_with_fibres_needs_their_course() {
    let text = r#"{"units":"mm","volume":"v","materials":{"*":{"preset":"muscle_kim_2012"}}}"#;
    let (code, errors) = refused(case(text));
    assert_eq!(code, "validation-failed");
    assert!(
        errors.iter().all(|(_, place)| place.starts_with("/case/materials/*/fibre")),
        "{errors:?}"
    );
}

#[test]
fn a_name_that_no_preset_has_is_refused_where_it_stands() {
    let text = r#"{"units":"mm","volume":"v","materials":{"*":{"preset":"muscle"}}}"#;
    let problem = parse::<CaseDocument>(text).err().unwrap();
    assert_eq!(problem.errors[0].pointer, "/materials/*/preset");
    assert!(problem.errors[0].detail.contains("fat_kim_2012"), "{}", problem.errors[0].detail);
}

#[test]
fn doubts_are_reported_and_the_result_repeats_what_was_used() {
    for preset in MaterialList::all().presets {
        let (_, warnings) = case(&with(preset.name.name(), "")).unwrap();
        assert_eq!(warnings.contains(&"preset-doubt"), preset.doubt.is_some(), "{:?}", preset.name);
        assert!(preset.source.year > 1980 && !preset.state.is_empty());
    }
    let document: CaseDocument =
        parse(&with("muscle_kim_2012", r#","density_g_per_cm3":1.04"#)).unwrap();
    let all = expanded_materials(document.materials.as_ref(), None);
    let used = used_presets(all.iter());
    let material = &used["*"].material;
    assert_eq!(material.preset, Some(PresetName::MuscleKim));
    assert_eq!((material.young_modulus_kpa, material.density_g_per_cm3), (Some(790.0), Some(1.04)));
    assert_eq!(material.fibre.as_ref().unwrap().young_modulus_kpa, Some(500.0));
    assert!(used["*"].doubt.as_ref().unwrap().contains("softer along"));
}

#[test]
fn tissues_of_an_image_may_be_presets_without_fibres() {
    let text = |preset: &str| {
        format!(
            r#"{{"units":"mm","volume":"v","materials":{{"*":{{"preset":"tissue_chabanas_2003"}}}},
            "hounsfield":{{"image":"ct","tissues":[{{"name":"muscle","from_hu":-30,"to_hu":100,"material":{{"preset":"{preset}"}}}}]}}}}"#
        )
    };
    let (_, warnings) = case(&text("muscle_zachow_2006")).unwrap();
    assert_eq!(warnings.iter().filter(|code| **code == "preset-doubt").count(), 1);
    let place = "/case/hounsfield/tissues/0/material/fibre";
    let wanted = one("method-not-available", "method-not-available", place);
    assert_eq!(refused(case(&text("muscle_kim_2012"))), wanted);
}
