//! The pictures of a prediction that has ended, drawn from what it was made of and the skin that it wrote.

use std::sync::Arc;

use super::failure::JobError;
use super::input::JobInput;
use super::predict::{PredictInput, Prepared};
use super::result::pictures::displacement_picture;
use super::source::{MeshSource, SourceError};
use crate::schema::Limits;
use crate::schema::predict::output::PictureName;
use crate::schema::predict::result::{ResultDocument, StatisticsDocument};
use mechanics::mesh::TriangleSurface;

/// A prediction that has ended.
pub struct Finished {
    job: String,
    input: PredictInput,
    statistics: StatisticsDocument,
}

impl Finished {
    /// What a job predicted, if it did.
    pub fn of_job(job: &str, input: JobInput, result: ResultDocument) -> Option<Finished> {
        let input = match input {
            JobInput::Predict(input) => input,
            JobInput::Optimise(input) => input.prediction(&result.optimisation?),
            JobInput::Compare(_)
            | JobInput::Response(_)
            | JobInput::Reproduce(_)
            | JobInput::Cohort(_)
            | JobInput::Study(_)
            | JobInput::Meshing(_) => return None,
        };
        Some(Finished { job: job.to_owned(), input, statistics: result.statistics? })
    }

    /// An SVG, the same as the job would have written.
    pub fn draw(
        &self,
        picture: PictureName,
        sources: &dyn MeshSource,
        limits: &Limits,
    ) -> Result<String, JobError> {
        let prepared = self.input.prepare(sources, limits)?;
        match picture {
            PictureName::Classes => prepared.classes_picture(),
            PictureName::Displacement => {
                let moved = self.skin(&prepared, sources)?;
                let (frame, numbers) = (prepared.case.frame, &self.statistics.skin.nodes);
                Ok(displacement_picture(&prepared.scene, &moved, frame, numbers)?)
            }
        }
    }

    /// The skin that the job wrote, which has the points of the skin at rest.
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
