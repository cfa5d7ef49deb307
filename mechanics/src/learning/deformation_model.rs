//! Statistical deformation model: skin that goes with bone as it did in the training cases.
//!
//! Displacements of skin and bone of each case are stacked, d = (s; b), and their mean subtracted. The first k left singular
//! vectors Phi = (Phi_s; Phi_b) are the modes. For bone b
//!   c = (Phi_b^T Phi_b + a I)^-1 Phi_b^T (b - b0),  s = s0 + Phi_s c,  a = ridge trace(Phi_b^T Phi_b) / k.
//! Zhang et al. 2016 compare with such a model and give no formula; this one is a choice. All is computed from scalar products
//! of cases: with D = U S V^T the modes are D V / S, so that s is the mean of the training cases weighted by
//!   w = 1/n + V S^-1 c.
//!
//! How many modes: as usual those that hold 95 % of the variance, at least one and at most n - 2; or those, from none to n - 3, by
//! which the training cases are predicted best from each other. Variance is no measure of what bone tells of skin: a mode that
//! hardly shows in bone has a large c for a small error there, and of what mechanics misses nearly all modes are such.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::pairs::Pairs;

/// The ridge, as a share of the mean of what it is added to.
pub const RIDGE: f64 = 1e-3;

/// Of the variance that modes hold.
const VARIANCE: f64 = 0.95;

/// Modes whose variance is this share of the first are rounding.
const ROUNDING: f64 = 1e-13;

/// An error that is less by this share only is not less.
const NOTEWORTHY: f64 = 1e-9;

/// A model that is fitted to training cases.
#[derive(Clone, Debug, PartialEq)]
pub struct DeformationModel {
    pub modes: ModeCount,
    /// V S^-1: a row for each training case, a column for each mode.
    shares: DMatrix<f64>,
    /// Phi_b^T Phi_b + a I.
    normal: DMatrix<f64>,
    /// For each training case the mean scalar product of its bone with the others'.
    bone_means: Vec<f64>,
}

/// How many modes a model has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModeCount {
    pub count: usize,
    /// That so many training cases permit.
    pub most: usize,
    /// Whether the rule reached `most`: with more cases there might be more.
    pub is_limited: bool,
}

/// How many modes are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModeRule {
    /// Those that hold this share of the variance, in (0, 1].
    Variance(f64),
    /// So many, or all that there are.
    Count(usize),
}

/// How a model is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    pub ridge: f64,
    pub modes: ModeRule,
}

impl Default for Fit {
    fn default() -> Self {
        Fit { ridge: RIDGE, modes: ModeRule::Variance(VARIANCE) }
    }
}

/// All modes of some cases.
struct Modes {
    /// Of each, falling; rounding is left out.
    variances: Vec<f64>,
    /// Of all, those that are left out too.
    total: f64,
    /// V S^-1.
    shares: DMatrix<f64>,
    /// Phi_b^T Phi_b.
    normal: DMatrix<f64>,
    bone_means: Vec<f64>,
}

impl Modes {
    /// From scalar products of what is predicted and of the displacement of bone.
    fn new(skin: &Pairs, bone: &Pairs) -> Self {
        let count = skin.count();
        let all = centred(&DMatrix::from_fn(count, count, |i, j| skin.at(i, j) + bone.at(i, j)));
        let products = DMatrix::from_fn(count, count, |i, j| bone.at(i, j));
        let eigen = all.symmetric_eigen();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let ordered: Vec<f64> = order.iter().map(|&own| eigen.eigenvalues[own]).collect();
        let total = ordered.iter().map(|own| own.max(0.0)).sum();
        let largest = ordered.first().copied().unwrap_or_default();
        let variances: Vec<f64> =
            ordered.into_iter().take_while(|own| *own > ROUNDING * largest).collect();
        let shares = DMatrix::from_fn(count, variances.len(), |case, mode| {
            eigen.eigenvectors[(case, order[mode])] / variances[mode].sqrt()
        });
        let normal = shares.transpose() * centred(&products) * &shares;
        let bone_means = products.column_mean().iter().copied().collect();
        Modes { variances, total, shares, normal, bone_means }
    }

