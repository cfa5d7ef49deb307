//! Check of a case with new meshes: the boundary conditions of its nodes before any segment moves.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::check::check;
use super::input::PredictInput;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::JobContext;
use crate::jobs::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::case::document::LengthUnit;
use crate::schema::predict::check::CheckDocument;
use crate::schema::{CaseDocument, ErrorCode, PlanDocument, PredictDocument};
use mechanics::mesh::Frame;

/// New meshes, beside stored ones.
struct MadeBeside<'a> {
    made: BTreeMap<String, StoredMesh>,
    stored: &'a dyn MeshSource,
}

impl MeshSource for MadeBeside<'_> {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        self.made.get(id).cloned().map_or_else(|| self.stored.mesh(id), Ok)
    }

    fn model(&self, job: &str) -> Result<Vec<u8>, SourceError> {
        self.stored.model(job)
    }

    fn takes_any_scale(&self) -> bool {
        self.stored.takes_any_scale()
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        self.stored.predicted_skin(job)
    }
}

impl StoredMesh {
    /// One in mm that is not stored yet.
    pub fn made(shape: StoredShape, frame: Frame) -> StoredMesh {
        StoredMesh {
            shape,
            of_points: Arc::default(),
            frame: Some(frame),
            units: Some(LengthUnit::Mm),
            warnings: Vec::new(),
            told: Vec::new(),
            sha256: String::new(),
            identity: String::new(),
        }
    }
}

/// Checks a case as it will be stored; `made` are its meshes by their names in it. `None` if its boundary conditions
/// depend on a plan.
pub fn check_made(
    case: &CaseDocument,
    made: BTreeMap<String, StoredMesh>,
    place: &JobContext,
    clock: &Observed,
) -> Result<Option<CheckDocument>, JobError> {
    let sources = MadeBeside { made, stored: place.sources };
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: case.clone(),
        plan: PlanDocument::default(),
        spec: PredictDocument::default(),
    };
    match clock.prepared(|stop| check(&input, &sources, place.limits, stop)) {
        Ok(report) => Ok(Some(report.document)),
        Err(JobError::Refused(problem)) if problem.is_only(ErrorCode::Underconstrained) => Ok(None),
        Err(error) => Err(error),
    }
}
