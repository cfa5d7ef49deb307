//! Segments whose nodes lie far from the bone of their name: two sets that were swapped, or a wrong one.

use super::case::{Bone, Case};
use crate::boundary::HeldNodes;
use crate::mesh::{SurfaceSearch, Vector, Warning};

/// Nodes of a segment that are measured, evenly chosen.
const MEASURED_NODES: usize = 2000;

/// A median distance above which nodes are not on their bone, in mm.
const FAR: f64 = 5.0;

/// A bone that is so many times closer is the better match, where its own is farther than [`BESIDE`].
const MUCH_CLOSER: f64 = 5.0;
const BESIDE: f64 = 1.0;

/// A bone and how far the nodes of a segment are from it, in mm.
struct Match<'a> {
    bone: &'a str,
    median: f64,
}

/// Warnings for the segments of a case that lie far from their bone.
pub(super) fn far_segments(case: &Case, held: &HeldNodes) -> Vec<Warning> {
    let bones: Vec<(&Bone, SurfaceSearch)> = case
        .bones
        .iter()
        .filter_map(|bone| {
            let surface = case.surfaces.get(&bone.surface)?;
            Some((bone, SurfaceSearch::new(surface).ok()?))
        })
        .collect();
    let segments = case.segments.iter().zip(&held.joined);
    segments
        .filter_map(|(segment, (nodes, _))| {
            let step = nodes.len().div_ceil(MEASURED_NODES).max(1);
            let chosen = nodes.iter().step_by(step);
            let places: Vec<Vector> =
                chosen.map(|&node| case.volume.nodes[node as usize]).collect();
            let matches = bones
                .iter()
                .map(|(bone, search)| Match { bone: &bone.name, median: median(&places, search) });
            far_segment(&segment.name, &matches.collect::<Vec<_>>())
        })
        .collect()
}

fn median(places: &[Vector], bone: &SurfaceSearch) -> f64 {
    let mut distances: Vec<f64> = places.iter().map(|place| bone.closest(place).distance).collect();
    distances.sort_unstable_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(0.0)
}

fn far_segment(segment: &str, matches: &[Match]) -> Option<Warning> {
    let own = matches.iter().find(|found| found.bone == segment)?;
    let others = matches.iter().filter(|found| found.bone != segment);
    let closest = others.min_by(|a, b| a.median.total_cmp(&b.median));
    let better = closest.filter(|other| other.median < own.median);
    let is_beside =
        better.is_some_and(|other| own.median > BESIDE && other.median * MUCH_CLOSER < own.median);
    if own.median <= FAR && !is_beside {
        return None;
    }
    let instead = better.map_or_else(String::new, |other| {
        format!("; bone {:?} is {:.1} mm away: were the sets swapped?", other.bone, other.median)
    });
    let detail = format!(
        "the nodes of segment {segment:?} lie {:.1} mm (median) from the bone of its name{instead}",
        own.median
    );
    let warning = Warning::new("segment-far-from-bone", detail).with("median_mm", own.median);
    Some(match better {
        Some(other) => warning.with("closer_median_mm", other.median),
        None => warning,
    })
}
