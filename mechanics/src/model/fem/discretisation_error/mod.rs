//! Discretisation error of linear finite elements of first order, estimated by one two-level step with quadratic edge
//! functions.
//!
//! The displacement that the mesh cannot show is looked for in functions of its edges, u + b, b = sum_ij b_ij phi_ij
//! (`edge_functions`). One step of block Jacobi and one solve with the matrix of the answer give
//!   b_ij = D_ij^-1 r_ij,   K e = -K_cb b,   r_ij = f(phi_ij) - int sigma(u) : grad phi_ij
//! with D_ij the 3 x 3 block of edge ij and K_cb the coupling of edges to corners; e is how much the nodes of the mesh move
//! because of b, and with that what u lacks. b is zero where edges are held. Tetrahedra with pressures take 2 mu eps in D and
//! K_cb, and their volume rows lose what the edge functions add and what the stabilisation took:
//!   B e - C e_p = -int q div b - (M - Mbar) p / mu.
//! Undamped, the step overshoots what the edge functions alone would give by about what they cannot show.
//!
//! Source: hierarchical estimators with edge bubbles: Bank, Smith, A posteriori error estimates based on hierarchical bases,
//! SIAM Journal on Numerical Analysis 30, 1993; the step and its factors: docs/estimates.md, with what was measured.

mod cell;
#[cfg(test)]
mod column_tests;
mod edge_equations;
mod edge_functions;
mod edges;
mod held_edges;
mod indicators;
mod inner_modes;
mod loads;
mod mean_stress;
mod points;
mod sheet;
mod simplex;
mod two_level;

use super::assembly::Tissue;
use super::contact::InContact;
use super::linear_system::{Correction, LinearSystem, Residual, Solved};
use crate::boundary::Constraint;
use crate::boundary::contact::with_pressing;
use crate::material::LinearElastic;
use crate::mesh::Vector;
use crate::mesh::volume::BoundaryFace;
use crate::model::problem::ModelError;
use crate::progress::{Phase, Progress};
use cell::{CellAnswer, Cells};

pub(super) use edge_equations::EdgeEquation;
pub(super) use edge_functions::{Corners, MAX_EDGES, at_point};
pub use indicators::{Goal, marked};
pub(super) use inner_modes::{
    MAX_MODES, ModeEquations, Modes, NO_MODES, mode_gradients, moment_weights, sums_of_edges,
};
pub use loads::DistributedLoads;
pub(super) use mean_stress::{Weighted, has_wedges, smooth_in_wedges};
pub(super) use points::{gradient_of, of_corners};
pub(super) use two_level::{AtCorners, Coefficients, EnrichedCells, OfEdges, TwoLevel};

/// Relative residual of the solve: the first digit of an estimate is all that it has.
const LOOSE: f64 = 0.03;

/// The same where the first iterations show little of the answer: where Young's modulus differs by more than this factor.
const TIGHTER: f64 = 0.01;
const CONTRAST: f64 = 3.0;

/// The same where volume changes resist much more than changes of shape, from this Poisson ratio on: what inner modes do to volume
/// has most of the residual and little of the answer.
const TIGHTEST: f64 = 0.003;
const LOCKING: f64 = 0.495;

/// Factor of e: without it e falls short by about this (docs/estimates.md).
const PLAIN_FACTOR: f64 = 1.2;
const MIXED_FACTOR: f64 = 1.3;

/// Input of the estimate: a solution and its problem.
pub struct Estimate<'a> {
    pub tissue: Tissue<'a>,
    pub system: &'a LinearSystem<'a>,
    /// The faces of the mesh that belong to one cell only.
    pub boundary: &'a [BoundaryFace],
    pub loads: &'a DistributedLoads,
}

/// Estimated discretisation error of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscretisationError {
    /// For each node what its displacement lacks, in mm.
    pub missing: Vec<Vector>,
    /// The squared energy norm of the edge functions, sum_ij b_ij . r_ij in mN mm.
    pub squared_energy_norm: f64,
    /// Iterations of the solve.
    pub iterations: usize,
}

