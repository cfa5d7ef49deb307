//! Two-level step with functions of edges: the coefficient of every edge by itself, and its effect on the equations of
//! the corners.

use rayon::prelude::*;

use super::edge_equations::{EdgeEquation, EdgeEquations};
use super::edge_functions::MAX_EDGES;
use super::edges::Edges;
use super::held_edges::HeldEdges;
use super::inner_modes::{Modes, NO_MODES};
use super::loads::DistributedLoads;
use super::sheet::{Sheet, SheetState};
use crate::boundary::Constraint;
use crate::element::MAX_NODES;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{CellShape, Vector};
use crate::model::dofs::DofMap;
use crate::model::fem::assembly::Tissue;
use crate::model::fem::linear_system::Residual;
use crate::model::problem::InvertedCell;

/// Forces on the corners of a cell, and the volumes of its pressures; zero where it has none.
pub(in crate::model::fem) type AtCorners = ([Vector; MAX_NODES], [f64; 4]);

/// The equations of the edges of a cell, and what its inner modes do; what is beyond its last edge or mode does not count.
#[derive(Clone)]
pub(in crate::model::fem) struct OfEdges {
    pub equations: [EdgeEquation; MAX_EDGES],
    pub modes: Modes,
}

impl OfEdges {
    const ZERO: OfEdges = OfEdges { equations: [EdgeEquation::ZERO; MAX_EDGES], modes: NO_MODES };
}

/// Coefficients of edges on one cell, and of its inner modes, in mm.
pub(in crate::model::fem) struct Coefficients {
    pub edges: [Vector; MAX_EDGES],
    pub modes: Modes,
}

/// Cells of an answer with functions on their edges.
pub(in crate::model::fem) trait EnrichedCells: Sync {
    /// Whether the answer is one of finite strain.
    fn is_finite(&self) -> bool;

    /// The numbers of the pressures of its corners, where a cell has any.
    fn pressure_numbers(&self, cell: usize) -> Option<[u32; 4]>;

    /// Writes r and D of each edge of a cell, and what its inner modes do.
    fn equations(&self, cell: usize, of_edges: &mut OfEdges) -> Result<(), InvertedCell>;

    /// Forces of coefficients on the corners of a cell.
    fn at_corners(&self, cell: usize, of: &Coefficients) -> Result<AtCorners, InvertedCell>;

    /// v . (K_i - K) v of a cell in mN mm (`inner_modes`), for v of all nodes.
    fn stiffening(&self, cell: usize, of_nodes: &[Vector]) -> Result<f64, InvertedCell>;
}

/// A step is not made longer or shorter by more than this. At finite strain it is not made longer: the tangent of pressed cells gives way
/// to modes more than finer cells do.
const LEAST_SHARE: f64 = 0.25;
const MOST_SHARE: f64 = 2.0;

/// An answer, and its cells with functions on their edges.
pub(in crate::model::fem) struct TwoLevel<'a, C> {
    pub tissue: &'a Tissue<'a>,
    pub dof_map: &'a DofMap,
    pub boundary: &'a [BoundaryFace],
    pub constraints: &'a [Constraint],
    pub loads: &'a DistributedLoads,
    /// Of the nodes, in mm.
    pub displacement: &'a [Vector],
    pub cells: &'a C,
    pub pressure_count: usize,
}

