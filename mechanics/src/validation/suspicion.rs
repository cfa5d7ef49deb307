//! Plausibility of the actual surface: that of another person fits badly wherever it lies, and one from before the
//! operation fits where nothing was moved yet.

use super::alignment::{Alignment, AlignmentReport};
use super::both_ways::{BothDirections, Pair};
use super::error::ComparisonError;
use super::region::MovedSurface;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, Warning, area_sampling};

/// In mm: predictions of the field are 0.6 to 1.2 mm off in the mean.
pub(super) const SKIN_MEDIAN: f64 = 2.0;

/// In mm: what moves less shows no operation.
pub(super) const MOVED: f64 = 1.0;

/// Before the operation the scan has to lie so much nearer to the skin at rest than to the prediction.
const MUCH_NEARER: f64 = 0.25;

/// In mm: surfaces of one head that lie in one frame are not so far apart.
const APART: f64 = 20.0;

/// Points where the plan moves the skin; fewer say nothing.
const POINTS: usize = 2000;
const FEWEST: usize = 20;

/// A warning where surfaces that were aligned by their own shapes do not fit.
pub(super) fn another_person(
    report: &AlignmentReport,
    distances: &BothDirections,
) -> Option<Warning> {
    let rms = report.rms?;
    let median = distances.both.unsigned.median;
    if report.method == Alignment::ICP && median > SKIN_MEDIAN {
        let detail = format!(
            "aligned by their shapes half of the surfaces is still more than {median:.1} mm apart: is the scan of another person?"
        );
        let warning = Warning::new("another-person-suspect", detail);
        return Some(warning.with("median_mm", median).with("rms_mm", rms));
    }
    None
}

/// A warning where surfaces that were not fitted to each other lie apart: another frame, or another unit.
pub(super) fn apart(report: &AlignmentReport, distances: &BothDirections) -> Option<Warning> {
    let median = distances.both.unsigned.median;
    let detail = format!(
        "half of the surfaces is more than {median:.0} mm apart: are they in one frame, and is `align` meant to be `none`?"
    );
    let warning = Warning::new("surfaces-apart", detail).with("median_mm", median);
    (report.rms.is_none() && median > APART).then_some(warning)
}

/// A warning where one of the surfaces faces inwards: signs of distances are then wrong in one of the directions.
pub(super) fn facing_inwards(pair: &Pair) -> Option<Warning> {
    let normals = pair.prediction.point_normals();
    let step = normals.len().div_ceil(POINTS).max(1);
    let opposed = |(point, normal): (&Vector, &Vector)| {
        let closest = pair.actual_search.closest(point);
        pair.actual.area_vector(closest.triangle).dot(normal) < 0.0
    };
    let looked: Vec<bool> =
        pair.prediction.points.iter().zip(&normals).step_by(step).map(opposed).collect();
    let share = looked.iter().filter(|is| **is).count() as f64 / looked.len().max(1) as f64;
    let detail = format!(
        "at {:.0} % of the prediction the actual surface faces the other way: the triangles of one of them are turned inwards, and signed \
         distances have the wrong sign in one direction",
        share * 100.0
    );
    (share > 0.5).then(|| Warning::new("surfaces-opposed", detail).with("share", share))
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
    Ok(told_before_operation(before, after))
}

/// The warning where what moves is so far from the skin at rest and from the prediction, in mm, that it has not moved yet.
pub(super) fn told_before_operation(before: f64, after: f64) -> Option<Warning> {
    (before < MUCH_NEARER * after).then(|| {
        let detail = format!(
            "where the plan moves the skin by more than {MOVED} mm the actual surface is {before:.2} mm from the skin before it and {after:.2} mm from the prediction: is it the scan before the operation?"
        );
        let warning = Warning::new("before-operation-suspect", detail);
        warning.with("rms_at_rest_mm", before).with("rms_predicted_mm", after)
    })
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