    /// The first modes of these, as many as the rule says.
    fn model(&self, fit: Fit) -> DeformationModel {
        let modes = self.count(fit.modes);
        let first = modes.count;
        let mut normal = self.normal.view((0, 0), (first, first)).into_owned();
        let ridge = fit.ridge * normal.trace() / first.max(1) as f64;
        (0..first).for_each(|mode| normal[(mode, mode)] += ridge);
        let shares = self.shares.columns(0, first).into_owned();
        DeformationModel { modes, shares, normal, bone_means: self.bone_means.clone() }
    }

    fn count(&self, rule: ModeRule) -> ModeCount {
        let (cases, real) = (self.shares.nrows(), self.variances.len());
        match rule {
            ModeRule::Variance(share) => {
                let most = cases.saturating_sub(2).max(1);
                let mut held = 0.0;
                let needed = self.variances.iter().take_while(|own| {
                    let more = held < share * self.total;
                    held += *own;
                    more
                });
                let needed = needed.count();
                ModeCount { count: needed.min(most), most, is_limited: needed > most }
            }
            ModeRule::Count(wanted) => {
                let most = cases.saturating_sub(3);
                let count = wanted.min(real);
                ModeCount { count, most, is_limited: most > 0 && wanted == most && real > most }
            }
        }
    }
}

/// The number of modes, from none, by which each case is predicted best from the others: one decomposition of the others serves
/// all numbers.
pub fn best_mode_count(skin: &Pairs, bone: &Pairs, ridge: f64) -> usize {
    let cases = skin.count();
    let most = cases.saturating_sub(3);
    let errors_of = |case: usize| -> Vec<f64> {
        let others: Vec<usize> = (0..cases).filter(|&other| other != case).collect();
        let modes = Modes::new(&skin.among(&others), &bone.among(&others));
        let query = bone.row(case, &others);
        let error = |count: usize| {
            let model = modes.model(Fit { ridge, modes: ModeRule::Count(count) });
            skin.squared_error(case, &others, &model.weights(&query))
        };
        (0..=most).map(error).collect()
    };
    let all: Vec<Vec<f64>> = (0..cases).into_par_iter().map(errors_of).collect();
    let sum = |count: usize| all.iter().map(|own| own[count]).sum::<f64>();
    let mut best = (0, sum(0));
    for count in 1..=most {
        let error = sum(count);
        if error < best.1 * (1.0 - NOTEWORTHY) {
            best = (count, error);
        }
    }
    best.0
}

impl DeformationModel {
    /// From scalar products of what is predicted and of the displacement of bone; at least three cases.
    pub fn new(skin: &Pairs, bone: &Pairs, fit: Fit) -> Self {
        Modes::new(skin, bone).model(fit)
    }

    /// The weights of the training cases for bone whose scalar products with theirs these are; their sum is 1.
    pub fn weights(&self, bone: &[f64]) -> Vec<f64> {
        let count = bone.len() as f64;
        // Cases that do not differ have no mode.
        if self.modes.count == 0 {
            return vec![1.0 / count; bone.len()];
        }
        let mean = bone.iter().sum::<f64>() / count;
        let overall = self.bone_means.iter().sum::<f64>() / count;
        let query =
            bone.iter().zip(&self.bone_means).map(|(own, of_case)| own - mean - of_case + overall);
        let query = DVector::from_iterator(bone.len(), query);
        let right = self.shares.transpose() * query;
        (&self.shares * self.solved(&right)).iter().map(|share| 1.0 / count + share).collect()
    }

    /// c; the shortest where there are several.
    fn solved(&self, right: &DVector<f64>) -> DVector<f64> {
        if let Some(factor) = self.normal.clone().cholesky() {
            return factor.solve(right);
        }
        let solved = self.normal.clone().svd(true, true).solve(right, f64::EPSILON);
        solved.unwrap_or_else(|_| DVector::zeros(right.len()))
    }
}

