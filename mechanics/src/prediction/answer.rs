//! Solution of a scene: its equilibrium, its discretisation error and its linearisation error.

use super::branch::another_branch;
use super::contact::{
    InTouch, Touch, expected_touch_at_finite_strain, facing_surfaces, touch, touch_at_finite_strain,
};
use super::following_pressure::{has_pressure, pressed_in_solution};
use super::method::MethodKind;
use super::nonlinearity::{self, Estimated, NonlinearityUnknown};
use super::numerical_error::{self, NotEstimated, NumericalError};
use super::scene::Scene;
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::problem::{Equilibrium, ModelError};
use crate::progress::Progress;

/// An equilibrium, and what it lacks.
pub(super) struct Answer {
    pub equilibrium: Equilibrium,
    pub numerical_error: Result<NumericalError, NotEstimated>,
    pub nonlinearity: Estimated,
    /// Contact.
    pub contact: Option<Touch>,
}

/// Solution of a scene, with linear elements of first order or otherwise.
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
    let mut answer = solve_without_doubt(scene, progress)?;
    let is_at_finite_strain = scene.settings.method.kind() == MethodKind::FemNonlinear;
    if is_at_finite_strain && scene.settings.estimate && answer.contact.is_none() {
        let doubt = another_branch(scene, &answer.equilibrium, progress)?;
        answer.equilibrium.warnings.extend(doubt);
    }
    Ok(answer)
}

