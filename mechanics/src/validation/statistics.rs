//! Weighted statistics of lengths.
//!
//! With weights w_i and W = Σ w_i:  mean = Σ w_i x_i / W,  rms² = Σ w_i x_i² / W,  sd² = rms² - mean²
//! (not the estimate of a larger population). Percentile p is the smallest value whose cumulative
//! weight reaches p W; nothing is interpolated, but over subjects and landmarks. The median is percentile 50.

/// A cumulative weight this share below its target has reached it: sums of many weights are rounded.
const ROUNDING: f64 = 1e-12;

/// Of lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    pub count: usize,
    pub mean: f64,
    pub sd: f64,
    pub rms: f64,
    pub min: f64,
    pub p25: f64,
    pub median: f64,
    pub p75: f64,
    pub p90: f64,
    pub p95: f64,
    pub p99: f64,
    pub max: f64,
}

/// Why values have no statistics.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StatisticsError {
    #[error("there are no values")]
    Empty,
    #[error("{values} values have {weights} weights")]
    NotPaired { values: usize, weights: usize },
    #[error("value {index} is {value}")]
    NotFinite { index: usize, value: f64 },
    #[error("weight {index} is {weight}; a weight is finite and not negative")]
    BadWeight { index: usize, weight: f64 },
    #[error("all {count} weights are zero")]
    NoWeight { count: usize },
}

impl Statistics {
    /// Of values that all count the same.
    pub fn plain(values: &[f64]) -> Result<Self, StatisticsError> {
        Self::weighted(values, &vec![1.0; values.len()])
    }

    /// Of values of a few subjects or landmarks that all count the same. Percentiles are interpolated between neighbours, so that the median
    /// of an even number is half-way between both middle values (Hyndman, Fan 1996, definition 7).
    pub fn of_subjects(values: &[f64]) -> Result<Self, StatisticsError> {
        let plain = Self::plain(values)?;
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * (sorted.len() - 1) as f64;
            let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
            below + (above - below) * place.fract()
        };
        let [p25, median, p75, p90, p95, p99] = [0.25, 0.5, 0.75, 0.9, 0.95, 0.99].map(at);
        Ok(Statistics { p25, median, p75, p90, p95, p99, ..plain })
    }

    /// Of values with their weights, such as areas.
    pub fn weighted(values: &[f64], weights: &[f64]) -> Result<Self, StatisticsError> {
        let total = checked_total(values, weights)?;
        let mean_of = |of: &dyn Fn(f64) -> f64| {
            values.iter().zip(weights).map(|(&x, &w)| w * of(x)).sum::<f64>() / total
        };
        let mean = mean_of(&|x| x);
        let sd = mean_of(&|x| (x - mean) * (x - mean)).sqrt();
        let rms = mean_of(&|x| x * x).sqrt();
        let mut order: Vec<usize> = (0..values.len()).filter(|&i| weights[i] > 0.0).collect();
        order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]).then(a.cmp(&b)));
        let shares = [0.0, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99, 1.0].map(|share| share * total);
        let [min, p25, median, p75, p90, p95, p99, max] =
            percentiles(values, weights, &order, shares);
        let count = values.len();
        Ok(Statistics { count, mean, sd, rms, min, p25, median, p75, p90, p95, p99, max })
    }
}

/// For each of some ascending targets the smallest value whose cumulative weight reaches it.
fn percentiles<const N: usize>(
    values: &[f64],
    weights: &[f64],
    order: &[usize],
    targets: [f64; N],
) -> [f64; N] {
    let mut place = 0;
    let mut cumulative = weights[order[0]];
    targets.map(|target| {
        while cumulative < target * (1.0 - ROUNDING) && place + 1 < order.len() {
            place += 1;
            cumulative += weights[order[place]];
        }
        values[order[place]]
    })
}

fn checked_total(values: &[f64], weights: &[f64]) -> Result<f64, StatisticsError> {
    if values.is_empty() {
        return Err(StatisticsError::Empty);
    }
    if values.len() != weights.len() {
        let (values, weights) = (values.len(), weights.len());
        return Err(StatisticsError::NotPaired { values, weights });
    }
    for (index, (&value, &weight)) in values.iter().zip(weights).enumerate() {
        // Its square has to be finite too.
        if !(value * value).is_finite() {
            return Err(StatisticsError::NotFinite { index, value });
        }
        if !weight.is_finite() || weight < 0.0 {
            return Err(StatisticsError::BadWeight { index, weight });
        }
    }
    let total: f64 = weights.iter().sum();
    if total > 0.0 { Ok(total) } else { Err(StatisticsError::NoWeight { count: weights.len() }) }
}
