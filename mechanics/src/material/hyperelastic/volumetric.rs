//! Energy of a change of volume, U(J), in kPa.

/// How the energy grows with the volume; K is the bulk modulus in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Volumetric {
    /// K/4 (J^2 - 1 - 2 ln J): convex in J, and without bound at J = 0.
    Barrier(f64),
    /// K/2 ln^2 J.
    Logarithmic(f64),
}

/// U, U' and U''.
#[derive(Clone, Copy)]
pub(super) struct OfVolume {
    pub energy: f64,
    pub first: f64,
    pub second: f64,
}

impl Volumetric {
    #[inline]
    pub(super) fn at(self, j: f64) -> OfVolume {
        match self {
            Volumetric::Barrier(bulk) => OfVolume {
                energy: 0.25 * bulk * (j * j - 1.0 - 2.0 * j.ln()),
                first: 0.5 * bulk * (j - 1.0 / j),
                second: 0.5 * bulk * (1.0 + 1.0 / (j * j)),
            },
            Volumetric::Logarithmic(bulk) => OfVolume {
                energy: 0.5 * bulk * j.ln().powi(2),
                first: bulk * j.ln() / j,
                second: bulk * (1.0 - j.ln()) / (j * j),
            },
        }
    }
}
