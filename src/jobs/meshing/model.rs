//! Construction of the model of the tissue from a prepared meshing.

use super::body::{Body, PartedBody, ScannedHead};
use super::input::PreparedMeshing;
use super::skin_scan::scanned_skin;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::schema::osteotomy::conversion::{refuse_bridges, unfound};
use crate::schema::{Faults, Pointer};
use mechanics::anatomy::closed_jaw::{Closed, close};
use mechanics::anatomy::label_bone::part_labels;
use mechanics::anatomy::left_out::left_out_of_scan;
use mechanics::anatomy::loose::{loose_bone, no_bone, without_loose};
use mechanics::anatomy::region::around_segments;
use mechanics::anatomy::skin_scan::{FittedScan, told};
use mechanics::anatomy::whole_bone::close_bone;
use mechanics::anatomy::{Anatomy, AnatomyError, build, part_bone};
use mechanics::domain::{ImageDomain, ImageDomainError, ImageOptions, LabelBody};
use mechanics::image::{ImageVolume, scan_report};
use mechanics::mesh::Warning;
use mechanics::meshing::MeshingError;

const MM3_IN_ML: f64 = 1000.0;

/// What a mesh of a scan without bone need not be told beside that.
const OF_BONE: [&str; 3] = ["nodes-off-bone", "thin-bone-lost", "no-cuts"];

impl PreparedMeshing {
    /// The body with its bone in segments; refused if it does not contain them, or a cut leaves a bridge.
    pub fn part(&self, clock: &Observed) -> Result<PartedBody, JobError> {
        let osteotomy = &self.rules.osteotomy;
        let at = match &self.body {
            Body::Scan(_) | Body::Surfaces(_) => Pointer::root().key("spec").key("osteotomy"),
            Body::Labels(_) => Pointer::root().key("spec").key("labels"),
        };
        let parted = match &self.body {
            Body::Scan(head) => self.part_scan(head, clock),
            Body::Labels(labels) => self.part_labels(labels).map_err(JobError::Anatomy),
            Body::Surfaces(surfaces) => surfaces.part(&self.rules),
        };
        let body = parted.map_err(|error| match error {
            JobError::Anatomy(AnatomyError::Bone(error)) => unfound(&error, osteotomy, &at).into(),
            other => other,
        })?;
        let mut faults = Faults::default();
        refuse_bridges(&body.bone.labelled.bridges, osteotomy, &at, &mut faults);
        faults.into_result()?;
        Ok(body)
    }

    /// With all warnings on the scan: its report, loose bone, omitted tissue.
    fn part_scan(&self, head: &ScannedHead, clock: &Observed) -> Result<PartedBody, JobError> {
        let scan: &ImageVolume = &head.image;
        let skin = head.skin.as_ref().map(|skin| skin.fit(scan, &self.rules.image, clock));
        let skin = skin.transpose()?;
        let parted = self.part_bone_of(scan, skin.as_ref()).map_err(JobError::Anatomy)?;
        Ok(PartedBody { skin, ..parted })
    }

    fn part_bone_of(
        &self,
        scan: &ImageVolume,
        skin: Option<&FittedScan>,
    ) -> Result<PartedBody, AnatomyError> {
        let mut options = self.rules.image.clone();
        let whole = close_bone(scan, options.bone_threshold, &self.rules.whole_bone);
        let (whole, closed) = whole.map_err(ImageDomainError::from)?.unzip();
        let seen = scan;
        let scan = whole.as_ref().unwrap_or(scan);
        let (report, bone) =
            rayon::join(|| scan_report(seen, self.frame), || part_bone(scan, &self.rules));
        let bone = bone?;
        let tissue = without_loose(scan, &bone.labelled, &options);
        let tissue = tissue.map_err(ImageDomainError::from)?;
        let mut warnings = report.findings;
        warnings.extend(closed);
        warnings.extend(no_bone(&bone.labelled, seen.range(), options.bone_threshold));
        let closing = self.rules.closing.filter(|_| skin.is_some());
        let (tissue, bone, way) = match closing {
            Some(closing) => {
                let Closed { image, bone, farthest, warning } =
                    close(&tissue, bone, &closing, &self.rules)?;
                warnings.extend(warning);
                (image, bone, farthest)
            }
            None => (tissue, bone, 0.0),
        };
        let margin = self.rules.around_segments_mm;
        options.limits.extend(margin.and_then(|margin| around_segments(&bone.labelled, margin)));
        let domain = match skin {
            Some(skin) => ImageDomain::with_skin(&tissue, &options, &scanned_skin(skin, way))?,
            None => ImageDomain::new(&tissue, &options)?,
        };
        warnings.extend(skin.iter().flat_map(|skin| told(skin, domain.bone_outside())));
        warnings.extend(left_out_of_scan(domain.left_out(), &warnings));
        warnings.extend(loose_bone(&bone.labelled));
        warnings.extend(cut_off(&domain, &options)?);
        Ok(PartedBody { domain: Box::new(domain), bone, warnings, skin: None })
    }

    /// With the warnings of the label map.
    fn part_labels(&self, labels: &LabelBody) -> Result<PartedBody, AnatomyError> {
        let domain = labels.domain(&[])?;
        let bone = part_labels(labels, &domain, &self.rules)?;
        let warnings = left_out_of_scan(domain.left_out(), &[]).into_iter().collect();
        Ok(PartedBody { domain: Box::new(domain), bone, warnings, skin: None })
    }

    /// The mesh with its node sets, and all warnings on it and the body.
    pub fn mesh(&self, body: PartedBody, clock: &Observed) -> Result<Anatomy, JobError> {
        let PartedBody { domain, bone, warnings, .. } = body;
        let mut anatomy =
            build(&*domain, bone, &self.rules, clock).map_err(|error| match error {
                AnatomyError::Meshing(MeshingError::Cancelled) => clock.stopped(),
                other => JobError::Anatomy(other),
            })?;
        if warnings.iter().any(|warning| warning.code == "no-bone") {
            anatomy.warnings.retain(|warning| !OF_BONE.contains(&warning.code));
        }
        anatomy.warnings.splice(0..0, warnings);
        Ok(anatomy)
    }
}

/// The tissue outside the region of interest.
fn cut_off(
    domain: &ImageDomain,
    options: &ImageOptions,
) -> Result<Option<Warning>, ImageDomainError> {
    if options.limits.is_empty() {
        return Ok(None);
    }
    let volume_ml = domain.cut_off(&options.limits)? / MM3_IN_ML;
    let detail = format!(
        "{volume_ml:.0} ml of soft tissue beyond the region are omitted; the boundary there is treated as where the \
         scan ends"
    );
    Ok(Some(Warning::new("tissue-cut-off", detail).with("volume_ml", volume_ml)))
}
