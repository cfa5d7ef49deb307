//! Laws of finite strain in documents: what becomes of them, what is refused, and where.

use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::{
    Fibres, Fung, Law, MooneyRivlin, NeoHookean, NeoHookeanIsochoric, Ogden, OgdenTerm,
    PolyconvexBarrier, RubinBodner, SaintVenantKirchhoff, VerondaWestmann, Volumetric,
};

use crate::schema::documents::{case, case_with, one, refused};

const FAILED: &str = "validation-failed";

/// A case of one material with these members.
fn with(members: &str) -> String {
    format!(r#"{{"units":"mm","volume":"v","materials":{{"*":{{{members}}}}}}}"#)
}

fn tissue(members: &str) -> LinearElastic {
    case(&with(members)).unwrap().0.materials["*"]
}

/// With E and nu.
const LINEAR: &str = r#""young_modulus_kpa":15,"poisson_ratio":0.46"#;

#[test]
fn every_law_of_a_document_is_that_of_the_tissue() {
    let bulk = Volumetric::Barrier(62.5);
    let of = |law: &str| *tissue(&format!(r#""law":{law}"#)).stated_law().unwrap();
    let polynomial =
        MooneyRivlin { c10: 2.0, c01: 0.5, c20: 0.0, c11: 0.1, c02: 0.0, volumetric: bulk };
    let terms = [OgdenTerm { mu: 2.0, alpha: 3.0 }, OgdenTerm { mu: -2.0, alpha: -2.0 }];
    let laws = [
        (
            r#"{"kind":"neo_hookean","mu_kpa":5,"lambda_kpa":40}"#,
            Law::NeoHookean(NeoHookean { lambda: 40.0, mu: 5.0 }),
        ),
        (
            r#"{"kind":"saint_venant_kirchhoff","mu_kpa":5,"lambda_kpa":40}"#,
            Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda: 40.0, mu: 5.0 }),
        ),
        (
            r#"{"kind":"polyconvex_barrier","mu_kpa":5,"lambda_kpa":40}"#,
            Law::PolyconvexBarrier(PolyconvexBarrier { lambda: 40.0, mu: 5.0 }),
        ),
        (
            r#"{"kind":"neo_hookean_isochoric","mu_kpa":5,"bulk_modulus_kpa":62.5}"#,
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric { mu: 5.0, volumetric: bulk }),
        ),
        (
            r#"{"kind":"mooney_rivlin","c10_kpa":2,"c01_kpa":0.5,"c11_kpa":0.1,"bulk_modulus_kpa":62.5}"#,
            Law::MooneyRivlin(polynomial),
        ),
        (
            r#"{"kind":"veronda_westmann","c1_kpa":2,"g":1.5,"bulk_modulus_kpa":62.5,"volumetric":"barrier"}"#,
            Law::VerondaWestmann(VerondaWestmann { c1: 2.0, g: 1.5, volumetric: bulk }),
        ),
        (
            r#"{"kind":"fung","mu_kpa":5,"b":2,"bulk_modulus_kpa":62.5,"volumetric":"logarithmic"}"#,
            Law::Fung(Fung { mu: 5.0, b: 2.0, volumetric: Volumetric::Logarithmic(62.5) }),
        ),
        (
            r#"{"kind":"ogden","terms":[{"mu_kpa":2,"alpha":3},{"mu_kpa":-2,"alpha":-2}],"bulk_modulus_kpa":62.5}"#,
            Law::Ogden(Ogden::new(&terms, bulk)),
        ),
        (
            r#"{"kind":"rubin_bodner","eps0_kpa":3700,"p":25,"eta1":595,"eta2":0.00216,"theta":0.95}"#,
            Law::RubinBodner(RubinBodner {
                eps0: 3700.0,
                p: 25.0,
                eta1: 595.0,
                eta2: 0.00216,
                theta: 0.95,
            }),
        ),
    ];
    for (text, law) in laws {
        assert_eq!(of(text), law);
        // Linear methods take the law at rest.
        let at_rest = tissue(&format!(r#""law":{text}"#));
        let (lambda, mu) = law.at_rest();
        assert!((at_rest.shear_modulus() / mu - 1.0).abs() < 1e-9, "{text}");
        assert!((at_rest.lambda() / lambda - 1.0).abs() < 1e-6, "{text}");
    }
}

#[test]
fn a_law_without_moduli_has_those_of_young_and_poisson_and_tissue_without_a_law_is_neo_hookean() {
    let linear = LinearElastic::new(15.0, 0.46, 1.0).unwrap();
    let (lambda, mu) = (linear.lambda(), linear.shear_modulus());
    let plain = tissue(LINEAR);
    assert_eq!(plain.stated_law(), None);
    assert_eq!(plain.hyperelastic().law, Law::NeoHookean(NeoHookean { lambda, mu }));
    let of = |law: &str| *tissue(&format!(r#"{LINEAR},"law":{law}"#)).stated_law().unwrap();
    assert_eq!(
        of(r#"{"kind":"saint_venant_kirchhoff"}"#),
        Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu })
    );
    let volumetric = Volumetric::Barrier(linear.bulk_modulus());
    assert_eq!(of(r#"{"kind":"fung","b":1}"#), Law::Fung(Fung { mu, b: 1.0, volumetric }));
}

#[test]
fn fibres_that_pull_go_with_every_law_and_an_anisotropic_one_needs_them() {
    let fibre = r#""fibre":{"k1_kpa":3,"k2":2,"direction":[1,0,0]}"#;
    let fibred = tissue(&format!(r#"{LINEAR},"law":{{"kind":"fung_anisotropic"}},{fibre}"#));
    assert_eq!(fibred.hyperelastic().fibres, Some(Fibres { k1: 3.0, k2: 2.0 }));
    assert!(matches!(fibred.stated_law(), Some(Law::NeoHookeanIsochoric(_))));
    assert!(!fibred.has_fibre(), "at small strain it has none");
    let default = tissue(&format!("{LINEAR},{fibre}"));
    assert!(default.has_pulling_fibres() && default.stated_law().is_none());
    let both = fibre.replace("\"k2\":2", "\"k2\":2,\"young_modulus_kpa\":90");
    let both = tissue(&format!("{LINEAR},{both}"));
    assert!(both.has_fibre() && both.has_pulling_fibres());
    let alone = with(&format!(r#"{LINEAR},"law":{{"kind":"fung_anisotropic"}}"#));
    assert_eq!(refused(case(&alone)), one(FAILED, "missing-field", "/case/materials/*/fibre"));
    let half = with(&format!(r#"{LINEAR},"fibre":{{"k1_kpa":3,"direction":[1,0,0]}}"#));
    let place = "/case/materials/*/fibre/k2";
    assert_eq!(refused(case(&half)), one(FAILED, "missing-field", place));
}

#[test]
fn laws_that_cannot_be_are_refused_at_their_place() {
    let wrong = [
        (r#"{"kind":"ogden","bulk_modulus_kpa":60}"#, "missing-field", "/terms"),
        (r#"{"kind":"ogden","terms":[],"bulk_modulus_kpa":60}"#, "out-of-range", "/terms"),
        (
            r#"{"kind":"ogden","terms":[{"mu_kpa":2,"alpha":99}],"bulk_modulus_kpa":60}"#,
            "out-of-range",
            "/terms/0/alpha",
        ),
        (r#"{"kind":"neo_hookean","mu_kpa":5}"#, "missing-field", "/lambda_kpa"),
        (r#"{"kind":"neo_hookean","mu_kpa":-5,"lambda_kpa":1}"#, "out-of-range", "/mu_kpa"),
        (r#"{"kind":"neo_hookean","mu_kpa":5,"lambda_kpa":9,"b":1}"#, "not-in-law", "/b"),
        (r#"{"kind":"fung","mu_kpa":5,"b":0,"bulk_modulus_kpa":60}"#, "out-of-range", "/b"),
        (r#"{"kind":"fung","mu_kpa":5,"bulk_modulus_kpa":60}"#, "missing-field", "/b"),
        // Softer than nothing, and with a negative Poisson's ratio, at rest.
        (r#"{"kind":"mooney_rivlin","c10_kpa":-2,"bulk_modulus_kpa":60}"#, "out-of-range", ""),
        (r#"{"kind":"mooney_rivlin","c10_kpa":20,"bulk_modulus_kpa":1}"#, "out-of-range", ""),
        (r#"{"kind":"hooke"}"#, "unknown-word", "/kind"),
    ];
    for (law, code, place) in wrong {
        let text = with(&format!(r#""law":{law}"#));
        let at = match code {
            "unknown-word" => format!("/materials/*/law{place}"),
            _ => format!("/case/materials/*/law{place}"),
        };
        assert_eq!(refused(case(&text)), one(FAILED, code, &at), "{law}");
    }
}

#[test]
fn linear_constants_that_are_not_those_of_the_law_are_refused_with_both_numbers() {
    let law = r#""law":{"kind":"neo_hookean","mu_kpa":5.136986301,"lambda_kpa":59.075342466}"#;
    let stated = |e: f64, nu: f64| {
        case(&with(&format!(r#""young_modulus_kpa":{e},"poisson_ratio":{nu},{law}"#)))
    };
    assert!(stated(15.0, 0.46).is_ok() && stated(15.1, 0.461).is_ok());
    let place = |name: &str| one(FAILED, "law-mismatch", &format!("/case/materials/*/{name}"));
    assert_eq!(refused(stated(15.2, 0.46)), place("young_modulus_kpa"));
    assert_eq!(refused(stated(15.0, 0.44)), place("poisson_ratio"));
    // Within 1 %, and yet tissue that resists pressure a fifth more.
    assert_eq!(refused(stated(15.0, 0.4646)), place("poisson_ratio"));
    let detail = stated(20.0, 0.46).err().unwrap().detail;
    assert!(detail.contains("is 20, and the law has 15.00"), "{detail}");
}

#[test]
fn a_law_of_a_spec_agrees_with_the_constants_that_the_case_states() {
    let text = with(LINEAR);
    let spec = |members: &str| {
        let spec = format!(r#"{{"materials":{{"*":{{{members}}}}}}}"#);
        case_with(&text, &spec, None).map(|(case, _)| case.materials["*"])
    };
    let other = r#""law":{"kind":"neo_hookean","mu_kpa":5,"lambda_kpa":5}"#;
    let places = ["young_modulus_kpa", "poisson_ratio"]
        .map(|name| ("law-mismatch".to_owned(), format!("/spec/materials/*/{name}")));
    assert_eq!(refused(spec(other)), (FAILED.to_owned(), places.to_vec()));
    // What the spec states itself stands over the case.
    let changed = spec(&format!(r#""young_modulus_kpa":12.5,"poisson_ratio":0.25,{other}"#));
    assert!((changed.unwrap().poisson_ratio() - 0.25).abs() < 1e-9);
    let changed = spec(r#""law":{"kind":"saint_venant_kirchhoff"}"#).unwrap();
    assert!((changed.young_modulus() - 15.0).abs() < 1e-9);
    assert!(matches!(changed.stated_law(), Some(Law::SaintVenantKirchhoff(_))));
}

#[test]
fn a_law_of_a_spec_takes_the_place_of_the_default_tissue() {
    let text = r#"{"units":"mm","volume":"v"}"#;
    let spec = r#"{"materials":{"*":{"law":{"kind":"neo_hookean","mu_kpa":5,"lambda_kpa":5}}}}"#;
    let changed = case_with(text, spec, None).unwrap().0.materials["*"];
    assert!((changed.poisson_ratio() - 0.25).abs() < 1e-9);
}
