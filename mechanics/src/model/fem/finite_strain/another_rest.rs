//! Doubt that the rest which was found is the only one.
//!
//! A tangent that is not positive definite on the way is met wherever tissue is far from rest, and by itself says nothing of rest:
//! pulled bars meet it too, and have one rest. Tissue buckles and creases where it is pressed along itself. So it is also asked how
//! much of the energy at rest is in cells whose smallest principal Cauchy stress is below a tenth of their shear modulus: .12 at
//! most in bars of 100 x 10 x 10 mm held at their ends and pulled to 1.1 to 3 times their length, .5 and more in those that were
//! pressed by a tenth to a half and buckled (nu .3 and .45, tetrahedra and hexahedra).

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::problem::FiniteStrain;
use crate::material::hyperelastic::point::Point;
use crate::mesh::jacobian::signed_volume;
use crate::mesh::{Vector, Warning};
use crate::model::fem::strain::gradient_at_centre;
use crate::solver::NewtonReport;

/// The pressure along an axis from which on a cell is pressed, as a share of its shear modulus.
const PRESSED: f64 = 0.1;

/// The share of the energy that pressed cells have where tissue may buckle.
const BUCKLES: f64 = 0.2;

/// The warning of tissue that may rest in another way too, or whose rest is not stable.
pub(super) fn another_rest(
    problem: &FiniteStrain,
    displacement: &[Vector],
    newton: &NewtonReport,
) -> Option<Warning> {
    let is_unstable = newton.is_stable == Some(false);
    if newton.indefinite_steps == 0 && !is_unstable {
        return None;
    }
    let pressed = pressed_share(problem, displacement);
    if pressed <= BUCKLES && !is_unstable {
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
    let warning = Warning::new("another-equilibrium", detail);
    let warning = warning.with("indefinite_steps", newton.indefinite_steps as f64);
    let warning = warning.with("pressed_energy_share", pressed);
    Some(warning.with("energy_mn_mm", newton.energy))
}

/// The share of the energy that is in pressed cells, by the deformation at their centres.
fn pressed_share(problem: &FiniteStrain, displacement: &[Vector]) -> f64 {
    let shear_moduli: Vec<f64> = problem.laws.iter().map(|law| law.at_rest().1).collect();
    let energies = |cell: usize| {
        let number = problem.law_of_cell[cell];
        let grown = problem.inner.grown(cell);
        let f = Matrix3::identity() + gradient_at_centre(problem.mesh, displacement, cell);
        let f = f / grown.length;
        let along = problem.fibres.along(number, cell);
        let point = Point::new(&problem.laws[usize::from(number)], along, f);
        let point = point.pulled(problem.inner.pulls(cell));
        let cauchy = point.kirchhoff() / point.volume();
        let least = cauchy.symmetric_eigenvalues().min();
        let corners: Vec<Vector> = problem.mesh.corners(cell).collect();
        let volume = grown.volume * signed_volume(problem.mesh.cells.shape(cell), &corners);
        let energy = point.energy() * volume;
        let is_pressed = least < -PRESSED * shear_moduli[usize::from(number)];
        [if is_pressed { energy } else { 0.0 }, energy]
    };
    let cells = (0..problem.mesh.cells.len()).into_par_iter();
    let pairs: Vec<[f64; 2]> = cells.map(energies).collect();
    let [pressed, all] = pairs.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    if all > 0.0 { pressed / all } else { 0.0 }
}
