//! The surface scan of a face beside its CT: fetched, registered with the skin of the CT, and used instead of it.

use std::sync::Arc;

use crate::jobs::clock::Observed;
use crate::jobs::compare::place_of;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::{fetch, no_surface};
use crate::jobs::source::{MeshSource, StoredMesh};
use crate::schema::meshing::skin_scan::{ScanLandmarkDocument, SkinScanDocument};
use crate::schema::{ErrorCode, Pointer, Problem};
use mechanics::anatomy::skin_scan::{BLEND_MM, FittedScan, REACH_MM, SkinScanRules, fit};
use mechanics::anatomy::{AnatomyError, SkinScanError};
use mechanics::domain::{ImageOptions, ScannedSkin};
use mechanics::image::ImageVolume;
use mechanics::mesh::{Frame, TriangleSurface, Vector};
use mechanics::registration::{AlignmentError, SphereOrBox};

/// Its file, registered with the CT.
pub const SKIN_SCAN_FILE: &str = "skin-scan.vtp";

/// A surface scan in mm, in LPS if its file names a frame.
pub struct SkinScan {
    surface: Arc<TriangleSurface>,
    rules: SkinScanRules,
}

fn place() -> Pointer {
    Pointer::root().key("spec").key("skin_scan")
}

/// Whether x and y of positions change sign, to be in LPS.
fn turned(point: Vector, frame: Frame) -> Vector {
    match frame {
        Frame::Ras => Vector::new(-point.x, -point.y, point.z),
        Frame::Lps | Frame::Unspecified => point,
    }
}

fn turned_place(place: SphereOrBox, frame: Frame) -> SphereOrBox {
    match place {
        SphereOrBox::Sphere { centre, radius } => {
            SphereOrBox::Sphere { centre: turned(centre, frame), radius }
        }
        SphereOrBox::Box { lower, upper } => {
            let [a, b] = [lower, upper].map(|corner| turned(corner, frame));
            SphereOrBox::Box { lower: a.inf(&b), upper: a.sup(&b) }
        }
    }
}

impl SkinScan {
    /// The stored scan, and its registration with the CT; positions of the document are in `stated`, the frame of its osteotomy.
    pub fn fetch(
        document: &SkinScanDocument,
        stated: Frame,
        sources: &dyn MeshSource,
    ) -> Result<(StoredMesh, SkinScan), JobError> {
        let at = place().key("mesh");
        let stored = fetch(sources, &document.mesh, &at)?;
        let own = stored.frame.unwrap_or_default();
        let mut surface = (*stored.surface_in_mm().ok_or_else(|| no_surface(&at))?).clone();
        surface.points.iter_mut().for_each(|point| *point = turned(*point, own));
        let pair = |landmark: &ScanLandmarkDocument| {
            [turned(landmark.scan_mm.into(), own), turned(landmark.ct_mm.into(), stated)]
        };
        let mask = document.mask.as_ref().and_then(place_of);
        let rules = SkinScanRules {
            landmarks: document.landmarks.values().map(pair).collect(),
            mask: mask.map(|mask| turned_place(mask, stated)),
        };
        Ok((stored, SkinScan { surface: Arc::new(surface), rules }))
    }

    /// Registers the scan with the skin of the CT, or returns the reason at its place in the document.
    pub fn fit(
        &self,
        image: &ImageVolume,
        options: &ImageOptions,
        clock: &Observed,
    ) -> Result<FittedScan, JobError> {
        let found = fit(&self.surface, image, (options, &self.rules), clock);
        found.map_err(|error| match &error {
            AnatomyError::SkinScan(SkinScanError::Alignment(AlignmentError::Cancelled {
                ..
            })) => clock.stopped(),
            AnatomyError::SkinScan(reason) => {
                let code = ErrorCode::from(&error);
                let of_mask = matches!(
                    reason,
                    SkinScanError::EmptyMask { .. } | SkinScanError::SmallMask { .. }
                );
                let at = place().key(if of_mask { "mask" } else { "mesh" });
                Problem::at(&at, code, reason.to_string()).into()
            }
            AnatomyError::Image(_)
            | AnatomyError::Surface(_)
            | AnatomyError::Bone(_)
            | AnatomyError::Meshing(_)
            | AnatomyError::NoSkin { .. } => JobError::Anatomy(error),
        })
    }
}

/// The skin of a body from a registered scan, with the movement of a jaw in mm.
pub fn scanned_skin(found: &FittedScan, way: f64) -> ScannedSkin {
    ScannedSkin { surface: found.surface.clone(), reach: REACH_MM + way, blend: BLEND_MM }
}
