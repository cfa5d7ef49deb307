//! Tissue of linear elements that is pressed along itself, and may buckle, which small strain does not know.

use nalgebra::Matrix3;

use super::scene::Scene;
use crate::mesh::{Vector, Warning};
use crate::model::cell_state::CellState;
use crate::model::fem::assembly::Tissue;
use crate::model::fem::linear_system::LinearSystem;
use crate::model::problem::ModelError;
use crate::progress::Progress;
use crate::solver::SolverError;

pub(super) const MAY_BUCKLE: &str = "tissue-may-buckle";

/// The pressure along an axis from which on a cell is pressed, as a share of its shear modulus: under this a strut buckles that is
/// thirty times as long as thick.
const PRESSED: f64 = 0.01;

/// The share of the energy of shear in pressed cells from which on it is asked whether tissue buckles.
const ASKED: f64 = 0.2;

/// Tissue counts as one that may buckle where it does under so many times the stress of the answer: what is not straight bends
/// before.
const TIMES: f64 = 1.5;

/// A warning where a linear answer would buckle, under the stress that it has with its second order, so that tissue which only turns is
/// not pressed; `reached` has displacements in mm and pressures in kPa.
pub(super) fn may_buckle(
    scene: &Scene,
    system: &LinearSystem,
    reached: (&[Vector], &[f64]),
    progress: &dyn Progress,
) -> Result<Option<Warning>, ModelError> {
    let tissue = scene.tissue();
    let states = scene.cell_states_at_second_order(system, reached.0, reached.1);
    // Exponential laws leave the range of numbers where the second order strains tissue much.
    let states: Vec<Option<CellState>> =
        states.into_iter().map(|own| own.filter(is_finite)).collect();
    let share = pressed_share(&tissue, &states);
    if share <= ASKED {
        return Ok(None);
    }
    let stress = |cell: usize| states[cell].unwrap_or_default().stress * TIMES;
    match system.is_stable_under(&tissue, &stress, progress) {
        Ok(Some(false)) => {}
        Err(stopped @ ModelError::Solver(SolverError::Stopped)) => return Err(stopped),
        // An answer is not lost for a doubt.
        Ok(_) | Err(_) => return Ok(None),
    }
    let detail = format!(
        "under {TIMES} times the stress of this answer the tissue is not stable, and {:.0} % of its energy is in cells that are pressed: \
         it may buckle or crease, which small strain does not know; request `fem_nonlinear`",
        100.0 * share
    );
    Ok(Some(Warning::new(MAY_BUCKLE, detail).with("pressed_energy_share", share)))
}

fn is_finite(state: &CellState) -> bool {
    state.stress.iter().chain(&state.strain).all(|value| value.is_finite())
}

/// The share of the energy of shear that is in pressed cells; zero without any.
fn pressed_share(tissue: &Tissue, states: &[Option<CellState>]) -> f64 {
    let (mut pressed, mut all) = (0.0, 0.0);
    for (cell, state) in states.iter().enumerate() {
        let Some(CellState { stress, strain }) = state else { continue };
        let mu = tissue.tensor(cell).mu;
        let shear = strain - Matrix3::identity() * (strain.trace() / 3.0);
        let energy = mu * shear.norm_squared() * tissue.mesh.cell_volume(cell);
        let is_pressed = stress.symmetric_eigenvalues().min() < -PRESSED * mu;
        all += energy;
        pressed += if is_pressed { energy } else { 0.0 };
    }
    if all > 0.0 { pressed / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stress_that_is_no_number_does_not_count() {
        let state =
            |value: f64| CellState { stress: Matrix3::repeat(value), ..CellState::default() };
        let found = [1.0, f64::INFINITY, f64::NAN].map(|value| is_finite(&state(value)));
        assert_eq!(found, [true, false, false]);
    }
}
