//! Step length: how far tissue may go along a step before a cell loses too much of its volume.

use nalgebra::Matrix3;

use crate::material::hyperelastic::point::cofactor;

/// Halvings of an interval in which the first root lies.
const HALVINGS: usize = 40;

/// det(F + t D) - keep det F as a polynomial in t.
#[derive(Clone, Copy, Debug)]
pub(super) struct Volume([f64; 4]);

impl Volume {
    pub fn along(f: &Matrix3<f64>, d: &Matrix3<f64>, keep: f64) -> Volume {
        let (cof_f, cof_d) = (cofactor(f), cofactor(d));
        let now = f.determinant();
        Volume([(1.0 - keep) * now, cof_f.dot(d), cof_d.dot(f), d.determinant()])
    }

    /// The largest t up to `most` before which it is nowhere negative.
    pub fn positive_until(&self, most: f64) -> f64 {
        if self.is_positive(0.0, most) {
            return most;
        }
        // `low` is always an end of an interval that is proven positive.
        let (mut low, mut width) = (0.0, most);
        for _ in 0..HALVINGS {
            width *= 0.5;
            if self.is_positive(low, low + width) {
                low += width;
            }
        }
        low
    }

    /// Proven by the Bernstein coefficients of the polynomial on the interval.
    fn is_positive(&self, from: f64, to: f64) -> bool {
        let [c0, c1, c2, c3] = self.0;
        let w = to - from;
        let value = c0 + from * (c1 + from * (c2 + from * c3));
        let slope = w * (c1 + from * (2.0 * c2 + 3.0 * from * c3));
        let curvature = w * w * (c2 + 3.0 * from * c3);
        let bend = w * w * w * c3;
        let b1 = value + slope / 3.0;
        let b2 = value + (2.0 * slope + curvature) / 3.0;
        let b3 = value + slope + curvature + bend;
        value.min(b1).min(b2).min(b3) >= 0.0
    }
}
