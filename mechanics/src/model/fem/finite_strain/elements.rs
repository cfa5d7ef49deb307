//! The elements of tissue at finite strain, and what of the bulk modulus is taken from their points.
//!
//! Of W the part c/2 ln^2 J is replaced by a pressure that several points share, with c = lambda - kappa and lambda that of
//! the law at rest:
//! * stabilised tetrahedra: p is linear and continuous, Pi = int W - c/2 ln^2 J + p ln J - p^2 / (2c) - (p - Pi p)^2 / (2 mu)
//!   (the perturbed Lagrangian of `displacement_pressure`, docs/methods.md#newton);
//! * hexahedra and wedges with mean dilatation: c/2 ln^2 of the mean of J over the cell, p = c ln(Jm) / Jm. A mean of ln J would agree
//!   with it near rest, but takes volume from cells that are pulled on all sides: the second order of their J then counts
//!   against their corners, and they crease.
//!
//! The share kappa of the bulk modulus that stays in each point keeps single cells from collapsing on the way; near rest it goes into
//! the pressures too, but in cells that are pressed to a small part of their volume. Only the neo-Hookean law
//! whose energy of volume is that of ln J shares it: what another law leaves in the points would no longer be convex, and no
//! barrier against collapse (steps of Mooney-Rivlin's and of exponential laws then wander without end). The others take volume at each point.

use crate::material::hyperelastic::{Law, VolumeEnergy};
use crate::mesh::Vector;

/// Elements for tetrahedra, and for the other cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elements {
    /// Whether tetrahedra have pressures.
    pub stabilised: bool,
    /// Whether hexahedra and wedges take volume as a mean over the cell.
    pub mean_dilatation: bool,
    /// Whether tetrahedra have nodes in the middle of their edges, and take volume at each of four points.
    pub quadratic: bool,
}

/// The bulk modulus that stays in cells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CellBulkModulus {
    /// As a multiple of mu.
    share: f64,
    /// For each cell of the mesh whether it keeps that, the others nothing; all keep it where none is named.
    only: Option<Vec<bool>>,
}

impl CellBulkModulus {
    /// On the way, in all cells: first, and after a jam.
    pub const USUAL: &'static [CellBulkModulus] =
        &[CellBulkModulus { share: 1.0, only: None }, CellBulkModulus { share: 2.0, only: None }];
    /// On the way of a movement in parts.
    pub const IN_PARTS: &'static [CellBulkModulus] = &[CellBulkModulus { share: 4.0, only: None }];

    /// Near rest in pressed cells only. Of the others, and of tissue none of whose cells is pressed, the tangent at rest is the
    /// matrix of linear elements.
    pub fn in_pressed(share: f64, pressed: Vec<bool>) -> CellBulkModulus {
        CellBulkModulus { share, only: Some(pressed) }
    }

    pub fn is_of_pressed(&self) -> bool {
        self.only.is_some()
    }

    /// As a multiple of mu.
    pub fn share(&self, cell: usize) -> f64 {
        match &self.only {
            Some(only) if !only[cell] => 0.0,
            _ => self.share,
        }
    }

    /// c and mu of a tetrahedron: at most half of lambda stays, so that the rest has something to act on.
    pub fn of(&self, law: &Law, cell: usize) -> Exchange {
        let (lambda, mu) = law.at_rest();
        let kept = (self.share(cell) * mu).min(0.5 * lambda);
        let carried = if law.shares_volume() { lambda - kept } else { 0.0 };
        Exchange { carried, mu }
    }

    /// What a cell with mean dilatation takes as a mean; none where that is nothing. Linear ones take all of the bulk modulus
    /// lambda + 2/3 mu so.
    pub fn of_brick(&self, law: &Law, cell: usize) -> Option<VolumeEnergy> {
        let Exchange { carried: logarithmic, mu } = self.of(law, cell);
        let takes_all = self.share(cell) == 0.0 && law.shares_volume();
        let bounded = if takes_all { 2.0 / 3.0 * mu } else { 0.0 };
        let energy = VolumeEnergy { logarithmic, bounded };
        (energy.bulk_modulus() > 0.0).then_some(energy)
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
