//! Failures of jobs, with the codes of the API.

use serde_json::{Map, Value, json};

use super::source::SourceError;
use crate::schema::ErrorCode;
use crate::schema::Problem;
use crate::schema::job::{ErrorClass, JobErrorDocument};
use crate::schema::wire::numbers::with_short_numbers;
use mechanics::anatomy::AnatomyError;
use mechanics::chart::PngError;
use mechanics::format::WriteError;
use mechanics::meshing::MeshingError;
use mechanics::optimisation::{OptimisationError, SearchError};
use mechanics::prediction::{InvertedCell, ModelError, NoScene, SolverError};
use mechanics::study::StudyError;
use mechanics::validation::StatisticsError;

/// The most reported residuals of a diverged solver, from one for each iteration.
const TOLD_RESIDUALS: usize = 200;

/// How the time of a whole study follows from its budget, behind a sentence that tells it.
pub const TIME_OF_STUDY: &str = ", as twice the `wall_s` of the study, once for its rows and once for their reference solutions, and 60 s; a larger `wall_s` allows more";

#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// The documents or the meshes.
    #[error("{}", .0.detail)]
    Refused(Problem),
    #[error(transparent)]
    Prediction(#[from] ModelError),
    #[error("no plan was found: {0}")]
    Optimisation(#[from] OptimisationError),
    #[error("no constants were found: {0}")]
    Search(SearchError),
    #[error("the scan could not be meshed: {0}")]
    Anatomy(AnatomyError),
    /// With what the check of the scan found of its values.
    #[error("the scan could not be meshed: {error}; its check found: {found}")]
    DoubtfulScan { error: Box<AnatomyError>, found: String },
    #[error("the study could not be run: {0}")]
    Study(#[from] StudyError),
    #[error("{which} ran out: {allowed} {unit} are allowed by `budget`{how}")]
    Budget { which: &'static str, allowed: f64, unit: &'static str, how: &'static str },
    #[error("stopped on request")]
    Cancelled,
    #[error("the surfaces could not be aligned: {0}")]
    Alignment(String),
    #[error("{0}")]
    Source(SourceError),
    #[error("{what} is not a finite number")]
    NotFinite { what: String },
    #[error("no statistics: {0}")]
    Statistics(#[from] StatisticsError),
    #[error(transparent)]
    Encode(#[from] WriteError),
    #[error(transparent)]
    Picture(#[from] PngError),
    #[error("{file} could not be written: {source}")]
    Write { file: String, source: std::io::Error },
}

impl JobError {
    pub fn class(&self) -> ErrorClass {
        match self {
            JobError::Refused(_) | JobError::Alignment(_) => ErrorClass::Input,
            JobError::Anatomy(error) => class_of(error),
            JobError::DoubtfulScan { error, .. } => class_of(error),
            JobError::Prediction(ModelError::Solver(SolverError::Stopped))
            | JobError::Cancelled => ErrorClass::Cancelled,
            JobError::Prediction(ModelError::Solver(SolverError::OverBudget { .. }))
            | JobError::Budget { .. } => ErrorClass::Budget,
            JobError::Prediction(
                ModelError::Inverted(_)
                | ModelError::StepAboveLimit { .. }
                | ModelError::NoBone
                | ModelError::Folded { .. },
            ) => ErrorClass::Input,
            JobError::Study(StudyError::Threads(_)) => ErrorClass::Infrastructure,
            JobError::Study(_) => ErrorClass::Input,
            JobError::Prediction(_)
            | JobError::Optimisation(_)
            | JobError::Search(_)
            | JobError::NotFinite { .. }
            | JobError::Statistics(_)
            | JobError::Encode(_) => ErrorClass::Numerical,
            JobError::Source(SourceError::Unreadable { .. })
            | JobError::Write { .. }
            | JobError::Picture(_) => ErrorClass::Infrastructure,
            JobError::Source(_) => ErrorClass::Input,
        }
    }

    /// The code of the error catalogue.
    pub fn kind(&self) -> ErrorCode {
        match self {
            JobError::Refused(problem) => problem.code,
            JobError::Prediction(error) => error.into(),
            JobError::Anatomy(error) => error.into(),
            JobError::DoubtfulScan { error, .. } => (&**error).into(),
            JobError::Budget { .. } => ErrorCode::BudgetExceeded,
            JobError::Cancelled => ErrorCode::Cancelled,
            JobError::Alignment(_) => ErrorCode::AlignmentFailed,
            JobError::Source(SourceError::Unknown { .. }) => ErrorCode::NotFound,
            JobError::Source(SourceError::Refused { code, .. }) => *code,
            JobError::Source(SourceError::Unreadable { .. }) | JobError::Write { .. } => {
                ErrorCode::Storage
            }
            JobError::Optimisation(_) | JobError::Search(_) => ErrorCode::NoPlanFound,
            JobError::NotFinite { .. } => ErrorCode::NotFinite,
            JobError::Statistics(_) => ErrorCode::StatisticsFailed,
            JobError::Encode(_) => ErrorCode::EncodingFailed,
            JobError::Study(StudyError::Threads(_)) | JobError::Picture(_) => ErrorCode::Internal,
            JobError::Study(_) => ErrorCode::ValidationFailed,
        }
    }

    /// The `error` of a failed job. Names of files and systems are only in the log.
    pub fn to_document(&self) -> JobErrorDocument {
        let detail = match self {
            JobError::Write { .. } => "a result file could not be written".to_owned(),
            other => with_short_numbers(&other.to_string()),
        };
        let kind = self.kind().name().to_owned();
        JobErrorDocument { kind, class: self.class(), detail, members: self.members() }
    }

    fn members(&self) -> Map<String, Value> {
        let value = match self {
            JobError::Refused(problem) => {
                let mut members = problem.members.clone();
                if !problem.errors.is_empty() {
                    members.insert("errors".to_owned(), json!(problem.errors));
                }
                return members;
            }
            JobError::Prediction(error) => no_equilibrium(error),
            JobError::Optimisation(OptimisationError::NotConverged {
                iterations,
                step,
                wanted,
            }) => json!({ "iterations": iterations, "step": step, "wanted": wanted }),
            JobError::Budget { which, allowed, unit, how: _ } => {
                json!({ "which": which, format!("allowed_{unit}"): allowed })
            }
            _ => json!({}),
        };
        match value {
            Value::Object(members) => members,
            _ => Map::new(),
        }
    }
}

fn class_of(error: &AnatomyError) -> ErrorClass {
    match error {
        AnatomyError::Meshing(MeshingError::Broken { .. } | MeshingError::NotFinite { .. }) => {
            ErrorClass::Numerical
        }
        AnatomyError::Meshing(MeshingError::Cancelled) => ErrorClass::Cancelled,
        AnatomyError::Image(_)
        | AnatomyError::Surface(_)
        | AnatomyError::SkinScan(_)
        | AnatomyError::Bone(_)
        | AnatomyError::NoSkin { .. }
        | AnatomyError::Meshing(_) => ErrorClass::Input,
    }
}

/// Error document of a missed equilibrium.
fn no_equilibrium(error: &ModelError) -> Value {
    match error {
        ModelError::Inverted(InvertedCell { cell }) => json!({ "element": cell }),
        ModelError::StepAboveLimit { step_s, limit_s } => {
            json!({ "step_s": step_s, "limit_s": limit_s })
        }
        ModelError::NoBone => json!({}),
        ModelError::Standstill { made, steps, least_det_f } => {
            json!({ "movement_share": made, "steps": steps, "least_det_f": least_det_f })
        }
        ModelError::ContactUnsettled { passes, moved_mm } => {
            json!({ "passes": passes, "moved_mm": moved_mm })
        }
        ModelError::ContactAlternates { steps, residual, depth_mm, place } => {
            json!({ "steps": steps, "residual": residual, "depth_mm": depth_mm, "place_mm": place })
        }
        ModelError::Folded { cell, det_f } => json!({ "element": cell, "det_f": det_f }),
        ModelError::BonesPass { cause, edges, cells, .. } => {
            let mut members = no_equilibrium(cause);
            members["turned_edges"] = json!(edges);
            members["turned_cells"] = json!(cells);
            members
        }
        ModelError::Solver(error) => no_solution(error),
    }
}

fn no_solution(error: &SolverError) -> Value {
    match error {
        SolverError::NotConverged { iterations, residual, wanted, history } => json!({
            "iterations": iterations,
            "residual": residual,
            "wanted": wanted,
            "residual_history": thinned(history),
        }),
        SolverError::Diverged { iterations, growth, residual, history } => json!({
            "iterations": iterations,
            "growth": growth,
            "residual": residual,
            "residual_history": thinned(history),
        }),
        SolverError::Singular { node } => json!({ "node": node }),
        SolverError::OverBudget { needed_mb, allowed_mb } => {
            json!({ "which": "memory", "needed_mb": needed_mb, "allowed_mb": allowed_mb })
        }
        SolverError::Stopped | SolverError::NotFinite => json!({}),
    }
}

/// At most 200 entries, evenly spread, with the last.
pub(super) fn thinned(history: &[f64]) -> Vec<f64> {
    let step = history.len().div_ceil(TOLD_RESIDUALS).max(1);
    let mut told: Vec<f64> = history.iter().copied().step_by(step).collect();
    if let Some(&last) = history.last()
        && !(history.len() - 1).is_multiple_of(step)
    {
        told.push(last);
    }
    told
}

impl From<NoScene> for JobError {
    fn from(none: NoScene) -> Self {
        match none {
            NoScene::Refused(errors) => JobError::Refused(errors.into()),
            NoScene::Stopped => JobError::Cancelled,
        }
    }
}

impl From<Problem> for JobError {
    fn from(problem: Problem) -> Self {
        JobError::Refused(problem)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_solver_says_that_a_solver_diverged() {
        let kind = |error: JobError| error.kind().name();
        assert_eq!(kind(ModelError::Solver(SolverError::NotFinite).into()), "solver-diverged");
        assert_eq!(kind(OptimisationError::NotFinite.into()), "no-plan-found");
        assert_eq!(kind(JobError::NotFinite { what: "mean".to_owned() }), "not-finite");
        assert_eq!(kind(StatisticsError::Empty.into()), "statistics-failed");
        assert_eq!(kind(WriteError::Empty.into()), "encoding-failed");
    }
}
