//! Theta of Rubin and Bodner's law for a class of surgery: fitted in an interval.
//!
//! Zhang et al. 2016 print theta <- theta - RMSE / d, with d the mean movement: it changes theta until RMSE is 0, whatever
//! theta does to it, so that no theta is a fixed point. Here theta minimises the error of the mechanical prediction over a
//! class in [0.5, 1.5] by golden section, which gives the same however often it is repeated. With displacements as boundary
//! conditions theta, which scales both tissues, all but cancels: where the error changes by less than [`DETERMINED`] over the
//! interval, or is smallest at its end, the data do not determine it, and that is said.

use super::golden_section::minimum;

/// Where theta is searched.
pub const THETAS: [f64; 2] = [0.5, 1.5];

/// By how much the error has to change over the interval for theta to be known, in mm.
pub const DETERMINED: f64 = 0.01;

/// To which theta is searched.
const TOLERANCE: f64 = 1e-6;

/// Theta of a class of surgery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Theta {
    pub theta: f64,
    /// The error there in mm.
    pub error: f64,
    /// By how much the error changes over the interval, in mm.
    pub spread: f64,
}

impl Theta {
    /// The theta of the smallest error.
    pub fn fitted(error: impl Fn(f64) -> f64) -> Theta {
        let [low, high] = THETAS;
        let found = minimum(&error, low, high, TOLERANCE);
        let largest = error(low).max(error(high));
        Theta { theta: found.at, error: found.value, spread: largest - found.value }
    }

    /// Whether the data say anything about it: the error changes, and is smallest inside the interval.
    pub fn is_determined(&self) -> bool {
        let [low, high] = THETAS;
        self.spread >= DETERMINED && self.theta > low && self.theta < high
    }
}

/// A parabola through values at the ends of the interval and at 1, so that few predictions stand for all thetas.
pub fn between(theta: f64, at: [f64; 3]) -> f64 {
    let [low, middle, high] = at;
    let x = 2.0 * (theta - 1.0);
    middle + 0.5 * x * (high - low) + 0.5 * x * x * (high - 2.0 * middle + low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_has_a_fixed_point_and_says_when_data_do_not_determine_it() {
        let error = |theta: f64| 0.7 + (theta - 0.9).powi(2);
        let fitted = Theta::fitted(error);
        assert!((fitted.theta - 0.9).abs() < 1e-5 && fitted.is_determined());
        assert_eq!(Theta::fitted(error), fitted);
        let flat = Theta::fitted(|theta| 0.7 + 1e-4 * (theta - 0.9).abs());
        assert!(!flat.is_determined());
        let falling = Theta::fitted(|theta| 0.7 - 0.1 * theta);
        assert!(falling.theta == 1.5 && !falling.is_determined(), "it lies beyond the interval");
    }

    #[test]
    fn a_parabola_goes_through_its_three_values() {
        for (theta, expected) in [(0.5, 2.0), (1.0, -1.0), (1.5, 5.0)] {
            assert!((between(theta, [2.0, -1.0, 5.0]) - expected).abs() < 1e-14);
        }
    }
}
