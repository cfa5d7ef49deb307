//! Wilcoxon's signed rank test: of pairs, is one side larger more often, and by more, than chance gives?
//!
//! d_i = first_i - second_i, ranked by |d_i|; equal ones share the mean of their ranks.
//! W+ = Σ ranks with d > 0,   W- = Σ ranks with d < 0,   r = (W+ - W-) / (W+ + W-)
//! Where the sign of each d is a fair coin, W+ is distributed as the sum of a random subset of the ranks:
//! p = min(1, 2 P(W ≤ min(W+, W-))), counted over all 2^n subsets up to n = 25. Above it W is taken as normal
//! with mean Σ rank / 2 and variance Σ rank² / 4, which holds the ties, and a continuity correction of half
//! the smallest step of W.
//!
//! Pairs without a difference leave the ranking before it is made (Wilcoxon) or after (Pratt); n counts the rest.
//! Source: Wilcoxon, Biometrics Bulletin 1 (1945) 80; Pratt, JASA 54 (1959) 655; r: Kerby, Comprehensive
//! Psychology 3 (2014) 1.

/// Differing pairs up to which the distribution is counted out.
pub const MOST_EXACT: usize = 25;

/// Treatment of pairs without a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroRule {
    /// They leave before the ranking.
    Wilcox,
    /// They are ranked, lowest, and leave then.
    Pratt,
}

/// Tolerance of equality.
#[derive(Clone, Copy, Debug)]
pub struct Equality {
    /// Differences up to this are none, and absolute differences this close share their ranks; in the unit of
    /// the values.
    pub within: f64,
    pub zeros: ZeroRule,
}

/// The test of some pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedRank {
    pub pairs: usize,
    /// Pairs with a difference.
    pub differing: usize,
    /// W+: ranks of pairs whose first value is larger.
    pub positive: f64,
    /// W-.
    pub negative: f64,
    pub two_sided_p: f64,
    /// Whether p is counted out and not approximated.
    pub exact: bool,
    /// r, the matched-pairs rank biserial correlation: 1 where every first value is larger, -1 where none is.
    pub effect: f64,
    /// The smallest two-sided p that so many differing pairs can give: 2^(1 - n).
    pub smallest_p: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PairedError {
    #[error("there are no pairs to compare")]
    Empty,
    #[error("{first} values are to be paired with {second}")]
    NotPaired { first: usize, second: usize },
    #[error("pair {index} holds a number that is not finite")]
    NotFinite { index: usize },
    #[error("none of {pairs} pairs differs: there is nothing to rank")]
    NoDifference { pairs: usize },
}

/// Tests pairs; `first[i]` belongs to `second[i]`.
pub fn signed_rank(
    first: &[f64],
    second: &[f64],
    equality: Equality,
) -> Result<SignedRank, PairedError> {
    if first.len() != second.len() {
        return Err(PairedError::NotPaired { first: first.len(), second: second.len() });
    }
    if first.is_empty() {
        return Err(PairedError::Empty);
    }
    let differences: Vec<f64> = first.iter().zip(second).map(|(a, b)| a - b).collect();
    if let Some(index) = differences.iter().position(|difference| !difference.is_finite()) {
        return Err(PairedError::NotFinite { index });
    }

    // 1. Ranks, doubled so that means of ranks stay whole.
    let ranked = doubled_ranks(&differences, equality);
    if ranked.is_empty() {
        return Err(PairedError::NoDifference { pairs: first.len() });
    }
    let sum_where = |is_positive: bool| -> u64 {
        ranked.iter().filter(|(sign, _)| *sign == is_positive).map(|(_, rank)| rank).sum()
    };
    let (positive, negative) = (sum_where(true), sum_where(false));
    let ranks: Vec<u64> = ranked.iter().map(|(_, rank)| *rank).collect();

    // 2. How often chance gives a sum as small as the smaller one.
    let exact = ranks.len() <= MOST_EXACT;
    let smaller = positive.min(negative);
    let below = if exact { share_at_most(&ranks, smaller) } else { normal_tail(&ranks, smaller) };
    Ok(SignedRank {
        pairs: first.len(),
        differing: ranks.len(),
        positive: positive as f64 / 2.0,
        negative: negative as f64 / 2.0,
        two_sided_p: (2.0 * below).min(1.0),
        exact,
        effect: (positive as f64 - negative as f64) / (positive + negative) as f64,
        smallest_p: 0.5f64.powi(ranks.len() as i32 - 1),
    })
}

