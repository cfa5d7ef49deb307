//! Doubt that a state at finite strain is the one that a finer mesh would have.
//!
//! The linear answer and the second order are the beginning of a series about rest. A state that lies farther from their sum than the
//! second order is large is not its limit, or the series has none: on the subject's face of the shared data, jaw 7 mm back and 8 mm
//! aside, Newton's method finds a stable state 1.4 mm in the mean from a second order of .4 mm, and another one with half the edges
//! (`a_state_that_the_second_order_does_not_lead_to_is_not_called_adequate`).

use super::following_pressure::has_pressure;
use super::nonlinearity::{second_order_of, without_second_order};
use super::scene::Scene;
use super::walls::rotation_beyond_second_order;
use crate::mesh::{Vector, Warning};
use crate::model::fem::finite_strain::ANOTHER_EQUILIBRIUM;
use crate::model::problem::{Equilibrium, ModelError};
use crate::progress::{Inner, Progress};
use crate::solver::SolverError;

/// How far a state is from the second order, in the mean in mm, before that is told of an answer for which nobody says which error is
/// accepted.
const TOLD_MM: f64 = 0.1;

/// The same as a multiple of the second order: ends of struts that turn by 30 degrees are 1.05 times that from it, where there is no
/// other equilibrium.
const TOLD_TIMES: f64 = 1.5;

/// Displacements of the nodes in mm: the linear answer, what the second order adds to it, and a state at finite strain.
pub(super) struct Branches<'a> {
    pub linear: &'a [Vector],
    pub second_order: &'a [Vector],
    pub found: &'a [Vector],
}

impl Branches<'_> {
    /// A warning where the state is farther from the second order than `accepted_mm`, and than so many times what that is from the linear
    /// answer; `mean` is the mean length of displacements over the skin, in mm.
    pub fn another(
        &self,
        accepted_mm: f64,
        times: f64,
        mean: impl Fn(&[Vector]) -> f64,
    ) -> Option<Warning> {
        let reached = self.linear.iter().zip(self.second_order);
        let ends = self.found.iter().zip(reached);
        let off: Vec<Vector> = ends.map(|(end, (first, second))| end - first - second).collect();
        let [off, second_order] = [mean(&off), mean(self.second_order)];
        if off <= times * second_order || off <= accepted_mm {
            return None;
        }
        let detail = format!(
            "at finite strain the skin ends {off:.2} mm in the mean from the second order of the movement, which is {second_order:.2} mm \
             from the linear solution: the tissue may come to another equilibrium, as it may on a finer mesh"
        );
        let warning = Warning::new(ANOTHER_EQUILIBRIUM, detail);
        let warning = warning.with("off_second_order_mm", off);
        Some(warning.with("second_order_mm", second_order))
    }
}

/// That warning of an answer at finite strain without contact, for which the linear answer is solved; none where that has no second order, or where
/// another doubt is told of already.
pub(super) fn another_branch(
    scene: &Scene,
    found: &Equilibrium,
    progress: &dyn Progress,
) -> Result<Option<Warning>, ModelError> {
    let is_told = found.warnings.iter().any(|warning| warning.code == ANOTHER_EQUILIBRIUM);
    let has_none = without_second_order(scene).is_some()
        || rotation_beyond_second_order(scene).is_some()
        || has_pressure(scene);
    if is_told || has_none {
        return Ok(None);
    }
    let [linear, second_order] = match second_order_of(scene, &Inner(progress)) {
        Ok(Some(both)) => both,
        Err(stopped @ ModelError::Solver(SolverError::Stopped)) => return Err(stopped),
        // Where linear elements have no answer, nothing is to be compared.
        Ok(None) | Err(_) => return Ok(None),
    };
    let moving = scene.skin.moving_points(&found.displacement);
    let (linear, second_order, found) = (&*linear, &*second_order, &*found.displacement);
    let mean = |values: &[Vector]| scene.skin.mean_length(&moving, values);
    Ok(Branches { linear, second_order, found }.another(TOLD_MM, TOLD_TIMES, mean))
}
