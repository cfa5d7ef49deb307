//! Fibres and membranes in documents: what becomes of them, what is refused, and where.

use facies::schema::{Faults, Limits, PredictDocument};
use mechanics::material::{Fibre, FibreLaw, LinearElastic};
use mechanics::mesh::Vector;
use mechanics::model::fem::mass_tensor::MassTensorSettings;
use mechanics::prediction::{FibreDirection, Method};

use crate::schema::documents::{case, case_with, one, refused, settings};

const FAILED: &str = "validation-failed";

/// A case of one material with these fibres.
fn with(fibre: &str) -> String {
    format!(
        r#"{{"units":"mm","volume":"v",
        "materials":{{"*":{{"young_modulus_kpa":6.2,"poisson_ratio":0.49,"fibre":{fibre}}}}}}}"#
    )
}

fn muscle(young_modulus: f64, shear_modulus: Option<f64>, law: FibreLaw) -> LinearElastic {
    let across = LinearElastic::new(6.2, 0.49, 1.0).unwrap();
    across.with_fibre(&Fibre { young_modulus, shear_modulus, law }).unwrap()
}

#[test]
fn fibres_of_a_document_are_those_of_the_material() {
    let engineering = muscle(110.0, None, FibreLaw::Engineering);
    let by_array = case(&with(r#"{"young_modulus_kpa":110,"array":" fibre "}"#)).unwrap().0;
    assert_eq!(by_array.materials["*"], engineering);
    assert_eq!(by_array.fibres["*"], FibreDirection::Array("fibre".to_owned()));
    let stated = r#"{"young_modulus_kpa":110,"shear_modulus_kpa":3,"direction":[0,0,2],"law":"engineering"}"#;
    let uniform = case(&with(stated)).unwrap().0;
    assert_eq!(uniform.materials["*"], muscle(110.0, Some(3.0), FibreLaw::Engineering));
    assert_eq!(uniform.fibres["*"], FibreDirection::Uniform(Vector::z() * 2.0));
    // The second is its name of before.
    for name in ["kim_2012", "paper_002"] {
        let text = format!(r#"{{"young_modulus_kpa":6.3,"direction":[1,0,0],"law":"{name}"}}"#);
        let of_kim = case(&with(&text)).unwrap().0;
        assert_eq!(of_kim.materials["*"], muscle(6.3, None, FibreLaw::Kim2012));
    }
}

#[test]
fn a_spec_changes_fibres_field_by_field() {
    let text = with(r#"{"young_modulus_kpa":110,"shear_modulus_kpa":3,"array":"fibre"}"#);
    let changed = |fibre: &str| {
        let spec = format!(r#"{{"materials":{{"*":{{"fibre":{fibre}}}}}}}"#);
        case_with(&text, &spec, None).unwrap().0
    };
    let stiffer = changed(r#"{"young_modulus_kpa":200}"#);
    assert_eq!(stiffer.materials["*"], muscle(200.0, Some(3.0), FibreLaw::Engineering));
    assert_eq!(stiffer.fibres["*"], FibreDirection::Array("fibre".to_owned()));
    let elsewhere = changed(r#"{"direction":[0,1,0]}"#);
    assert_eq!(elsewhere.fibres["*"], FibreDirection::Uniform(Vector::y()));
    // A region that only the spec names starts from all of the case's `*`.
    let text =
        text.replace(r#""materials""#, r#""regions":{"array":"band","names":{}},"materials""#);
    let spec = r#"{"materials":{"1":{"young_modulus_kpa":5}}}"#;
    let named = case_with(&text, spec, None).unwrap().0;
    assert!(named.materials["1"].has_fibre() && named.fibres.contains_key("1"));
}

#[test]
fn fibres_that_cannot_be_are_refused_at_their_place() {
    let at = |field: &str| format!("/case/materials/*/fibre{field}");
    let wrong = [
        (r#"{"direction":[1,0,0]}"#, "missing-field", "/young_modulus_kpa"),
        (r#"{"young_modulus_kpa":110}"#, "one-of", ""),
        (r#"{"young_modulus_kpa":110,"array":"f","direction":[1,0,0]}"#, "one-of", ""),
        (r#"{"young_modulus_kpa":0,"array":"f"}"#, "out-of-range", "/young_modulus_kpa"),
        (
            r#"{"young_modulus_kpa":110,"shear_modulus_kpa":-1,"array":"f"}"#,
            "out-of-range",
            "/shear_modulus_kpa",
        ),
        (
            r#"{"young_modulus_kpa":6,"shear_modulus_kpa":1,"array":"f","law":"kim_2012"}"#,
            "not-in-law",
            "/shear_modulus_kpa",
        ),
        (r#"{"young_modulus_kpa":1.5,"array":"f"}"#, "not-positive-definite", "/young_modulus_kpa"),
        (
            r#"{"young_modulus_kpa":110,"array":"f","law":"kim_2012"}"#,
            "not-positive-definite",
            "/young_modulus_kpa",
        ),
    ];
    for (fibre, code, field) in wrong {
        assert_eq!(refused(case(&with(fibre))), one(FAILED, code, &at(field)), "{fibre}");
    }
    let indefinite = with(r#"{"young_modulus_kpa":110,"array":"f","law":"kim_2012"}"#);
    let detail = case(&indefinite).err().unwrap().detail;
    assert!(detail.contains("(1-nu)/(2 nu^2) = 1.0621") && detail.contains("-1646"), "{detail}");
    let unknown = with(r#"{"young_modulus_kpa":110,"array":"f","law":"eq33"}"#);
    let place = "/materials/*/fibre/law";
    assert_eq!(refused(case(&unknown)), one(FAILED, "unknown-word", place));
    // The ratio of moduli may come from the spec.
    let text = with(r#"{"young_modulus_kpa":6.3,"direction":[1,0,0],"law":"kim_2012"}"#);
    let spec = r#"{"materials":{"*":{"young_modulus_kpa":3}}}"#;
    let place = "/spec/materials/*/fibre/young_modulus_kpa";
    assert_eq!(refused(case_with(&text, spec, None)), one(FAILED, "not-positive-definite", place));
}

#[test]
fn a_membrane_without_numbers_is_the_usual_one_and_a_wrong_one_is_refused_at_its_place() {
    let convert = |text: &str| {
        let document: PredictDocument = serde_json::from_str(text).unwrap();
        let mut faults = Faults::default();
        let settings = document.to_settings(&Limits::default(), &mut faults);
        assert!(faults.is_empty());
        settings
    };
    assert_eq!(convert("{}").membrane, None);
    let usual = convert(r#"{"membrane":{}}"#).membrane.unwrap();
    let stated =
        r#"{"membrane":{"thickness_mm":1.5,"young_modulus_kpa":200,"poisson_ratio":0.45}}"#;
    assert_eq!(convert(stated).membrane.unwrap(), usual);
    assert!(usual.sheet.thickness() == 1.5 && !usual.sheet.has_lines());
    let lines = r#"{"membrane":{"fibre":{"young_modulus_kpa":800,"array":"langer"}}}"#;
    let lines = convert(lines).membrane.unwrap();
    assert!(lines.sheet.has_lines());
    assert_eq!(lines.lines, Some(FibreDirection::Array("langer".to_owned())));

    let wrong = [
        (r#"{"thickness_mm":0}"#, "out-of-range", "/thickness_mm"),
        (r#"{"young_modulus_kpa":2e9}"#, "out-of-range", "/young_modulus_kpa"),
        (r#"{"poisson_ratio":0.6}"#, "out-of-range", "/poisson_ratio"),
        (r#"{"fibre":{"young_modulus_kpa":800}}"#, "one-of", "/fibre"),
        (
            r#"{"fibre":{"young_modulus_kpa":0,"array":"a"}}"#,
            "out-of-range",
            "/fibre/young_modulus_kpa",
        ),
        (
            r#"{"fibre":{"young_modulus_kpa":40,"array":"a"}}"#,
            "not-positive-definite",
            "/fibre/young_modulus_kpa",
        ),
    ];
    for (membrane, code, field) in wrong {
        let found = refused(settings(&format!(r#"{{"membrane":{membrane}}}"#)));
        assert_eq!(found, one(FAILED, code, &format!("/spec/membrane{field}")), "{membrane}");
    }
    let usual = MassTensorSettings::default();
    assert_eq!(convert(r#"{"method":"mtm_ti"}"#).method, Method::MassTensorTransverse(usual));
    // Each method has its iterations in the field of its name.
    let own = r#"{"method":"mtm_ti","mtm_ti":{"iterations":"gauss_seidel"}}"#;
    assert_ne!(convert(own).method, Method::MassTensorTransverse(usual));
    let of_another = r#"{"method":"mtm_ti","mtm":{"iterations":"gauss_seidel"}}"#;
    assert_eq!(
        refused(settings(of_another)),
        one("method-mismatch", "method-mismatch", "/spec/mtm")
    );
}
