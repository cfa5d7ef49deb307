//! The mass-spring model: nodes joined by springs along the edges of tetrahedra (Kim et al. 2012, section
//! 1.4.1, eq. 2-4; docs/methods.md#mass-springs).
//!
//! At rest the forces of the springs, for whatever turn and stretch, balance those that act:
//! sum_j k_ij (|d| - L) d / |d| + f_i = 0, d = p_j - p_i. There are no masses: only rest is asked for.
//! The springs know lengths and not volumes. On average they are an elastic body of bulk modulus 2 E / 3 and of
//! equal C1122 and C1212, whatever the mesh: a Poisson ratio of 1/4, which no choice of E changes. Nor does
//! a spring know on which side of a face its node is: a tetrahedron that is pushed through itself stays so.

mod direct;
mod network;
mod newton;
mod springs;
pub use network::{MassSpringSettings, POISSON_RATIO, Search};
pub use springs::{Spring, Springs};

use super::problem::{Equilibrium, LoadCase, ModelError};
use crate::model::fem::displacement::{Problem, check_finite};
use crate::progress::{Phase, Progress};
use network::{Network, SpringEquilibrium};

/// Solves a load case for rest.
pub fn solve(
    problem: &Problem,
    settings: &MassSpringSettings,
    case: &LoadCase,
    progress: &dyn Progress,
) -> Result<Equilibrium, ModelError> {
    progress.phase(Phase::Assemble);
    let network = Network::new(&problem.tissue, problem.constraints, case)?;
    progress.phase(Phase::Solve);
    let wanted = problem.tolerance.relative_residual;
    let found = match (network.scale > 0.0, settings.search) {
        (false, _) => SpringEquilibrium::nothing(&network, wanted),
        (true, Search::Newton) => newton::solve(&network, problem, settings, progress)?,
        (true, Search::Direct) => direct::solve(&network, wanted, settings, progress)?,
    };
    let forces = network.springs.forces(&found.positions);
    let displacement = found.positions.iter().zip(network.rest).map(|(p, x)| p - x).collect();
    let equilibrium = Equilibrium {
        displacement,
        reactions: network.reactions(&forces),
        solver: found.solver,
        warnings: Vec::new(),
        states: Default::default(),
    };
    check_finite(std::slice::from_ref(&equilibrium))?;
    Ok(equilibrium)
}
