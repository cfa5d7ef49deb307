//! Shares of area by distance.

use super::both_ways::MeasuredPair;
use super::distance::Measured;

/// Shares of the area of both surfaces, 0 to 1; they add up to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histogram {
    /// Below the first edge.
    pub below: f64,
    /// From each edge to below the next one.
    pub shares: Vec<f64>,
    /// From the last edge on.
    pub above: f64,
}

/// Of the distances of both directions, without and with their sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Histograms {
    pub unsigned: Histogram,
    /// Positive where the prediction lies outside the actual surface.
    pub signed: Histogram,
}

pub(super) fn histograms(measured: &MeasuredPair, edges: &[f64]) -> Option<Histograms> {
    if edges.is_empty() {
        return None;
    }
    let both = || measured.to_actual.measured.iter().chain(&measured.to_prediction.measured);
    let of = |value: fn(&Measured) -> f64| histogram(both().map(|m| (value(m), m.area)), edges);
    Some(Histograms { unsigned: of(|m| m.distance), signed: of(|m| m.signed) })
}

/// Of values with their weights; the edges ascend.
fn histogram(values: impl Iterator<Item = (f64, f64)>, edges: &[f64]) -> Histogram {
    let mut sums = vec![0.0; edges.len() + 1];
    for (value, weight) in values {
        sums[edges.partition_point(|edge| *edge <= value)] += weight;
    }
    let total: f64 = sums.iter().sum();
    let mut shares = sums.into_iter().map(|sum| sum / total);
    let below = shares.next().unwrap_or_default();
    let mut shares: Vec<f64> = shares.collect();
    let above = shares.pop().unwrap_or_default();
    Histogram { below, shares, above }
}
