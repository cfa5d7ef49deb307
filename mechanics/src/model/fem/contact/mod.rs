//! Unilateral contact without friction, in linear elasticity and for the steps of Newton's method: gaps g >= 0, contact
//! forces m >= 0, m g = 0.
//!
//! Primal-dual active set (Hintermueller, Ito, Kunisch, SIAM J. Optim. 13, 2003): the rows that press are equations,
//! K u = f + G^T m with g = 0, and the others are left out; a row presses in the next pass where m - c g > 0, whatever c is,
//! because one of both is 0. The equations are met under the matrix and the hierarchy that are there (`solver::constrained`).

mod active_set;
mod equations;
mod kept_rows;
mod pressing;
mod touch;

pub(super) use active_set::{ActiveSet, MOST_PASSES, Task};
pub(super) use equations::FreeUnknowns;
pub(super) use kept_rows::KeptRows;
pub(super) use pressing::{ALTERNATES, MOST_ROUNDS, UNSETTLED_MM};
pub use pressing::{ContactProblem, InContact, Pressing, SETTLED_MM};
pub use touch::{Contact, Effort, PressedStep, PressingRow, forces_of};
