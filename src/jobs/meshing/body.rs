//! The body to be meshed: a scan, a label map, or a skin with bones, with its bone in segments.

use std::sync::Arc;

use super::skin_scan::SkinScan;
use crate::jobs::failure::JobError;
use crate::schema::meshing::surfaces::SurfacesDocument;
use crate::schema::{ErrorCode, Pointer, Problem};
use mechanics::anatomy::skin_scan::FittedScan;
use mechanics::anatomy::surfaces::{
    hollow, mended, outside, overlapping, part_by_cuts, take_as_segments,
};
use mechanics::anatomy::{AnatomyError, AnatomyRules, PartedBone};
use mechanics::domain::{Domain, LabelBody, SurfaceDomain, SurfaceDomainError, SurfaceName};
use mechanics::image::ImageVolume;
use mechanics::mesh::{TriangleSurface, Warning};
use mechanics::osteotomy::LabelError;

/// Parsed input.
pub enum Body {
    Scan(ScannedHead),
    Labels(Box<LabelBody>),
    Surfaces(Surfaces),
}

impl Body {
    /// The image of a scan, in Hounsfield units.
    pub fn image(&self) -> Option<&ImageVolume> {
        match self {
            Body::Scan(head) => Some(&head.image),
            Body::Labels(_) | Body::Surfaces(_) => None,
        }
    }
}

/// A CT, and optionally the surface scan that is its skin.
pub struct ScannedHead {
    pub image: Arc<ImageVolume>,
    pub skin: Option<SkinScan>,
}

/// A skin and bones in mm.
pub struct Surfaces {
    pub skin: Arc<TriangleSurface>,
    pub bones: Vec<Arc<TriangleSurface>>,
    /// Their places.
    pub document: SurfacesDocument,
}

/// A body ready to be meshed.
pub struct PartedBody {
    pub domain: Box<dyn Domain>,
    pub bone: PartedBone,
    pub warnings: Vec<Warning>,
    /// The surface scan that is its skin.
    pub skin: Option<FittedScan>,
}

impl Surfaces {
    /// The body between the surfaces, with its bone in segments and the report of repairs.
    pub fn part(&self, rules: &AnatomyRules) -> Result<PartedBody, JobError> {
        let bones: Vec<&TriangleSurface> = self.bones.iter().map(AsRef::as_ref).collect();
        let domain =
            SurfaceDomain::new(&self.skin, &bones, &[]).map_err(|error| self.refusal(&error))?;
        let domain = if rules.whole_bone.fill_holes { domain.solid() } else { domain };
        let parted = match &self.document.bone {
            Some(_) => part_by_cuts(&domain, &rules.osteotomy),
            None => take_as_segments(&domain, &bones, &rules.osteotomy),
        };
        let bone = parted.map_err(|error| match (&error, &self.document.bone) {
            (AnatomyError::Bone(LabelError::NoBone { segment }), None) => self.hidden(segment),
            _ => JobError::Anatomy(error),
        })?;
        let warnings = mended(&domain).into_iter().chain(outside(&domain));
        let warnings = warnings.chain(hollow(&domain)).chain(overlapping(&domain)).collect();
        Ok(PartedBody { domain: Box::new(domain), bone, warnings, skin: None })
    }

    /// The refusal of a bone of which nothing is left beside the others.
    fn hidden(&self, name: &str) -> JobError {
        let at = Pointer::root().key("spec").key("surfaces").key("bones");
        let bones = &self.document.bones;
        let number = bones.iter().position(|bone| bone.name.trim() == name).unwrap_or_default();
        let same = (0..self.bones.len())
            .find(|&other| other != number && self.bones[other] == self.bones[number]);
        let detail = match same {
            Some(other) => format!(
                "bone `{name}` is the same surface as bone `{}`: each bone needs one of its own",
                bones[other].name.trim()
            ),
            None => format!(
                "bone `{name}` has no place of its own: all of it lies in another bone, or it is smaller than a voxel of the grid on \
                 which bones are distinguished"
            ),
        };
        Problem::at(&at.index(number).key("mesh"), ErrorCode::SegmentNotFound, detail).into()
    }

    /// With the place of its surface.
    fn refusal(&self, error: &SurfaceDomainError) -> JobError {
        let at = Pointer::root().key("spec").key("surfaces");
        let at = match error.surface() {
            None | Some(SurfaceName::Muscle(_)) => at,
            Some(SurfaceName::Skin) => at.key("skin"),
            Some(SurfaceName::Bone(number)) => {
                let bones = self.document.bones_at(&at);
                bones.get(number).map_or(at, |(place, _)| place.clone())
            }
        };
        Problem::at(&at, ErrorCode::from(error), error.to_string()).into()
    }
}
