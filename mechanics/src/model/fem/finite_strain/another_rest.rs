//! Doubt that the rest which was found is the only one.
//!
//! A tangent that is not positive definite on the way is met wherever tissue is far from rest, and by itself says nothing of rest:
//! pulled bars meet it too, and have one rest. Tissue buckles and creases where it is pressed along itself. So it is also asked how
//! much of the energy at rest is in cells whose smallest principal Cauchy stress is below a tenth of their shear modulus: .12 at
//! most in bars of 100 x 10 x 10 mm held at their ends and pulled to 1.1 to 3 times their length, .5 and more in those that were
//! pressed by a tenth to a half and buckled (nu .3 and .45, tetrahedra and hexahedra).

use super::problem::FiniteStrain;
use super::tissue::Deformed;
use crate::mesh::Warning;
use crate::model::cell_state::CellStates;
use crate::solver::NewtonReport;

pub const ANOTHER_EQUILIBRIUM: &str = "another-equilibrium";

/// The pressure along an axis from which on a cell is pressed, as a share of its shear modulus.
const PRESSED: f64 = 0.1;

/// The share of the energy that pressed cells have where tissue may buckle.
const BUCKLES: f64 = 0.2;

/// Whether the way to rest, or rest itself, gives reason to ask.
pub(super) fn is_doubtful(newton: &NewtonReport) -> bool {
    newton.indefinite_steps > 0 || newton.is_stable == Some(false)
}

/// The warning of tissue that may rest in another way too, or whose rest is not stable; `states` are those of its cells.
pub(super) fn another_rest(
    problem: &FiniteStrain,
    deformed: &Deformed,
    states: &CellStates,
    newton: &NewtonReport,
) -> Option<Warning> {
    let pressed = pressed_share(problem, deformed, states);
    if pressed <= BUCKLES && newton.is_stable != Some(false) {
        return None;
    }
    let state = match newton.is_stable {
        Some(false) => "the state that was found is not stable",
        Some(true) => "one of them was found, which is stable",
        None => "one of them was found, and whether it is stable is not known",
    };
    let detail = format!(
        "along {} of {} steps the tissue was not stable, and {:.0} % of its energy is in cells that are pressed: where tissue buckles \
         or creases it may rest in several ways, and {state}",
        newton.indefinite_steps,
        newton.path.len().saturating_sub(1),
        100.0 * pressed
    );
    let warning = Warning::new(ANOTHER_EQUILIBRIUM, detail);
    let warning = warning.with("indefinite_steps", newton.indefinite_steps as f64);
    let warning = warning.with("pressed_energy_share", pressed);
    Some(warning.with("energy_mn_mm", newton.energy))
}

/// The share of the energy that is in pressed cells, by their mean stress: that of the elements with their pressures, and without
/// the pull of muscles, which makes the whole negative.
fn pressed_share(problem: &FiniteStrain, deformed: &Deformed, states: &CellStates) -> f64 {
    let shear_moduli: Vec<f64> = problem.laws.iter().map(|law| law.at_rest().1).collect();
    let is_pressed = |cell: usize| {
        let least = states.cells[cell].stress.symmetric_eigenvalues().min();
        least < -PRESSED * shear_moduli[usize::from(problem.law_of_cell[cell])]
    };
    let (mut pressed, mut all) = (0.0, 0.0);
    for (cell, energy) in deformed.passive_energies() {
        all += energy;
        pressed += if is_pressed(cell) { energy } else { 0.0 };
    }
    if all > 0.0 { pressed / all } else { 0.0 }
}
