//! Starts of the search for a plan: rest, and where segments may turn far a lattice of other angles.
//!
//! Skin is linear in translations and growth, so that a start has them at rest: only angles make minima beside the least one. Start s of
//! 12 has the k-th free angle at ((s 6^k) mod 13) / 13 of its interval, a lattice whose points differ in every angle (Korobov, 1959).

use nalgebra::DVector;

use super::unknowns::{LEVER, Unknowns};

/// Angles that may be farther than this from those of rest, in radians, have other starts.
const FAR: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A prime and a primitive root of it.
const LATTICE: u64 = 13;
const GENERATOR: u64 = 6;

/// Within the bounds, rest first.
pub(super) fn starts(unknowns: &Unknowns) -> Vec<DVector<f64>> {
    let rest = unknowns.feasible_rest();
    let angles: Vec<usize> =
        (0..unknowns.count()).filter(|&place| unknowns.free[place].is_angle()).collect();
    let reach = |place: &usize| {
        let (low, high) = (unknowns.lower[*place], unknowns.upper[*place]);
        (rest[*place] - low).max(high - rest[*place]) / LEVER
    };
    if angles.iter().map(reach).fold(0.0, f64::max) <= FAR {
        return vec![rest];
    }
    let turned = |start: u64| {
        let (mut at, mut factor) = (rest.clone(), 1);
        for &place in &angles {
            let share = (start * factor % LATTICE) as f64 / LATTICE as f64;
            let (low, high) = (unknowns.lower[place], unknowns.upper[place]);
            at[place] = low + share * (high - low);
            factor = factor * GENERATOR % LATTICE;
        }
        unknowns.within(at)
    };
    std::iter::once(rest.clone()).chain((1..LATTICE).map(turned)).collect()
}
