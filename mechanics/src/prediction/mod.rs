//! The path of one prediction: scene in, nodal displacement and its measures out.

mod build;
pub mod case;
mod check;
mod cut;
mod element_choice;
mod fibres;
mod held;
mod hounsfield;
mod imaged_tissue;
mod listed;
mod method;
mod off_wall;
mod problem;
pub mod progress;
pub mod scene;
mod skin;
mod small_strain;
mod stiff_layer;

use std::collections::BTreeMap;

pub use case::{
    Bone, Case, CaseSegment, FibreDirection, Hounsfield, Load, Mixing, Plan, Prescribed,
    RegionNames, Settings, SkinMembrane, Sliding, SlidingNormal, TissueWindow,
};
pub use element_choice::ElementChoice;
pub use imaged_tissue::{ImagedTissue, TissueShare};
pub use method::{Method, MethodKind, MethodProperties, Unknowns};
pub use problem::{SceneError, SceneErrors};
pub use progress::{Phase, Progress, Unobserved};
pub use scene::Scene;
pub use skin::Skin;

pub use crate::boundary::NodeClass;
use crate::mesh::{Vector, Warning};
use crate::model::fem::strain::{CellDeformation, deformations};
use crate::model::problem::{Equilibrium, ModelError, Observer};
use crate::solver::SolverError;

/// A landmark farther than this from the tissue, in mm, is told to move as something it is not part of.
pub const LANDMARK_FAR: f64 = 2.0;

/// The answer. Node and cell order are those of the volume mesh of the case.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// In mm, for each node.
    pub displacement: Vec<Vector>,
    /// For each cell.
    pub deformation: Vec<CellDeformation>,
    /// In mN: what each segment, `fixed`, `sliding` and `prescribed` nodes exert on the tissue.
    pub reactions: BTreeMap<String, Vector>,
    /// The displacement of each landmark in mm.
    pub landmarks: BTreeMap<String, Vector>,
    pub solver: SolverReport,
    /// Those of the scene and those of the solution.
    pub warnings: Vec<Warning>,
}

/// How the equations were solved.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverReport {
    /// `cholesky`, `conjugate_gradient`, `conjugate_residual` with pressures, what the method's own iterations are
    /// called, or `none` where nothing moves.
    pub name: &'static str,
    pub preconditioner: &'static str,
    /// Why this solver was chosen.
    pub why: String,
    /// Free displacements and, with stabilised tetrahedra, pressures.
    pub unknowns: usize,
    pub iterations: usize,
    /// |f - K u| / |f_D| of the free rows, recomputed at the end; with pressures as `solver::mixed` says.
    pub relative_residual: f64,
    /// The relative residual after each iteration, of methods that have their own iterations to show.
    pub history: Vec<f64>,
    /// Steps of load or time.
    pub steps: u32,
    pub wanted_residual: f64,
    /// The elements used, e.g. `hex8 mean dilatation`.
    pub elements: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PredictionError {
    #[error("stopped on request")]
    Cancelled,
    #[error("residual {residual:.2e} after {iterations} iterations, wanted {wanted:.2e}")]
    NotConverged { iterations: usize, residual: f64, wanted: f64, history: Vec<f64> },
    #[error(
        "diverged: the residual grew {growth:.3} times an iteration, to {residual:.1e} after {iterations}"
    )]
    Diverged { iterations: usize, growth: f64, residual: f64, history: Vec<f64> },
    #[error("the matrix is singular at node {node}")]
    Singular { node: usize },
    #[error("cell {cell} is inverted or flat")]
    Inverted { cell: usize },
    #[error("the problem needs about {needed_mb:.0} MB and may take {allowed_mb:.0} MB")]
    OverBudget { needed_mb: f64, allowed_mb: f64 },
    #[error("the solution has values that are not finite")]
    NotFinite,
    #[error(
        "a step of {step_s:.3e} s grows without bound: explicit steps may take up to {limit_s:.3e} s"
    )]
    StepAboveLimit { step_s: f64, limit_s: f64 },
    #[error("no face of the tissue lies on bone: a warp has nothing to follow")]
    NoBone,
}

impl PredictionError {
    /// The stable word of the error catalogue.
    pub fn code(&self) -> &'static str {
        match self {
            PredictionError::Cancelled => "cancelled",
            PredictionError::NotConverged { .. }
            | PredictionError::Diverged { .. }
            | PredictionError::NotFinite => "solver-diverged",
            PredictionError::Singular { .. } => "matrix-singular",
            PredictionError::Inverted { .. } => "element-inverted",
            PredictionError::StepAboveLimit { .. } => "step-above-limit",
            PredictionError::NoBone => "no-bone",
            PredictionError::OverBudget { .. } => "budget-exceeded",
        }
    }
}

