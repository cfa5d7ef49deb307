//! Plausibility of a reproduction: both scans are of one person, not mirrored, in chronological order.

use crate::schema::reproduce::document::{ReproduceDocument, ReproducedSegmentDocument};
use mechanics::mesh::{TriangleSurface, Warning};
use mechanics::plan::RigidMovement;
use mechanics::registration::mirror::check_mirror;
use mechanics::registration::performed::{BoneBefore, Performed, median_distance, share_in_common};
use mechanics::registration::{RigidTransform, SurfaceAlignment, undetermined};

/// The code of scans that are in the wrong order.
pub(super) const BEFORE_OPERATION: &str = "before-operation-suspect";

/// Bone that was not operated on fits to 0.1 to 0.25 mm, 0.5 % of it beyond 1 mm (Zachow et al. 2006, section 3.2).
const MISFIT: f64 = 0.25;

/// The same of a segment, and of a base with a mask: a mask that also holds bone that did not move with it leaves 6 to 22 % beyond 1 mm, at movements of 3 mm.
const SEGMENT_MISFIT: f64 = 0.05;

/// Segments of operations rotate by less, and a search that starts beyond about 40 degrees finds another place.
const TURNED_DEG: f64 = 45.0;

/// The share of a segment that may also be another's: what a corner of a mask holds of bone beside it. Surfaces of segments that
/// were cut apart have their cut faces in common, up to half of a thin one.
const IN_COMMON: f64 = 0.05;
const IN_COMMON_WITH_CUTS: f64 = 0.5;

/// The share beyond which bone was moved.
const MOVED: f64 = 0.02;

/// In mm: bone nearer than that is on a surface.
const LIES: f64 = 0.25;

/// A segment that moves and rotates by less was not moved: a hundredth of planned movements, a tenth of the error of a registration
/// of bone.
const STAYS_MM: f64 = 0.02;
const STAYS_DEG: f64 = 0.02;

/// The ratio of the distances from both scans above which it is on one scan only.
const FARTHER: f64 = 3.0;

/// Doubts that both scans are of one person, and not mirrored.
pub(super) fn base_warnings(
    bone: &BoneBefore,
    after: &TriangleSurface,
    found: &SurfaceAlignment,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    // What is not masked may have moved: that is told of.
    let limit = if bone.mask.is_some() { SEGMENT_MISFIT } else { MISFIT };
    if found.share_far > limit {
        let detail = format!(
            "{:.0} % of the base remains more than 1 mm from the bone after the operation, rms {:.2} mm: another person, another scale, does the base hold bone that was moved, or does it need a `start` of `landmarks`?",
            100.0 * found.share_far,
            found.rms
        );
        let warning = Warning::new("another-person-suspect", detail);
        warnings.push(warning.with("share_above_1_mm", found.share_far).with("rms_mm", found.rms));
    }
    let mirrored = check_mirror(bone.surface, after, bone.mask.as_ref(), &found.transform).ok();
    if let Some(check) = mirrored.filter(|check| check.looks_mirrored()) {
        let detail = format!(
            "a mirror image of the bone after the operation fits to {:.2} mm, itself only to {:.2} mm",
            check.mirrored_rms, check.rms
        );
        let warning = Warning::new("mirrored?", detail).with("rms_mm", check.rms);
        warnings.push(warning.with("mirrored_rms_mm", check.mirrored_rms));
    }
    warnings
}

/// A base that may contain moved bone: its registration is then between those of head and moved bone.
pub(super) fn unmasked(spec: &ReproduceDocument, found: &SurfaceAlignment) -> Option<Warning> {
    let holds_segments = spec.segments.iter().any(|segment| segment.before.is_none());
    if spec.base.mask.is_some() || !(holds_segments || found.share_far > MOVED) {
        return None;
    }
    let detail = format!(
        "the base has no `mask`, so that moved bone affects the registration of the head: {:.1} % of it remains more than 1 mm from \
         the bone after the operation. State a `mask` with only bone that was not operated on",
        100.0 * found.share_far
    );
    let warning = Warning::new("base-unmasked", detail);
    Some(warning.with("share_above_1_mm", found.share_far).with("rms_mm", found.rms))
}

pub(super) fn misfit(segment: &ReproducedSegmentDocument, found: &Performed) -> Option<Warning> {
    let share = found.fit.share_far;
    (share > SEGMENT_MISFIT).then(|| {
        let detail = format!(
            "{:.0} % of segment `{}` remains more than 1 mm from the bone after the operation: its movement is unreliable; state landmarks to \
             start from, and a `mask` without bone that did not move with it",
            100.0 * share,
            segment.name.trim()
        );
        let warning = Warning::new("segment-misfit", detail);
        warning.with("share_above_1_mm", share).with("rms_mm", found.fit.rms)
    })
}

/// A segment that fits after a rotation that no operation makes: elongated bone, or a part of it, fits upside down too.
pub(super) fn turned_over(
    segment: &ReproducedSegmentDocument,
    found: &Performed,
) -> Option<Warning> {
    let turned = found.turned_from_start.to_degrees();
    (turned > TURNED_DEG).then(|| {
        let detail = format!(
            "segment `{}` fits the bone after the operation turned by {turned:.0} degrees from where its search started, which segments \
             are not: its movement is unreliable; state landmarks to start from",
            segment.name.trim()
        );
        let warning = Warning::new("segment-misfit", detail).with("turned_deg", turned);
        warning.with("share_above_1_mm", found.fit.share_far)
    })
}

