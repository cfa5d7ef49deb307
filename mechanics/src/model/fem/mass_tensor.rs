//! The mass-tensor model (Cotin, Delingette, Ayache 2000; Kim et al. 2012, section 1.4.3; docs/methods.md#mass-tensor).
//!
//! The force on node j is f_j = K_jj u_j + sum_k K_jk u_k, with the tensors of each tetrahedron
//! K_jk = V [ lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I ]. These are the stiffness matrix of plain
//! linear tetrahedra: the model is theirs, and so is its answer. What is its own is how papers bring it to rest,
//! node by node (`solver::stationary`); `Iterations::Fast` solves the same matrix as finite elements do.

use super::displacement::Problem;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::Progress;
use crate::solver::stationary::{self, Stationary};
use crate::solver::{self, System, Unknowns};

/// Parameters of this model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassTensorSettings {
    pub iterations: Iterations,
}

/// How the tensors are brought to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Iterations {
    /// As finite elements are: a factorisation, or conjugate gradients with multigrid.
    #[default]
    Fast,
    /// Node by node, as the papers do.
    Stationary(Stationary),
}

/// Solves for a load case. The problem states the tensors: those of its tissue, whose tetrahedra are plain.
pub fn solve(
    problem: &Problem,
    settings: &MassTensorSettings,
    case: &LoadCase,
    progress: &dyn Progress,
) -> Result<Equilibrium, ModelError> {
    let tolerance = &problem.tolerance;
    let solve = |system: &System, right_hand_sides: &[Unknowns]| match &settings.iterations {
        Iterations::Fast => solver::solve(system, right_hand_sides, tolerance, progress),
        Iterations::Stationary(own) => right_hand_sides
            .iter()
            .map(|right_hand_side| {
                stationary::solve(system, right_hand_side, own, tolerance, progress)
            })
            .collect(),
    };
    let mut equilibria = problem.solve_cases_by(std::slice::from_ref(case), progress, &solve)?;
    Ok(equilibria.remove(0))
}
