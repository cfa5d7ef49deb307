//! Discretisation error of an answer: solved together with its estimate, or with the reason why there is none.

use super::method::Method;
use super::scene::Scene;
use crate::mesh::{Vector, Warning};
use crate::model::fem::contact::InContact;
use crate::model::fem::discretisation_error::{DiscretisationError, Estimate};
use crate::model::fem::finite_strain::{MeshError, NoMeshError};
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::fem::mass_tensor::Iterations;
use crate::model::problem::ModelError;
use crate::progress::Progress;
use crate::solver::SolverError;

/// The code of answers whose mesh is estimated to leave out much.
pub const NUMERICAL_ERROR_LARGE: &str = "numerical-error-large";

/// The mean over the skin above which an answer says how large its error is, in mm.
const LARGE_MM: f64 = 0.1;

/// An estimate of what the mesh cannot show.
#[derive(Clone, Debug, PartialEq)]
pub struct NumericalError {
    /// For each node what the displacement that was solved for lacks, in mm.
    pub missing: Vec<Vector>,
    /// Whether the displacement of the prediction has it added.
    pub is_added: bool,
}

impl From<DiscretisationError> for NumericalError {
    fn from(error: DiscretisationError) -> Self {
        NumericalError { missing: error.missing, is_added: false }
    }
}

/// An estimate, or why there is none.
pub type ErrorOrReason = Result<NumericalError, NotEstimated>;

/// Why there is no estimate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotEstimated {
    #[error("it was not asked for")]
    NotAsked,
    #[error(
        "there is no element of higher order that the error of quadratic tetrahedra could be estimated with"
    )]
    Quadratic,
    #[error(transparent)]
    AtRest(#[from] NoMeshError),
    #[error("springs have no limit that a finer mesh comes to")]
    Springs,
    #[error("the tissue was brought to rest node by node, and left no matrix to solve with")]
    NodeByNode,
    #[error("a volume spline is not a function of the mesh")]
    Spline,
    #[error("a warp solves no equation")]
    Warp,
    #[error("{0}")]
    Failed(String),
}

/// The estimate for an answer of linear elements.
pub(super) fn estimate(
    scene: &Scene,
    system: &LinearSystem,
    solved: &Solved,
    progress: &dyn Progress,
) -> Result<ErrorOrReason, ModelError> {
    Ok(known(of(scene, system).of(solved, progress))?.map(NumericalError::from))
}

/// The same where tissue presses on what it touches.
pub(super) fn estimate_in_contact(
    scene: &Scene,
    system: &LinearSystem,
    found: &mut InContact,
    progress: &dyn Progress,
) -> Result<ErrorOrReason, ModelError> {
    Ok(known(of(scene, system).in_contact(found, progress))?.map(NumericalError::from))
}

fn of<'a>(scene: &'a Scene, system: &'a LinearSystem<'a>) -> Estimate<'a> {
    let (boundary, loads) = (&scene.boundary, &scene.distributed);
    Estimate { tissue: scene.tissue(), system, boundary, loads }
}

/// An unknown error is no failure.
pub(super) fn known<T>(
    estimate: Result<T, ModelError>,
) -> Result<Result<T, NotEstimated>, ModelError> {
    match estimate {
        Ok(estimate) => Ok(Ok(estimate)),
        Err(stopped @ ModelError::Solver(SolverError::Stopped)) => Err(stopped),
        Err(other) => Ok(Err(NotEstimated::Failed(other.to_string()))),
    }
}

/// The estimate of an answer at finite strain.
pub(super) fn at_last_tangent(error: MeshError) -> ErrorOrReason {
    error.map(NumericalError::from).map_err(NotEstimated::AtRest)
}

/// Why a method has no estimate.
pub(super) fn reason_for_none(scene: &Scene) -> Option<NotEstimated> {
    if !scene.settings.estimate {
        return Some(NotEstimated::NotAsked);
    }
    match &scene.settings.method {
        Method::FemNonlinear if !scene.is_first_order() => Some(NotEstimated::Quadratic),
        Method::FemLinear | Method::FemNonlinear | Method::MassTensorNonlinear => None,
        Method::MassTensor(own) | Method::MassTensorTransverse(own) => match own.iterations {
            Iterations::Fast => None,
            Iterations::Stationary(_) => Some(NotEstimated::NodeByNode),
        },
        Method::MassSpring(_) => Some(NotEstimated::Springs),
        Method::VolumeSpline(_) => Some(NotEstimated::Spline),
        Method::ThicknessWarp(_) => Some(NotEstimated::Warp),
    }
}

/// What a reader must know: an error that is large, a correction that could not be made.
pub(super) fn warnings(scene: &Scene, error: &ErrorOrReason) -> Vec<Warning> {
    let why = match error {
        Ok(error) if error.is_added => None,
        Ok(_) => Some(
            "tissue presses on what it touches, and what opens or closes on a finer mesh is not known"
                .to_owned(),
        ),
        Err(reason) => Some(reason.to_string()),
    };
    let not_corrected = why.filter(|_| scene.settings.corrected).map(|why| {
        let detail = format!("the answer is not corrected for the error of its mesh: {why}");
        Warning::new("not-corrected", detail)
    });
    let large = error.as_ref().ok().and_then(|error| large(scene, error));
    [large, not_corrected].into_iter().flatten().collect()
}

fn large(scene: &Scene, error: &NumericalError) -> Option<Warning> {
    let mean = scene.skin.mean_length(&scene.skin.points(), &error.missing);
    let mut lengths = scene.skin.lengths(&error.missing);
    lengths.sort_by(f64::total_cmp);
    if mean.is_nan() || mean <= LARGE_MM {
        return None;
    }
    let at = |share: f64| lengths[((lengths.len() as f64 * share).ceil() as usize).max(1) - 1];
    let what = match error.is_added {
        true => "the mesh left out, and a correction has added,",
        false => "the mesh leaves out",
    };
    let detail = format!("{what} an estimated {mean:.2} mm in the mean over the skin");
    let warning = Warning::new(NUMERICAL_ERROR_LARGE, detail);
    Some(warning.with("mean_mm", mean).with("p95_mm", at(0.95)).with("max_mm", at(1.0)))
}
