//! Assessment of a surface: how certain its inside is.
//!
//! The winding number of a sound surface is 1 inside and 0 outside. Holes, missing triangles and triangles of the other side
//! leave values in between. The median over the inside is the surface's level: where half of the triangles are
//! missing evenly it is 1/2, and half of that still tells inside from outside.

use rayon::prelude::*;

use super::mending::RepairedSurface;
use super::triangle::Corners;
use super::triangle_tree::TriangleTree;
use super::winding_cells::WindingCells;
use crate::mesh::Vector;

/// Points all over the box of a surface.
const SAMPLES: usize = 1 << 14;
/// Winding numbers below this are outside whatever the level is.
const OUTSIDE: f64 = 0.2;
/// Points of the inside that are kept, at most.
const MOST_INSIDE: usize = 2048;
/// Fewer points inside are no body.
const FEWEST: usize = 8;
/// A level above this is a whole surface's.
const WHOLE: f64 = 0.85;
/// Winding numbers between these parts of the level say neither inside nor outside.
const BETWEEN: std::ops::Range<f64> = 0.2..0.8;
/// A surface with a median winding number above this goes around its inside more than once.
const SEVERAL: f64 = 1.3;
/// Winding numbers between these parts of the median belong to some of its sheets, and between these of the level to holes.
const SOME: [f64; 2] = [0.25, 0.75];
/// Where triangles are missing all over, winding numbers above this part of the level show that they are not missing evenly.
const UNEVEN: f64 = 1.25;
/// Steps of the sequence R3: powers of the positive root of x (x³ - 1) = 1, inverted (Roberts, 2018).
const STEPS: [f64; 3] = [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3];

/// Assessment of a surface, and its repairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    /// What is left after mending.
    pub triangles: usize,
    pub mending: super::mending::Mending,
    /// Edges at which the surface does not go on with one triangle of the same side.
    pub open_edges: usize,
    /// Parts that hang together over edges.
    pub pieces: usize,
    /// The median winding number inside: 1 for a whole surface, less where triangles are missing or turned all over.
    pub level: f64,
    /// How much of what is not outside has a winding number between 0.2 and 0.8 of the level, or above 1.25 of a level below
    /// that of a whole surface; away from the surface.
    pub uncertain: f64,
    /// The sum of all area vectors in parts of the area: 0 for a whole surface, the share of an opening for one that was cut off.
    pub opening: f64,
    /// Of a surface that goes around its inside more than once how much of that lies between its sheets; 0 of others.
    pub between_sheets: f64,
    /// By how much the volumes of second sheets that were left out and of the first differ, in parts of the inside.
    pub second_sheets_differ: f64,
    /// Of a surface with wide holes that have no lid, how much in parts of its inside has a winding number between 1/4 and 3/4 of
    /// the level: where the surface that is missing may have been; 0 of others.
    pub in_holes: f64,
    /// Where the winding number is above half of the level, in mm³.
    pub volume: f64,
    /// By the divergence theorem over the triangles, in mm³: the same for a whole surface, twice as much for a doubled one.
    pub volume_of_triangles: f64,
}

/// What a point of the box sees.
#[derive(Clone, Copy)]
struct Sample {
    point: Vector,
    winding: f64,
    is_clear: bool,
}

/// The assessment of a surface, with points spread evenly over its inside.
pub(super) struct Assessed {
    pub assessment: Assessment,
    pub inside: Vec<Vector>,
}

