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
mod loads;
mod mean_stress;
mod points;
mod sheet;
mod simplex;

use super::assembly::Tissue;
use super::linear_system::{Correction, LinearSystem, Residual, Solved};
use crate::mesh::Vector;
use crate::mesh::volume::BoundaryFace;
use crate::model::problem::ModelError;
use crate::progress::{Phase, Progress};
use cell::Cells;
use edge_equations::{EdgeEquation, EdgeEquations};
use edge_functions::MAX_EDGES;
use edges::Edges;
use held_edges::HeldEdges;
use sheet::Sheet;

pub use indicators::{Goal, marked};
pub use loads::DistributedLoads;

/// Relative residual of the solve: the first digit of an estimate is all that it has.
const LOOSE: f64 = 0.1;

/// The same where the first iterations show little of the answer: where Young's modulus differs by more than this factor, or
/// volume changes resist much more than changes of shape.
const TIGHTER: f64 = 0.01;
const CONTRAST: f64 = 3.0;
const LOCKING: f64 = 0.495;

/// What e is multiplied by: without it e falls short by about this (docs/estimates.md).
const PLAIN_FACTOR: f64 = 1.2;
const MIXED_FACTOR: f64 = 1.3;

/// What an answer was made of.
pub struct Estimate<'a> {
    pub tissue: Tissue<'a>,
    pub system: &'a LinearSystem<'a>,
    /// The faces of the mesh that belong to one cell only.
    pub boundary: &'a [BoundaryFace],
    pub loads: &'a DistributedLoads,
}

/// What the mesh cannot show of an answer, as an estimate.
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
        let edges = Edges::new(self.tissue.mesh, &self.system.numbering);
        let cells = self.cells(&solved.equilibrium.displacement, &solved.pressures);
        let (residual, squared_energy_norm) = self.at_corners(&edges, &cells)?;
        let mut corrections = self.system.solve_for(&[residual], self.tolerance(), progress)?;
        let correction = corrections.remove(0);
        let factor = match self.system.pressures {
            Some(_) => MIXED_FACTOR,
            None => PLAIN_FACTOR,
        };
        let missing = correction.displacement.into_iter().map(|e| e * factor).collect();
        let iterations = correction.iterations;
        Ok(DiscretisationError { missing, squared_energy_norm, iterations })
    }

    fn tolerance(&self) -> f64 {
        let materials = self.tissue.materials;
        let moduli = materials.iter().map(|material| material.young_modulus());
        let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(a, b), e| (a.min(e), b.max(e)));
        let locks = self.system.pressures.is_none()
            && materials.iter().any(|material| material.poisson_ratio() > LOCKING);
        if most > CONTRAST * least || locks { TIGHTER } else { LOOSE }
    }

    fn cells<'b>(&'b self, displacement: &'b [Vector], pressures: &'b [f64]) -> Cells<'b> {
        Cells::new(&self.tissue, self.system, displacement, pressures)
    }

    /// The equations of the edges beside an answer; nothing acts on them but the answer.
    fn equations(&self, edges: &Edges, cells: &Cells) -> Result<EdgeEquations, ModelError> {
        let mut equations = EdgeEquations::zeros(edges.count());
        edges.each_cell(
            |cell| cells.equations(cell),
            |cell, own: [EdgeEquation; MAX_EDGES]| {
                let cell = edges.of_cell(cell);
                cell.numbers().iter().zip(&own).for_each(|(&edge, own)| equations.add(edge, own));
            },
        )?;
        if let Some(sheet) = self.sheet(edges, &equations) {
            sheet.add_equations(cells.displacement, &mut equations);
        }
        Ok(equations)
    }

    /// The membrane, if there is one.
    fn sheet<'b>(&'b self, edges: &'b Edges<'b>, equations: &EdgeEquations) -> Option<Sheet<'b>> {
        let is_edge = |edge: usize| equations.stiffness[edge][(0, 0)] > 0.0;
        self.tissue.membrane.map(|skin| Sheet::new(skin, self.tissue.mesh, edges, is_edge))
    }

    fn held_edges(&self, edges: &Edges) -> HeldEdges {
        HeldEdges::new(self.boundary, self.system.holds, self.tissue.mesh.nodes.len(), edges)
    }

    /// What the edge functions do to the equations of the corners, and their squared energy norm.
    fn at_corners(&self, edges: &Edges, cells: &Cells) -> Result<(Residual, f64), ModelError> {
        // 1. The equations of the edges, and b.
        let mut equations = self.equations(edges, cells)?;
        let mesh = self.tissue.mesh;
        self.loads.add_to(&self.tissue, edges, &mut equations.residual)?;
        let steps = equations.steps(&self.held_edges(edges));

        let squared_energy_norm = equations.work(&steps);

        // 2. K_cb b, and what it is with pressures.
        let count = self.system.pressures.as_ref().map_or(0, |all| all.cells.pressure_count);
        let mut residual =
            Residual { forces: vec![Vector::zeros(); mesh.nodes.len()], volumes: vec![0.0; count] };
        edges.each_cell(
            |cell| cells.at_corners(cell, &edges.of_cell(cell).gather(&steps)),
            |cell, (forces, volumes)| {
                for (&node, force) in mesh.cells.nodes(cell).iter().zip(forces) {
                    residual.forces[node as usize] -= force;
                }
                let numbered = cells.pressure_numbers(cell).iter().flatten();
                for (&number, volume) in numbered.zip(volumes) {
                    residual.volumes[number as usize] -= volume;
                }
            },
        )?;
        if let Some(sheet) = self.sheet(edges, &equations) {
            sheet.subtract_forces(&steps, &mut residual.forces);
        }
        Ok((residual, squared_energy_norm))
    }
}