/// Twice the rank of each pair that differs, and whether its difference is positive.
fn doubled_ranks(differences: &[f64], equality: Equality) -> Vec<(bool, u64)> {
    let Equality { within, zeros } = equality;
    let is_zero = |difference: f64| difference.abs() <= within;
    let mut order: Vec<f64> = differences.to_vec();
    if zeros == ZeroRule::Wilcox {
        order.retain(|&difference| !is_zero(difference));
    }
    order.sort_unstable_by(|a, b| a.abs().total_cmp(&b.abs()));
    let mut ranked = Vec::with_capacity(order.len());
    let mut start = 0;
    while start < order.len() {
        let lowest = order[start].abs();
        let shared = if is_zero(order[start]) {
            order[start..].iter().take_while(|&&other| is_zero(other)).count()
        } else {
            order[start..].iter().take_while(|other| other.abs() - lowest <= within).count()
        };
        // Ranks start + 1 to start + shared have this mean.
        let doubled = (2 * start + shared + 1) as u64;
        let group = &order[start..start + shared];
        let differing = group.iter().filter(|&&difference| !is_zero(difference));
        ranked.extend(differing.map(|&difference| (difference > 0.0, doubled)));
        start += shared;
    }
    ranked
}

/// The share of all subsets whose sum is at most `most`, by counting the subsets of each sum.
fn share_at_most(ranks: &[u64], most: u64) -> f64 {
    let total: u64 = ranks.iter().sum();
    let mut subsets = vec![0u64; total as usize + 1];
    subsets[0] = 1;
    for &rank in ranks {
        for sum in (rank as usize..subsets.len()).rev() {
            subsets[sum] += subsets[sum - rank as usize];
        }
    }
    // At most 2^25 subsets: both numbers are exact.
    let counted: u64 = subsets[..=most as usize].iter().sum();
    counted as f64 / 2f64.powi(ranks.len() as i32)
}

/// P(W ≤ smaller) of the normal distribution with the mean and the variance of W; ranks and sum doubled.
fn normal_tail(ranks: &[u64], smaller: u64) -> f64 {
    let mean = ranks.iter().sum::<u64>() as f64 / 2.0;
    let variance = ranks.iter().map(|&rank| (rank * rank) as f64).sum::<f64>() / 4.0;
    // Without ties W goes in steps of 1, which are steps of 2 when doubled: half a step is 1.
    let z = (smaller as f64 + 1.0 - mean) / variance.sqrt();
    0.5 * complementary_error_function(-z / std::f64::consts::SQRT_2)
}

/// erfc(x) = 2/√π ∫_x^∞ exp(-t²) dt; to about 1e-13 of it.
/// Source: Abramowitz, Stegun, Handbook of Mathematical Functions, 1964, 7.1.6 below 2 and 7.1.14 above.
fn complementary_error_function(x: f64) -> f64 {
    if x < 0.0 {
        return 2.0 - complementary_error_function(-x);
    }
    let scale = (-x * x).exp() / std::f64::consts::PI.sqrt();
    if x < 2.0 {
        let (mut term, mut sum) = (x, x);
        for k in 1..60 {
            term *= 2.0 * x * x / f64::from(2 * k + 1);
            sum += term;
        }
        return 1.0 - 2.0 * scale * sum;
    }
    let fraction = (1..=80).rev().fold(x, |below, k| x + 0.5 * f64::from(k) / below);
    scale / fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_function_has_its_known_values() {
        // As the C library of glibc 2.36 has them.
        for (x, value) in [
            (0.0, 1.0),
            (0.5, 0.479_500_122_186_953_5),
            (1.0, 0.157_299_207_050_285_13),
            (1.999_999, 0.004_677_755_648_073_953),
            (2.0, 0.004_677_734_981_047_265),
            (3.0, 2.209_049_699_858_543_8e-5),
            (-1.0, 1.842_700_792_949_715),
        ] {
            let found = complementary_error_function(x);
            // Below 2 the result is what is left of 1, whose rounding is 2e-14 of it there.
            assert!((found / value - 1.0).abs() < 1e-12, "{x}: {found}");
        }
    }
}
