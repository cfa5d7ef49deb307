//! Check of the case of a mesh that was just made: what holds its nodes before any segment moves.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::case::bone_file;
use crate::jobs::failure::JobError;
use crate::jobs::output::Workplace;
use crate::jobs::predict::{PredictInput, check};
use crate::jobs::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::case::document::LengthUnit;
use crate::schema::predict::check::CheckDocument;
use crate::schema::{CaseDocument, ErrorCode, PlanDocument, PredictDocument, WarningDocument};
use mechanics::anatomy::Anatomy;
use mechanics::mesh::Frame;

/// Meshes that were made, beside those that are stored.
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

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        self.stored.predicted_skin(job)
    }
}

/// A mesh that was made, its frame, and what there is to say of it.
pub(super) struct MadeAnatomy<'a> {
    pub anatomy: &'a Anatomy,
    pub frame: Frame,
    pub told: Vec<WarningDocument>,
}

/// Checks a case as it will be stored; `None` where only a plan can tell what holds it.
pub(super) fn check_made(
    case: &CaseDocument,
    made: &MadeAnatomy,
    place: &Workplace,
) -> Result<Option<CheckDocument>, JobError> {
    let MadeAnatomy { anatomy, frame, told } = made;
    let stored = |shape| StoredMesh {
        shape,
        of_points: Default::default(),
        frame: Some(*frame),
        units: Some(LengthUnit::Mm),
        warnings: Vec::new(),
        told: Vec::new(),
        sha256: String::new(),
    };
    let volume = stored(StoredShape::Volume(Arc::new(anatomy.volume.clone())));
    let volume = StoredMesh { told: told.clone(), ..volume };
    let bones = anatomy.bones.iter().enumerate().map(|(number, bone)| {
        (bone_file(number), stored(StoredShape::Surface(Arc::new(bone.clone()))))
    });
    let made = bones.chain([(case.volume.clone(), volume)]).collect();
    let sources = MadeBeside { made, stored: place.sources };
    let input = PredictInput {
        job: None,
        queue_s: None,
        case: case.clone(),
        plan: PlanDocument::default(),
        spec: PredictDocument::default(),
    };
    match check(&input, &sources, place.limits) {
        Ok(report) => Ok(Some(report.document)),
        Err(JobError::Refused(problem)) if problem.is_only(ErrorCode::Underconstrained) => Ok(None),
        Err(error) => Err(error),
    }
}
