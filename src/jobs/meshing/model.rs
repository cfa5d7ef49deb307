//! From the scan of a prepared meshing to the model of its tissue.

use super::input::PreparedMeshing;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::schema::osteotomy::conversion::{refuse_bridges, unfound};
use crate::schema::{Faults, Pointer};
use mechanics::anatomy::loose::{loose_bone, without_loose};
use mechanics::anatomy::region::around_segments;
use mechanics::anatomy::{Anatomy, AnatomyError, PartedBone, build, part_bone};
use mechanics::domain::{ImageDomain, ImageDomainError, ImageOptions};
use mechanics::image::scan_report;
use mechanics::mesh::Warning;
use mechanics::meshing::MeshingError;

const MM3_IN_ML: f64 = 1000.0;

impl PreparedMeshing {
    /// The bone in its segments; refused where it does not hold them, or a cut leaves a bridge.
    pub fn part_bone(&self) -> Result<PartedBone, JobError> {
        let osteotomy = &self.rules.osteotomy;
        let at = Pointer::root().key("spec").key("osteotomy");
        let bone = part_bone(&self.image, &self.rules).map_err(|error| match error {
            AnatomyError::Bone(error) => unfound(&error, osteotomy, &at).into(),
            other => JobError::Anatomy(other),
        })?;
        let mut faults = Faults::default();
        refuse_bridges(&bone.labelled.bridges, osteotomy, &at, &mut faults);
        faults.into_result()?;
        Ok(bone)
    }

    /// The mesh with its node sets, and all that is to be told of the scan and of it.
    pub fn mesh(&self, bone: PartedBone, clock: &Observed) -> Result<Anatomy, JobError> {
        let mut options = self.rules.image.clone();
        let margin = self.rules.around_segments_mm;
        let region = margin.and_then(|margin| around_segments(&bone.labelled, margin));
        options.limits.extend(region);
        let refused = |error: ImageDomainError| JobError::Anatomy(error.into());
        let tissue = without_loose(&self.image, &bone.labelled, &options);
        let tissue = tissue.map_err(|error| refused(error.into()))?;
        let domain = ImageDomain::new(&tissue, &options).map_err(refused)?;
        let (report, anatomy) = rayon::join(
            || scan_report(&self.image, self.frame),
            || build(&domain, bone, &self.rules, clock),
        );
        let mut anatomy = anatomy.map_err(|error| match error {
            AnatomyError::Meshing(MeshingError::Cancelled) => clock.stopped(),
            other => JobError::Anatomy(other),
        })?;
        anatomy.warnings.splice(0..0, report.findings);
        anatomy.warnings.extend(loose_bone(&anatomy.bone));
        anatomy.warnings.extend(cut_off(&domain, &options).map_err(refused)?);
        Ok(anatomy)
    }
}

/// How much tissue the region of interest leaves out.
fn cut_off(
    domain: &ImageDomain,
    options: &ImageOptions,
) -> Result<Option<Warning>, ImageDomainError> {
    if options.limits.is_empty() {
        return Ok(None);
    }
    let volume_ml = domain.cut_off(&options.limits)? / MM3_IN_ML;
    let detail = format!(
        "{volume_ml:.0} ml of soft tissue lie beyond the region and are left out; what remains ends there as where the \
         scan ends"
    );
    Ok(Some(Warning::new("tissue-cut-off", detail).with("volume_ml", volume_ml)))
}
