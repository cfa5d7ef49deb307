//! One row of a study: a scene made and solved, timed on one thread.
//!
//! Timed is the way from mesh in memory to displacement in memory: classes of nodes, assembly, setup of the
//! solver, solution. Whatever is found out about the answer afterwards is not.

use rayon::ThreadPool;

use super::Stopwatch;
use super::deadline::Deadline;
use crate::mesh::Vector;
use crate::model::fem::strain::deformations;
use crate::model::problem::{Equilibrium, ModelError};
use crate::prediction::{
    Case, Plan, Scene, SceneErrorCode, SceneErrors, Settings, equilibrium, inverted_cells,
};
use crate::progress::Progress;
use crate::solver::SolverError;

/// A row is not solved again once its solves took this long together, in s.
pub const LONG_S: f64 = 2.0;

/// What measures rows.
pub(super) struct Bench<'a> {
    /// Of one thread.
    pub pool: ThreadPool,
    pub repeats: usize,
    /// A solve that takes longer is given up, in s.
    pub row_s: f64,
    pub stopwatch: &'a dyn Stopwatch,
    pub progress: &'a dyn Progress,
}

/// What a method answered.
pub(super) struct Answer {
    /// In mm, at the nodes that were asked for.
    pub displacement: Vec<Vector>,
    pub elements: String,
    pub unknowns: usize,
    pub iterations: usize,
    pub wall_s: f64,
    pub repeats: usize,
    pub peak_mb: Option<f64>,
    pub smallest_det_f: f64,
    /// Codes.
    pub warnings: Vec<String>,
}

/// Why there is no answer, or no truth: a stable word, and the sentence with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Refusal {
    pub code: String,
    pub detail: String,
}

/// Why a row has no numbers.
pub(super) enum NoAnswer {
    /// The caller wants no more.
    Cancelled,
    Refused(Refusal),
    /// The method or its element does not serve this scene: the sentence that says so.
    Unserved(String),
    /// It took longer than a row may.
    Late(Refusal),
}

impl Refusal {
    pub(super) fn new(code: &str, detail: impl Into<String>) -> Self {
        Refusal { code: code.to_owned(), detail: detail.into() }
    }
}

impl From<&SceneErrors> for Refusal {
    fn from(errors: &SceneErrors) -> Self {
        let code = errors.0.first().map_or("refused", |error| error.code.name());
        Refusal::new(code, errors.to_string())
    }
}

impl From<Refusal> for NoAnswer {
    fn from(refusal: Refusal) -> Self {
        NoAnswer::Refused(refusal)
    }
}

impl From<SceneErrors> for NoAnswer {
    fn from(errors: SceneErrors) -> Self {
        let unserved = |code| code == SceneErrorCode::MethodNotAvailable;
        match errors.0.iter().find(|error| unserved(error.code)) {
            Some(error) => NoAnswer::Unserved(error.detail.clone()),
            None => NoAnswer::Refused(Refusal::from(&errors)),
        }
    }
}

impl From<ModelError> for NoAnswer {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Solver(SolverError::Stopped) => NoAnswer::Cancelled,
            other => NoAnswer::Refused(Refusal::new(other.code(), other.to_string())),
        }
    }
}

/// Makes the scene and solves it on this thread and those of its pool.
pub(super) fn solve(
    case: &Case,
    plan: &Plan,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<(Scene, Equilibrium), NoAnswer> {
    let scene = Scene::new(case, plan, settings)?;
    let (equilibrium, _) = equilibrium(&scene, progress)?;
    Ok((scene, equilibrium))
}

impl Bench<'_> {
    /// Solves as often as is asked for and keeps the answer at some nodes.
    pub(super) fn answer(
        &self,
        case: &Case,
        plan: &Plan,
        settings: &Settings,
        nodes: &[u32],
    ) -> Result<Answer, NoAnswer> {
        let mut times: Vec<f64> = Vec::new();
        let mut peak_mb = None;
        self.stopwatch.forget_peak();
        let (scene, equilibrium) = loop {
            let begin = self.stopwatch.seconds();
            let deadline = Deadline::after(self.row_s, self.stopwatch, self.progress);
            let solved = self.pool.install(|| solve(case, plan, settings, &deadline));
            let solved = solved.map_err(|why| self.too_late(why))?;
            times.push(self.stopwatch.seconds() - begin);
            if times.len() == 1 {
                peak_mb = self.stopwatch.peak_mb();
            }
            if times.len() >= self.repeats || times.iter().sum::<f64>() > LONG_S {
                break solved;
            }
        };
        check_sane(&scene, &equilibrium.displacement)?;
        let deformation = deformations(&scene.mesh, &equilibrium.displacement);
        let mut warnings: Vec<String> = scene
            .warnings
            .iter()
            .chain(&equilibrium.warnings)
            .chain(&inverted_cells(&deformation))
            .chain(&scene.nothing_moves())
            .map(|warning| warning.code.to_owned())
            .collect();
        warnings.sort_unstable();
        warnings.dedup();
        Ok(Answer {
            displacement: nodes.iter().map(|&n| equilibrium.displacement[n as usize]).collect(),
            elements: scene.elements().join(", "),
            unknowns: equilibrium.solver.unknowns,
            iterations: equilibrium.solver.iterations,
            repeats: times.len(),
            wall_s: median(times),
            peak_mb,
            smallest_det_f: deformation.iter().map(|c| c.det_f).fold(f64::INFINITY, f64::min),
            warnings,
        })
    }

    /// What was stopped, and not by the caller, has taken too long.
    fn too_late(&self, why: NoAnswer) -> NoAnswer {
        match why {
            NoAnswer::Cancelled if !self.progress.is_cancelled() => {
                let detail = format!("not solved after {} s", self.row_s);
                NoAnswer::Late(Refusal::new("budget-exceeded", detail))
            }
            other => other,
        }
    }
}

/// Refuses displacements that are not numbers, and those that are larger than the tissue is.
fn check_sane(scene: &Scene, displacement: &[Vector]) -> Result<(), NoAnswer> {
    let nodes = &scene.mesh.nodes;
    let first = nodes.first().copied().unwrap_or_else(Vector::zeros);
    let (low, high) = nodes.iter().fold((first, first), |(l, h), x| (l.inf(x), h.sup(x)));
    let diagonal = (high - low).norm();
    let largest = displacement
        .iter()
        .map(|u| u.norm())
        .fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) });
    if !displacement.iter().flatten().all(|value| value.is_finite()) {
        return Err(ModelError::from(SolverError::NotFinite).into());
    }
    if largest > diagonal {
        let detail = format!(
            "the answer moves a node by {largest:.3e} mm, and the tissue is {diagonal:.3e} mm across"
        );
        return Err(Refusal::new("answer-absurd", detail).into());
    }
    Ok(())
}

/// The smallest time that at least half of them do not exceed.
fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[(times.len() - 1) / 2]
}
