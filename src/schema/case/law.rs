//! Hyperelastic laws of tissue: kinds, their constants in kPa, and valid ranges.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::material::hyperelastic::MOST_TERMS;

pub(super) const MODULUS: RangeInclusive<f64> = 1e-9..=1e9;
/// Lambda of tissue without lateral contraction.
const MODULUS_OR_NONE: RangeInclusive<f64> = 0.0..=1e9;
/// A constant of a polynomial, which may be negative.
const COEFFICIENT: RangeInclusive<f64> = -1e9..=1e9;
/// A factor in an exponent.
pub(super) const EXPONENT: RangeInclusive<f64> = 1e-6..=1e3;
const FACTOR: RangeInclusive<f64> = 1e-9..=1e9;
const POWER: RangeInclusive<f64> = -30.0..=30.0;

/// The hyperelastic law of a tissue, for `fem_nonlinear`. `neo_hookean`, `neo_hookean_isochoric`,
/// `saint_venant_kirchhoff`, `fung`, `fung_anisotropic` and `polyconvex_barrier` take their moduli from Young's modulus and
/// Poisson's ratio if these are given and theirs are not. A law of a spec replaces that of the case entirely.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LawDocument {
    pub kind: LawKind,
    /// The shear modulus at zero strain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub mu_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 1e9)]
    pub lambda_kpa: Option<f64>,
    /// K of U(J), of laws with an isochoric-volumetric split.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub bulk_modulus_kpa: Option<f64>,
    /// U(J) of the same laws; default `barrier`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub volumetric: Option<VolumetricName>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = -1e9, maximum = 1e9)]
    pub c10_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = -1e9, maximum = 1e9)]
    pub c01_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = -1e9, maximum = 1e9)]
    pub c20_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = -1e9, maximum = 1e9)]
    pub c11_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = -1e9, maximum = 1e9)]
    pub c02_kpa: Option<f64>,
    /// Of Veronda and Westmann; mu at rest is c1 g.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub c1_kpa: Option<f64>,
    /// Of Veronda and Westmann's exponent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-6, maximum = 1e3)]
    pub g: Option<f64>,
    /// Of Fung's exponent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-6, maximum = 1e3)]
    pub b: Option<f64>,
    /// Of Ogden, at most 6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, min_items = 1, max_items = 6)]
    pub terms: Option<Vec<OgdenTermDocument>>,
    /// Of Rubin and Bodner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub eps0_kpa: Option<f64>,
    /// Of Rubin and Bodner's exponent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-6, maximum = 1e3)]
    pub p: Option<f64>,
    /// Volumetric: the bulk modulus at zero strain is eps0 eta1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub eta1: Option<f64>,
    /// Isochoric: the shear modulus at zero strain is theta eps0 eta2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub eta2: Option<f64>,
    /// Of the class of surgery; default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub theta: Option<f64>,
}

/// The equations are in docs/finite-strain.md.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LawKind {
    NeoHookean,
    NeoHookeanIsochoric,
    SaintVenantKirchhoff,
    MooneyRivlin,
    VerondaWestmann,
    Fung,
    /// Neo-Hookean, or Fung's if `b` is given, with tension-only fibres: `k1_kpa` and `k2` of `fibre` are required.
    FungAnisotropic,
    Ogden,
    PolyconvexBarrier,
    RubinBodner,
}

/// The volumetric energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum VolumetricName {
    /// K/4 (J^2 - 1 - 2 ln J).
    #[default]
    Barrier,
    /// K/2 ln^2 J.
    Logarithmic,
}

/// mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3) of the isochoric stretches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OgdenTermDocument {
    /// Of the sign of alpha, else the term softens the tissue.
    #[schema(minimum = -1e9, maximum = 1e9)]
    pub mu_kpa: f64,
    #[schema(minimum = -30, maximum = 30)]
    pub alpha: f64,
}

/// A constant of a law: its name, its value, and its range.
struct Constant {
    name: &'static str,
    value: Option<f64>,
    range: RangeInclusive<f64>,
}

/// The required and the optional constants of a kind.
struct ConstantNames {
    needed: &'static [&'static str],
    other: &'static [&'static str],
}

impl LawKind {
    /// Its name in documents.
    pub fn name(self) -> &'static str {
        match self {
            LawKind::NeoHookean => "neo_hookean",
            LawKind::NeoHookeanIsochoric => "neo_hookean_isochoric",
            LawKind::SaintVenantKirchhoff => "saint_venant_kirchhoff",
            LawKind::MooneyRivlin => "mooney_rivlin",
            LawKind::VerondaWestmann => "veronda_westmann",
            LawKind::Fung => "fung",
            LawKind::FungAnisotropic => "fung_anisotropic",
            LawKind::Ogden => "ogden",
            LawKind::PolyconvexBarrier => "polyconvex_barrier",
            LawKind::RubinBodner => "rubin_bodner",
        }
    }

    fn takes(self) -> ConstantNames {
        let takes = |needed, other| ConstantNames { needed, other };
        match self {
            LawKind::NeoHookean | LawKind::SaintVenantKirchhoff | LawKind::PolyconvexBarrier => {
                takes(&[], &["mu_kpa", "lambda_kpa"])
            }
            LawKind::NeoHookeanIsochoric => {
                takes(&[], &["mu_kpa", "bulk_modulus_kpa", "volumetric"])
            }
            LawKind::MooneyRivlin => takes(
                &["c10_kpa", "bulk_modulus_kpa"],
                &["c01_kpa", "c20_kpa", "c11_kpa", "c02_kpa", "volumetric"],
            ),
            LawKind::VerondaWestmann => {
                takes(&["c1_kpa", "g", "bulk_modulus_kpa"], &["volumetric"])
            }
            LawKind::Fung => takes(&["b"], &["mu_kpa", "bulk_modulus_kpa", "volumetric"]),
            LawKind::FungAnisotropic => {
                takes(&[], &["b", "mu_kpa", "bulk_modulus_kpa", "volumetric"])
            }
            LawKind::Ogden => takes(&["terms", "bulk_modulus_kpa"], &["volumetric"]),
            LawKind::RubinBodner => takes(&["eps0_kpa", "p", "eta1", "eta2"], &["theta"]),
        }
    }
}

