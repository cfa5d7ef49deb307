//! Right-hand sides of a size whose squares neither vanish nor overflow.
//!
//! K x = f has the solution x = y / s of K y = s f. With s a power of two no digit of f or x changes, and only zero
//! has the norm zero. Sides of usual size are left alone.

use super::{Solution, SolverError, Unknowns};

/// Between these sizes of the largest value, squares and their sums keep their digits.
const USUAL: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// The largest power of two by which anything is scaled.
const MOST: i32 = 1000;

/// The power of two that brings the largest value near one; one where it is of usual size, zero or not finite.
pub(super) fn factor<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let largest = values.fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest == 0.0 || !largest.is_finite() || USUAL.contains(&largest) {
        return 1.0;
    }
    let exponent = -largest.log2().floor() as i32;
    2.0_f64.powi(exponent.clamp(-MOST, MOST))
}

/// Values times a factor.
pub(super) fn times<const B: usize>(values: &[[f64; B]], factor: f64) -> Vec<[f64; B]> {
    values.iter().map(|values| values.map(|value| value * factor)).collect()
}

/// Solves for right-hand sides of usual size, and takes the solutions back to the size of those given.
pub(super) fn scaled(
    right_hand_sides: &[Unknowns],
    solve: impl FnOnce(&[Unknowns]) -> Result<Vec<Solution>, SolverError>,
) -> Result<Vec<Solution>, SolverError> {
    let factors: Vec<f64> =
        right_hand_sides.iter().map(|f| factor(f.as_flattened().iter())).collect();
    if factors.iter().all(|factor| *factor == 1.0) {
        return solve(right_hand_sides);
    }
    let sides = right_hand_sides.iter().zip(&factors);
    let of_usual_size: Vec<Unknowns> = sides.map(|(f, factor)| times(f, *factor)).collect();
    let mut solutions = solve(&of_usual_size)?;
    for (solution, factor) in solutions.iter_mut().zip(factors) {
        solution.unknowns = times(&solution.unknowns, factor.recip());
    }
    Ok(solutions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_of_usual_size_are_left_alone_and_others_come_near_one() {
        for usual in [0.0, 1.0, -1e-99, 3e99, f64::INFINITY] {
            assert_eq!(factor([usual].iter()), 1.0);
        }
        for value in [1e-170, 5e-324, -2e-308, 1e200, f64::MAX] {
            let near = f64::abs(value * factor([value, 0.0].iter()));
            assert!((1e-100..=1e100).contains(&near), "{value:e} {near:e}");
        }
        // A power of two: its own inverse gives the value back.
        let power = factor([1e-170].iter());
        assert_eq!(1e-170 * power * power.recip(), 1e-170);
    }
}
