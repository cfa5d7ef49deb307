//! Equivalent tissue of cells that muscles fill in part: the mixture of their shares by a stated rule, and the volume
//! in which the choice of the rule matters.

use crate::material::LinearElastic;
use crate::material::mixture::{MixingRule, mixture};

/// Where a modulus by Voigt is more than this many times that by Reuss, the answer is a property of the rule.
const RULE_DECIDES: f64 = 3.0;

/// The tissue of a cell of several parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquivalentTissue {
    pub tissue: LinearElastic,
    /// Of Young's modulus by Voigt to that by Reuss, across fibres or along them, where that is more.
    pub rule_ratio: f64,
}

impl EquivalentTissue {
    /// Of parts with shares that sum to 1, whose fibres, where they have any, are along one direction.
    pub fn new(parts: &[(f64, LinearElastic)], rule: MixingRule) -> Self {
        let [voigt, reuss] = [MixingRule::Voigt, MixingRule::Reuss].map(|own| mixture(parts, own));
        let across = voigt.young_modulus() / reuss.young_modulus();
        let along = voigt.fibre_modulus().zip(reuss.fibre_modulus()).map_or(1.0, |(v, r)| v / r);
        EquivalentTissue { tissue: mixture(parts, rule), rule_ratio: across.max(along) }
    }
}

/// The share of some volumes, each of a cell with the ratio of its rules, in which the rule decides.
pub fn rule_dependent_share(cells: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let (mut all, mut decided) = (0.0, 0.0);
    for (volume, ratio) in cells {
        all += volume;
        decided += if ratio > RULE_DECIDES { volume } else { 0.0 };
    }
    if all > 0.0 { decided / all } else { 0.0 }
}
