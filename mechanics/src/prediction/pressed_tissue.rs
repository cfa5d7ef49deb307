//! Tissue of linear elements that is pressed along itself, and may buckle, which small strain does not know.

use nalgebra::Matrix3;

use super::scene::Scene;
use crate::mesh::Warning;
use crate::model::cell_state::CellState;
use crate::model::fem::assembly::Tissue;
use crate::model::fem::finite_strain::{BUCKLES, PRESSED};
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::problem::ModelError;
use crate::progress::Progress;

pub(super) const MAY_BUCKLE: &str = "tissue-may-buckle";

/// Tissue counts as one that may buckle where it does under so many times the stress of the answer: what is not straight bends
/// before.
const TIMES: f64 = 1.5;

/// A warning where a linear answer would buckle. Asked where much of the energy of shear is in cells that are pressed as those of
/// tissue which buckles at finite strain.
pub(super) fn may_buckle(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
    progress: &dyn Progress,
) -> Result<Option<Warning>, ModelError> {
    let tissue = scene.tissue();
    let states = scene.cell_states(system, solved)?;
    let share = pressed_share(&tissue, &states);
    if share <= BUCKLES {
        return Ok(None);
    }
    let stress = |cell: usize| states[cell].stress * TIMES;
    if system.is_stable_under(&tissue, &stress, progress)? != Some(false) {
        return Ok(None);
    }
    let detail = format!(
        "under {TIMES} times the stress of this answer the tissue is not stable, and {:.0} % of its energy is in cells that are pressed: \
         it may buckle or crease, which small strain does not know; request `fem_nonlinear`",
        100.0 * share
    );
    Ok(Some(Warning::new(MAY_BUCKLE, detail).with("pressed_energy_share", share)))
}

/// The share of the energy of shear that is in pressed cells; zero without any.
fn pressed_share(tissue: &Tissue, states: &[CellState]) -> f64 {
    let (mut pressed, mut all) = (0.0, 0.0);
    for (cell, state) in states.iter().enumerate() {
        let mu = tissue.tensor(cell).mu;
        let shear = state.strain - Matrix3::identity() * (state.strain.trace() / 3.0);
        let energy = mu * shear.norm_squared() * tissue.mesh.cell_volume(cell);
        let is_pressed = state.stress.symmetric_eigenvalues().min() < -PRESSED * mu;
        all += energy;
        pressed += if is_pressed { energy } else { 0.0 };
    }
    if all > 0.0 { pressed / all } else { 0.0 }
}
