//! The root of a function between two points of different signs, by the Illinois variant of false position.
//!
//! Source: Dowell, Jarratt, A modified regula falsi method for computing the root of an equation, BIT 11 (1971) 168-174.

use crate::mesh::Vector;

/// Length of the segment at which the root counts as found.
const TOLERANCE: f64 = 1e-4;
/// Steps; every fourth halves the bracket, which brings any function to the tolerance.
const MOST_STEPS: usize = 80;

/// A point between `inside`, where `value` is positive, and `outside`, where it is not, within 1e-4 of their distance from a
/// change of sign. Where the signs are not as said, the one of the two that is nearer to zero.
pub(crate) fn between(inside: &Vector, outside: &Vector, value: impl Fn(&Vector) -> f64) -> Vector {
    let at = |part: f64| inside + (outside - inside) * part;
    let (mut low, mut high) = (0.0, 1.0);
    let (mut at_low, mut at_high) = (value(inside), value(outside));
    if at_low <= 0.0 || at_high > 0.0 {
        return if at_low.abs() < at_high.abs() { *inside } else { *outside };
    }
    let mut last_moved_low = None;
    for step in 0..MOST_STEPS {
        if high - low < TOLERANCE || at_high == 0.0 {
            break;
        }
        let secant = low + (high - low) * (at_low / (at_low - at_high));
        let halving = step % 4 == 3 || !secant.is_finite();
        let part = if halving { 0.5 * (low + high) } else { secant };
        let found = value(&at(part));
        let moves_low = found > 0.0;
        if moves_low {
            (low, at_low) = (part, found);
        } else {
            (high, at_high) = (part, found);
        }
        if last_moved_low == Some(moves_low) {
            let other = if moves_low { &mut at_high } else { &mut at_low };
            *other *= 0.5;
        }
        last_moved_low = Some(moves_low);
    }
    at(if at_high == 0.0 { high } else { 0.5 * (low + high) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_is_found_to_a_ten_thousandth_of_the_segment() {
        let ends = (Vector::zeros(), Vector::x() * 4.0);
        for root in [1e-3, 0.37, 2.0, 3.999] {
            let shapes: [&dyn Fn(f64) -> f64; 4] = [
                &|x| root - x,
                &|x| (root - x).powi(3),
                &|x| if x < root { 1.0 } else { -1e9 },
                &|x| (root - x).min(30.0 * (root - x)) * (1.0 + x).exp(),
            ];
            for (number, shape) in shapes.iter().enumerate() {
                let found = between(&ends.0, &ends.1, |point| shape(point.x));
                assert!((found.x - root).abs() < 4e-4, "{root}, shape {number}: {found}");
            }
        }
    }

    #[test]
    fn ends_of_one_sign_give_the_end_that_is_nearer_to_zero() {
        let found = between(&Vector::zeros(), &Vector::x(), |point| 2.0 - point.x);
        assert_eq!(found, Vector::x());
    }
}