/// Solves a scene by the method it asks for. The same scene gives the same bits on any number of threads.
pub fn predict(scene: &Scene, progress: &dyn Progress) -> Result<Prediction, PredictionError> {
    // 1. Equilibrium.
    let wanted = scene.settings.relative_residual;
    let equilibrium = scene.solve(&Followed { progress, wanted })?;

    // 2. What it does to the tissue and to the landmarks.
    progress.phase(Phase::Surface);
    let deformation = deformations(&scene.mesh, &equilibrium.displacement);
    let landmarks =
        skin::landmark_displacement(&scene.mesh, &scene.landmarks, &equilibrium.displacement);

    // 3. What a reader must know.
    let mut warnings = scene.warnings.clone();
    warnings.extend(equilibrium.warnings.iter().cloned());
    warnings.extend(inverted_cells(&deformation));
    warnings.extend(small_strain::left(scene, &deformation));
    warnings.extend(off_wall::left_wall(scene, &equilibrium.displacement));
    warnings.extend(far_landmarks(&landmarks));
    Ok(Prediction {
        reactions: reactions(scene, &equilibrium),
        landmarks: landmarks.into_iter().map(|(name, (moved, _))| (name, moved)).collect(),
        solver: report(scene, &equilibrium),
        displacement: equilibrium.displacement,
        deformation,
        warnings,
    })
}

/// Passes the solver's words on to the progress of the work.
pub(crate) struct Followed<'a> {
    pub(crate) progress: &'a dyn Progress,
    pub(crate) wanted: f64,
}

impl Observer for Followed<'_> {
    fn assembling(&self) {
        self.progress.phase(Phase::Assemble);
    }

    fn solving(&self) {
        self.progress.phase(Phase::Solve);
    }

    fn iterated(&self, iteration: usize, relative_residual: f64) -> bool {
        self.progress.iteration(iteration, relative_residual, self.wanted);
        !self.progress.is_cancelled()
    }

    fn is_stopped(&self) -> bool {
        self.progress.is_cancelled()
    }
}

/// Sums the reactions of the nodes of each segment and of each other class.
fn reactions(scene: &Scene, equilibrium: &Equilibrium) -> BTreeMap<String, Vector> {
    let mut sums: BTreeMap<String, Vector> =
        scene.segments.iter().map(|segment| (segment.name.clone(), Vector::zeros())).collect();
    for (hold, reaction) in scene.conditions.holds.iter().zip(&equilibrium.reactions) {
        let holder = match scene.conditions.classes[hold.node as usize] {
            NodeClass::Joined(segment) => scene.segments[segment as usize].name.clone(),
            other => other.name().to_owned(),
        };
        *sums.entry(holder).or_insert_with(Vector::zeros) += reaction;
    }
    sums
}

pub(crate) fn report(scene: &Scene, equilibrium: &Equilibrium) -> SolverReport {
    let found = &equilibrium.convergence;
    SolverReport {
        name: found.method,
        preconditioner: found.preconditioner,
        why: found.why.clone(),
        unknowns: equilibrium.unknowns,
        iterations: found.iterations,
        relative_residual: found.relative_residual,
        history: found.history.clone(),
        steps: found.steps,
        wanted_residual: scene.settings.relative_residual,
        elements: scene.elements(),
    }
}

/// An answer that turns cells inside out says so.
pub(crate) fn inverted_cells(deformation: &[CellDeformation]) -> Option<Warning> {
    let inverted = deformation.iter().filter(|cell| cell.det_f <= 0.0).count();
    let smallest = deformation.iter().map(|cell| cell.det_f).fold(f64::INFINITY, f64::min);
    let detail = format!("the displacement turns {inverted} cells inside out");
    let warning = Warning::new("cells-inverted", detail)
        .with("cells", inverted as f64)
        .with("share", inverted as f64 / deformation.len().max(1) as f64);
    (inverted > 0).then(|| warning.with("smallest_det_f", smallest))
}

fn far_landmarks(landmarks: &BTreeMap<String, (Vector, f64)>) -> Vec<Warning> {
    let far = landmarks.iter().filter(|(_, (_, distance))| *distance > LANDMARK_FAR);
    far.map(|(name, (_, distance))| {
        let detail = format!(
            "landmark {name:?} takes the displacement of the closest point of the tissue surface"
        );
        Warning::new("landmark-far", detail).with("distance_mm", *distance)
    })
    .collect()
}

impl From<ModelError> for PredictionError {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::StepAboveLimit { step_s, limit_s } => {
                PredictionError::StepAboveLimit { step_s, limit_s }
            }
            ModelError::NoBone => PredictionError::NoBone,
            ModelError::Inverted(inverted) => PredictionError::Inverted { cell: inverted.cell },
            ModelError::Solver(SolverError::Stopped) => PredictionError::Cancelled,
            ModelError::Solver(SolverError::NotFinite) => PredictionError::NotFinite,
            ModelError::Solver(SolverError::NotPositiveDefinite { row }) => {
                PredictionError::Singular { node: row }
            }
            ModelError::Solver(SolverError::OverBudget { needed_mb, allowed_mb }) => {
                PredictionError::OverBudget { needed_mb, allowed_mb }
            }
            ModelError::Solver(SolverError::NotConverged {
                iterations,
                residual,
                wanted,
                history,
            }) => PredictionError::NotConverged { iterations, residual, wanted, history },
            ModelError::Solver(SolverError::Diverged { iterations, growth, residual, history }) => {
                PredictionError::Diverged { iterations, growth, residual, history }
            }
        }
    }
}
