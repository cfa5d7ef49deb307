//! The elements of tissue at finite strain, and what of the bulk modulus is taken from their points.
//!
//! Of W the part c/2 ln^2 J is replaced by a pressure that several points share, with c = lambda - kappa and lambda that of
//! the law at rest:
//! * stabilised tetrahedra: p is linear and continuous, Pi = int W - c/2 ln^2 J + p ln J - p^2 / (2c) - (p - Pi p)^2 / (2 mu)
//!   (the perturbed Lagrangian of `displacement_pressure`, docs/methods.md#newton);
//! * hexahedra and wedges with mean dilatation: p = c/V int ln J, one for each cell.
//!
//! The share kappa of the bulk modulus that stays in each point keeps single cells from collapsing on the way; near rest it goes into
//! the pressures too, unless cells are pressed to a small part of their volume. Only the neo-Hookean law
//! whose energy of volume is that of ln J shares it: what another law leaves in the points would no longer be convex, and no
//! barrier against collapse (steps of Mooney-Rivlin's and of exponential laws then wander without end). The others take volume at each point.

use crate::material::hyperelastic::Law;
use crate::mesh::Vector;

/// Elements for tetrahedra, and for the other cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elements {
    /// Whether tetrahedra have pressures.
    pub stabilised: bool,
    /// Whether hexahedra and wedges take volume as a mean over the cell.
    pub mean_dilatation: bool,
}

/// The share of the bulk modulus that stays in each cell, as a multiple of mu.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kept(pub f64);

impl Kept {
    pub const FIRST: Kept = Kept(1.0);
    /// After a standstill.
    pub const MORE: Kept = Kept(2.0);
    /// Near rest, where no cell is pressed to a small part of its volume: the tangent at rest is the matrix of linear elements.
    pub const NONE: Kept = Kept(0.0);

    /// c and mu of tetrahedra: at most half of lambda stays, so that the rest has something to act on.
    pub fn of(self, law: &Law) -> Exchange {
        let (lambda, mu) = law.at_rest();
        let kept = (self.0 * mu).min(0.5 * lambda);
        let carried = if law.shares_volume() { lambda - kept } else { 0.0 };
        Exchange { carried, mu }
    }

    /// c and mu of cells with mean dilatation. Linear ones take all of the bulk modulus lambda + 2/3 mu as a mean.
    pub fn of_bricks(self, law: &Law) -> Exchange {
        let own = self.of(law);
        match self == Kept::NONE && law.shares_volume() {
            true => Exchange { carried: own.carried + 2.0 / 3.0 * own.mu, ..own },
            false => own,
        }
    }
}

/// Moduli of a law whose pressure is shared, in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Exchange {
    /// c; not positive where there is nothing to carry.
    pub carried: f64,
    pub mu: f64,
}

/// What rounding at a point is relative to, of a modulus times its volume in mN mm: the norm of the forces that such a stress exerts on
/// nodes of these gradients, more by as often as the cell fits into the `farthest` distance of a node from the origin in mm, whose last
/// digit is lost; and the energy in mN mm.
pub(super) fn rounded(modulus: f64, gradients: &[Vector], farthest: f64) -> (f64, f64) {
    let slope = gradients.iter().map(Vector::norm_squared).sum::<f64>().sqrt();
    (modulus * slope * (1.0 + farthest * slope), modulus)
}
