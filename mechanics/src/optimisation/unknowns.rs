//! The parameters that are free to move, and how the numbers of a movement depend on them.
//!
//! a = (R - I, (R - I)(c - p) + t), R = Rz Ry Rx, c the centre of the response, p the pivot. With [v]
//! the matrix of the cross product with v:
//! dR/dx = R [e_x]   dR/dy = [Rz e_y] R   dR/dz = [e_z] R

use nalgebra::{DMatrix, DVector, Matrix3};

use super::{Bound, PARAMETERS_PER_SEGMENT, Parameter, SegmentBounds};
use crate::mesh::Vector;
use crate::plan::RigidMovement;
use crate::response::{COLUMNS_PER_SEGMENT, ResponseSegment, coefficients};

/// An angle counts as the arc in mm that it draws at this distance from its axis, about the size of
/// a jaw, so that translations and angles can be weighed against each other. The arc in mm is the
/// angle in degrees.
pub const LEVER: f64 = 180.0 / std::f64::consts::PI;

/// Free parameters as one vector: translations in mm, angles as arcs in mm.
pub struct Unknowns<'a> {
    segments: &'a [ResponseSegment],
    bounds: &'a [SegmentBounds],
    pub free: Vec<Parameter>,
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
}

impl<'a> Unknowns<'a> {
    pub fn new(segments: &'a [ResponseSegment], bounds: &'a [SegmentBounds]) -> Self {
        let all = (0..bounds.len()).flat_map(|segment| {
            (0..PARAMETERS_PER_SEGMENT).map(move |number| Parameter { segment, number })
        });
        let free: Vec<Parameter> = all
            .filter(|parameter| parameter.interval(bounds).0 < parameter.interval(bounds).1)
            .collect();
        let end = |pick: fn((f64, f64)) -> f64| {
            let ends = free.iter().map(|free| pick(free.interval(bounds)) * free.scale());
            DVector::from_iterator(free.len(), ends)
        };
        let (lower, upper) = (end(|interval| interval.0), end(|interval| interval.1));
        Unknowns { segments, bounds, free, lower, upper }
    }

    pub fn count(&self) -> usize {
        self.free.len()
    }

    /// The point within the bounds that is nearest to no movement.
    pub fn nearest_to_rest(&self) -> DVector<f64> {
        self.within(DVector::zeros(self.count()))
    }

    /// The nearest point within the bounds.
    pub fn within(&self, unknowns: DVector<f64>) -> DVector<f64> {
        unknowns.sup(&self.lower).inf(&self.upper)
    }

    /// Which unknowns stand at an end of their interval.
    pub fn at_bound(&self, unknowns: &DVector<f64>) -> Vec<(Parameter, Bound)> {
        let bound = |at: usize| match unknowns[at] {
            value if value <= self.lower[at] => Some(Bound::Lower),
            value if value >= self.upper[at] => Some(Bound::Upper),
            _ => None,
        };
        let free = self.free.iter().enumerate();
        free.filter_map(|(at, &parameter)| Some((parameter, bound(at)?))).collect()
    }

    /// All parameters of each segment, in mm and radians.
    pub fn parameters(&self, unknowns: &DVector<f64>) -> Vec<[f64; PARAMETERS_PER_SEGMENT]> {
        let held = |bounds: &SegmentBounds| bounds.intervals.map(|(low, _)| low);
        let mut parameters: Vec<_> = self.bounds.iter().map(held).collect();
        for (free, value) in self.free.iter().zip(unknowns) {
            parameters[free.segment][free.number] = value / free.scale();
        }
        parameters
    }

    pub fn movements(&self, unknowns: &DVector<f64>) -> Vec<RigidMovement> {
        let movement = |(q, bounds): (&[f64; PARAMETERS_PER_SEGMENT], &SegmentBounds)| {
            let (translation, angles) =
                (Vector::new(q[0], q[1], q[2]), Vector::new(q[3], q[4], q[5]));
            RigidMovement::about_pivot(angles, bounds.pivot, translation)
        };
        self.parameters(unknowns).iter().zip(self.bounds).map(movement).collect()
    }

    /// The twelve numbers of each segment, one after the other.
    pub fn coefficients(&self, unknowns: &DVector<f64>) -> DVector<f64> {
        let movements = self.movements(unknowns);
        let numbers: Vec<f64> = movements
            .iter()
            .zip(self.segments)
            .flat_map(|(movement, segment)| coefficients(movement, &segment.centre))
            .collect();
        DVector::from_vec(numbers)
    }

    /// Their derivatives, one column for each unknown.
    pub fn derivatives(&self, unknowns: &DVector<f64>) -> DMatrix<f64> {
        let mut derivatives =
            DMatrix::zeros(COLUMNS_PER_SEGMENT * self.segments.len(), self.count());
        let parameters = self.parameters(unknowns);
        let movements = self.movements(unknowns);
        for (at, free) in self.free.iter().enumerate() {
            let arm = self.segments[free.segment].centre - self.bounds[free.segment].pivot;
            let (turn, shift) = match free.number {
                axis @ 0..3 => (Matrix3::zeros(), Vector::ith(axis, 1.0)),
                number => {
                    let rotation = movements[free.segment].rotation();
                    let about_z = parameters[free.segment][5];
                    let turn = rotation_derivative(rotation, number - 3, about_z);
                    (turn, turn * arm)
                }
            };
            for k in 0..COLUMNS_PER_SEGMENT {
                let value = if k % 4 == 3 { shift[k / 4] } else { turn[(k / 4, k % 4)] };
                derivatives[(COLUMNS_PER_SEGMENT * free.segment + k, at)] = value / free.scale();
            }
        }
        derivatives
    }
}

impl Parameter {
    fn interval(self, bounds: &[SegmentBounds]) -> (f64, f64) {
        bounds[self.segment].intervals[self.number]
    }

    pub fn is_angle(self) -> bool {
        self.number >= 3
    }

    /// How much of the unknown one mm or one radian is.
    pub(super) fn scale(self) -> f64 {
        if self.is_angle() { LEVER } else { 1.0 }
    }
}

/// The derivative of R = Rz Ry Rx by the angle about an axis.
fn rotation_derivative(rotation: &Matrix3<f64>, axis: usize, about_z: f64) -> Matrix3<f64> {
    let turned_y = Vector::new(-about_z.sin(), about_z.cos(), 0.0);
    match axis {
        0 => rotation * Vector::x().cross_matrix(),
        1 => turned_y.cross_matrix() * rotation,
        _ => Vector::z().cross_matrix() * rotation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_coefficients() {
        let centre = Vector::new(3.0, -20.0, 10.0);
        let segments = [ResponseSegment { name: "jaw".to_owned(), centre }];
        let intervals = [(-50.0, 50.0); 6];
        let bounds = [SegmentBounds { intervals, pivot: Vector::new(1.0, 30.0, -5.0) }];
        let unknowns = Unknowns::new(&segments, &bounds);
        let at = DVector::from_vec(vec![1.0, -2.0, 3.0, 20.0, -35.0, 50.0]);
        let derivatives = unknowns.derivatives(&at);
        // A central difference of step h is off by h² and by rounding over h: 1e-10 each, times the arm of 50 mm.
        let h = 1e-4;
        for k in 0..6 {
            let step = DVector::from_fn(6, |row, _| if row == k { h } else { 0.0 });
            let difference =
                unknowns.coefficients(&(&at + &step)) - unknowns.coefficients(&(&at - &step));
            assert!((difference / (2.0 * h) - derivatives.column(k)).amax() < 1e-8, "unknown {k}");
        }
    }
}