/// The same, where whether there are other states at finite strain is not asked.
pub(super) fn solve_without_doubt(
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<Answer, ModelError> {
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
    answered(scene, Unknown::asked(scene), progress)
}

/// The equilibrium of a scene by its method, and what touches, without estimates.
pub fn equilibrium(
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<(Equilibrium, Option<Touch>), ModelError> {
    let Answer { equilibrium, contact, .. } = match answered(scene, Unknown::not_asked(), progress)?
    {
        Linear::Solved(answer) => answer.into_answer(scene)?,
        Linear::Other(answer) => *answer,
    };
    Ok((equilibrium, contact))
}

/// What the mesh and what linearity leave out of the answer of a scene, which is solved for that; why not, where that is known
/// before.
pub fn estimates(
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<(Result<NumericalError, NotEstimated>, Estimated), ModelError> {
    let unknown = Unknown { with_doubt: false, ..Unknown::asked(scene) };
    if let (Some(of_mesh), Some(of_linearity)) = (&unknown.of_mesh, &unknown.of_linearity) {
        return Ok((Err(of_mesh.clone()), Err(of_linearity.clone())));
    }
    Ok(match answered(scene, unknown, progress)? {
        Linear::Solved(answer) => (answer.numerical_error, answer.nonlinearity),
        Linear::Other(answer) => (answer.numerical_error, answer.nonlinearity),
    })
}

/// Why what a mesh and what linearity leaves out is not estimated; nothing where it is.
struct Unknown {
    of_mesh: Option<NotEstimated>,
    of_linearity: Option<NonlinearityUnknown>,
    /// Whether a linear answer with an estimate is also asked whether its tissue may buckle.
    with_doubt: bool,
}

impl Unknown {
    fn asked(scene: &Scene) -> Self {
        let of_mesh = numerical_error::reason_for_none(scene);
        let of_linearity = nonlinearity::reason_for_none(scene);
        Unknown { of_mesh, of_linearity, with_doubt: true }
    }

    fn not_asked() -> Self {
        let (of_mesh, of_linearity) = (NotEstimated::NotAsked, NonlinearityUnknown::NotAsked);
        Unknown { of_mesh: Some(of_mesh), of_linearity: Some(of_linearity), with_doubt: false }
    }
}

fn answered<'a>(
    scene: &'a Scene,
    unknown: Unknown,
    progress: &dyn Progress,
) -> Result<Linear<'a>, ModelError> {
    if scene.settings.method.kind() == MethodKind::FemNonlinear {
        let displacement = |scene: &Scene| {
            let found = at_finite_strain(scene, Unknown::not_asked(), progress)?;
            Ok(found.equilibrium.displacement)
        };
        let (pressed, unsettled) = pressed_in_solution(scene, displacement)?;
        let mut answer = at_finite_strain(&pressed, unknown, progress)?;
        answer.equilibrium.warnings.extend(unsettled);
        if has_pressure(scene) {
            // The tangent that was tested leaves out how pressure turns with its faces.
            let newton = answer.equilibrium.solver.newton.iter_mut();
            newton.for_each(|newton| newton.is_stable = newton.is_stable.filter(|stable| !stable));
        }
        return Ok(other(answer));
    }
    if scene.settings.method.kind() == MethodKind::MassTensorNonlinear {
        return Ok(other(by_nonlinear_mass_tensors(scene, unknown, progress)?));
    }
    let Unknown { of_mesh, of_linearity, with_doubt } = unknown;
    let is_without = of_mesh.is_some() && of_linearity.is_some();
    // With contact quadratic elements and methods of other kinds are refused before.
    let system = match is_without && !scene.settings.contact.is_unilateral() {
        true => None,
        false => scene.assemble(progress)?,
    };
    let Some(system) = system else {
        return Ok(other(Answer {
            equilibrium: scene.solve(progress)?,
            numerical_error: Err(of_mesh.unwrap_or(NotEstimated::Quadratic)),
            nonlinearity: Err(of_linearity.unwrap_or(NonlinearityUnknown::Quadratic)),
            contact: None,
        }));
    };
    let mut solved = system.solve(&[scene.load_case()], progress)?.remove(0);
    let touched = touch(scene, &system, &solved, of_mesh.is_none(), progress)?;
    let in_contact = touched.as_ref().and_then(|touched| touched.numerical_error.clone());
    let numerical_error = match (of_mesh, in_contact) {
        (Some(reason), _) => Err(reason),
        (None, Some(known)) => known,
        (None, None) => numerical_error::estimate(scene, &system, &solved, progress)?,
    };
    if let Some(InTouch { equilibrium, touch, .. }) = touched {
        let nonlinearity = Err(of_linearity.unwrap_or(NonlinearityUnknown::Contact));
        let contact = Some(touch);
        return Ok(other(Answer { equilibrium, numerical_error, nonlinearity, contact }));
    }
    let (nonlinearity, doubt) = match of_linearity {
        Some(reason) => (Err(reason), None),
        None => nonlinearity::estimate(scene, &system, &solved, with_doubt, progress)?,
    };
    solved.equilibrium.warnings.extend(doubt);
    let answer = LinearAnswer { system, solved, numerical_error, nonlinearity };
    Ok(Linear::Solved(Box::new(answer)))
}

fn other<'a>(answer: Answer) -> Linear<'a> {
    Linear::Other(Box::new(answer))
}

/// At finite strain, where the last tangent is at hand; with contact where it closes and is asked for.
fn at_finite_strain(
    scene: &Scene,
    unknown: Unknown,
    progress: &dyn Progress,
) -> Result<Answer, ModelError> {
    let with_error = unknown.of_mesh.is_none();
    let surfaces = facing_surfaces(scene);
    let expected = match &surfaces {
        Some(surfaces) => expected_touch_at_finite_strain(scene, surfaces, with_error, progress)?,
        None => None,
    };
    let in_touch = |found: InTouch| (found.equilibrium, found.numerical_error, Some(found.touch));
    let (equilibrium, known, contact) = match expected {
        Some(found) => in_touch(found),
        None => {
            let (free, error) = scene.solve_at_finite_strain(with_error, progress)?;
            let touched = match &surfaces {
                Some(own) => touch_at_finite_strain(scene, own, &free, with_error, progress)?,
                None => None,
            };
            let error = error.map(numerical_error::at_last_tangent);
            match touched.map(in_touch) {
                Some((found, known, touch)) => (found, known.or(error), touch),
                None => (free, error, None),
            }
        }
    };
    let not_asked = unknown.of_mesh.unwrap_or(NotEstimated::NotAsked);
    Ok(Answer {
        equilibrium,
        numerical_error: known.unwrap_or(Err(not_asked)),
        nonlinearity: Err(unknown.of_linearity.unwrap_or(NonlinearityUnknown::NotAsked)),
        contact,
    })
}

/// By the nonlinear mass-tensor, whose tissue is that of plain tetrahedra at finite strain.
fn by_nonlinear_mass_tensors(
    scene: &Scene,
    unknown: Unknown,
    progress: &dyn Progress,
) -> Result<Answer, ModelError> {
    let equilibrium = scene.solve(progress)?;
    let numerical_error = match unknown.of_mesh {
        Some(reason) => Err(reason),
        None => {
            let found = scene.mesh_error_of_mass_tensors(&equilibrium.displacement, progress);
            numerical_error::known(found)?.and_then(numerical_error::at_last_tangent)
        }
    };
    let nonlinearity = Err(unknown.of_linearity.unwrap_or(NonlinearityUnknown::NotAsked));
    Ok(Answer { equilibrium, numerical_error, nonlinearity, contact: None })
}

impl LinearAnswer<'_> {
    pub fn equilibrium(&self) -> &Equilibrium {
        &self.solved.equilibrium
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
    /// Adds what the mesh leaves out to the displacement where that is asked for. Not in contact: what opens or closes on a finer
    /// mesh is not known, and parts would pass each other.
    pub(super) fn corrected(mut self, is_asked: bool) -> Self {
        let is_added = is_asked && self.contact.is_none();
        if let (true, Ok(error)) = (is_added, &mut self.numerical_error) {
            let displacement = self.equilibrium.displacement.iter_mut();
            displacement.zip(&error.missing).for_each(|(u, missing)| *u += missing);
            error.is_added = true;
        }
        self
    }
}
