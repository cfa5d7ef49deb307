//! General regression neural network: the mean of known answers, weighted by how near their features are.
//!
//! y(x) = sum_i y_i exp(-G_i / s) / sum_i exp(-G_i / s),  G_i = |x - x_i|,
//! with the sum of absolute differences (L1) or the Euclidean norm (L2) for G (Specht, A general regression neural network,
//! IEEE Transactions on Neural Networks 2, 1991; Zhang et al., Improved Rubin-Bodner model, 2016, equation 6, which is L1).
//! The smallest G is subtracted before the exponential, which changes nothing and keeps the sum from vanishing. As s goes to
//! 0 the answer is that of the nearest case, as s goes to infinity the mean of all. Features times c with s times c give the
//! same: a constant that only scales features is a width under another name.

use super::golden_section::minimum;
use super::pairs::Pairs;

/// The widths that are tried, as shares of the median distance between two cases.
const WIDTHS: [f64; 2] = [1e-3, 1e3];

/// Widths tried for each factor of ten.
const BY_DECADE: usize = 6;

/// To which share of itself a width is searched.
const TOLERANCE: f64 = 1e-4;

/// A width between the limits is one only where it betters both by this share.
const NOTEWORTHY: f64 = 1e-9;

/// The weights of cases at these distances; of width 0 the nearest counts alone, of an infinite one all count the same.
pub fn weights(distances: &[f64], width: f64) -> Vec<f64> {
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let weight = |&distance: &f64| match distance - nearest {
        0.0 => 1.0,
        further => (-further / width).exp(),
    };
    let mut weights: Vec<f64> = distances.iter().map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    weights
}

/// Known cases, each of which is predicted from the others.
pub struct LeaveOneOut {
    distances: Pairs,
    /// Scalar products of the answers, which may be taken from their mean.
    products: Pairs,
}

/// What a width search came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WidthEnd {
    /// A width of its own.
    Inside,
    /// The smaller the better: the answer is that of the nearest case.
    NearestNeighbour,
    /// The larger the better: features say nothing, and the answer is the mean.
    Mean,
}

/// The width with the smallest error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Width {
    /// 0 and infinity at the ends.
    pub width: f64,
    /// Of the leave-one-out prediction, as a length of vectors.
    pub rmse: f64,
    pub end: WidthEnd,
}

impl LeaveOneOut {
    pub fn new(distances: Pairs, products: Pairs) -> Self {
        LeaveOneOut { distances, products }
    }

    /// sqrt(1/n sum_i |y'_i - y_i|^2), where y'_i is predicted from all others.
    pub fn rmse(&self, width: f64) -> f64 {
        let count = self.distances.count();
        let sum: f64 = (0..count).map(|case| self.squared_error(case, width)).sum();
        (sum / count as f64).sqrt()
    }

    /// |y_i - sum_j w_j y_j|^2 from scalar products.
    fn squared_error(&self, case: usize, width: f64) -> f64 {
        let others: Vec<usize> = (0..self.distances.count()).filter(|&own| own != case).collect();
        let weights = weights(&self.distances.row(case, &others), width);
        self.products.squared_error(case, &others, &weights)
    }

    /// The best of widths six to a decade, refined by golden section between its neighbours.
    pub fn best_width(&self) -> Width {
        let [nearest, mean] = [0.0, f64::INFINITY].map(|width| self.rmse(width));
        let end = match nearest <= mean {
            true => Width { width: 0.0, rmse: nearest, end: WidthEnd::NearestNeighbour },
            false => Width { width: f64::INFINITY, rmse: mean, end: WidthEnd::Mean },
        };
        let Some(median) = self.median_distance() else { return end };
        let [low, high] = WIDTHS.map(|share| (share * median).ln());
        let step = std::f64::consts::LN_10 / BY_DECADE as f64;
        let tried = (0..=((high - low) / step).round() as usize).map(|k| low + step * k as f64);
        let best = tried
            .map(|log| (log, self.rmse(log.exp())))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(low, |(log, _)| log);
        let found = minimum(|log| self.rmse(log.exp()), best - step, best + step, TOLERANCE);
        match found.value < end.rmse * (1.0 - NOTEWORTHY) {
            true => Width { width: found.at.exp(), rmse: found.value, end: WidthEnd::Inside },
            false => end,
        }
    }

    /// Of all pairs at a distance; absent where there is none.
    fn median_distance(&self) -> Option<f64> {
        let count = self.distances.count();
        let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j)));
        let mut all: Vec<f64> =
            pairs.map(|(i, j)| self.distances.at(i, j)).filter(|own| *own > 0.0).collect();
        all.sort_unstable_by(f64::total_cmp);
        all.get(all.len() / 2).copied()
    }
}

#[cfg(test)]
#[path = "regression_tests.rs"]
mod tests;
