//! Free parameters, and the factors of the columns as functions of them.
//!
//! For a segment a = (R - I, (R - I)(c - p) + t), R = Rz Ry Rx, c the centre of the response, p the pivot. With [v]
//! the matrix of the cross product with v:
//! dR/dx = R [e_x]   dR/dy = [Rz e_y] R   dR/dz = [e_z] R
//! For the growth of all tissue by the change of volume v, a = e(v) = (1 + v)^(1/3) - 1, and for that of a region by w beside
//! it, whose column is what it grows more, a = e(w) - e(v). For a constant a is how far it is from where the response is.

use nalgebra::{DMatrix, DVector, Matrix3};

use super::{Bound, InnerBounds, PARAMETERS_PER_SEGMENT, Parameter, Question, SegmentBounds};
use crate::mesh::Vector;
use crate::plan::RigidMovement;
use crate::prediction::linear_strain;
use crate::response::quadratic_form::pairs;
use crate::response::{COLUMNS_PER_SEGMENT, InnerLoad, coefficients};

/// An angle counts as the arc in mm that it draws at this distance from its axis, about the size of
/// a jaw, so that translations and angles can be weighed against each other. The arc in mm is the
/// angle in degrees.
pub const LEVER: f64 = 180.0 / std::f64::consts::PI;

/// A change of volume, Poisson's ratio or the logarithm of Young's modulus counts as hundredths of it: 1 % of the volume moves
/// skin by a tenth of a mm.
const HUNDREDTHS: f64 = 100.0;

/// Shares of a bound that are rounding.
const ROUNDING: f64 = 1e-15;

/// Free parameters as one vector: translations in mm, angles as arcs in mm, the others in hundredths.
pub struct Unknowns<'a> {
    question: &'a Question<'a>,
    pub free: Vec<Parameter>,
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
}

/// All parameters, free or not, in mm, radians and shares.
pub struct Values {
    pub movements: Vec<[f64; PARAMETERS_PER_SEGMENT]>,
    /// For each entry of [`Response::inner`](crate::response::Response::inner) its change of volume; 0 of what is held.
    pub growth: Vec<f64>,
    pub constants: Vec<f64>,
}

impl<'a> Unknowns<'a> {
    pub fn new(question: &'a Question<'a>) -> Self {
        let movements = (0..question.bounds.len()).flat_map(|segment| {
            (0..PARAMETERS_PER_SEGMENT).map(move |number| Parameter::Movement { segment, number })
        });
        let growth = (0..question.inner.len()).map(Parameter::Growth);
        let constants = (0..question.constants.len()).map(Parameter::Constant);
        let all = movements.chain(growth).chain(constants);
        let free: Vec<Parameter> = all
            .filter(|parameter| parameter.interval(question).0 < parameter.interval(question).1)
            .collect();
        let end = |pick: fn((f64, f64)) -> f64| {
            let ends = free.iter().map(|free| pick(free.interval(question)) * free.scale());
            DVector::from_iterator(free.len(), ends)
        };
        let (lower, upper) = (end(|interval| interval.0), end(|interval| interval.1));
        Unknowns { question, free, lower, upper }
    }

    pub fn count(&self) -> usize {
        self.free.len()
    }

    /// The point within the bounds that is nearest to no movement, to no growth, and to the constants of the response.
    pub fn feasible_rest(&self) -> DVector<f64> {
        let rest = |free: &Parameter| match free {
            Parameter::Movement { .. } | Parameter::Growth(_) => 0.0,
            Parameter::Constant(place) => self.question.constants[*place].value * free.scale(),
        };
        self.within(DVector::from_iterator(self.count(), self.free.iter().map(rest)))
    }

    /// The point of an optimum whose constants were held, by its values, and these as the response has them.
    pub(super) fn beside(&self, value_of: impl Fn(Parameter) -> f64) -> DVector<f64> {
        let value = |free: &Parameter| match *free {
            Parameter::Movement { .. } | Parameter::Growth(_) => value_of(*free),
            Parameter::Constant(place) => self.question.constants[place].value,
        };
        let values = self.free.iter().map(|free| value(free) * free.scale());
        self.within(DVector::from_iterator(self.count(), values))
    }

    /// The twelve numbers of each segment.
    pub(super) fn movement_numbers(&self, unknowns: &DVector<f64>) -> DVector<f64> {
        let movements = self.movements(&self.values(unknowns));
        let pairs = movements.iter().zip(&self.question.response.segments);
        let numbers = pairs.flat_map(|(movement, segment)| coefficients(movement, &segment.centre));
        DVector::from_vec(numbers.collect())
    }

