//! Covariance of the free parameters: (JᵀJ)⁻¹ of those that the targets determine.
//!
//! Where JᵀJ is singular, a parameter has a finite variance only if no undetermined combination
//! contains it; its variance is then that of the pseudo-inverse (Searle, Linear Models, 1971,
//! section 5.4: estimable functions).

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::bounded_step::UNDETERMINED;
use super::minimum::Minimum;
use super::unknowns::Unknowns;
use super::{Bound, Parameter};

/// A combination of length 1, in mm, degrees and hundredths, that changes the targets by less than this share of their sigma is not
/// determined, however little else is asked: derivatives by differences are no better.
const BLIND: f64 = 1e-5;

/// A parameter with less than this weight takes no part in a combination.
const SMALL_WEIGHT: f64 = 1e-3;

/// Certainty of the parameters from the targets.
#[derive(Clone, Debug, PartialEq)]
pub struct Certainty {
    /// The parameters that the targets determine: those that no bound stops, and those of tissue even so, since a bound of a
    /// constant says where it may be and not that it is there.
    pub determined: Vec<Parameter>,
    /// Their covariance in mm, radians and shares.
    pub covariance: DMatrix<f64>,
    /// How many independent combinations the targets determine.
    pub rank: usize,
    /// Combinations that could be added to the plan without a change at any target, to first order.
    pub undetermined: Vec<Vec<Weight>>,
}

/// The part of a parameter in a combination: in mm, degrees and hundredths, the largest part is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    pub parameter: Parameter,
    pub part: f64,
}

impl Certainty {
    pub fn new(unknowns: &Unknowns, minimum: &Minimum, at_bound: &[(Parameter, Bound)]) -> Self {
        let is_free = |parameter: &Parameter| {
            parameter.is_of_tissue() || at_bound.iter().all(|(other, _)| other != parameter)
        };
        let places: Vec<usize> =
            (0..unknowns.count()).filter(|&place| is_free(&unknowns.free[place])).collect();
        let free: Vec<Parameter> = places.iter().map(|&place| unknowns.free[place]).collect();
        let jacobian = minimum.linearised.jacobian.select_columns(&places);
        let floor = (UNDETERMINED.powi(2) * minimum.linearised.largest).max(BLIND.powi(2));
        let (inverse, blind) = inverse_and_kernel(jacobian.tr_mul(&jacobian), floor);
        let is_seen = |place: &usize| blind.iter().all(|way| way[*place].abs() < SMALL_WEIGHT);
        let seen: Vec<usize> = (0..free.len()).filter(is_seen).collect();
        let covariance = DMatrix::from_fn(seen.len(), seen.len(), |row, column| {
            let (row, column) = (seen[row], seen[column]);
            inverse[(row, column)] / (free[row].scale() * free[column].scale())
        });
        Certainty {
            determined: seen.iter().map(|&place| free[place]).collect(),
            covariance,
            rank: free.len() - blind.len(),
            undetermined: readable(blind).iter().map(|way| weights(&free, way)).collect(),
        }
    }

    /// The standard error of each determined parameter, in mm, radians or shares.
    pub fn standard_errors(&self) -> Vec<f64> {
        self.covariance.diagonal().iter().map(|variance| variance.sqrt()).collect()
    }

    /// The standard error of a parameter; none where the targets do not determine it.
    pub fn standard_error_of(&self, parameter: Parameter) -> Option<f64> {
        let place = self.determined.iter().position(|other| *other == parameter)?;
        Some(self.covariance[(place, place)].sqrt())
    }

    /// The correlation of each two determined parameters.
    pub fn correlation(&self) -> DMatrix<f64> {
        let errors = self.standard_errors();
        let of = |row: usize, column: usize| {
            self.covariance[(row, column)] / (errors[row] * errors[column])
        };
        DMatrix::from_fn(errors.len(), errors.len(), of)
    }
}

/// The inverse on the directions whose eigenvalues are above the floor, and the other directions.
fn inverse_and_kernel(normal: DMatrix<f64>, floor: f64) -> (DMatrix<f64>, Vec<DVector<f64>>) {
    let mut inverse = DMatrix::zeros(normal.nrows(), normal.ncols());
    let mut kernel = Vec::new();
    if normal.is_empty() {
        return (inverse, kernel);
    }
    let eigen = SymmetricEigen::new(normal);
    for (&value, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        match value > floor {
            true => inverse += direction * direction.transpose() / value,
            false => kernel.push(direction.into_owned()),
        }
    }
    (inverse, kernel)
}

/// The same space spanned by vectors of few entries: Gauss-Jordan elimination with the largest
/// entry of each vector as its pivot.
fn readable(mut space: Vec<DVector<f64>>) -> Vec<DVector<f64>> {
    for row in 0..space.len() {
        let pivot = space[row].icamax();
        let largest = space[row][pivot];
        space[row] /= largest;
        for other in (0..space.len()).filter(|&other| other != row) {
            let part = space[other][pivot];
            let own = space[row].clone();
            space[other].axpy(-part, &own, 1.0);
        }
    }
    space
}

fn weights(free: &[Parameter], way: &DVector<f64>) -> Vec<Weight> {
    let largest = way[way.icamax()];
    let weight =
        |(&parameter, part): (&Parameter, &f64)| Weight { parameter, part: part / largest };
    let all = free.iter().zip(way.iter()).map(weight);
    all.filter(|weight| weight.part.abs() >= SMALL_WEIGHT).collect()
}
