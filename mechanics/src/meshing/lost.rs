//! Tissue in no cell, by points: how much of it is in one piece, and where.
//!
//! Points are spread evenly over the leaves that hold a boundary. A leaf with little of its tissue in cells counts, so that the
//! chords of a curved boundary do not: a sheet thinner than a cell is lost where lattice nodes miss it, and where all nodes
//! in it were moved to its boundary.

use super::draft::Draft;
use super::error::MeshingError;
use super::octree::{Leaf, Leaves};
use super::shape::determinant;
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::Vector;
use crate::mesh::clusters::{Clusters, clusters};
use crate::mesh::cubes::Cubes;

/// Points of a leaf, no two of them at one height along an axis.
const POINTS: usize = 16;
/// Powers of the inverse of the root of x⁴ = x + 1. Source: Roberts, The unreasonable effectiveness of quasirandom sequences, 2018.
const SPREAD: [f64; 3] =
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
/// A leaf with at least so many points of tissue in no cell, and at most as many in one, has lost its tissue.
const LOST_POINTS: usize = 3;
/// So many pieces are told.
const TOLD: usize = 20;

/// Connected tissue that is in no cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LostPiece {
    /// In mm³.
    pub volume: f64,
    /// The place of it that is nearest to its middle.
    pub at: Vector,
}

#[derive(Clone, Copy)]
struct Point {
    at: Vector,
    /// What it stands for, in mm³.
    volume: f64,
}

/// The largest pieces, the largest first.
pub(super) fn find(
    leaves: &Leaves,
    draft: &Draft,
    domain: &dyn Domain,
    watch: &Watch,
) -> Result<Vec<LostPiece>, MeshingError> {
    let unit = leaves.tree.grid.unit;
    let points = points(leaves);
    let numbered = (0_u32..).zip(&points).map(|(number, point)| (number, point.at));
    let cubes = Cubes::new(4.0 * unit, numbered);
    let held = watch.gather(&draft.tetrahedra, |tets, list| {
        tets.iter().for_each(|tet| add_inside(&draft.corners(tet), &cubes, &points, list));
    })?;
    let mut is_held = vec![false; points.len()];
    held.into_iter().for_each(|point| is_held[point as usize] = true);
    let firsts: Vec<usize> = (0..points.len()).step_by(POINTS).collect();
    let lost_of = |&first: &usize| {
        let of_leaf = first..first + POINTS;
        let held = of_leaf.clone().filter(|&point| is_held[point]).count();
        if held > POINTS / 2 {
            return Vec::new();
        }
        let is_lost = |point: &usize| !is_held[*point] && domain.value(&points[*point].at) > 0.0;
        let lost: Vec<usize> = of_leaf.filter(is_lost).collect();
        if lost.len() >= LOST_POINTS.max(held) { lost } else { Vec::new() }
    };
    let lost = watch.map(&firsts, lost_of)?;
    let lost: Vec<Point> = lost.into_iter().flatten().map(|point| points[point]).collect();
    Ok(pieces(&lost, 2.0 * unit))
}

/// Of each leaf that holds a boundary.
fn points(leaves: &Leaves) -> Vec<Point> {
    let grid = &leaves.tree.grid;
    let mixed = leaves.list.iter().filter(|leaf| leaf.held == Coverage::Mixed);
    let of_leaf = |leaf: &Leaf| {
        let (edge, corner) = (f64::from(leaf.size) * grid.unit, grid.position(leaf.corner));
        (0..POINTS).map(move |n| {
            let off = Vector::from(SPREAD.map(|step| (0.5 + step * (n + 1) as f64).fract()));
            Point { at: corner + off * edge, volume: edge.powi(3) / POINTS as f64 }
        })
    };
    mixed.flat_map(of_leaf).collect()
}

/// Adds the points in a tetrahedron.
fn add_inside(corners: &[Vector; 4], cubes: &Cubes, points: &[Point], list: &mut Vec<u32>) {
    let low = corners.iter().fold(corners[0], |low, corner| low.inf(corner));
    let high = corners.iter().fold(corners[0], |high, corner| high.sup(corner));
    let is_inside = |point: &u32| {
        (0..4).all(|corner| {
            let mut part = *corners;
            part[corner] = points[*point as usize].at;
            determinant(&part) >= 0.0
        })
    };
    list.extend(cubes.in_box(&low, &high).filter(is_inside));
}

/// Points in neighbouring cubes together.
fn pieces(points: &[Point], width: f64) -> Vec<LostPiece> {
    let places: Vec<Vector> = points.iter().map(|point| point.at).collect();
    let Clusters { of_place, count } = clusters(&places, width);
    let mut of_cluster: Vec<Vec<Point>> = vec![Vec::new(); count];
    points.iter().zip(of_place).for_each(|(point, cluster)| of_cluster[cluster].push(*point));
    let mut pieces: Vec<LostPiece> = of_cluster.iter().filter_map(|points| piece(points)).collect();
    pieces.sort_by(|one, other| other.volume.total_cmp(&one.volume));
    pieces.truncate(TOLD);
    pieces
}

fn piece(points: &[Point]) -> Option<LostPiece> {
    let volume: f64 = points.iter().map(|point| point.volume).sum();
    let mean = points.iter().map(|point| point.at * point.volume).sum::<Vector>() / volume;
    let off = |point: &&Point| (point.at - mean).norm();
    let nearest = points.iter().min_by(|one, other| off(one).total_cmp(&off(other)))?;
    Some(LostPiece { volume, at: nearest.at })
}