impl LawDocument {
    /// A law given by its kind only.
    pub fn of_kind(kind: LawKind) -> Self {
        LawDocument {
            kind,
            mu_kpa: None,
            lambda_kpa: None,
            bulk_modulus_kpa: None,
            volumetric: None,
            c10_kpa: None,
            c01_kpa: None,
            c20_kpa: None,
            c11_kpa: None,
            c02_kpa: None,
            c1_kpa: None,
            g: None,
            b: None,
            terms: None,
            eps0_kpa: None,
            p: None,
            eta1: None,
            eta2: None,
            theta: None,
        }
    }

    /// Whether it has its own moduli at zero strain.
    pub(super) fn has_moduli(&self) -> bool {
        [self.mu_kpa, self.lambda_kpa, self.bulk_modulus_kpa, self.eps0_kpa]
            .iter()
            .any(Option::is_some)
    }

    fn constants(&self) -> [Constant; 16] {
        let constant = |name, value, range| Constant { name, value, range };
        // Every member by its name: one that is left out here would be neither refused nor checked.
        #[rustfmt::skip]
        let LawDocument {
            kind: _, terms: _, volumetric: _,
            mu_kpa, lambda_kpa, bulk_modulus_kpa, c10_kpa, c01_kpa, c20_kpa, c11_kpa, c02_kpa,
            c1_kpa, g, b, eps0_kpa, p, eta1, eta2, theta,
        } = self;
        [
            constant("mu_kpa", *mu_kpa, MODULUS),
            constant("lambda_kpa", *lambda_kpa, MODULUS_OR_NONE),
            constant("bulk_modulus_kpa", *bulk_modulus_kpa, MODULUS),
            constant("c10_kpa", *c10_kpa, COEFFICIENT),
            constant("c01_kpa", *c01_kpa, COEFFICIENT),
            constant("c20_kpa", *c20_kpa, COEFFICIENT),
            constant("c11_kpa", *c11_kpa, COEFFICIENT),
            constant("c02_kpa", *c02_kpa, COEFFICIENT),
            constant("c1_kpa", *c1_kpa, MODULUS),
            constant("g", *g, EXPONENT),
            constant("b", *b, EXPONENT),
            constant("eps0_kpa", *eps0_kpa, MODULUS),
            constant("p", *p, EXPONENT),
            constant("eta1", *eta1, FACTOR),
            constant("eta2", *eta2, FACTOR),
            constant("theta", *theta, FACTOR),
        ]
    }

    /// Whether the law has the constants of its kind, no others, and all in range.
    pub(super) fn check(&self, at: &Pointer, faults: &mut Faults) -> bool {
        let ConstantNames { needed, other } = self.kind.takes();
        let constants = self.constants();
        let stated = constants.iter().filter(|constant| constant.value.is_some());
        let others = [("terms", self.terms.is_some()), ("volumetric", self.volumetric.is_some())]
            .into_iter();
        let stated: Vec<&str> = stated
            .map(|constant| constant.name)
            .chain(others.filter(|(_, is_stated)| *is_stated).map(|(name, _)| name))
            .collect();
        let mut is_sound = true;
        for name in stated.iter().filter(|name| !needed.contains(name) && !other.contains(name)) {
            let detail = format!("this law has no `{name}`; it takes {}", listed(needed, other));
            faults.add(&at.key(name), ErrorCode::NotInLaw, detail);
            is_sound = false;
        }
        for name in needed.iter().filter(|name| !stated.contains(name)) {
            faults.add(&at.key(name), ErrorCode::MissingField, format!("missing field `{name}`"));
            is_sound = false;
        }
        for Constant { name, value, range } in constants {
            let Some(value) = value else { continue };
            let unit = if name.ends_with("_kpa") { "kPa" } else { "" };
            is_sound &= faults.check_range(&at.key(name), value, range, unit);
        }
        self.check_terms(&at.key("terms"), faults) && is_sound
    }

    fn check_terms(&self, at: &Pointer, faults: &mut Faults) -> bool {
        let terms = self.terms.as_deref().unwrap_or_default();
        if self.terms.is_some() && !(1..=MOST_TERMS).contains(&terms.len()) {
            let detail = format!("{} terms, 1 to {MOST_TERMS} are allowed", terms.len());
            faults.add(at, ErrorCode::OutOfRange, detail);
            return false;
        }
        let mut is_sound = true;
        for (index, term) in terms.iter().enumerate() {
            let at = at.index(index);
            is_sound &= faults.check_range(&at.key("mu_kpa"), term.mu_kpa, COEFFICIENT, "kPa");
            is_sound &= faults.check_range(&at.key("alpha"), term.alpha, POWER, "");
        }
        is_sound
    }
}

fn listed(needed: &[&str], other: &[&str]) -> String {
    let names = needed.iter().chain(other).map(|name| format!("`{name}`"));
    names.collect::<Vec<_>>().join(", ")
}
