//! Error of a refined reference solution, by extrapolation from the mesh before it:
//!
//! e = |u_t - u_(t-1)| / (2^p - 1)        p = log2(mean |u_(t-1) - u_(t-2)| / mean |u_t - u_(t-1)|)
//!
//! With two meshes only p = 1: where held tissue meets free tissue u grows with the root of the distance, and
//! twice its exponent is the order at which such a place spoils the rest, whatever the element.

use super::error;
use crate::mesh::Vector;

/// Orders outside of this are chance: the meshes are too coarse to show one.
const ORDERS: std::ops::RangeInclusive<f64> = 0.5..=4.0;

/// How far the finest of some fields is from the limit.
pub(super) struct OwnError {
    pub order: f64,
    pub is_observed: bool,
    pub mean_and_p95: [f64; 2],
}

/// What truths are off by themselves, mean and p95 in mm, as far as that is known: for each plan, for each set of materials.
#[derive(Default)]
pub(super) struct TruthErrors(Vec<Vec<Option<[f64; 2]>>>);

impl TruthErrors {
    pub fn of(all: &[Vec<Option<OwnError>>]) -> TruthErrors {
        let numbers = |own: &Option<OwnError>| own.as_ref().map(|own| own.mean_and_p95);
        TruthErrors(all.iter().map(|of_plan| of_plan.iter().map(numbers).collect()).collect())
    }

    /// Of a plan and of materials, by their places.
    pub fn get(&self, plan: usize, materials: usize) -> Option<[f64; 2]> {
        self.0.get(plan).and_then(|of_plan| of_plan[materials])
    }

    /// That of the plan and the materials for which the mean is largest.
    pub fn largest(&self) -> Option<[f64; 2]> {
        let known = self.0.iter().flatten().flatten();
        known.copied().max_by(|one, other| one[0].total_cmp(&other[0]))
    }
}

/// From the same field on two or three meshes, coarsest first.
pub(super) fn own_error(fields: &[&Vec<Vector>], areas: &[f64]) -> Option<OwnError> {
    let steps: Vec<_> = fields
        .windows(2)
        .map(|pair| {
            let apart: Vec<f64> =
                pair[0].iter().zip(pair[1]).map(|(a, b)| (a - b).norm()).collect();
            error::errors(&apart, areas)
        })
        .collect::<Result<_, _>>()
        .ok()?;
    let last = steps.last()?;
    let observed = match steps.as_slice() {
        [before, last] => (before.mean / last.mean).log2(),
        _ => f64::NAN,
    };
    let is_observed = observed.is_finite();
    let order = if is_observed { observed.clamp(*ORDERS.start(), *ORDERS.end()) } else { 1.0 };
    let share = 1.0 / (order.exp2() - 1.0);
    Some(OwnError { order, is_observed, mean_and_p95: [last.mean * share, last.p95 * share] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_the_finest_field_is_extrapolated_from_the_steps_before() {
        let on = |h: f64| vec![Vector::new(1.0 + 0.2 * h * h, 0.0, 0.0)];
        let fields = [on(4.0), on(2.0), on(1.0)];
        let fields: Vec<_> = fields.iter().collect();
        let own = own_error(&fields, &[1.0]).expect("three fields");
        // Rounding only.
        assert!(own.is_observed && (own.order - 2.0).abs() < 1e-12);
        assert!((own.mean_and_p95[0] - 0.2).abs() < 1e-12);
        let own = own_error(&fields[1..], &[1.0]).expect("two fields");
        assert!(!own.is_observed && (own.mean_and_p95[0] - 0.6).abs() < 1e-12);
        assert!(own_error(&fields[2..], &[1.0]).is_none());
    }
}
