//! Is the actual surface the scan that is meant? Somebody else's fits badly wherever it lies, and one from before
//! the operation fits where nothing was moved yet.

use super::alignment::{Alignment, AlignmentReport};
use super::both_ways::BothDirections;
use super::error::ComparisonError;
use super::region::MovedSurface;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, Warning, area_sampling};
use crate::registration::closest_point::FAR;

/// Bone that nothing was done to fits to 0.1 to 0.25 mm, 0.5 % of it beyond 1 mm (paper 001 section 3.2).
const BONE_SHARE: f64 = 0.25;

/// In mm: predictions of the field are 0.6 to 1.2 mm off in the mean.
const SKIN_MEDIAN: f64 = 2.0;

/// In mm: what moves less shows no operation.
const MOVED: f64 = 1.0;

/// Before the operation the scan has to lie so much nearer to the skin at rest than to the prediction.
const MUCH_NEARER: f64 = 0.25;

/// Points where the plan moves the skin; fewer say nothing.
const POINTS: usize = 2000;
const FEWEST: usize = 20;

/// A warning where surfaces that were aligned by their shapes do not fit.
pub(super) fn another_person(
    report: &AlignmentReport,
    distances: &BothDirections,
) -> Option<Warning> {
    let rms = report.rms?;
    let share = report.share_far?;
    if report.method == Alignment::SURFACES && share > BONE_SHARE {
        let percent = share * 100.0;
        let detail = format!(
            "{percent:.0} % of the bone is left more than {FAR} mm from its partner, rms {rms:.2} mm: is it somebody else's, or not the same bone?"
        );
        let warning = Warning::new("another-person-suspect", detail);
        return Some(warning.with("share_above_1_mm", share).with("rms_mm", rms));
    }
    let median = distances.both.unsigned.median;
    if report.method == Alignment::ICP && median > SKIN_MEDIAN {
        let detail = format!(
            "aligned by their shapes half of the surfaces is still more than {median:.1} mm apart: is the scan somebody else's?"
        );
        let warning = Warning::new("another-person-suspect", detail);
        return Some(warning.with("median_mm", median).with("rms_mm", rms));
    }
    None
}

/// A warning where the actual surface is the skin before the plan rather than after it.
pub(super) fn before_operation(
    prediction: &MovedSurface,
    actual: &TriangleSurface,
) -> Result<Option<Warning>, ComparisonError> {
    let (Some(moved_by), Some(displacement)) = (prediction.moved_by(), prediction.displacement)
    else {
        return Ok(None);
    };
    let surface = prediction.surface;
    let mut moving = TriangleSurface { triangles: Vec::new(), ..surface.clone() };
    let triangles = surface.triangles.iter().zip(&moved_by);
    moving.triangles = triangles.filter(|(_, by)| **by > MOVED).map(|(&t, _)| t).collect();
    if moving.triangles.is_empty() {
        return Ok(None);
    }
    let mut at_rest = moving.clone();
    for (point, moved) in at_rest.points.iter_mut().zip(displacement) {
        *point -= moved;
    }
    let search = SurfaceSearch::new(actual)
        .map_err(|source| ComparisonError::Surface { which: "actual", source })?;
    let (Some(after), Some(before)) = (rms(&moving, &search), rms(&at_rest, &search)) else {
        return Ok(None);
    };
    Ok((before < MUCH_NEARER * after).then(|| {
        let detail = format!(
            "where the plan moves the skin by more than {MOVED} mm the actual surface is {before:.2} mm from the skin before it and {after:.2} mm from the prediction: is it the scan before the operation?"
        );
        let warning = Warning::new("before-operation-suspect", detail);
        warning.with("rms_at_rest_mm", before).with("rms_predicted_mm", after)
    }))
}

/// Root of the mean squared distance of a surface to what is opposite; nothing where that is too little.
fn rms(from: &TriangleSurface, to: &SurfaceSearch) -> Option<f64> {
    let distance = |point: &Vector| {
        let closest = to.closest(point);
        (!to.is_on_open_border(&closest)).then_some(closest.distance)
    };
    let samples = area_sampling::equal_areas(from, POINTS);
    let found: Vec<f64> = samples.iter().filter_map(|sample| distance(&sample.point)).collect();
    let squares = found.iter().map(|distance| distance * distance).sum::<f64>();
    (found.len() >= FEWEST).then(|| (squares / found.len() as f64).sqrt())
}