impl<C: EnrichedCells> TwoLevel<'_, C> {
    pub(super) fn edges(&self) -> Edges<'_> {
        Edges::new(self.tissue.mesh, self.dof_map)
    }

    /// The equations of the edges beside the answer; nothing acts on them but the answer.
    pub(super) fn equations(&self, edges: &Edges) -> Result<EdgeEquations, InvertedCell> {
        let mut equations = EdgeEquations::zeros(edges.count());
        if self.has_modes() {
            equations.modes = vec![NO_MODES; self.tissue.mesh.cells.len()];
        }
        edges.each_cell(
            OfEdges::ZERO,
            |cell, _, own| self.cells.equations(cell, own),
            |cell, numbers, own| {
                let pairs = numbers.numbers().zip(&own.equations);
                pairs.for_each(|(edge, own)| equations.add(edge, own));
                if let Some(modes) = equations.modes.get_mut(cell) {
                    *modes = own.modes;
                }
            },
        )?;
        if let Some(sheet) = self.sheet(edges, &equations) {
            sheet.add_equations(&mut equations);
        }
        Ok(equations)
    }

    /// b of every edge; what acts between the nodes is added to the equations.
    pub(super) fn steps(
        &self,
        edges: &Edges,
        equations: &mut EdgeEquations,
    ) -> Result<Vec<Vector>, InvertedCell> {
        let has_pressure = |cell: usize| self.cells.pressure_numbers(cell).is_some();
        self.loads.add_to(self.tissue, edges, &has_pressure, &mut equations.residual)?;
        let mesh = self.tissue.mesh;
        Ok(equations.steps(&HeldEdges::new(mesh, self.boundary, self.constraints, edges)))
    }

    /// The membrane, if there is one.
    fn sheet<'b>(&'b self, edges: &'b Edges<'b>, equations: &EdgeEquations) -> Option<Sheet<'b>> {
        let is_edge = |edge: usize| equations.stiffness[edge][(0, 0)] > 0.0;
        let (displacement, is_finite) = (self.displacement, self.cells.is_finite());
        let skin = self.tissue.membrane?;
        let moved = SheetState { displacement, is_finite };
        Some(Sheet::new((skin, self.tissue.mesh), moved, edges, is_edge))
    }

    /// Whether cells have inner modes.
    fn has_modes(&self) -> bool {
        self.tissue.mesh.cells.iter().any(|(shape, _)| shape != CellShape::Tet4)
    }

    /// The share of the step e of the nodes, K e = forces, that leaves least energy where cells have inner modes.
    pub fn share(&self, step: &[Vector], forces: &[Vector]) -> Result<f64, InvertedCell> {
        if !self.has_modes() {
            return Ok(1.0);
        }
        let own = (0..self.tissue.mesh.cells.len())
            .into_par_iter()
            .map(|cell| self.cells.stiffening(cell, step));
        let stiffening: f64 = own.collect::<Result<Vec<f64>, _>>()?.iter().sum();
        let work: f64 = step.iter().zip(forces).map(|(e, f)| e.dot(f)).sum();
        let is_minimum = work > 0.0 && work + stiffening > 0.0;
        let most = if self.cells.is_finite() { 1.0 } else { MOST_SHARE };
        let share = if is_minimum { work / (work + stiffening) } else { 1.0 };
        Ok(share.clamp(LEAST_SHARE, most))
    }

    /// Forces of the edge functions in the equations of the corners, and their squared energy norm in mN mm.
    pub fn at_corners(&self) -> Result<(Residual, f64), InvertedCell> {
        // 1. The equations of the edges, and b.
        let (mesh, cells, edges) = (self.tissue.mesh, self.cells, self.edges());
        let mut equations = self.equations(&edges)?;
        let steps = self.steps(&edges, &mut equations)?;
        let squared_energy_norm = equations.work(&steps);

        // 2. K_cb b, and what it is with pressures.
        let mut residual = Residual {
            forces: vec![Vector::zeros(); mesh.nodes.len()],
            volumes: vec![0.0; self.pressure_count],
        };
        edges.each_cell(
            ([Vector::zeros(); MAX_NODES], [0.0; 4]),
            |cell, numbers, at_corners| {
                let modes = equations.modes.get(cell).copied().unwrap_or(NO_MODES);
                let of = Coefficients { edges: numbers.gather(&steps), modes };
                *at_corners = cells.at_corners(cell, &of)?;
                Ok(())
            },
            |cell, _, (forces, volumes)| {
                for (&node, force) in mesh.cells.nodes(cell).iter().zip(forces) {
                    residual.forces[node as usize] -= force;
                }
                let numbered = cells.pressure_numbers(cell).into_iter().flatten();
                for (number, volume) in numbered.zip(volumes) {
                    residual.volumes[number as usize] -= volume;
                }
            },
        )?;
        if let Some(sheet) = self.sheet(&edges, &equations) {
            sheet.subtract_forces(&steps, &mut residual.forces);
        }
        Ok((residual, squared_energy_norm))
    }
}
