//! Doubt that a state at finite strain is the one that a finer mesh would have.
//!
//! The linear answer and the second order are the beginning of a series about rest. A state that lies farther from their sum than the
//! second order is large is not its limit, or the series has none: on the subject's face of the shared data, jaw 7 mm back and 8 mm
//! aside, Newton's method finds a stable state 1.4 mm in the mean from a second order of .4 mm, and another one with half the edges
//! (`a_state_that_the_second_order_does_not_lead_to_is_not_called_adequate`).

use super::accepted::Accepted;
use super::objection::Objection;
use crate::mesh::{Vector, Warning};
use crate::prediction::answer::{Answer, LinearAnswer};

/// What speaks against a state at finite strain; `mean` is the mean length of displacements over the skin, in mm.
pub(super) fn another_branch(
    linear: &LinearAnswer,
    found: &Answer,
    accepted: &Accepted,
    mean: impl Fn(&[Vector]) -> f64,
) -> Option<Objection> {
    let second_order = &linear.nonlinearity.as_ref().ok()?.left_out;
    let reached = linear.equilibrium().displacement.iter().zip(second_order);
    let ends = found.equilibrium.displacement.iter().zip(reached);
    let off: Vec<Vector> = ends.map(|(end, (first, second))| end - first - second).collect();
    let [off, second_order] = [mean(&off), mean(second_order)];
    let detail = format!(
        "at finite strain the skin ends {off:.2} mm in the mean from the second order of the movement, which is {second_order:.2} mm from \
         the linear solution: the tissue may come to another equilibrium, as it may on a finer mesh"
    );
    let warning = Warning::new("another-equilibrium", detail).with("off_second_order_mm", off);
    let warning = warning.with("second_order_mm", second_order);
    let is_off = off > second_order && off > accepted.skin_mm;
    is_off.then_some(Objection { warning, is_of_model: false })
}
