//! The tissue of cells that muscles fill in part: the mixture of their shares by a stated rule, its one axis, and how much of the
//! volume depends on which rule is taken.

use super::axis::{MeanAxis, mean_axis};
use crate::material::elastic_tensor::ElasticTensor;
use crate::material::mixture::{Mixing, mixed};
use crate::material::{LinearElastic, MaterialError};
use crate::mesh::Vector;

/// Where Young's modulus by Voigt is more than this many times that by Reuss, the answer is a property of the rule.
const RULE_DECIDES: f64 = 3.0;

/// A muscle in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuscleShare {
    /// Of the volume of the cell, 0 to 1.
    pub share: f64,
    pub tissue: LinearElastic,
    /// Along its fibres, where it has some.
    pub axis: Option<Vector>,
}

/// The tissue of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquivalentTissue {
    pub tissue: LinearElastic,
    /// Of all its muscles, by their shares.
    pub axis: Option<MeanAxis>,
    /// Of Young's modulus by Voigt to that by Reuss.
    pub rule_ratio: f64,
}

/// The isotropic tissue of a cell of muscles and, in what they leave, `rest`. Shares that sum to more than 1, as of muscles that
/// overlap, are taken down to 1 together.
pub fn equivalent(
    muscles: &[MuscleShare],
    rest: LinearElastic,
    mixing: Mixing,
) -> Result<EquivalentTissue, MaterialError> {
    let parts = parts_of(muscles, rest);
    let [voigt, reuss] = [Mixing::Voigt, Mixing::Reuss].map(|rule| mixed(&parts, rule));
    Ok(EquivalentTissue {
        tissue: mixed(&parts, mixing)?,
        axis: axis_of(muscles),
        rule_ratio: voigt?.young_modulus() / reuss?.young_modulus(),
    })
}

/// C = Σ f_i C_i(a) of muscles with fibres and the rest, a their mean axis: linear in lambda, mu, dlam, dmu and beta, all parts
/// strained alike (Voigt). Without an axis the fibres are left out.
pub fn equivalent_tensor(muscles: &[MuscleShare], rest: LinearElastic) -> ElasticTensor {
    let axis = axis_of(muscles).map_or_else(Vector::x, |mean| mean.direction);
    let parts = parts_of(muscles, rest);
    let tensors = parts.iter().map(|(share, tissue)| (*share, tissue.tensor(&axis)));
    ElasticTensor::mixed(tensors, &axis)
}

/// The share of some volumes, each of a cell with the ratio of its rules, in which the rule decides.
pub fn decided_by_rule(cells: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let (mut all, mut decided) = (0.0, 0.0);
    for (volume, ratio) in cells {
        all += volume;
        decided += if ratio > RULE_DECIDES { volume } else { 0.0 };
    }
    if all > 0.0 { decided / all } else { 0.0 }
}

fn axis_of(muscles: &[MuscleShare]) -> Option<MeanAxis> {
    mean_axis(muscles.iter().filter_map(|own| Some((own.share, own.axis?))))
}

fn parts_of(muscles: &[MuscleShare], rest: LinearElastic) -> Vec<(f64, LinearElastic)> {
    let total: f64 = muscles.iter().map(|own| own.share.max(0.0)).sum();
    let scale = if total > 1.0 { 1.0 / total } else { 1.0 };
    let of_muscles = muscles.iter().map(|own| (own.share.max(0.0) * scale, own.tissue));
    of_muscles.chain([((1.0 - total).max(0.0), rest)]).filter(|(share, _)| *share > 0.0).collect()
}
