//! Energies that are a function of shape alone and one of volume alone: W = w(Ibar1, Ibar2) + U(J), with
//! Ibar1 = J^-2/3 I1 and Ibar2 = J^-4/3 I2 (docs/finite-strain.md#laws).

use super::volumetric::Volumetric;
use super::{Derivatives, Invariants};

/// Invariants of shape, 3 each at rest.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    pub i1: f64,
    pub i2: f64,
}

/// w and its derivatives by Ibar1 and Ibar2.
#[derive(Clone, Copy, Default)]
pub(super) struct OfShape {
    pub energy: f64,
    pub by_1: f64,
    pub by_2: f64,
    pub by_1_1: f64,
    pub by_1_2: f64,
    pub by_2_2: f64,
}

/// The derivatives of w + U by I1, I2 and J.
#[inline]
pub(super) fn split(
    at: &Invariants,
    volumetric: Volumetric,
    of_shape: impl FnOnce(Shape) -> OfShape,
) -> Derivatives {
    let Invariants { i1, i2, j } = *at;
    let per_1 = j.cbrt().powi(-2);
    let per_2 = per_1 * per_1;
    let shape = Shape { i1: per_1 * i1, i2: per_2 * i2 };
    let w = of_shape(shape);
    let u = volumetric.at(j);
    // Of Ibar1 and Ibar2 by J.
    let (first_1, first_2) = (-2.0 / 3.0 * shape.i1 / j, -4.0 / 3.0 * shape.i2 / j);
    let (second_1, second_2) = (10.0 / 9.0 * shape.i1 / (j * j), 28.0 / 9.0 * shape.i2 / (j * j));
    Derivatives {
        energy: w.energy + u.energy,
        by_i1: w.by_1 * per_1,
        by_i2: w.by_2 * per_2,
        by_j: w.by_1 * first_1 + w.by_2 * first_2 + u.first,
        by_i1_i1: w.by_1_1 * per_1 * per_1,
        by_i1_i2: w.by_1_2 * per_1 * per_2,
        by_i2_i2: w.by_2_2 * per_2 * per_2,
        by_i1_j: per_1 * (w.by_1_1 * first_1 + w.by_1_2 * first_2 - 2.0 / 3.0 * w.by_1 / j),
        by_i2_j: per_2 * (w.by_1_2 * first_1 + w.by_2_2 * first_2 - 4.0 / 3.0 * w.by_2 / j),
        by_j_j: w.by_1_1 * first_1 * first_1
            + 2.0 * w.by_1_2 * first_1 * first_2
            + w.by_2_2 * first_2 * first_2
            + w.by_1 * second_1
            + w.by_2 * second_2
            + u.second,
    }
}
