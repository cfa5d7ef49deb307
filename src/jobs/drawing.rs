//! Pictures and reports of a finished job, drawn from its input and its files.

use std::sync::Arc;

use super::compare::CompareInput;
use super::failure::JobError;
use super::input::JobInput;
use super::predict::{PredictInput, Prepared};
use super::report::{
    PredictionFacts, Report, ReportForm, StudyFacts, prediction_report, study_report,
};
use super::result::pictures::displacement_picture;
use super::source::{MeshSource, SourceError};
use super::study::chart_drawing;
use crate::schema::predict::output::PictureName;
use crate::schema::predict::result::{ResultDocument, StatisticsDocument};
use crate::schema::{Language, Limits, ReportDocument};
use mechanics::mesh::TriangleSurface;
use mechanics::progress::StopQuery;

/// A successful job with something to draw.
pub struct Finished {
    job: String,
    result: ResultDocument,
    made_of: MadeOf,
}

enum MadeOf {
    Prediction(Box<PredictInput>, Box<StatisticsDocument>),
    Comparison(Box<CompareInput>),
    Study(Box<ReportDocument>),
}

impl Finished {
    /// The result of a job, if there is a picture or a report of it; `study` is the report of a study.
    pub fn of_job(
        job: &str,
        input: JobInput,
        result: ResultDocument,
        study: Option<ReportDocument>,
    ) -> Option<Finished> {
        let statistics = result.statistics.clone().map(Box::new);
        let made_of = match input {
            JobInput::Predict(input) => MadeOf::Prediction(Box::new(input), statistics?),
            JobInput::Optimise(input) => {
                let input = input.prediction(result.optimisation.as_ref()?);
                MadeOf::Prediction(Box::new(input), statistics?)
            }
            JobInput::Compare(input) => MadeOf::Comparison(Box::new(input)),
            JobInput::Study(_) => MadeOf::Study(Box::new(study?)),
            JobInput::Response(_)
            | JobInput::Reproduce(_)
            | JobInput::Cohort(_)
            | JobInput::Learn(_)
            | JobInput::Conform(_)
            | JobInput::Meshing(_) => return None,
        };
        Some(Finished { job: job.to_owned(), result, made_of })
    }

    /// Whether a job of its kind has this picture.
    pub fn has(&self, picture: PictureName) -> bool {
        self.has_skin() || PictureName::REPORTS.contains(&picture)
    }

    /// Whether pictures need the written skin of the job.
    pub fn has_skin(&self) -> bool {
        matches!(self.made_of, MadeOf::Prediction(..))
    }

    /// The bytes of a picture or a report. An SVG is the same as the job would have written. After a stop it is cancelled.
    pub fn draw(
        &self,
        (picture, language): (PictureName, Language),
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<Vec<u8>, JobError> {
        if let Some(form) = ReportForm::of(picture.output()) {
            return Ok(self.report(language, sources, limits, stop)?.written(form));
        }
        let MadeOf::Prediction(input, statistics) = &self.made_of else { return Ok(Vec::new()) };
        let prepared = input.prepare(sources, limits, stop)?;
        if picture == PictureName::Classes {
            return Ok(prepared.classes_picture()?.into_bytes());
        }
        let moved = self.skin(&prepared, sources)?;
        let (shown, numbers) =
            ((prepared.case.frame, input.spec.range_mm()), &statistics.skin.nodes);
        Ok(displacement_picture(&prepared.scene, &moved, shown, numbers)?.into_bytes())
    }

    fn report(
        &self,
        language: Language,
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<Report, JobError> {
        let result = &self.result;
        match &self.made_of {
            MadeOf::Prediction(input, _) => {
                let prepared = input.prepare(sources, limits, stop)?;
                let facts = PredictionFacts {
                    case: &input.case,
                    plan: &input.plan,
                    scene: &prepared.scene,
                    frame: prepared.case.frame,
                    after: &*self.skin(&prepared, sources)?,
                    range_mm: input.spec.range_mm(),
                    result,
                };
                Ok(prediction_report(&facts, language)?)
            }
            MadeOf::Comparison(input) => input.report(result, language, sources, limits),
            MadeOf::Study(report) => {
                let facts = StudyFacts { report, chart: chart_drawing(report, None), result };
                Ok(study_report(facts, language))
            }
        }
    }

    /// The written skin of the job, with the points of the undeformed skin.
    fn skin(
        &self,
        prepared: &Prepared,
        sources: &dyn MeshSource,
    ) -> Result<Arc<TriangleSurface>, JobError> {
        let written = sources.predicted_skin(&self.job).map_err(JobError::Source)?.surface();
        let points = written.as_ref().map_or(0, |skin| skin.points.len());
        let rest = prepared.scene.skin.surface.points.len();
        written.filter(|_| points == rest).ok_or_else(|| {
            let detail =
                format!("the skin of the job has {points} points, and that of its case {rest}");
            JobError::Source(SourceError::Unreadable {
                id: self.job.clone(),
                detail,
                may_pass: false,
            })
        })
    }
}
