//! The answer of a scene: its equilibrium, what the mesh leaves out of it, and what linearity does.

use super::nonlinearity::{self, Estimated, NonlinearityUnknown};
use super::numerical_error::{self, NotEstimated, NumericalError};
use super::scene::Scene;
use crate::model::problem::{Equilibrium, ModelError};
use crate::progress::Progress;

/// An equilibrium, and what it lacks.
pub(super) struct Answer {
    pub equilibrium: Equilibrium,
    pub numerical_error: Result<NumericalError, NotEstimated>,
    pub nonlinearity: Estimated,
}

/// Solves a scene by its method, and estimates what the answer leaves out where that is possible and asked for.
pub(super) fn solve(scene: &Scene, progress: &dyn Progress) -> Result<Answer, ModelError> {
    let of_mesh = numerical_error::reason_for_none(scene);
    let of_linearity = nonlinearity::reason_for_none(scene);
    let without = |of_mesh, of_linearity| -> Result<Answer, ModelError> {
        let equilibrium = scene.solve(progress)?;
        Ok(Answer { equilibrium, numerical_error: Err(of_mesh), nonlinearity: Err(of_linearity) })
    };
    if let (Some(of_mesh), Some(of_linearity)) = (&of_mesh, &of_linearity) {
        return without(of_mesh.clone(), of_linearity.clone());
    }
    let Some(system) = scene.assemble(progress)? else {
        return without(NotEstimated::Quadratic, NonlinearityUnknown::Quadratic);
    };
    let solved = system.solve(&[scene.load_case()], progress)?.remove(0);
    let numerical_error = match of_mesh {
        Some(reason) => Err(reason),
        None => numerical_error::estimate(scene, &system, &solved, progress)?,
    };
    let nonlinearity = match of_linearity {
        Some(reason) => Err(reason),
        None => nonlinearity::estimate(scene, &system, &solved, progress)?,
    };
    Ok(Answer { equilibrium: solved.equilibrium, numerical_error, nonlinearity })
}

impl Answer {
    /// Adds what the mesh leaves out to the displacement where that is asked for.
    pub(super) fn corrected(mut self, is_asked: bool) -> Self {
        if let (true, Ok(error)) = (is_asked, &mut self.numerical_error) {
            let displacement = self.equilibrium.displacement.iter_mut();
            displacement.zip(&error.missing).for_each(|(u, missing)| *u += missing);
            error.is_added = true;
        }
        self
    }
}
