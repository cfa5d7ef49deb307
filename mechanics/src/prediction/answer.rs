//! The answer of a scene: its equilibrium, what the mesh leaves out of it, and what linearity does.

use super::contact::{Touch, touch, touch_at_finite_strain};
use super::method::MethodKind;
use super::nonlinearity::{self, Estimated, NonlinearityUnknown};
use super::numerical_error::{self, NotEstimated, NumericalError};
use super::scene::Scene;
use crate::mesh::Vector;
use crate::model::fem::finite_strain::NoMeshError;
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::problem::{Equilibrium, ModelError};
use crate::progress::Progress;

/// An equilibrium, and what it lacks.
pub(super) struct Answer {
    pub equilibrium: Equilibrium,
    pub numerical_error: Result<NumericalError, NotEstimated>,
    pub nonlinearity: Estimated,
    /// What touches.
    pub contact: Option<Touch>,
}

/// What was solved of a scene, with linear elements of first order or otherwise.
pub(super) enum Linear<'a> {
    Solved(Box<LinearAnswer<'a>>),
    Other(Box<Answer>),
}

/// An answer of linear elements of first order, with the matrix that it was solved with.
pub(super) struct LinearAnswer<'a> {
    system: LinearSystem<'a>,
    solved: Solved,
    pub numerical_error: Result<NumericalError, NotEstimated>,
    pub nonlinearity: Estimated,
}

/// Solves a scene by its method, and estimates what the answer leaves out where that is possible and asked for.
pub(super) fn solve(scene: &Scene, progress: &dyn Progress) -> Result<Answer, ModelError> {
    Ok(match linear(scene, progress)? {
        Linear::Solved(answer) => answer.into_answer(scene)?,
        Linear::Other(answer) => *answer,
    })
}

/// The same, with the matrix where there is one.
pub(super) fn linear<'a>(
    scene: &'a Scene,
    progress: &dyn Progress,
) -> Result<Linear<'a>, ModelError> {
    let of_mesh = numerical_error::reason_for_none(scene);
    let of_linearity = nonlinearity::reason_for_none(scene);
    let without = |of_mesh, of_linearity| -> Result<Linear, ModelError> {
        let (numerical_error, nonlinearity) = (Err(of_mesh), Err(of_linearity));
        let (equilibrium, contact) = equilibrium(scene, progress)?;
        Ok(other(Answer { equilibrium, numerical_error, nonlinearity, contact }))
    };
    if let (Some(of_mesh), Some(of_linearity)) = (&of_mesh, &of_linearity) {
        return without(of_mesh.clone(), of_linearity.clone());
    }
    if let (None, Some(of_linearity)) = (&of_mesh, &of_linearity)
        && scene.settings.method.kind() == MethodKind::FemNonlinear
    {
        let (equilibrium, numerical_error) = at_finite_strain(scene, progress)?;
        let nonlinearity = Err(of_linearity.clone());
        let free = Answer { equilibrium, numerical_error, nonlinearity, contact: None };
        return Ok(other(free.touching_at_finite_strain(scene, progress)?));
    }
    let Some(system) = scene.assemble(progress)? else {
        return without(NotEstimated::Quadratic, NonlinearityUnknown::Quadratic);
    };
    let solved = system.solve(&[scene.load_case()], progress)?.remove(0);
    if let Some((equilibrium, contact)) = touch(scene, &system, &solved, progress)? {
        return Ok(other(Answer {
            equilibrium,
            numerical_error: Err(of_mesh.unwrap_or(NotEstimated::Contact)),
            nonlinearity: Err(of_linearity.unwrap_or(NonlinearityUnknown::Contact)),
            contact: Some(contact),
        }));
    }
    let numerical_error = match of_mesh {
        Some(reason) => Err(reason),
        None => numerical_error::estimate(scene, &system, &solved, progress)?,
    };
    let nonlinearity = match of_linearity {
        Some(reason) => Err(reason),
        None => nonlinearity::estimate(scene, &system, &solved, progress)?,
    };
    let answer = LinearAnswer { system, solved, numerical_error, nonlinearity };
    Ok(Linear::Solved(Box::new(answer)))
}

fn other<'a>(answer: Answer) -> Linear<'a> {
    Linear::Other(Box::new(answer))
}

/// The equilibrium of a scene by its method, and what touches, without estimates.
pub fn equilibrium(
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<(Equilibrium, Option<Touch>), ModelError> {
    if !scene.settings.contact.is_unilateral() {
        return Ok((scene.solve(progress)?, None));
    }
    if scene.settings.method.kind() == MethodKind::FemNonlinear {
        let free = scene.solve(progress)?;
        let found = touch_at_finite_strain(scene, &free, progress)?;
        return Ok(found.map_or((free, None), |(own, contact)| (own, Some(contact))));
    }
    // Quadratic elements and methods of other kinds are refused before.
    let Some(system) = scene.assemble(progress)? else { return Ok((scene.solve(progress)?, None)) };
    let solved = system.solve(&[scene.load_case()], progress)?.remove(0);
    let found = touch(scene, &system, &solved, progress)?;
    Ok(match found {
        Some((own, contact)) => (own, Some(contact)),
        None => (scene.stated(&system, solved)?, None),
    })
}

/// At finite strain the last tangent is at hand.
fn at_finite_strain(
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<(Equilibrium, Result<NumericalError, NotEstimated>), ModelError> {
    let (equilibrium, error) = scene.solve_at_finite_strain(true, progress)?;
    let error = error.unwrap_or(Err(NoMeshError::NotSolved));
    Ok((equilibrium, error.map(NumericalError::from).map_err(NotEstimated::AtRest)))
}

impl LinearAnswer<'_> {
    pub fn displacement(&self) -> &[Vector] {
        &self.solved.equilibrium.displacement
    }

    pub fn into_answer(self, scene: &Scene) -> Result<Answer, ModelError> {
        Ok(Answer {
            equilibrium: scene.stated(&self.system, self.solved)?,
            numerical_error: self.numerical_error,
            nonlinearity: self.nonlinearity,
            contact: None,
        })
    }

    /// The answer to second order, with what that leaves out; what the mesh leaves out is that of the first.
    pub fn to_second_order(
        &self,
        scene: &Scene,
        progress: &dyn Progress,
    ) -> Result<Answer, ModelError> {
        let (equilibrium, nonlinearity) =
            nonlinearity::to_second_order(scene, &self.system, &self.solved, progress)?;
        let numerical_error = self.numerical_error.clone();
        Ok(Answer { equilibrium, numerical_error, nonlinearity, contact: None })
    }
}

impl Answer {
    /// With contact where it closes and is asked for.
    fn touching_at_finite_strain(
        self,
        scene: &Scene,
        progress: &dyn Progress,
    ) -> Result<Self, ModelError> {
        let found = touch_at_finite_strain(scene, &self.equilibrium, progress)?;
        Ok(match found {
            Some((equilibrium, contact)) => Answer {
                equilibrium,
                numerical_error: self.numerical_error.and(Err(NotEstimated::Contact)),
                nonlinearity: self.nonlinearity,
                contact: Some(contact),
            },
            None => self,
        })
    }

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
