//! Statistical deformation model: skin that goes with bone as it did in the training cases.
//!
//! Displacements of skin and bone of each case are stacked, d = (s; b), and their mean subtracted. The first k left singular
//! vectors Phi = (Phi_s; Phi_b) are the modes, k = min(n - 2, those that hold 95 % of the variance), at least one. For bone b
//!   c = (Phi_b^T Phi_b + a I)^-1 Phi_b^T (b - b0),  s = s0 + Phi_s c,  a = ridge trace(Phi_b^T Phi_b) / k.
//! Zhang et al. 2016 compare with such a model and give no formula; this one is a choice. All is computed from scalar products
//! of cases: with D = U S V^T the modes are D V / S, so that s is the mean of the training cases weighted by
//!   w = 1/n + V S^-1 c.

use nalgebra::{DMatrix, DVector};

use super::pairs::Pairs;

/// The ridge, as a share of the mean of what it is added to.
pub const RIDGE: f64 = 1e-3;

/// Of the variance that modes hold.
const VARIANCE: f64 = 0.95;

/// Modes whose variance is this share of the first are rounding.
const ROUNDING: f64 = 1e-13;

/// A model that is fitted to training cases.
#[derive(Clone, Debug, PartialEq)]
pub struct DeformationModel {
    /// V S^-1: a row for each training case, a column for each mode.
    shares: DMatrix<f64>,
    /// Phi_b^T Phi_b + a I.
    normal: DMatrix<f64>,
    /// For each training case the mean scalar product of its bone with the others'.
    bone_means: Vec<f64>,
}

/// How a model is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    pub ridge: f64,
    /// Of the variance, in (0, 1].
    pub variance: f64,
}

impl Default for Fit {
    fn default() -> Self {
        Fit { ridge: RIDGE, variance: VARIANCE }
    }
}

impl DeformationModel {
    /// From scalar products of what is predicted and of the displacement of bone; at least three cases.
    pub fn new(skin: &Pairs, bone: &Pairs, fit: Fit) -> Self {
        let count = skin.count();
        let all = centred(&DMatrix::from_fn(count, count, |i, j| skin.at(i, j) + bone.at(i, j)));
        let products = DMatrix::from_fn(count, count, |i, j| bone.at(i, j));
        let eigen = all.symmetric_eigen();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let modes =
            mode_count(order.iter().map(|&own| eigen.eigenvalues[own]).collect(), fit.variance);
        let shares = DMatrix::from_fn(count, modes, |case, mode| {
            let own = order[mode];
            eigen.eigenvectors[(case, own)] / eigen.eigenvalues[own].max(f64::MIN_POSITIVE).sqrt()
        });
        let mut normal = shares.transpose() * centred(&products) * &shares;
        let ridge = fit.ridge * normal.trace() / modes.max(1) as f64;
        (0..modes).for_each(|mode| normal[(mode, mode)] += ridge);
        let bone_means = products.column_mean().iter().copied().collect();
        DeformationModel { shares, normal, bone_means }
    }

    pub fn modes(&self) -> usize {
        self.shares.ncols()
    }

    /// The weights of the training cases for bone whose scalar products with theirs these are; their sum is 1.
    pub fn weights(&self, bone: &[f64]) -> Vec<f64> {
        let count = bone.len() as f64;
        // Cases that do not differ have no mode.
        if self.modes() == 0 {
            return vec![1.0 / count; bone.len()];
        }
        let mean = bone.iter().sum::<f64>() / count;
        let overall = self.bone_means.iter().sum::<f64>() / count;
        let query =
            bone.iter().zip(&self.bone_means).map(|(own, of_case)| own - mean - of_case + overall);
        let query = DVector::from_iterator(bone.len(), query);
        let right = self.shares.transpose() * query;
        let solved = self.normal.clone().svd(true, true).solve(&right, f64::EPSILON);
        let modes = solved.unwrap_or_else(|_| DVector::zeros(self.modes()));
        (&self.shares * modes).iter().map(|share| 1.0 / count + share).collect()
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

/// Of variances in falling order.
fn mode_count(variances: Vec<f64>, share: f64) -> usize {
    let most = variances.len().saturating_sub(2).max(1);
    let real = variances.iter().filter(|own| **own > ROUNDING * variances[0]).count();
    let total: f64 = variances.iter().map(|own| own.max(0.0)).sum();
    let mut held = 0.0;
    let needed = variances.iter().take_while(|own| {
        let more = held < share * total;
        held += own.max(0.0);
        more
    });
    needed.count().min(most).min(real)
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let fit = Fit { ridge: 0.0, variance: 1.0 };
        let model = DeformationModel::new(&products(&skin[..8]), &products(&bone[..8]), fit);
        assert_eq!(model.modes(), 2);
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

    #[test]
    fn modes_are_at_most_two_fewer_than_cases_and_hold_the_variance() {
        assert_eq!(mode_count(vec![9.0, 5.0, 4.0, 1.0, 0.5], 1.0), 3);
        assert_eq!(mode_count(vec![90.0, 6.0, 3.0, 1.0, 0.0], 0.95), 2);
        assert_eq!(mode_count(vec![1.0, 0.0, 0.0], 0.95), 1);
    }
}
