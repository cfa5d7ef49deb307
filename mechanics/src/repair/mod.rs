//! Repair of distorted cells by bounded moves of their nodes, until Bézier bounds prove every cell or name it.
//!
//! The Bézier coefficients c_k of a cell's Jacobian are affine in the place of each single node, so that
//!
//!   Σ_cells Σ_k max(0, ε - c_k / J0)²,   J0 the mean |J| of the cells about a node,
//!
//! is convex in it: sweeps over the nodes of unproven cells minimise it node by node, inside a ball about the node's
//! first place, and on skin and bone along the surface only. A cell counts as mended when
//! [`crate::mesh::jacobian::jacobian_sign`] proves it, in every point and not at its corners only.
//!
//! Source: Johnen, Weill, Remacle, Procedia Engineering 203 (2017) 271 (the bounds). Chabanas, Luboz, Payan, Medical
//! Image Analysis 7 (2003) 131, section 3.5.4 move along the gradient of J at corners instead, and stop when corners
//! are positive: [`corner_rule`] does that, for comparison.

mod bounds;
pub mod corner_rule;
mod mend;
mod node;
pub mod noisy;

pub use bounds::Bounds;
pub use mend::{RepairReport, UnprovenCell, repair};
