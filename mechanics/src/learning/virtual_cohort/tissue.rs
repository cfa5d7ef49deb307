//! Tissue of virtual patients: what the models take it for, and what it is.
//!
//! The models take it for the optimum of Zachow et al. 2006 (muscle 300 kPa in 50 kPa), linear or neo-Hookean, or for Rubin and
//! Bodner's of Zhang et al. 2016, table 2, with the bulk modulus at 1000 times the shear modulus. In truth it is softer in
//! muscle, less compressible, and stiffens as Veronda and Westmann's law does, by constants of each patient.

use std::collections::BTreeMap;

use crate::draws::Draws;
use crate::material::hyperelastic::{Law, RubinBodner, VerondaWestmann, Volumetric};
use crate::material::{LinearElastic, MaterialError};

pub type Tissue = BTreeMap<String, LinearElastic>;

/// The bulk modulus over the shear modulus of Rubin and Bodner's tissue; the paper's are 2.75e5 and 1.6e7.
const BULK: f64 = 1000.0;

/// What the models suppose.
pub fn supposed() -> Result<Tissue, MaterialError> {
    both(LinearElastic::new(50.0, 0.455, 1.0)?, LinearElastic::new(300.0, 0.44, 1.0)?)
}

/// Table 2: eps0 in kPa, p, and eta2 of remaining tissue and of muscle.
pub fn rubin_bodner(theta: f64) -> Result<Tissue, MaterialError> {
    let law = |eps0: f64, p: f64, eta2: f64| {
        let law = RubinBodner { eps0, p, eta1: BULK * eta2, eta2, theta };
        LinearElastic::of_law(Law::RubinBodner(law), 1.0)
    };
    both(law(1700.0, 36.0, 0.00008)?, law(3700.0, 25.0, 0.00216)?)
}

/// What a patient's tissue is: g in [2, 6], nu 0.48, muscle 2 to 4 times as stiff as the rest.
pub fn true_tissue(draws: &mut Draws) -> Result<Tissue, MaterialError> {
    let stiffening = draws.between(2.0, 6.0);
    let ratio = draws.between(2.0, 4.0);
    let law = |mu: f64| {
        let volumetric = Volumetric::Barrier(25.0 * mu);
        let law = VerondaWestmann { c1: mu / stiffening, g: stiffening, volumetric };
        LinearElastic::of_law(Law::VerondaWestmann(law), 1.0)
    };
    both(law(15.0)?, law(15.0 * ratio)?)
}

fn both(rest: LinearElastic, muscle: LinearElastic) -> Result<Tissue, MaterialError> {
    Ok(BTreeMap::from([("*".to_owned(), rest), ("muscle".to_owned(), muscle)]))
}