/// `None` where the surface has no inside.
pub(super) fn assess(
    mended: &RepairedSurface,
    tree: &TriangleTree,
    cells: &WindingCells,
) -> Option<Assessed> {
    let samples = samples(tree, cells);
    let level = level(&samples)?;
    let uncertain = uncertain(&samples, level);
    let inside = samples.iter().filter(|sample| sample.winding > 0.5 * level);
    let inside: Vec<Vector> = inside.map(|sample| sample.point).collect();
    let (low, high) = tree.bounds();
    let box_volume = (high - low).product();
    let middle = (low + high) * 0.5;
    let six_volumes = tree.facets().iter().map(|facet| facet.corners.volume_with(&middle));
    let in_holes = samples
        .iter()
        .filter(|sample| SOME[0] * level < sample.winding && sample.winding < SOME[1] * level);
    let in_holes = if mended.wide_holes == 0 { 0 } else { in_holes.count() };
    let volume = box_volume * inside.len() as f64 / SAMPLES as f64;
    let assessment = Assessment {
        triangles: tree.facets().len(),
        mending: mended.mending,
        open_edges: mended.open_edges,
        pieces: mended.pieces,
        level,
        uncertain,
        opening: mended.opening,
        between_sheets: between_sheets(&samples),
        second_sheets_differ: mended.second_sheets_differ / volume,
        in_holes: in_holes as f64 / inside.len() as f64,
        volume,
        volume_of_triangles: six_volumes.sum::<f64>() / 6.0,
    };
    let apart = inside.len().div_ceil(MOST_INSIDE).max(1);
    Some(Assessed { assessment, inside: inside.into_iter().step_by(apart).collect() })
}

/// How much of what is not outside is uncertain.
fn uncertain(samples: &[Sample], level: f64) -> f64 {
    let counted = interior_winding_numbers(samples, BETWEEN.start * level);
    let most = if level < WHOLE { UNEVEN * level } else { f64::INFINITY };
    let is_certain = |winding: &&f64| (BETWEEN.end * level..=most).contains(*winding);
    let certain = counted.iter().filter(is_certain).count();
    1.0 - certain as f64 / counted.len().max(1) as f64
}

/// How much of what all sheets of a surface go around only some of them do.
fn between_sheets(samples: &[Sample]) -> f64 {
    let mut all: Vec<f64> = samples.iter().map(|sample| sample.winding).collect();
    all.retain(|&winding| winding > OUTSIDE);
    all.sort_unstable_by(f64::total_cmp);
    let sheets = all.get(all.len() / 2).copied().unwrap_or_default();
    if sheets < SEVERAL {
        return 0.0;
    }
    let [few, most] = SOME.map(|part| part * sheets);
    let within = all.len() - all.partition_point(|&winding| winding <= few);
    let between = within - (all.len() - all.partition_point(|&winding| winding < most));
    between as f64 / within.max(1) as f64
}

/// The winding numbers above `least` away from the surface, or all where those are few.
fn interior_winding_numbers(samples: &[Sample], least: f64) -> Vec<f64> {
    let inside = |counts: &dyn Fn(&Sample) -> bool| -> Vec<f64> {
        let all = samples.iter().filter(|&sample| counts(sample)).map(|sample| sample.winding);
        all.filter(|&winding| winding > least).collect()
    };
    let found = inside(&|sample| sample.is_clear);
    // Bone may be thinner than its triangles are long.
    if found.len() < FEWEST { inside(&|_| true) } else { found }
}

/// 1 where the median of the winding numbers inside is near it or more.
fn level(samples: &[Sample]) -> Option<f64> {
    let mut found = interior_winding_numbers(samples, OUTSIDE);
    if found.len() < FEWEST {
        return None;
    }
    found.sort_unstable_by(f64::total_cmp);
    let median = found[found.len() / 2];
    Some(if median > WHOLE { 1.0 } else { median })
}

fn samples(tree: &TriangleTree, cells: &WindingCells) -> Vec<Sample> {
    let (low, high) = tree.bounds();
    let clearance = 0.5 * mean_edge(tree);
    (0..SAMPLES)
        .into_par_iter()
        .map(|n| {
            let part = |axis: usize| (0.5 + (n + 1) as f64 * STEPS[axis]).fract();
            let part = Vector::new(part(0), part(1), part(2));
            let point = low + (high - low).component_mul(&part);
            Sample {
                point,
                winding: cells.winding(tree, &point),
                is_clear: !tree.has_within(&point, clearance),
            }
        })
        .collect()
}

fn mean_edge(tree: &TriangleTree) -> f64 {
    let edges = |Corners([a, b, c]): Corners| (b - a).norm() + (c - b).norm() + (a - c).norm();
    let sum: f64 = tree.facets().iter().map(|facet| edges(facet.corners)).sum();
    sum / (3 * tree.facets().len()).max(1) as f64
}