/// C K C with C = I - 1 1^T / n.
fn centred(products: &DMatrix<f64>) -> DMatrix<f64> {
    let of_rows = products.column_mean();
    let overall = of_rows.mean();
    DMatrix::from_fn(products.nrows(), products.ncols(), |i, j| {
        products[(i, j)] - of_rows[i] - of_rows[j] + overall
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;
    use crate::learning::pairs::{blended, dot};

    /// Cases whose skin follows bone linearly through two planted modes.
    fn planted(count: usize) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let wave = |k: usize, i: usize| ((k + 1) as f64 * (i as f64 + 0.3)).sin();
        let of = |length: usize, c: [f64; 2], phase: usize| -> Vec<f64> {
            (0..length).map(|i| 0.2 + c[0] * wave(phase, i) + c[1] * wave(phase + 1, i)).collect()
        };
        let amounts: Vec<[f64; 2]> =
            (0..count).map(|i| [wave(3, i) * 4.0, wave(7, i) * 3.0 + 0.5]).collect();
        let skin = amounts.iter().map(|&c| of(90, c, 1)).collect();
        let bone = amounts.iter().map(|&c| of(30, c, 5)).collect();
        (skin, bone)
    }

    fn products(vectors: &[Vec<f64>]) -> Pairs {
        Pairs::products(&vectors.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    #[test]
    fn planted_data_of_rank_two_come_back_to_1e_8() {
        let (skin, bone) = planted(9);
        let fit = Fit { ridge: 0.0, modes: ModeRule::Variance(1.0) };
        let model = DeformationModel::new(&products(&skin[..8]), &products(&bone[..8]), fit);
        assert_eq!(model.modes.count, 2);
        let query: Vec<f64> = bone[..8].iter().map(|own| dot(own, &bone[8])).collect();
        let known: Vec<&[f64]> = skin[..8].iter().map(Vec::as_slice).collect();
        let found = blended(&model.weights(&query), &known);
        let error = found.iter().zip(&skin[8]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-8, "{error}");
    }

    #[test]
    fn bone_as_in_the_mean_gives_the_mean_skin_whatever_the_ridge() {
        let (skin, bone) = planted(6);
        let model = DeformationModel::new(&products(&skin), &products(&bone), Fit::default());
        let mean: Vec<f64> =
            blended(&[1.0 / 6.0; 6], &bone.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let query: Vec<f64> = bone.iter().map(|own| dot(own, &mean)).collect();
        for weight in model.weights(&query) {
            assert!((weight - 1.0 / 6.0).abs() < 1e-12);
        }
    }

    fn of_variances(variances: &[f64]) -> Modes {
        let (real, cases) = (variances.iter().filter(|own| **own > 0.0).count(), variances.len());
        Modes {
            variances: variances[..real].to_vec(),
            total: variances.iter().sum(),
            shares: DMatrix::zeros(cases, real),
            normal: DMatrix::zeros(real, real),
            bone_means: vec![0.0; cases],
        }
    }

    #[test]
    fn modes_are_at_most_two_fewer_than_cases_and_hold_the_variance_and_a_limit_is_told() {
        let count = |variances: &[f64], share: f64| {
            let found = of_variances(variances).count(ModeRule::Variance(share));
            (found.count, found.most, found.is_limited)
        };
        assert_eq!(count(&[9.0, 5.0, 4.0, 1.0, 0.5], 1.0), (3, 3, true));
        assert_eq!(count(&[90.0, 6.0, 3.0, 1.0, 0.0], 0.95), (2, 3, false));
        assert_eq!(count(&[1.0, 0.0, 0.0], 0.95), (1, 1, false));
        let chosen = of_variances(&[9.0, 5.0, 4.0, 1.0, 0.5]).count(ModeRule::Count(2));
        assert_eq!(chosen, ModeCount { count: 2, most: 2, is_limited: true });
    }

    #[test]
    fn of_planted_data_two_modes_are_chosen_and_of_noise_none() {
        let (skin, bone) = planted(12);
        assert_eq!(best_mode_count(&products(&skin), &products(&bone), RIDGE * 1e-6), 2);
        let mut draws = Draws::of(3, 0);
        let noise: Vec<Vec<f64>> =
            (0..12).map(|_| (0..90).map(|_| draws.normal()).collect()).collect();
        let by_variance =
            DeformationModel::new(&products(&noise), &products(&bone), Fit::default());
        assert!(by_variance.modes.count > 5);
        assert_eq!(best_mode_count(&products(&noise), &products(&bone), RIDGE), 0);
    }
}
