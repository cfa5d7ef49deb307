//! The step of a linear least-squares problem that keeps to its bounds.
//!
//! minimise  |J s + r|² + mu |s|²  over  lower <= s <= upper
//!
//! by active sets (Nocedal, Wright, Numerical Optimization, 2nd ed., 2006, section 16.5): go to the
//! minimum over the unknowns that are not held; hold the first one that a bound stops; let one go
//! that would move inwards. Combinations that J leaves undetermined are not moved, so that where no
//! bound stops it the step is the shortest of those that do the same.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Combinations that change the targets by less than this share of what the strongest one does are
/// not determined: a hundred times the rounding of a response, which is stored in single precision.
pub const UNDETERMINED: f64 = 1e-5;

/// A slope smaller than this share of the largest possible is rounding.
const FLAT: f64 = 1e-12;

/// A residual and its derivative at one point.
pub struct Linearised {
    pub jacobian: DMatrix<f64>,
    pub residual: DVector<f64>,
    /// JᵀJ.
    normal: DMatrix<f64>,
    /// Jᵀr.
    slope: DVector<f64>,
    /// The largest eigenvalue of JᵀJ.
    pub largest: f64,
}

/// How far each unknown may go down and up from here.
pub struct StepBounds {
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
}

impl Linearised {
    pub fn new(jacobian: DMatrix<f64>, residual: DVector<f64>) -> Self {
        let normal = jacobian.tr_mul(&jacobian);
        let slope = jacobian.tr_mul(&residual);
        let largest = match normal.is_empty() {
            true => 0.0,
            false => normal.symmetric_eigenvalues().iter().copied().fold(0.0, f64::max),
        };
        Linearised { jacobian, residual, normal, slope, largest }
    }

    /// The best step within the room, with damping mu.
    pub fn step(&self, damping: f64, room: &StepBounds) -> DVector<f64> {
        let count = self.slope.len();
        let mut step = DVector::zeros(count);
        let mut is_held = vec![false; count];
        // Each change lowers the sum, so no set of held unknowns comes twice but for rounding.
        for _ in 0..4 * count + 4 {
            let best = self.best_of_free(&step, &is_held, damping);
            let (share, stopped) = room.way(&step, &best);
            step += (best - &step) * share;
            let change = match stopped {
                Some((unknown, end)) => {
                    step[unknown] = end;
                    Some(unknown)
                }
                None => self.bound_to_release(&step, &is_held, damping, room),
            };
            let Some(unknown) = change else { break };
            is_held[unknown] = stopped.is_some();
        }
        step
    }

    /// By how much a step lowers the sum of squares without its damping.
    pub fn promise(&self, step: &DVector<f64>) -> f64 {
        -2.0 * self.slope.dot(step) - (&self.jacobian * step).norm_squared()
    }

    /// The nearest minimum over the unknowns that are not held. What is not determined stays, so the
    /// sum never rises on the way.
    fn best_of_free(&self, step: &DVector<f64>, is_held: &[bool], damping: f64) -> DVector<f64> {
        let free: Vec<usize> = (0..step.len()).filter(|&unknown| !is_held[unknown]).collect();
        let mut best = step.clone();
        if free.is_empty() {
            return best;
        }
        let slope = self.slope_at(step, damping).select_rows(&free);
        let eigen = SymmetricEigen::new(self.normal.select_rows(&free).select_columns(&free));
        for (&value, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if value > UNDETERMINED.powi(2) * self.largest {
                let length = -direction.dot(&slope) / (value + damping);
                for (&unknown, part) in free.iter().zip(&direction) {
                    best[unknown] += length * part;
                }
            }
        }
        best
    }

    /// Half the derivative of the sum.
    fn slope_at(&self, step: &DVector<f64>, damping: f64) -> DVector<f64> {
        &self.slope + &self.normal * step + step * damping
    }

    /// The unknown at a bound whose gradient points most strongly back inside.
    fn bound_to_release(
        &self,
        step: &DVector<f64>,
        is_held: &[bool],
        damping: f64,
        room: &StepBounds,
    ) -> Option<usize> {
        let slope = self.slope_at(step, damping);
        let flat = FLAT * self.largest.sqrt() * self.residual.norm();
        let inwards = |unknown: usize| match step[unknown] <= room.lower[unknown] {
            true => -slope[unknown],
            false => slope[unknown],
        };
        let held = (0..step.len()).filter(|&unknown| is_held[unknown] && inwards(unknown) > flat);
        held.max_by(|&a, &b| inwards(a).total_cmp(&inwards(b)))
    }
}

impl StepBounds {
    /// How much of the way from a step to another one lies within the room, and which unknown is
    /// stopped at which of its ends.
    fn way(&self, from: &DVector<f64>, to: &DVector<f64>) -> (f64, Option<(usize, f64)>) {
        let mut share = 1.0;
        let mut stopped = None;
        for unknown in 0..from.len() {
            let end = to[unknown].clamp(self.lower[unknown], self.upper[unknown]);
            if end != to[unknown] {
                let own = (end - from[unknown]) / (to[unknown] - from[unknown]);
                if stopped.is_none() || own < share {
                    (share, stopped) = (own, Some((unknown, end)));
                }
            }
        }
        (share, stopped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three unknowns of which the bounds of the first two matter.
    fn linearised() -> Linearised {
        let jacobian = DMatrix::from_row_slice(
            4,
            3,
            &[2.0, 1.0, 0.0, 1.0, 3.0, 1.0, 0.0, 1.0, 2.0, 1.0, 0.0, 1.0],
        );
        Linearised::new(jacobian, DVector::from_vec(vec![-7.0, 4.0, 1.0, -3.0]))
    }

    fn room(size: f64) -> StepBounds {
        StepBounds { lower: DVector::repeat(3, -size), upper: DVector::repeat(3, size) }
    }

    #[test]
    fn no_step_within_the_bounds_is_better() {
        let linearised = linearised();
        let sum =
            |s: &DVector<f64>| (&linearised.jacobian * s + &linearised.residual).norm_squared();
        for size in [0.1, 1.0, 3.0, 100.0] {
            let best = linearised.step(0.0, &room(size));
            assert!(best.amax() <= size);
            let lowest = sum(&best);
            // All points of a lattice over the room.
            for index in 0..21_usize.pow(3) {
                let at = |axis: u32| (index / 21_usize.pow(axis) % 21) as f64 / 10.0 - 1.0;
                let other = DVector::from_fn(3, |axis, _| size * at(axis as u32));
                assert!(lowest <= sum(&other) + 1e-12 * lowest, "{size}: {best} {other}");
            }
        }
    }

    #[test]
    fn what_is_not_determined_does_not_move() {
        // Only the sum of the first two unknowns counts, and the third does not count at all.
        let jacobian = DMatrix::from_row_slice(1, 3, &[1.0, 1.0, 0.0]);
        let linearised = Linearised::new(jacobian, DVector::from_vec(vec![-4.0]));
        let step = linearised.step(0.0, &room(100.0));
        assert!((step - DVector::from_vec(vec![2.0, 2.0, 0.0])).amax() < 1e-14);
        // One of the two stopped leaves the rest to the other.
        let mut narrow = room(100.0);
        narrow.upper[0] = 0.5;
        let step = linearised.step(0.0, &narrow);
        assert!((step - DVector::from_vec(vec![0.5, 3.5, 0.0])).amax() < 1e-14);
    }
}
