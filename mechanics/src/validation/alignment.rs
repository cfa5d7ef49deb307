//! The actual surface onto the prediction: not at all, by landmarks, or by iterative closest point.

use super::error::ComparisonError;
use crate::mesh::{TriangleSurface, Vector, Warning};
use crate::progress::Progress;
use crate::registration::mirror::{MirrorCheck, check_mirror};
use crate::registration::{IterativeClosestPoint, Place, RigidTransform, align_points};

/// A landmark may lie outside the box around its surface by this share of the box's diagonal.
const MARGIN: f64 = 0.1;

/// How the actual surface is brought onto the prediction.
#[derive(Clone, Debug, PartialEq)]
pub enum Alignment {
    None,
    Landmarks(Vec<LandmarkPair>),
    /// Only the part of the prediction in the mask decides.
    ClosestPoint {
        mask: Option<Place>,
    },
}

impl Alignment {
    /// The word of the documents.
    pub fn name(&self) -> &'static str {
        match self {
            Alignment::None => "none",
            Alignment::Landmarks(_) => "landmarks",
            Alignment::ClosestPoint { .. } => "icp",
        }
    }
}

/// The same place on both surfaces, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandmarkPair {
    pub prediction: Vector,
    pub actual: Vector,
}

/// What the alignment did to the actual surface.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignmentReport {
    pub method: &'static str,
    /// Of the actual surface, into the frame of the prediction.
    pub transform: RigidTransform,
    /// Of its rotation, in radians.
    pub angle: f64,
    /// How far it takes the middle of the actual surface, in mm.
    pub middle_displacement: Vector,
    pub iterations: usize,
    /// Root of the mean squared distance of the pairs that decided, in mm; absent without alignment.
    pub rms: Option<f64>,
    /// How many pairs decided.
    pub pairs: usize,
    /// What landmarks would leave if they were mirrored as well, in mm.
    mirrored_rms: Option<f64>,
}

pub(super) fn align(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    alignment: &Alignment,
    progress: &dyn Progress,
) -> Result<AlignmentReport, ComparisonError> {
    let mut report = AlignmentReport {
        method: alignment.name(),
        transform: RigidTransform::identity(),
        angle: 0.0,
        middle_displacement: Vector::zeros(),
        iterations: 0,
        rms: None,
        pairs: 0,
        mirrored_rms: None,
    };
    match alignment {
        Alignment::None => return Ok(report),
        Alignment::Landmarks(pairs) => {
            let (to, from): (Vec<Vector>, Vec<Vector>) =
                pairs.iter().map(|pair| (pair.prediction, pair.actual)).unzip();
            refuse_outside("predicted", prediction, &to)?;
            refuse_outside("actual", actual, &from)?;
            let fit = align_points(&from, &to)?;
            (report.transform, report.rms, report.pairs) = (fit.transform, Some(fit.rms), to.len());
            report.mirrored_rms = Some(fit.mirrored_rms);
        }
        Alignment::ClosestPoint { mask } => {
            let method = IterativeClosestPoint { mask: *mask, ..IterativeClosestPoint::default() };
            let found = method.align(prediction, actual, progress)?;
            (report.transform, report.rms) = (found.transform, Some(found.rms));
            (report.iterations, report.pairs) = (found.iterations, found.pairs);
        }
    }
    let middle = middle_of_box(actual);
    report.angle = report.transform.angle();
    report.middle_displacement = report.transform.apply(&middle) - middle;
    Ok(report)
}

/// A warning where a mirror image of the actual surface would fit much better.
pub(super) fn mirror_warning(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    alignment: &Alignment,
    report: &AlignmentReport,
) -> Option<Warning> {
    let landmarks = report.rms.zip(report.mirrored_rms);
    let landmarks = landmarks.map(|(rms, mirrored_rms)| MirrorCheck { rms, mirrored_rms });
    let mask = match alignment {
        Alignment::ClosestPoint { mask } => mask.as_ref(),
        Alignment::None | Alignment::Landmarks(_) => None,
    };
    // Surfaces that cannot be aligned are no reason to fail where nobody asked for it.
    let surfaces = || check_mirror(prediction, actual, mask, &report.transform).ok();
    let check = landmarks.filter(MirrorCheck::looks_mirrored).or_else(surfaces)?;
    check.looks_mirrored().then(|| {
        let detail = format!(
            "a mirror image of the actual surface fits to {:.2} mm, itself only to {:.2} mm",
            check.mirrored_rms, check.rms
        );
        Warning::new("mirrored?", detail)
            .with("rms_mm", check.rms)
            .with("mirrored_rms_mm", check.mirrored_rms)
    })
}

fn refuse_outside(
    which: &'static str,
    surface: &TriangleSurface,
    landmarks: &[Vector],
) -> Result<(), ComparisonError> {
    let (low, high) = surface.bounds();
    let margin = MARGIN * (high - low).norm();
    for (pair, landmark) in landmarks.iter().enumerate() {
        let distance = (low - landmark).sup(&(landmark - high)).sup(&Vector::zeros()).norm();
        // A landmark that is not a number is refused with its number by the alignment itself.
        if distance > margin {
            return Err(ComparisonError::LandmarkOutside { which, pair, distance });
        }
    }
    Ok(())
}

fn middle_of_box(surface: &TriangleSurface) -> Vector {
    let (low, high) = surface.bounds();
    (low + high) * 0.5
}
