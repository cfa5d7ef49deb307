//! Conversion of a law between its document and the numerics.

use super::law::{LawDocument, LawKind, OgdenTermDocument, VolumetricName};
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::material::LinearElastic;
use mechanics::material::hyperelastic::{
    Fung, Law, MooneyRivlin, NeoHookean, NeoHookeanIsochoric, Ogden, OgdenTerm, PolyconvexBarrier,
    RubinBodner, SaintVenantKirchhoff, VerondaWestmann, Volumetric,
};

impl LawDocument {
    /// The law, with moduli from the linear constants if its own are not given.
    pub(super) fn to_law(
        &self,
        linear: Option<&LinearElastic>,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<Law> {
        if !self.check(at, faults) {
            return None;
        }
        let of_shape = |faults: &mut Faults| self.shear_and_bulk(linear, at, faults);
        let volumetric = |bulk| self.volumetric(bulk);
        let or_none = |value: Option<f64>| value.unwrap_or(0.0);
        Some(match self.kind {
            LawKind::NeoHookean => {
                let [mu, lambda] = self.shear_and_lambda(linear, at, faults)?;
                Law::NeoHookean(NeoHookean { lambda, mu })
            }
            LawKind::SaintVenantKirchhoff => {
                let [mu, lambda] = self.shear_and_lambda(linear, at, faults)?;
                Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu })
            }
            LawKind::PolyconvexBarrier => {
                let [mu, lambda] = self.shear_and_lambda(linear, at, faults)?;
                Law::PolyconvexBarrier(PolyconvexBarrier { lambda, mu })
            }
            LawKind::NeoHookeanIsochoric | LawKind::Fung | LawKind::FungAnisotropic => {
                let [mu, bulk] = of_shape(faults)?;
                let volumetric = volumetric(bulk);
                match self.b {
                    None => Law::NeoHookeanIsochoric(NeoHookeanIsochoric { mu, volumetric }),
                    Some(b) => Law::Fung(Fung { mu, b, volumetric }),
                }
            }
            LawKind::MooneyRivlin => Law::MooneyRivlin(MooneyRivlin {
                c10: self.c10_kpa?,
                c01: or_none(self.c01_kpa),
                c20: or_none(self.c20_kpa),
                c11: or_none(self.c11_kpa),
                c02: or_none(self.c02_kpa),
                volumetric: volumetric(self.bulk_modulus_kpa?),
            }),
            LawKind::VerondaWestmann => Law::VerondaWestmann(VerondaWestmann {
                c1: self.c1_kpa?,
                g: self.g?,
                volumetric: volumetric(self.bulk_modulus_kpa?),
            }),
            LawKind::Ogden => {
                let terms = self.terms.iter().flatten();
                let terms: Vec<OgdenTerm> =
                    terms.map(|term| OgdenTerm { mu: term.mu_kpa, alpha: term.alpha }).collect();
                Law::Ogden(Ogden::new(&terms, volumetric(self.bulk_modulus_kpa?)))
            }
            LawKind::RubinBodner => Law::RubinBodner(RubinBodner {
                eps0: self.eps0_kpa?,
                p: self.p?,
                eta1: self.eta1?,
                eta2: self.eta2?,
                theta: self.theta.unwrap_or(1.0),
            }),
        })
    }

    fn volumetric(&self, bulk: f64) -> Volumetric {
        match self.volumetric.unwrap_or_default() {
            VolumetricName::Barrier => Volumetric::Barrier(bulk),
            VolumetricName::Logarithmic => Volumetric::Logarithmic(bulk),
        }
    }

    fn shear_and_lambda(
        &self,
        linear: Option<&LinearElastic>,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<[f64; 2]> {
        let of_linear = linear.map(|linear| [linear.shear_modulus(), linear.lambda()]);
        let own = [("mu_kpa", self.mu_kpa), ("lambda_kpa", self.lambda_kpa)];
        both(own, of_linear, at, faults)
    }

    fn shear_and_bulk(
        &self,
        linear: Option<&LinearElastic>,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<[f64; 2]> {
        let of_linear = linear.map(|linear| [linear.shear_modulus(), linear.bulk_modulus()]);
        let own = [("mu_kpa", self.mu_kpa), ("bulk_modulus_kpa", self.bulk_modulus_kpa)];
        both(own, of_linear, at, faults)
    }
}

/// Two moduli of a law: both given, or both from the linear constants.
fn both(
    own: [(&str, Option<f64>); 2],
    of_linear: Option<[f64; 2]>,
    at: &Pointer,
    faults: &mut Faults,
) -> Option<[f64; 2]> {
    let [(one, first), (other, second)] = own;
    if let (None, None, Some(of_linear)) = (first, second, of_linear) {
        return Some(of_linear);
    }
    let missing = [(one, first), (other, second)].into_iter().filter(|(_, value)| value.is_none());
    for (name, _) in missing {
        let detail = format!(
            "missing field `{name}`: `{one}` and `{other}` go together, or both follow from `young_modulus_kpa` and \
             `poisson_ratio`"
        );
        faults.add(&at.key(name), ErrorCode::MissingField, detail);
    }
    Some([first?, second?])
}

impl From<&Law> for LawDocument {
    fn from(law: &Law) -> Self {
        let of = LawDocument::of_kind;
        match *law {
            Law::NeoHookean(NeoHookean { lambda, mu }) => of(LawKind::NeoHookean).lame(lambda, mu),
            Law::SaintVenantKirchhoff(SaintVenantKirchhoff { lambda, mu }) => {
                of(LawKind::SaintVenantKirchhoff).lame(lambda, mu)
            }
            Law::PolyconvexBarrier(PolyconvexBarrier { lambda, mu }) => {
                of(LawKind::PolyconvexBarrier).lame(lambda, mu)
            }
            Law::NeoHookeanIsochoric(NeoHookeanIsochoric { mu, volumetric }) => LawDocument {
                mu_kpa: Some(mu),
                ..of(LawKind::NeoHookeanIsochoric).with_volume(volumetric)
            },
            Law::Fung(Fung { mu, b, volumetric }) => LawDocument {
                mu_kpa: Some(mu),
                b: Some(b),
                ..of(LawKind::Fung).with_volume(volumetric)
            },
            Law::MooneyRivlin(MooneyRivlin { c10, c01, c20, c11, c02, volumetric }) => {
                LawDocument {
                    c10_kpa: Some(c10),
                    c01_kpa: Some(c01),
                    c20_kpa: Some(c20),
                    c11_kpa: Some(c11),
                    c02_kpa: Some(c02),
                    ..of(LawKind::MooneyRivlin).with_volume(volumetric)
                }
            }
            Law::VerondaWestmann(VerondaWestmann { c1, g, volumetric }) => LawDocument {
                c1_kpa: Some(c1),
                g: Some(g),
                ..of(LawKind::VerondaWestmann).with_volume(volumetric)
            },
            Law::Ogden(law) => {
                let term =
                    |term: &OgdenTerm| OgdenTermDocument { mu_kpa: term.mu, alpha: term.alpha };
                LawDocument {
                    terms: Some(law.terms().map(term).collect()),
                    ..of(LawKind::Ogden).with_volume(law.volumetric)
                }
            }
            Law::RubinBodner(RubinBodner { eps0, p, eta1, eta2, theta }) => LawDocument {
                eps0_kpa: Some(eps0),
                p: Some(p),
                eta1: Some(eta1),
                eta2: Some(eta2),
                theta: Some(theta),
                ..of(LawKind::RubinBodner)
            },
        }
    }
}

impl LawDocument {
    fn lame(self, lambda: f64, mu: f64) -> Self {
        LawDocument { lambda_kpa: Some(lambda), mu_kpa: Some(mu), ..self }
    }

    fn with_volume(self, volumetric: Volumetric) -> Self {
        let (name, bulk) = match volumetric {
            Volumetric::Barrier(bulk) => (VolumetricName::Barrier, bulk),
            Volumetric::Logarithmic(bulk) => (VolumetricName::Logarithmic, bulk),
        };
        LawDocument { volumetric: Some(name), bulk_modulus_kpa: Some(bulk), ..self }
    }
}
