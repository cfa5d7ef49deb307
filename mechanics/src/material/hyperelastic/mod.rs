//! Hyperelastic laws: energy of tissue at finite strain, and its derivatives by the invariants of the deformation.
//!
//! W(I1, I2, J, I4) in kPa with I1 = tr C, I2 = tr cof C, J = det F, I4 = a . C a, C = F^T F. Every law states W and its
//! first and second derivatives by (I1, I2, J) in a file of its own; stress and tangent follow from them for all laws
//! alike ([`point`]).

mod exponential;
mod fibres;
mod fung;
mod invariants;
mod isochoric;
mod mooney_rivlin;
mod neo_hookean;
pub mod point;
mod polyconvex_barrier;
mod saint_venant_kirchhoff;
mod veronda_westmann;
mod volumetric;

pub use fibres::Fibres;
pub use fung::Fung;
pub use invariants::{Derivatives, Invariants};
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean::{NeoHookean, NeoHookeanIsochoric};
pub use polyconvex_barrier::PolyconvexBarrier;
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use veronda_westmann::VerondaWestmann;
pub use volumetric::Volumetric;

/// What tissue does at any deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    SaintVenantKirchhoff(SaintVenantKirchhoff),
    NeoHookean(NeoHookean),
    NeoHookeanIsochoric(NeoHookeanIsochoric),
    MooneyRivlin(MooneyRivlin),
    VerondaWestmann(VerondaWestmann),
    Fung(Fung),
    PolyconvexBarrier(PolyconvexBarrier),
}

impl Law {
    /// Energy density in kPa, with its derivatives.
    #[inline]
    pub fn at(&self, invariants: &Invariants) -> Derivatives {
        match self {
            Law::SaintVenantKirchhoff(law) => law.at(invariants),
            Law::NeoHookean(law) => law.at(invariants),
            Law::NeoHookeanIsochoric(law) => law.at(invariants),
            Law::MooneyRivlin(law) => law.at(invariants),
            Law::VerondaWestmann(law) => law.at(invariants),
            Law::Fung(law) => law.at(invariants),
            Law::PolyconvexBarrier(law) => law.at(invariants),
        }
    }
}
