//! Alignment of the actual surface with the prediction: none, a given one, by landmarks, or by iterative closest point
//! of itself or of bone that was scanned with it.

use super::error::ComparisonError;
use crate::mesh::{TriangleSurface, Vector, Warning};
use crate::progress::Progress;
use crate::registration::closest_point::FAR;
use crate::registration::mirror::{MirrorCheck, check_mirror};
use crate::registration::{
    IterativeClosestPoint, RigidTransform, SphereOrBox, StandardError, Start, SurfaceAlignment,
    align_points, undetermined,
};

/// A landmark may lie outside the box around its surface by this share of the box's diagonal.
const MARGIN: f64 = 0.1;

/// Bone that nothing was done to fits to 0.1 to 0.25 mm, 0.5 % of it beyond 1 mm (Zachow et al. 2006, section 3.2).
const BONE_SHARE: f64 = 0.25;

/// How the actual surface is brought onto the prediction.
#[derive(Clone, Debug, PartialEq)]
pub enum Alignment {
    None,
    /// The movement of the actual surface is known.
    Matrix(RigidTransform),
    Landmarks(Vec<LandmarkPair>),
    /// Only the part of the prediction in the mask decides.
    ClosestPoint {
        mask: Option<SphereOrBox>,
    },
    /// Other surfaces decide, such as bone of both scans; the actual surface goes along.
    Surfaces(Box<BoneSurfaces>),
}

/// Surfaces that were scanned with those that are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneSurfaces {
    /// In the frame of the prediction.
    pub fixed: TriangleSurface,
    /// In the frame of the actual surface.
    pub moving: TriangleSurface,
    /// Only the part of the fixed one in it decides.
    pub mask: Option<SphereOrBox>,
    pub start: Start,
}

impl Alignment {
    pub(super) const ICP: &'static str = "icp";
    pub(super) const SURFACES: &'static str = "surfaces";

    /// The word of the documents.
    pub fn name(&self) -> &'static str {
        match self {
            Alignment::None => "none",
            Alignment::Matrix(_) => "matrix",
            Alignment::Landmarks(_) => "landmarks",
            Alignment::ClosestPoint { .. } => Alignment::ICP,
            Alignment::Surfaces(_) => Alignment::SURFACES,
        }
    }
}

/// The same place on both surfaces, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandmarkPair {
    pub prediction: Vector,
    pub actual: Vector,
}

/// Result of the alignment of the actual surface.
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
    /// Of what decided, the share that is left more than 1 mm away, 0 to 1; of iterative closest point only.
    pub share_far: Option<f64>,
    /// Of what is compared, by its registration; absent too where the shape of what decided leaves a movement free.
    pub standard_error: Option<StandardError>,
    /// What landmarks would leave if they were mirrored as well, in mm.
    mirrored_rms: Option<f64>,
}

impl AlignmentReport {
    fn decided_by(&mut self, found: &SurfaceAlignment, prediction: &TriangleSurface) {
        (self.transform, self.rms) = (found.transform, Some(found.rms));
        (self.iterations, self.pairs) = (found.iterations, found.pairs);
        self.share_far = Some(found.share_far);
        let uncertainty = found.uncertainty.as_ref();
        self.standard_error =
            uncertainty.map(|own| StandardError::of_points(own, &prediction.points));
    }
}

/// The actual surface where an alignment puts it.
pub struct Aligned {
    pub surface: TriangleSurface,
    pub report: AlignmentReport,
    /// A mirror image fits better, bone does not fit, or its shape does not determine where it lies.
    pub warnings: Vec<Warning>,
}

/// Brings the actual surface onto the prediction.
pub fn aligned(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    alignment: &Alignment,
    progress: &dyn Progress,
) -> Result<Aligned, ComparisonError> {
    let report = align(prediction, actual, alignment, progress)?;
    let mirrored = mirror_warning(prediction, actual, alignment, &report);
    let doubts = another_bone(&report).into_iter().chain(undetermined_place(&report));
    let warnings = mirrored.into_iter().chain(doubts).collect();
    let mut surface = actual.clone();
    if *alignment != Alignment::None {
        surface.points.iter_mut().for_each(|point| *point = report.transform.apply(point));
    }
    Ok(Aligned { surface, report, warnings })
}

fn align(
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
        share_far: None,
        standard_error: None,
        mirrored_rms: None,
    };
    match alignment {
        Alignment::None => return Ok(report),
        Alignment::Matrix(transform) => report.transform = *transform,
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
            report.decided_by(&method.align(prediction, actual, progress)?, prediction);
        }
        Alignment::Surfaces(bones) => {
            let (mask, start) = (bones.mask, bones.start);
            let method = IterativeClosestPoint { mask, start, ..IterativeClosestPoint::default() };
            report.decided_by(&method.align(&bones.fixed, &bones.moving, progress)?, prediction);
        }
    }
    let middle = middle_of_box(actual);
    report.angle = report.transform.angle();
    report.middle_displacement = report.transform.apply(&middle) - middle;
    Ok(report)
}

/// A warning where a mirror image of the actual surface would fit much better.
fn mirror_warning(
    prediction: &TriangleSurface,
    actual: &TriangleSurface,
    alignment: &Alignment,
    report: &AlignmentReport,
) -> Option<Warning> {
    let landmarks = report.rms.zip(report.mirrored_rms);
    let landmarks = landmarks.map(|(rms, mirrored_rms)| MirrorCheck { rms, mirrored_rms });
    let (fixed, moving, mask) = match alignment {
        Alignment::ClosestPoint { mask } => (prediction, actual, mask.as_ref()),
        Alignment::Surfaces(bones) => (&bones.fixed, &bones.moving, bones.mask.as_ref()),
        Alignment::None | Alignment::Matrix(_) | Alignment::Landmarks(_) => {
            (prediction, actual, None)
        }
    };
    // Surfaces that cannot be aligned are no reason to fail where nobody asked for it.
    let surfaces = || check_mirror(fixed, moving, mask, &report.transform).ok();
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

/// A warning where bone that was aligned by its shape does not fit.
fn another_bone(report: &AlignmentReport) -> Option<Warning> {
    let (rms, share) = (report.rms?, report.share_far?);
    let percent = share * 100.0;
    let detail = format!(
        "{percent:.0} % of the bone is left more than {FAR} mm from its partner, rms {rms:.2} mm: is it of another person, or not the same bone?"
    );
    let warning = Warning::new("another-person-suspect", detail);
    let warning = warning.with("share_above_1_mm", share).with("rms_mm", rms);
    (report.method == Alignment::SURFACES && share > BONE_SHARE).then_some(warning)
}

/// A warning where the surfaces that were aligned fit in other places as well.
fn undetermined_place(report: &AlignmentReport) -> Option<Warning> {
    let is_by_surfaces = report.share_far.is_some();
    let told = || undetermined("the place of the actual surface", report.standard_error.as_ref());
    is_by_surfaces.then(told).flatten()
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