impl Estimate<'_> {
    /// Estimates the error of an answer of the system.
    pub fn of(
        &self,
        solved: &Solved,
        progress: &dyn Progress,
    ) -> Result<DiscretisationError, ModelError> {
        progress.phase(Phase::Estimate);
        self.missing(solved, self.system.constraints, &mut |residual, tolerance| {
            Ok(self.system.solve_for(&[residual], tolerance, progress)?.remove(0))
        })
    }

    /// Estimates the error of an answer in which something presses, and goes on to do so where it does.
    pub fn in_contact(
        &self,
        found: &mut InContact,
        progress: &dyn Progress,
    ) -> Result<DiscretisationError, ModelError> {
        progress.phase(Phase::Estimate);
        let InContact { solved, contact, pressing } = found;
        let rows = contact.pressed.iter().map(|pressed| &pressed.row);
        let constraints = with_pressing(self.system.constraints, rows);
        self.missing(solved, &constraints, &mut |residual, tolerance| {
            pressing.correction(&residual, tolerance, progress)
        })
    }

    /// What an answer lacks, by what its holds are for edges and by what solves for the nodes.
    fn missing(
        &self,
        solved: &Solved,
        constraints: &[Constraint],
        solve: &mut dyn FnMut(Residual, f64) -> Result<Correction, ModelError>,
    ) -> Result<DiscretisationError, ModelError> {
        let has_pressures = self.system.pressures.is_some();
        let cells = self.cells(self.answered(solved));
        let two_level = TwoLevel { constraints, ..self.two_level(&cells) };
        let (residual, squared_energy_norm) = two_level.at_corners()?;
        let forces = residual.forces.clone();
        let tolerance = tolerance(self.tissue.materials, has_pressures);
        let Correction { displacement, iterations, .. } = solve(residual, tolerance)?;
        let factor = factor(has_pressures) * two_level.share(&displacement, &forces)?;
        let missing = displacement.into_iter().map(|e| e * factor).collect();
        Ok(DiscretisationError { missing, squared_energy_norm, iterations })
    }

    fn answered<'b>(&'b self, solved: &'b Solved) -> CellAnswer<'b> {
        let Solved { equilibrium, pressures } = solved;
        let growth = &self.loads.inner.growth;
        CellAnswer { displacement: &equilibrium.displacement, pressures, growth }
    }

    fn cells<'b>(&'b self, answered: CellAnswer<'b>) -> Cells<'b> {
        Cells::new(&self.tissue, self.system, answered)
    }

    fn two_level<'b>(&'b self, cells: &'b Cells<'b>) -> TwoLevel<'b, Cells<'b>> {
        let pressures = self.system.pressures.as_ref();
        TwoLevel {
            tissue: &self.tissue,
            dof_map: &self.system.dof_map,
            boundary: self.boundary,
            constraints: self.system.constraints,
            loads: self.loads,
            displacement: cells.displacement,
            cells,
            pressure_count: pressures.map_or(0, |all| all.cells.pressure_count),
        }
    }
}

/// The relative residual of the solve, for elements with pressures or without.
pub(super) fn tolerance(materials: &[LinearElastic], has_pressures: bool) -> f64 {
    let moduli = materials.iter().map(|material| material.young_modulus());
    let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(a, b), e| (a.min(e), b.max(e)));
    let locks =
        !has_pressures && materials.iter().any(|material| material.poisson_ratio() > LOCKING);
    match (locks, most > CONTRAST * least) {
        (true, _) => TIGHTEST,
        (false, true) => TIGHTER,
        (false, false) => LOOSE,
    }
}

/// Factor of e.
pub(super) fn factor(has_pressures: bool) -> f64 {
    if has_pressures { MIXED_FACTOR } else { PLAIN_FACTOR }
}
