//! One row of a study: a scene made and solved, timed on one thread.
//!
//! Timed is the way from mesh in memory to displacement in memory: classes of nodes, assembly, setup of the
//! solver, solution. Whatever is found out about the answer afterwards is not.

use rayon::ThreadPool;

use super::Stopwatch;
use super::deadline::Deadline;
use super::estimated::Estimates;
use super::variant::{Strain, Variant};
use crate::mesh::{CellShape, Vector, Warning, bounds_of};
use crate::model::fem::strain::{determinants, inverted_cells};
use crate::model::problem::{Equilibrium, ModelError};
use crate::prediction::{
    Accepted, Adequate, Case, ElementChoice, NoScene, Plan, Scene, SceneErrorCode, SceneErrors,
    Settings, TimedProgress, equilibrium, estimates, predict_adequately,
};
use crate::progress::{Progress, StopQuery};
use crate::solver::SolverError;

/// A row is not solved again once its solves took this long together, in s.
pub const LONG_S: f64 = 2.0;

/// Measurement of rows.
pub(super) struct Bench<'a> {
    /// Of one thread.
    pub pool: ThreadPool,
    pub repeats: usize,
    /// A solve that takes longer is given up, in s.
    pub row_s: f64,
    pub stopwatch: &'a dyn Stopwatch,
    pub progress: &'a dyn Progress,
}

/// Answer of a method.
pub(super) struct Answer {
    /// In mm, at the nodes that were asked for.
    pub displacement: Vec<Vector>,
    pub estimates: Estimates,
    pub strain: Strain,
    pub elements: String,
    pub unknowns: usize,
    pub iterations: usize,
    pub time: Time,
    pub smallest_det_f: f64,
    /// The model, where it was chosen by its error.
    pub chosen: Option<String>,
    /// Codes.
    pub warnings: Vec<String>,
}

impl Answer {
    /// With what is told of points that the mesh of a level keeps.
    pub(super) fn told(mut self, level: u32, points: &Option<Warning>) -> Answer {
        let code = points.iter().filter(|_| level > 0).map(|warning| warning.code.to_owned());
        self.warnings.extend(code);
        Answer { warnings: distinct(self.warnings), ..self }
    }
}