    /// The nearest point within the bounds; at a bound where nothing but rounding parts it from there.
    pub fn within(&self, unknowns: DVector<f64>) -> DVector<f64> {
        DVector::from_fn(unknowns.len(), |at, _| {
            let (value, low, high) = (unknowns[at], self.lower[at], self.upper[at]);
            match value {
                value if value <= low + ROUNDING * low.abs() => low,
                value if value >= high - ROUNDING * high.abs() => high,
                value => value,
            }
        })
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

    pub fn values(&self, unknowns: &DVector<f64>) -> Values {
        let Question { bounds, inner, constants, .. } = self.question;
        let held = |bounds: &SegmentBounds| bounds.intervals.map(|(low, _)| low);
        let mut values = Values {
            movements: bounds.iter().map(held).collect(),
            growth: inner.iter().map(|own| own.interval().0).collect(),
            constants: constants.iter().map(|own| own.interval.0).collect(),
        };
        for (free, value) in self.free.iter().zip(unknowns) {
            let place = match *free {
                Parameter::Movement { segment, number } => &mut values.movements[segment][number],
                Parameter::Growth(place) => &mut values.growth[place],
                Parameter::Constant(place) => &mut values.constants[place],
            };
            *place = value / free.scale();
        }
        values
    }

    pub fn movements(&self, values: &Values) -> Vec<RigidMovement> {
        let movement = |(q, bounds): (&[f64; PARAMETERS_PER_SEGMENT], &SegmentBounds)| {
            let (translation, angles) =
                (Vector::new(q[0], q[1], q[2]), Vector::new(q[3], q[4], q[5]));
            RigidMovement::about_pivot(angles, bounds.pivot, translation)
        };
        values.movements.iter().zip(self.question.bounds).map(movement).collect()
    }

    /// How much there is of each column of what acts inside.
    pub fn inner(&self, values: &Values) -> Vec<f64> {
        let everywhere = self.everywhere().map_or(0.0, |place| linear_strain(values.growth[place]));
        let amount = |(place, own): (usize, &InnerBounds)| match own {
            InnerBounds::Held(amount) => *amount,
            InnerBounds::Growth(..) => {
                let strain = linear_strain(values.growth[place]);
                if Some(place) == self.everywhere() { strain } else { strain - everywhere }
            }
        };
        self.question.inner.iter().enumerate().map(amount).collect()
    }

    /// The entry of the growth of all tissue.
    fn everywhere(&self) -> Option<usize> {
        let loads = self.question.response.inner.iter().zip(self.question.inner);
        let is_all = |(load, own): (&InnerLoad, &InnerBounds)| {
            let grows = matches!(own, InnerBounds::Growth(..));
            grows && matches!(load, InnerLoad::Growth(region) if region == "*")
        };
        loads.map(is_all).position(|is_all| is_all)
    }

    /// Factors of the columns: twelve numbers of each segment, then internal loads, then constants, then the products of each two
    /// numbers of segments where the second order counts.
    pub fn coefficients(&self, unknowns: &DVector<f64>) -> DVector<f64> {
        let Question { response, constants, .. } = self.question;
        let values = self.values(unknowns);
        let movements = self.movements(&values);
        let of_segments = movements
            .iter()
            .zip(&response.segments)
            .flat_map(|(movement, segment)| coefficients(movement, &segment.centre));
        let away = values.constants.iter().zip(*constants).map(|(value, own)| value - own.value);
        let mut numbers: Vec<f64> = of_segments.chain(self.inner(&values)).chain(away).collect();
        let products: Vec<f64> = self.pairs().map(|[k, l]| numbers[k] * numbers[l]).collect();
        numbers.extend(products);
        DVector::from_vec(numbers)
    }

    /// The pairs of numbers of segments whose products have columns.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        pairs(self.question.second_order.map_or(0, |form| form.numbers))
    }

    /// Their derivatives, one column for each unknown.
    pub fn derivatives(&self, unknowns: &DVector<f64>) -> DMatrix<f64> {
        let Question { response, inner, constants, .. } = self.question;
        let of_segments = COLUMNS_PER_SEGMENT * response.segments.len();
        let of_tissue = of_segments + inner.len();
        let first = of_tissue + constants.len();
        let mut derivatives = DMatrix::zeros(first + self.pairs().count(), self.count());
        let numbers = self.coefficients(unknowns);
        let values = self.values(unknowns);
        let movements = self.movements(&values);
        for (at, free) in self.free.iter().enumerate() {
            let mut column = derivatives.column_mut(at);
            match *free {
                Parameter::Movement { segment, number } => {
                    let own = self.moving((segment, number), &values, &movements[segment]);
                    let begin = COLUMNS_PER_SEGMENT * segment;
                    column.rows_mut(begin, COLUMNS_PER_SEGMENT).copy_from_slice(&own);
                }
                Parameter::Growth(place) => {
                    let slope = (1.0 + values.growth[place]).cbrt().powi(-2) / 3.0;
                    if Some(place) == self.everywhere() {
                        for (other, own) in inner.iter().enumerate() {
                            if matches!(own, InnerBounds::Growth(..)) {
                                column[of_segments + other] = -slope;
                            }
                        }
                    }
                    column[of_segments + place] = slope;
                }
                Parameter::Constant(place) => column[of_tissue + place] = 1.0,
            }
            for (pair, [k, l]) in self.pairs().enumerate() {
                column[first + pair] = column[k] * numbers[l] + numbers[k] * column[l];
            }
            column /= free.scale();
        }
        derivatives
    }

