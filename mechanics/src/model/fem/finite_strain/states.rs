//! Stress and strain of the cells of tissue at rest at finite strain, with the pressures and mean dilatations of its elements.

use super::tissue::Deformed;
use crate::mesh::VolumeMesh;
use crate::model::cell_state::{CellState, CellStates};
use crate::model::fem::inner_stress::InnerStress;
use crate::model::fem::law_states::CellSums;

/// The state of every cell, in cell order.
pub(super) fn cell_states(
    mesh: &VolumeMesh,
    inner: &InnerStress,
    deformed: &Deformed,
) -> CellStates {
    let mut states = vec![CellState::default(); mesh.cells.len()];
    for (number, cell) in deformed.tissue.cells_of_simplices().enumerate() {
        let (at_rest, point) = deformed.simplices.at_cell(number);
        let mut sums = CellSums::default();
        sums.add(point, at_rest.volume);
        states[cell] = sums.means(&inner.grown(cell));
    }
    for cell in deformed.tissue.cells_of_bricks() {
        let brick = deformed.bricks.at_cell(cell);
        let mut sums = CellSums::default();
        let points = brick.at_rest.iter().zip(brick.points);
        points.for_each(|(at_rest, point)| sums.add(point, at_rest.volume));
        states[cell] = sums.means(&inner.grown(cell));
    }
    CellStates { cells: states, is_green: true }
}
