//! Golden section search: the minimum of a function of one number in an interval.
//!
//! Each step keeps the part of the interval, 0.618 of it, on the side of the smaller of two inner values (Kiefer, Sequential
//! minimax search for a maximum, Proceedings of the American Mathematical Society 4, 1953). Where the function has one
//! minimum in the interval that one is found; where it has several, one of them.

/// The smaller part of an interval, as a share of it: (3 - sqrt 5) / 2.
const SMALLER: f64 = 0.381_966_011_250_105_1;

/// A minimum in an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    pub at: f64,
    pub value: f64,
}

/// The smallest value found between `low` and `high`, whose place is known to `tolerance`; the ends are asked too.
pub fn minimum(of: impl Fn(f64) -> f64, low: f64, high: f64, tolerance: f64) -> Minimum {
    let asked = |at: f64| Minimum { at, value: of(at) };
    let [mut left, mut right] = [low, high];
    let mut first = asked(left + SMALLER * (right - left));
    let mut second = asked(right - SMALLER * (right - left));
    while right - left > tolerance {
        if first.value <= second.value {
            right = second.at;
            second = first;
            first = asked(left + SMALLER * (right - left));
        } else {
            left = first.at;
            first = second;
            second = asked(right - SMALLER * (right - left));
        }
    }
    let found = [first, second, asked(low), asked(high)];
    found.into_iter().min_by(|a, b| a.value.total_cmp(&b.value)).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_and_a_slope_have_their_minima() {
        let found = minimum(|x| (x - 0.3).powi(2) + 2.0, -1.0, 4.0, 1e-6);
        // Where values differ by less than rounding, places by less than its root.
        assert!((found.at - 0.3).abs() < 1e-6 && (found.value - 2.0).abs() < 1e-12);
        assert_eq!(minimum(|x| x, 0.5, 1.5, 1e-6), Minimum { at: 0.5, value: 0.5 });
        assert_eq!(minimum(|x| -x, 0.5, 1.5, 1e-6).at, 1.5);
    }
}
