//! Hyperelastic laws: energy of tissue at finite strain, and its derivatives by the invariants of the deformation.
//!
//! W(I1, I2, J, I4) in kPa with I1 = tr C, I2 = tr cof C, J = det F, I4 = a . C a, C = F^T F. Every law states W and its
//! first and second derivatives by (I1, I2, J) in a file of its own; stress and tangent follow from them for all laws
//! alike ([`point`]). What is stated in principal stretches goes its own way ([`principal`]).

mod exponential;
mod fibres;
mod fung;
mod invariants;
mod isochoric;
mod mooney_rivlin;
mod neo_hookean;
mod ogden;
pub mod point;
mod polyconvex_barrier;
mod principal;
mod rubin_bodner;
mod saint_venant_kirchhoff;
mod veronda_westmann;
mod volumetric;

pub use exponential::LARGEST_EXPONENT;
pub use fibres::Fibres;
pub use fung::Fung;
pub use invariants::{Derivatives, Invariants};
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean::{NeoHookean, NeoHookeanIsochoric};
pub use ogden::{MOST_TERMS, Ogden, OgdenTerm};
pub use polyconvex_barrier::PolyconvexBarrier;
pub use rubin_bodner::RubinBodner;
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use veronda_westmann::VerondaWestmann;
pub use volumetric::{OfVolume, VolumeEnergy, Volumetric};

/// Law of the tissue between fibres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    SaintVenantKirchhoff(SaintVenantKirchhoff),
    NeoHookean(NeoHookean),
    NeoHookeanIsochoric(NeoHookeanIsochoric),
    MooneyRivlin(MooneyRivlin),
    VerondaWestmann(VerondaWestmann),
    Fung(Fung),
    Ogden(Ogden),
    PolyconvexBarrier(PolyconvexBarrier),
    RubinBodner(RubinBodner),
}

impl Law {
    /// Energy density in kPa, with its derivatives; without the part that is stated in principal stretches.
    #[inline]
    pub fn at(&self, invariants: &Invariants) -> Derivatives {
        match self {
            Law::SaintVenantKirchhoff(law) => law.at(invariants),
            Law::NeoHookean(law) => law.at(invariants),
            Law::NeoHookeanIsochoric(law) => law.at(invariants),
            Law::MooneyRivlin(law) => law.at(invariants),
            Law::VerondaWestmann(law) => law.at(invariants),
            Law::Fung(law) => law.at(invariants),
            Law::Ogden(law) => law.of_volume(invariants.j),
            Law::PolyconvexBarrier(law) => law.at(invariants),
            Law::RubinBodner(law) => law.at(invariants),
        }
    }

    /// Whether its energy of volume is that of ln J, which elements can share between points.
    pub fn shares_volume(&self) -> bool {
        match self {
            Law::NeoHookean(_) => true,
            Law::SaintVenantKirchhoff(_)
            | Law::NeoHookeanIsochoric(_)
            | Law::MooneyRivlin(_)
            | Law::VerondaWestmann(_)
            | Law::Fung(_)
            | Law::Ogden(_)
            | Law::PolyconvexBarrier(_)
            | Law::RubinBodner(_) => false,
        }
    }

    /// What is stated in principal stretches.
    #[inline]
    fn in_stretches(&self) -> Option<&Ogden> {
        match self {
            Law::Ogden(law) => Some(law),
            Law::SaintVenantKirchhoff(_)
            | Law::NeoHookean(_)
            | Law::NeoHookeanIsochoric(_)
            | Law::MooneyRivlin(_)
            | Law::VerondaWestmann(_)
            | Law::Fung(_)
            | Law::PolyconvexBarrier(_)
            | Law::RubinBodner(_) => None,
        }
    }

    /// Of the exponential at a deformation; none of a law without one.
    pub fn exponent(&self, at: &Invariants) -> Option<f64> {
        let shape = at.j.cbrt().powi(-2) * at.i1 - 3.0;
        match self {
            Law::VerondaWestmann(law) => Some(law.g * shape),
            Law::Fung(law) => Some(law.b * shape),
            Law::RubinBodner(law) => Some(law.exponent(at)),
            Law::SaintVenantKirchhoff(_)
            | Law::NeoHookean(_)
            | Law::NeoHookeanIsochoric(_)
            | Law::MooneyRivlin(_)
            | Law::Ogden(_)
            | Law::PolyconvexBarrier(_) => None,
        }
    }
}

/// A law, with or without fibres that only pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hyperelastic {
    pub law: Law,
    pub fibres: Option<Fibres>,
}
