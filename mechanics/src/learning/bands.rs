//! Calibrated bands of a prediction, and how far a case is from those that were learned from.
//!
//! With y_-i what is predicted of the new case without training case i, and r_i what that misses of case i, the band of the new
//! case is between the values at the places 0.1 (n + 1) and 0.9 (n + 1) of the ordered y_-i + r_i, between places by
//! interpolation (after the jackknife+, with signed residuals: Barber, Candes, Ramdas, Tibshirani, Predictive inference with the
//! jackknife+, Annals of Statistics 49, 2021; the place: Hyndman, Fan, Sample quantiles in statistical packages, 1996, type 6).
//! The residuals of the training cases about one prediction, without the y_-i, give bands that are too wide: 84 % of 11 cases
//! instead of 80 %.
//! Fewer than 9 training cases have no band.

use std::ops::Range;

use rayon::prelude::*;

use super::pairs::Pairs;

/// The lower and the upper end of a band, as probabilities.
pub const BAND: [f64; 2] = [0.1, 0.9];

/// Of distances between training cases: beyond, a case is not one of their kind.
pub const FARTHEST: f64 = 0.95;

/// Numbers whose bands are made at once: what every case says of them fits into a near cache.
const TOGETHER: usize = 256;

/// The value that a new one of these is below with probability `share`; absent where they are too few for that. They are put into
/// another order, no more than is needed.
pub fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let place = share * (values.len() + 1) as f64;
    let low = place.floor();
    if low < 1.0 || place > values.len() as f64 {
        return None;
    }
    let (_, &mut below, rest) = values.select_nth_unstable_by(low as usize - 1, f64::total_cmp);
    let above = rest.iter().copied().min_by(f64::total_cmp).unwrap_or(below);
    Some(below + (place - low) * (above - below))
}

/// The ends of the band of each number, from what each training case makes of a range of them; absent where cases are too few.
pub fn band(
    cases: usize,
    numbers: usize,
    values: impl Fn(usize, Range<usize>) -> Vec<f64> + Sync,
) -> Option<Vec<[f64; 2]>> {
    let parts: Vec<Option<Vec<[f64; 2]>>> = (0..numbers.div_ceil(TOGETHER))
        .into_par_iter()
        .map(|part| {
            let range = part * TOGETHER..numbers.min((part + 1) * TOGETHER);
            let told: Vec<Vec<f64>> = (0..cases).map(|case| values(case, range.clone())).collect();
            let of = |place: usize| {
                let mut own: Vec<f64> = told.iter().map(|case| case[place]).collect();
                let [low, high] = BAND.map(|share| quantile(&mut own, share));
                Some([low?, high?])
            };
            (0..range.len()).map(of).collect()
        })
        .collect();
    Some(parts.into_iter().collect::<Option<Vec<_>>>()?.concat())
}

/// The distance from the nearest training case that 95 % of these keep among each other.
pub fn farthest(distances: &Pairs) -> f64 {
    let count = distances.count();
    let nearest = |case: usize| {
        let others = (0..count).filter(|&other| other != case);
        others.map(|other| distances.at(case, other)).fold(f64::INFINITY, f64::min)
    };
    let mut all: Vec<f64> = (0..count).map(nearest).collect();
    all.sort_unstable_by(f64::total_cmp);
    let place = (FARTHEST * count as f64).ceil() as usize;
    all.get(place.saturating_sub(1)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;

    #[test]
    fn nine_values_have_a_band_and_eight_none() {
        let mut nine: Vec<f64> = (1..=9).rev().map(f64::from).collect();
        assert_eq!(BAND.map(|share| quantile(&mut nine, share)), [Some(1.0), Some(9.0)]);
        assert_eq!(quantile(&mut nine[..8], 0.1), None);
        assert_eq!(quantile(&mut nine, 0.55), Some(5.5));
    }

    #[test]
    fn bands_hold_four_of_five_new_values_whatever_their_law() {
        for (count, law) in [(10, 0), (11, 1), (59, 0), (60, 2)] {
            let mut draws = Draws::of(7, count as u64);
            let mut value = || match law {
                0 => draws.normal(),
                1 => draws.share(),
                _ => draws.share().powi(3),
            };
            let (mut held, trials) = (0, 20_000);
            for _ in 0..trials {
                let values: Vec<f64> = (0..count).map(|_| value()).collect();
                let [low, high] = band(count, 1, |case, _| vec![values[case]]).expect("enough")[0];
                let new = value();
                held += usize::from(low <= new && new <= high);
            }
            let coverage = held as f64 / trials as f64;
            // Twenty thousand trials know it to 0.3 %.
            assert!((coverage - 0.8).abs() < 0.03, "{count}: {coverage}");
        }
    }

    #[test]
    fn nineteen_of_twenty_cases_lie_within_the_limit() {
        let at = |i: usize| if i == 19 { 40.0 } else { i as f64 };
        let limit = farthest(&Pairs::of(20, |i, j| (at(i) - at(j)).abs()));
        assert_eq!(limit, 1.0, "the one that is 22 off does not widen it");
    }
}
