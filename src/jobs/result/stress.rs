//! Stress and strain of a result, as arrays of `volume.vtu` and in numbers by region.

use std::collections::BTreeMap;

use crate::schema::compare::result::StatDocument;
use crate::schema::predict::stress::{RegionStressDocument, StrainMeasure, StressDocument};
use mechanics::format::{ArrayValues, NamedValues, VolumeInLps};
use mechanics::mesh::Vector;
use mechanics::mesh::jacobian::signed_volume;
use mechanics::prediction::{CellState, Prediction, Scene, node_states};
use mechanics::validation::{Statistics, StatisticsError};

/// Stress of the cells of a mesh, and of its nodes from adjacent cells.
pub struct StressArrays {
    cells: Components,
    nodes: Components,
}

/// One entry for each cell or node.
struct Components {
    stress: Vec<[f64; 6]>,
    strain: Vec<[f64; 6]>,
    pressure: Vec<f64>,
    von_mises: Vec<f64>,
}

impl StressArrays {
    /// In the frame of the written mesh; none without stress.
    pub fn new(scene: &Scene, prediction: &Prediction, written: &VolumeInLps) -> Option<Self> {
        let states = &prediction.states.cells;
        let of = |states: &[CellState]| Components::new(states, written);
        let nodes = || of(&node_states(&scene.mesh, states));
        (!states.is_empty()).then(|| StressArrays { cells: of(states), nodes: nodes() })
    }

    pub fn of_cells(&self) -> [NamedValues<'_>; 4] {
        self.cells.arrays()
    }

    pub fn of_nodes(&self) -> [NamedValues<'_>; 4] {
        self.nodes.arrays()
    }
}

impl Components {
    fn new(states: &[CellState], written: &VolumeInLps) -> Self {
        let turned = |tensor: [f64; 6]| written.turned_tensor(tensor);
        Components {
            stress: states.iter().map(|state| turned(state.stress_components())).collect(),
            strain: states.iter().map(|state| turned(state.strain_components())).collect(),
            pressure: states.iter().map(CellState::pressure).collect(),
            von_mises: states.iter().map(CellState::von_mises).collect(),
        }
    }

    fn arrays(&self) -> [NamedValues<'_>; 4] {
        let named = |name, values| NamedValues { name, values };
        [
            named("stress_kpa", ArrayValues::Tensors(&self.stress)),
            named("strain", ArrayValues::Tensors(&self.strain)),
            named("pressure_kpa", ArrayValues::Reals(&self.pressure)),
            named("von_mises_kpa", ArrayValues::Reals(&self.von_mises)),
        ]
    }
}

/// The strain measure of a result.
pub fn strain_measure(prediction: &Prediction) -> StrainMeasure {
    match prediction.states.is_green {
        true => StrainMeasure::Green,
        false => StrainMeasure::Small,
    }
}

/// Stress by the regions of a case, weighted by the volumes of cells; none without stress.
pub fn stress_by_region(
    scene: &Scene,
    prediction: &Prediction,
) -> Result<Option<StressDocument>, StatisticsError> {
    if prediction.states.cells.is_empty() {
        return Ok(None);
    }
    let mut cells_of: BTreeMap<u16, Vec<usize>> = BTreeMap::new();
    for (cell, &region) in scene.region_of_cell.iter().enumerate() {
        cells_of.entry(region).or_default().push(cell);
    }
    let volume = |&cell: &usize| {
        let corners: Vec<Vector> = scene.mesh.corners(cell).collect();
        signed_volume(scene.mesh.cells.shape(cell), &corners)
    };
    let mut regions = BTreeMap::new();
    for (region, cells) in cells_of {
        let volumes: Vec<f64> = cells.iter().map(volume).collect();
        let over = |of: &dyn Fn(&CellState) -> f64| -> Result<StatDocument, StatisticsError> {
            let values: Vec<f64> =
                cells.iter().map(|&cell| of(&prediction.states.cells[cell])).collect();
            Ok((&Statistics::weighted(&values, &volumes)?).into())
        };
        let document = RegionStressDocument {
            von_mises_kpa: over(&CellState::von_mises)?,
            pressure_kpa: over(&CellState::pressure)?,
        };
        regions.insert(scene.regions[region as usize].clone(), document);
    }
    Ok(Some(StressDocument { strain: strain_measure(prediction), regions }))
}