/// Cost of the solution.
pub(super) struct Time {
    /// Median of the repeats.
    pub wall_s: f64,
    pub repeats: usize,
    pub peak_mb: Option<f64>,
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

impl From<NoScene> for NoAnswer {
    fn from(none: NoScene) -> Self {
        match none {
            NoScene::Refused(errors) => errors.into(),
            NoScene::Stopped => NoAnswer::Cancelled,
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
    let scene = Scene::unless_stopped(case, plan, settings, &StopQuery::of(progress))?;
    let (equilibrium, _) = equilibrium(&scene, progress)?;
    Ok((scene, equilibrium))
}

impl Bench<'_> {
    /// Solves as often as is asked for and keeps the answer at some nodes.
    pub(super) fn answer(
        &self,
        case: &Case,
        plan: &Plan,
        variant: &Variant,
        nodes: &[u32],
    ) -> Result<Answer, NoAnswer> {
        match &variant.accepted {
            Some(accepted) => self.chosen(case, plan, (variant, accepted), nodes),
            None => self.solved(case, plan, &variant.settings, nodes),
        }
    }

    fn solved(
        &self,
        case: &Case,
        plan: &Plan,
        settings: &Settings,
        nodes: &[u32],
    ) -> Result<Answer, NoAnswer> {
        let ((scene, equilibrium), time) =
            self.timed(|deadline| solve(case, plan, settings, deadline))?;
        check_sane(&scene, &equilibrium.displacement)?;
        let determinants = determinants(&scene.mesh, &equilibrium.displacement);
        let warnings = scene
            .warnings
            .iter()
            .chain(&equilibrium.warnings)
            .chain(&inverted_cells(&determinants))
            .chain(&scene.nothing_moves())
            .map(|warning| warning.code.to_owned())
            .collect();
        let displacement = at(nodes, &equilibrium.displacement);
        Ok(Answer {
            estimates: self.estimates(&scene, nodes)?,
            strain: Strain::of(settings.method.kind()),
            displacement,
            elements: scene.elements().join(", "),
            unknowns: equilibrium.solver.unknowns,
            iterations: equilibrium.solver.iterations,
            smallest_det_f: determinants.into_iter().fold(f64::INFINITY, f64::min),
            chosen: None,
            warnings: distinct(warnings),
            time,
        })
    }

    /// By the cheapest model whose estimated error is accepted; timed is the way to it, with its estimates.
    fn chosen(
        &self,
        case: &Case,
        plan: &Plan,
        (variant, accepted): (&Variant, &Accepted),
        nodes: &[u32],
    ) -> Result<Answer, NoAnswer> {
        let accepted = Accepted { time_s: self.row_s, ..accepted.clone() };
        let stopwatch = || self.stopwatch.seconds();
        let ((linear, adequate), time) = self.timed(|progress| {
            let stop = StopQuery::of(progress);
            let scene = Scene::unless_stopped(case, plan, &variant.settings, &stop)?;
            let watched = TimedProgress { stopwatch: &stopwatch, progress };
            let adequate = predict_adequately(case, plan, &scene, &accepted, watched)?;
            Ok((scene, adequate))
        })?;
        let Adequate { prediction, scene, rung, considered, .. } = adequate;
        let scene = scene.as_ref().unwrap_or(&linear);
        check_sane(scene, &prediction.displacement)?;
        let taken = considered.iter().find(|considered| considered.rung == rung);
        let expected = taken.and_then(|taken| taken.error.as_ref()).map(|error| error.skin_mm);
        let mesh = prediction.numerical_error.as_ref().ok();
        let linearity = prediction.nonlinearity.as_ref().ok();
        let deformation = prediction.deformation.iter();
        let warnings = prediction.warnings.iter().map(|warning| warning.code.to_owned());
        Ok(Answer {
            displacement: at(nodes, &prediction.displacement),
            estimates: Estimates {
                mesh: mesh.map(|error| at(nodes, &error.missing)),
                linearity: linearity.map(|left| at(nodes, &left.left_out)),
                of_moving: expected,
            },
            strain: Strain::of_rung(rung),
            elements: prediction.elements.join(", "),
            unknowns: prediction.solver.unknowns,
            iterations: prediction.solver.iterations,
            smallest_det_f: deformation.map(|c| c.det_f).fold(f64::INFINITY, f64::min),
            chosen: Some(rung.name().to_owned()),
            warnings: distinct(warnings.collect()),
            time,
        })
    }

    /// What a work takes: as often as is asked for, or until it took long.
    fn timed<T: Send>(
        &self,
        work: impl Fn(&dyn Progress) -> Result<T, NoAnswer> + Sync,
    ) -> Result<(T, Time), NoAnswer> {
        let mut times: Vec<f64> = Vec::new();
        let mut peak_mb = None;
        self.stopwatch.reset_peak();
        loop {
            let begin = self.stopwatch.seconds();
            let deadline = Deadline::after(self.row_s, self.stopwatch, self.progress);
            let done = self.pool.install(|| work(&deadline)).map_err(|why| self.too_late(why))?;
            times.push(self.stopwatch.seconds() - begin);
            if times.len() == 1 {
                peak_mb = self.stopwatch.peak_mb();
            }
            if times.len() >= self.repeats || times.iter().sum::<f64>() > LONG_S {
                let repeats = times.len();
                return Ok((done, Time { wall_s: median(times), repeats, peak_mb }));
            }
        }
    }

    /// What an answer is estimated to leave out, as far as that is known; no part of its time.
    fn estimates(&self, scene: &Scene, nodes: &[u32]) -> Result<Estimates, NoAnswer> {
        let has_tetrahedra = scene.mesh.cells.iter().any(|(shape, _)| shape == CellShape::Tet4);
        if scene.settings.element == ElementChoice::Quadratic && has_tetrahedra {
            return Ok(Estimates::default());
        }
        let deadline = Deadline::after(self.row_s, self.stopwatch, self.progress);
        let (mesh, linearity) = match self.pool.install(|| estimates(scene, &deadline)) {
            Ok(found) => found,
            Err(ModelError::Solver(SolverError::Stopped)) if self.progress.is_cancelled() => {
                return Err(NoAnswer::Cancelled);
            }
            Err(_) => return Ok(Estimates::default()),
        };
        Ok(Estimates {
            mesh: mesh.ok().map(|error| at(nodes, &error.missing)),
            linearity: linearity.ok().map(|left| at(nodes, &left.left_out)),
            of_moving: None,
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
    let [low, high] = bounds_of(&scene.mesh.nodes).unwrap_or_default();
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

fn at(nodes: &[u32], vectors: &[Vector]) -> Vec<Vector> {
    nodes.iter().map(|&node| vectors[node as usize]).collect()
}

fn distinct(mut codes: Vec<String>) -> Vec<String> {
    codes.sort_unstable();
    codes.dedup();
    codes
}

/// The smallest time that at least half of them do not exceed.
fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[(times.len() - 1) / 2]
}