/// A movement that the shape of the base, or of the segment, leaves open.
pub(super) fn undetermined_movement(
    segment: &ReproducedSegmentDocument,
    base: &SurfaceAlignment,
    found: &Performed,
) -> Option<Warning> {
    let rotation =
        |fit: &SurfaceAlignment| fit.uncertainty.map_or(f64::INFINITY, |of| of.rotation());
    let worst = if rotation(base) > rotation(&found.fit) { "base" } else { "segment" };
    let what = format!("the movement of segment `{}` (the {worst} worst)", segment.name.trim());
    undetermined(&what, found.standard_error.as_ref())
}

/// Segments of which both hold the same bone: it can have moved with one of them only.
pub(super) fn bone_in_common(bones: &[(&ReproducedSegmentDocument, BoneBefore)]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (index, (one, bone)) in bones.iter().enumerate() {
        for (other, beside) in &bones[..index] {
            let shares = [share_in_common(bone, beside), share_in_common(beside, bone)];
            let [Ok(of_one), Ok(of_other)] = shares else { continue };
            let are_cut = one.before.is_some() && other.before.is_some();
            let limit = if are_cut { IN_COMMON_WITH_CUTS } else { IN_COMMON };
            if of_one.max(of_other) <= limit {
                continue;
            }
            let (first, second) = (other.name.trim(), one.name.trim());
            let detail = format!(
                "segments `{first}` and `{second}` hold the same bone, {:.0} % of `{first}` and {:.0} % of `{second}`: it can have moved \
                 with one of them only; give each a `mask` without bone of the other",
                100.0 * of_other,
                100.0 * of_one
            );
            let warning = Warning::new("segment-misfit", detail);
            warnings.push(warning.with("share_in_common", of_one.max(of_other)));
        }
    }
    warnings
}

/// A segment with a separate surface, of the scan before the operation, is on the other scan only: as scanned
/// or as registered by the base. `scans` are those before and after the operation, by name.
pub(super) fn lies_on_the_other_scan(
    segment: &ReproducedSegmentDocument,
    bone: &BoneBefore,
    scans: [&TriangleSurface; 2],
    base: &SurfaceAlignment,
) -> Option<Warning> {
    let [before, after] = scans;
    let still = RigidTransform::identity();
    let to_before = median_distance(bone, before, &still).ok()?;
    let ways = [still, base.transform.inverse()];
    let to_after = ways.iter().filter_map(|way| median_distance(bone, after, way).ok());
    let to_after = to_after.min_by(f64::total_cmp)?;
    if to_before <= LIES.max(FARTHER * to_after) {
        return None;
    }
    let detail = format!(
        "the surface of segment `{}` before the operation is {to_before:.2} mm (median) from the bone of `before`, and {to_after:.2} mm \
         from that of `after`: are the two scans swapped?",
        segment.name.trim()
    );
    let warning = Warning::new(BEFORE_OPERATION, detail);
    Some(warning.with("to_before_mm", to_before).with("to_after_mm", to_after))
}

/// Both scans are the same surface, or no segment moves: never so after an operation.
pub(super) fn same_scan(
    before: &TriangleSurface,
    after: &TriangleSurface,
    found: &[Performed],
) -> Option<Warning> {
    let is_same = before.points == after.points && before.triangles == after.triangles;
    let gone = |own: &Performed| (own.movement.apply(&own.centre) - own.centre).norm();
    let farthest = found.iter().map(gone).fold(0.0, f64::max);
    let turned = found.iter().map(|own| own.movement.angle().to_degrees()).fold(0.0, f64::max);
    let stays = !found.is_empty() && farthest <= STAYS_MM && turned <= STAYS_DEG;
    (is_same || stays).then(|| {
        let told = if is_same { "the scans before and after the operation are one surface" } else { "no segment was moved" };
        let detail = format!(
            "{told}: the largest displacement of a segment is {farthest:.3} mm, the largest rotation {turned:.3} degrees; is `after` \
             the scan before the operation?"
        );
        let warning = Warning::new("nothing-performed", detail).with("farthest_mm", farthest);
        warning.with("turned_deg", turned)
    })
}

/// A movement that is nearer to the reversed plan than to the plan, by the displacement of the segment's centroid.
pub(super) fn reversed_plan(
    segment: &ReproducedSegmentDocument,
    found: &Performed,
    planned: &RigidMovement,
) -> Option<Warning> {
    let planned =
        RigidTransform { rotation: *planned.rotation(), translation: planned.translation() };
    let done = found.movement.apply(&found.centre) - found.centre;
    let gone = |way: &RigidTransform| (way.apply(&found.centre) - found.centre - done).norm();
    let (to_plan, to_undone) = (gone(&planned), gone(&planned.inverse()));
    if to_plan <= LIES.max(FARTHER * to_undone) {
        return None;
    }
    let detail = format!(
        "segment `{}` is {to_plan:.2} mm from its planned position, and {to_undone:.2} mm from that of the reversed plan: are the \
         scans before and after the operation swapped?",
        segment.name.trim()
    );
    let warning = Warning::new(BEFORE_OPERATION, detail);
    Some(warning.with("to_planned_mm", to_plan).with("to_undone_mm", to_undone))
}
