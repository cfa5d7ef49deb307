//! Invariants of a deformation, and derivatives of an energy by them.

use nalgebra::Matrix3;

/// Of C = F^T F.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invariants {
    /// tr C
    pub i1: f64,
    /// tr cof C = (I1^2 - tr C^2) / 2
    pub i2: f64,
    /// det F
    pub j: f64,
}

impl Invariants {
    pub fn of(f: &Matrix3<f64>) -> Invariants {
        let c = f.transpose() * f;
        let i1 = c.trace();
        Invariants { i1, i2: 0.5 * (i1 * i1 - c.norm_squared()), j: f.determinant() }
    }
}

/// An energy density in kPa at a deformation, and its derivatives by I1, I2 and J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    pub energy: f64,
    pub by_i1: f64,
    pub by_i2: f64,
    pub by_j: f64,
    pub by_i1_i1: f64,
    pub by_i1_i2: f64,
    pub by_i2_i2: f64,
    pub by_i1_j: f64,
    pub by_i2_j: f64,
    pub by_j_j: f64,
}
