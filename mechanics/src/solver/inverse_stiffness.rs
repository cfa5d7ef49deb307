//! What stands for the inverse of K under pressures: one multigrid cycle, or a factor of K where iterations under a cycle stall.
//!
//! A cycle is weak where flat cells of a stiff layer bend on soft tissue, since what the layer does as a plate is no rigid
//! movement of neighbourhoods. Under a factor only the pressures are approximated, D / 3 for B K^-1 B^T + C: against D
//! its eigenvalues stayed within .17 and 1.5 for cells of 10:1 and moduli of 1000:1.

use super::cholesky::Factor;
use super::lanes::Lanes;
use super::multigrid::{Multigrid, Workspace};

/// What was made of K, for any number of right-hand sides.
#[derive(Clone, Copy)]
pub(super) enum ReadyInverse<'a> {
    Cycle(&'a Multigrid),
    Factor(&'a Factor),
}

/// The same with work vectors for N right-hand sides.
pub(super) enum InverseStiffness<'a, const N: usize> {
    Cycle(&'a Multigrid, Workspace<N>),
    Factor(&'a Factor),
}

impl<'a, const N: usize> InverseStiffness<'a, N> {
    pub fn new(made: ReadyInverse<'a>) -> Self {
        match made {
            ReadyInverse::Cycle(multigrid) => {
                InverseStiffness::Cycle(multigrid, multigrid.workspace())
            }
            ReadyInverse::Factor(factor) => InverseStiffness::Factor(factor),
        }
    }

    /// Puts about K^-1 `forces` into `u`, which is zero.
    pub fn apply(&mut self, forces: &[Lanes<f64, 3, N>], u: &mut [Lanes<f64, 3, N>]) {
        match self {
            InverseStiffness::Cycle(multigrid, workspace) => {
                let cycle = multigrid.apply(forces, workspace);
                let values = u.as_flattened_mut().iter_mut().zip(cycle.values.as_flattened());
                for (u, z) in values {
                    *u = std::array::from_fn(|n| cycle.scale[n] * f64::from(z[n]));
                }
            }
            InverseStiffness::Factor(factor) => factor.correct(forces, u),
        }
    }

    /// For reports.
    pub fn preconditioner(&self) -> &'static str {
        match self {
            InverseStiffness::Cycle(..) => "multigrid and pressure mass",
            InverseStiffness::Factor(_) => "cholesky and pressure mass",
        }
    }
}