    /// The derivatives of the twelve numbers of a segment by one of its six.
    fn moving(
        &self,
        (segment, number): (usize, usize),
        values: &Values,
        movement: &RigidMovement,
    ) -> [f64; COLUMNS_PER_SEGMENT] {
        let Question { response, bounds, .. } = self.question;
        let arm = response.segments[segment].centre - bounds[segment].pivot;
        let (turn, shift) = match number {
            axis @ 0..3 => (Matrix3::zeros(), Vector::ith(axis, 1.0)),
            number => {
                let about_z = values.movements[segment][5];
                let turn = rotation_derivative(movement.rotation(), number - 3, about_z);
                (turn, turn * arm)
            }
        };
        std::array::from_fn(|k| if k % 4 == 3 { shift[k / 4] } else { turn[(k / 4, k % 4)] })
    }
}

impl InnerBounds {
    /// Of the change of volume.
    fn interval(self) -> (f64, f64) {
        match self {
            InnerBounds::Held(_) => (0.0, 0.0),
            InnerBounds::Growth(low, high) => (low, high),
        }
    }
}

impl Parameter {
    fn interval(self, question: &Question) -> (f64, f64) {
        match self {
            Parameter::Movement { segment, number } => question.bounds[segment].intervals[number],
            Parameter::Growth(place) => question.inner[place].interval(),
            Parameter::Constant(place) => question.constants[place].interval,
        }
    }

    pub fn is_angle(self) -> bool {
        matches!(self, Parameter::Movement { number: 3.., .. })
    }

    /// Whether it moves no segment.
    pub fn is_of_tissue(self) -> bool {
        !matches!(self, Parameter::Movement { .. })
    }

    /// How much of the unknown one mm, one radian or the whole of a share is.
    pub(super) fn scale(self) -> f64 {
        match self {
            Parameter::Movement { number: 0..3, .. } => 1.0,
            Parameter::Movement { .. } => LEVER,
            Parameter::Growth(_) | Parameter::Constant(_) => HUNDREDTHS,
        }
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
    use super::super::ConstantColumn;
    use super::*;
    use crate::response::{QuadraticForm, Response, ResponseSegment};

    /// A response of one segment, and of growth everywhere, of a region beside it, and of a muscle.
    fn response() -> Response {
        let segment =
            ResponseSegment { name: "jaw".to_owned(), centre: Vector::new(3.0, -20.0, 10.0) };
        let growth = |region: &str| InnerLoad::Growth(region.to_owned());
        Response {
            segments: vec![segment],
            inner: vec![growth("fat"), growth("*"), InnerLoad::Muscle("left".to_owned())],
            nodes: Vec::new(),
            columns: Vec::new(),
        }
    }

    #[test]
    fn derivatives_are_those_of_the_coefficients() {
        let (response, intervals) = (response(), [(-50.0, 50.0); 6]);
        let bounds = [SegmentBounds { intervals, pivot: Vector::new(1.0, 30.0, -5.0) }];
        let growth = InnerBounds::Growth(-0.5, 1.0);
        let constant =
            ConstantColumn { derivative: Vec::new(), value: 0.46, interval: (0.3, 0.49) };
        let numbers = COLUMNS_PER_SEGMENT;
        let form = QuadraticForm {
            numbers,
            values: Vec::new(),
            scales: Vec::new(),
            third: Vec::new(),
            coupling: Vec::new(),
        };
        let question = Question {
            response: &response,
            second_order: Some(&form),
            bounds: &bounds,
            targets: &[],
            inner: &[growth, growth, InnerBounds::Held(20.0)],
            constants: &[constant],
        };
        let unknowns = Unknowns::new(&question);
        let at = DVector::from_vec(vec![1.0, -2.0, 3.0, 20.0, -35.0, 50.0, -10.0, 20.0, 45.0]);
        let derivatives = unknowns.derivatives(&at);
        // A central difference of step h is off by h² and by rounding over h: 1e-10 each, times the arm of 50 mm, squared in products.
        let h = 1e-4;
        for k in 0..unknowns.count() {
            let step = DVector::from_fn(at.len(), |row, _| if row == k { h } else { 0.0 });
            let difference =
                unknowns.coefficients(&(&at + &step)) - unknowns.coefficients(&(&at - &step));
            assert!((difference / (2.0 * h) - derivatives.column(k)).amax() < 1e-6, "unknown {k}");
        }
        let inner = unknowns.inner(&unknowns.values(&at));
        let everywhere = linear_strain(0.2);
        assert_eq!(inner, [linear_strain(-0.1) - everywhere, everywhere, 20.0]);
    }
}
