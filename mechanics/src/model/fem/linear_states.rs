//! Stress and strain of cells at small strain, as means over each cell.
//!
//! eps = (grad u + grad u^T) / 2, sigma = C : eps + S0 with the stress S0 of growth and of muscles (`inner_stress`). C and S0 are
//! constant in a cell, so that a mean dilatation (`cell_stiffness`) leaves the mean stress what it is. Tetrahedra with
//! pressures have sigma = (C - lambda' 1 x 1) : eps + S0 + p 1 with the mean p of their four pressures (`displacement_pressure`).
//! The means are those of the element: sum_cells V sigma grad N balances what acts, up to what varies within a cell.
//!
//! Source: Hughes, The finite element method, 1987, sections 2.7 and 4.4 (stress of displacement and of mixed elements).

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::assembly::Tissue;
use super::displacement_pressure::without_pressure_part;
use super::edge_nodes::EdgeNodes;
use super::inner_stress::{InnerStress, slopes, volume};
use crate::mesh::{Vector, VolumeMesh};
use crate::model::cell_state::CellState;
use crate::model::problem::InvertedCell;

/// Displacements, and what belongs to cells beside them.
#[derive(Clone, Copy)]
pub struct Displaced<'a> {
    /// In mm, of the nodes; of quadratic tetrahedra with those of edge nodes after them.
    pub displacement: &'a [Vector],
    pub edges: Option<&'a EdgeNodes>,
    /// For each cell the mean of its pressures p in kPa, tension positive, where it has any; empty where none has.
    pub pressures: &'a [Option<f64>],
}

/// The state of every cell, in cell order.
pub fn at_small_strain(
    tissue: &Tissue,
    inner: &InnerStress,
    displaced: &Displaced,
) -> Result<Vec<CellState>, InvertedCell> {
    let state = |cell: usize| {
        let gradient = mean_gradient(tissue.mesh, cell, displaced)?;
        let pressure = displaced.pressures.get(cell).copied().flatten();
        let tensor = tissue.tensor(cell);
        let tensor = if pressure.is_some() { without_pressure_part(tensor) } else { tensor };
        let inner = inner.stress(tissue, cell, pressure.is_some()).unwrap_or_default();
        let pressure = Matrix3::from_diagonal_element(pressure.unwrap_or(0.0));
        let strain = (gradient + gradient.transpose()) * 0.5;
        Ok(CellState { stress: tensor.stress(&strain) + inner + pressure, strain })
    };
    (0..tissue.mesh.cells.len()).into_par_iter().map(state).collect()
}

/// 1/V int grad u dV.
fn mean_gradient(
    mesh: &VolumeMesh,
    cell: usize,
    displaced: &Displaced,
) -> Result<Matrix3<f64>, InvertedCell> {
    let slopes = slopes(mesh, cell, displaced.edges)?.into_iter();
    let parts = slopes.map(|s| displaced.displacement[s.node as usize] * s.integral.transpose());
    Ok(parts.sum::<Matrix3<f64>>() / volume(mesh, cell)?)
}

/// For each node the mean of the cells around it, by their volumes at rest; zero at nodes of no cell. Where materials meet it is
/// a mean of both.
pub fn node_states(mesh: &VolumeMesh, cells: &[CellState]) -> Vec<CellState> {
    let mut sums = vec![(CellState::default(), 0.0); mesh.nodes.len()];
    for (cell, state) in cells.iter().enumerate() {
        let volume = mesh.cell_volume(cell);
        for &node in mesh.cells.nodes(cell) {
            let (sum, volumes) = &mut sums[node as usize];
            sum.stress += state.stress * volume;
            sum.strain += state.strain * volume;
            *volumes += volume;
        }
    }
    let mean = |(sum, volume): (CellState, f64)| match volume > 0.0 {
        true => CellState { stress: sum.stress / volume, strain: sum.strain / volume },
        false => CellState::default(),
    };
    sums.into_iter().map(mean).collect()
}
