//! Check of the case of a mesh from a scan, with the warnings of the scan.

use std::sync::Arc;

use super::case::bone_file;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::output::JobContext;
use crate::jobs::predict::check_made;
use crate::jobs::source::{StoredMesh, StoredShape};
use crate::schema::predict::check::CheckDocument;
use crate::schema::{CaseDocument, WarningDocument};
use mechanics::anatomy::Anatomy;
use mechanics::mesh::Frame;

/// A new mesh, its frame, and its warnings.
pub(super) struct MadeAnatomy<'a> {
    pub anatomy: &'a Anatomy,
    pub frame: Frame,
    pub told: Vec<WarningDocument>,
}

/// Checks a case as it will be stored; `None` if its boundary conditions depend on a plan.
pub(super) fn check_anatomy(
    case: &CaseDocument,
    made: &MadeAnatomy,
    place: &JobContext,
    clock: &Observed,
) -> Result<Option<CheckDocument>, JobError> {
    let MadeAnatomy { anatomy, frame, told } = made;
    let volume = StoredShape::Volume(Arc::new(anatomy.volume.clone()));
    let volume = StoredMesh { told: told.clone(), ..StoredMesh::made(volume, *frame) };
    let bones = anatomy.bones.iter().enumerate().map(|(number, bone)| {
        let shape = StoredShape::Surface(Arc::new(bone.clone()));
        (bone_file(number), StoredMesh::made(shape, *frame))
    });
    check_made(case, bones.chain([(case.volume.clone(), volume)]).collect(), place, clock)
}
