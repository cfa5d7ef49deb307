//! Tissue in no cell of a mesh, by points: how much of it there is, in which pieces, and where.
//!
//! Points are spread evenly over the leaves that hold a boundary. Those in tissue, in no cell and deeper in what has none than chords of
//! a curved boundary are off it show that their leaf has lost its tissue: a sheet thinner than a cell is lost where lattice
//! nodes miss it, and where all nodes in it were moved to its boundary. All points of such a leaf in tissue and in no cell count.

use std::sync::LazyLock;

use nalgebra::{Matrix3, Vector3};

use super::draft::{Draft, FACES};
use super::error::MeshingError;
use super::octree::{Leaf, Leaves};
use super::rims::RimFace;
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::{TriangleSearch, TriangleSurface, Vector};
use crate::vectorised::vectorised;

/// Points of a leaf, no two of them at one height along an axis; a bit each in a `u16`.
const POINTS: usize = 16;
/// Powers of the inverse of the root of x⁴ = x + 1. Source: Roberts, The unreasonable effectiveness of quasirandom sequences, 2018.
const SPREAD: [f64; 3] =
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
/// From the lowest corner of a leaf with edges of 1, by axis.
static OFFSETS: LazyLock<[[f32; POINTS]; 3]> = LazyLock::new(|| {
    SPREAD.map(|step| std::array::from_fn(|n| (0.5 + step * (n + 1) as f64).fract() as f32))
});
/// Points so little outside a cell, in parts of its height, lie in it, so that none is between two cells by rounding.
const BETWEEN: f32 = 1e-5;
/// A point farther from all cells than this part of the edge of its leaf is lost. Chords of a boundary with the radius of an edge are
/// an eighth off it.
const DEEP: f64 = 0.25;
/// So many pieces are told.
const TOLD: usize = 20;

/// Connected tissue that is in no cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LostPiece {
    /// In mm³.
    pub volume: f64,
    /// The place of it that is nearest to its middle.
    pub at: Vector,
    /// The box around it.
    pub low: Vector,
    pub high: Vector,
}

/// All tissue that is in no cell.
#[derive(Default)]
pub(super) struct Lost {
    /// In mm³.
    pub volume: f64,
    /// The largest pieces, the largest first.
    pub pieces: Vec<LostPiece>,
}

/// Cells of a mesh, and those that were left out of it.
pub(super) struct Cells<'a> {
    pub draft: &'a Draft,
    /// The triangles of its boundary.
    pub faces: &'a [RimFace],
    /// The corners of cells of pieces apart, which are told by themselves.
    pub dropped: &'a [[Vector; 4]],
}

#[derive(Clone, Copy)]
struct Point {
    at: Vector,
    /// What it stands for, in mm³.
    volume: f64,
}

impl Lost {
    pub fn find(
        leaves: &Leaves,
        cells: &Cells,
        domain: &dyn Domain,
        watch: &Watch,
    ) -> Result<Lost, MeshingError> {
        let held = cells.held(leaves, watch)?;
        let Ok(search) = TriangleSearch::new(&cells.surface()) else { return Ok(Lost::default()) };
        let numbers = 0..leaves.list.len() as u32;
        let mixed = |&leaf: &u32| leaves.list[leaf as usize].held == Coverage::Mixed;
        let mixed: Vec<u32> = numbers.filter(mixed).collect();
        let lost_of = |&leaf: &u32| {
            let of_leaf = points(leaves, leaf).zip(0..);
            let is_out = |(point, n): &(Point, u32)| {
                held[leaf as usize] >> n & 1 == 0 && domain.value(&point.at) > 0.0
            };
            let out: Vec<Point> = of_leaf.filter(is_out).map(|(point, _)| point).collect();
            let deep = DEEP * f64::from(leaves.list[leaf as usize].size) * leaves.tree.grid.unit;
            let is_deep = |point: &Point| search.closest_within(&point.at, deep).is_none();
            if out.iter().any(is_deep) { out } else { Vec::new() }
        };
        let lost = watch.map(&mixed, lost_of)?;
        let lost = mixed.into_iter().zip(lost).filter(|(_, points)| !points.is_empty()).collect();
        Ok(Lost::of(leaves, lost))
    }

    /// Of points by their leaves, ascending; those of leaves that touch are of one piece.
    fn of(leaves: &Leaves, lost: Vec<(u32, Vec<Point>)>) -> Lost {
        let mut joined = DisjointSets::new(lost.len());
        for (number, (leaf, _)) in lost.iter().enumerate() {
            for other in around(leaves, *leaf) {
                if let Ok(other) = lost.binary_search_by_key(&other, |(leaf, _)| *leaf) {
                    joined.join(number as u32, other as u32);
                }
            }
        }
        let mut of_piece: Vec<Vec<Point>> = vec![Vec::new(); lost.len()];
        for (number, (_, points)) in lost.into_iter().enumerate() {
            of_piece[joined.root(number as u32) as usize].extend(points);
        }
        let mut pieces: Vec<LostPiece> =
            of_piece.iter().filter_map(|points| piece(points)).collect();
        let volume = pieces.iter().map(|piece| piece.volume).sum::<f64>() + 0.0;
        pieces.sort_by(|one, other| other.volume.total_cmp(&one.volume));
        pieces.truncate(TOLD);
        Lost { volume, pieces }
    }
}

impl Cells<'_> {
    /// Which points of each leaf that holds a boundary lie in a cell, a bit each.
    fn held(&self, leaves: &Leaves, watch: &Watch) -> Result<Vec<u16>, MeshingError> {
        let mut inside = watch.gather(&self.draft.tetrahedra, |tets, list| {
            let mut near = Vec::new();
            vectorised(
                #[inline(always)]
                || {
                    for tet in tets {
                        add_inside(&self.draft.corners(tet), leaves, &mut near, list);
                    }
                },
            );
        })?;
        inside.extend(watch.gather(self.dropped, |cells, list| {
            let mut near = Vec::new();
            cells.iter().for_each(|corners| add_inside(corners, leaves, &mut near, list));
        })?);
        let mut held = vec![0; leaves.list.len()];
        inside.into_iter().for_each(|(leaf, points)| held[leaf as usize] |= points);
        Ok(held)
    }

    /// Where the mesh ends, and all faces of what was left out.
    fn surface(&self) -> TriangleSurface {
        let points = self.draft.nodes.iter().chain(self.dropped.iter().flatten()).copied();
        let first = self.draft.nodes.len() as u32;
        let of_cell =
            |cell: u32| FACES.map(|face| face.map(|local| first + 4 * cell + local as u32));
        let dropped = (0..self.dropped.len() as u32).flat_map(of_cell);
        let triangles = self.faces.iter().map(|face| face.nodes).chain(dropped).collect();
        TriangleSurface { points: points.collect(), triangles, ..TriangleSurface::default() }
    }
}

/// Of a leaf.
fn points(leaves: &Leaves, leaf: u32) -> impl Iterator<Item = Point> {
    let (grid, Leaf { corner, size, .. }) = (&leaves.tree.grid, &leaves.list[leaf as usize]);
    let (edge, corner) = (f64::from(*size) * grid.unit, grid.position(*corner));
    let volume = edge.powi(3) / POINTS as f64;
    let off = |n: usize| Vector::from(OFFSETS.map(|offsets| f64::from(offsets[n])));
    (0..POINTS).map(move |n| Point { at: corner + off(n) * edge, volume })
}

/// Leaves that touch a leaf; of several smaller ones at a face or an edge not all.
fn around(leaves: &Leaves, leaf: u32) -> impl Iterator<Item = u32> {
    let Leaf { corner, size, .. } = leaves.list[leaf as usize];
    let beside = move |step: u32| {
        let steps = [step % 3, step / 3 % 3, step / 9];
        let at = [0, 1, 2].map(|axis| match steps[axis] {
            0 => corner[axis].wrapping_sub(1),
            1 => corner[axis],
            _ => corner[axis] + size,
        });
        leaves.at(at)
    };
    (0..27).filter_map(beside).filter(move |&other| other != leaf)
}

/// Adds the points of leaves in a tetrahedron, a bit each. `near` is room for leaves.
#[inline(always)]
fn add_inside(
    corners: &[Vector; 4],
    leaves: &Leaves,
    near: &mut Vec<u32>,
    list: &mut Vec<(u32, u16)>,
) {
    let low = corners.iter().fold(corners[0], |low, corner| low.inf(corner));
    let high = corners.iter().fold(corners[0], |high, corner| high.sup(corner));
    let grid = &leaves.tree.grid;
    // A conversion to integers saturates: what lies below 0 becomes 0.
    let place =
        |at: &Vector| [0, 1, 2].map(|axis| ((at[axis] - grid.origin[axis]) / grid.unit) as u32);
    near.clear();
    leaves.add_in_box(place(&low), place(&high), near);
    near.retain(|&leaf| leaves.list[leaf as usize].held == Coverage::Mixed);
    let [first, edges @ ..] = *corners;
    let edges = Matrix3::from_columns(&edges.map(|corner| corner - first));
    let Some(shares) = edges.try_inverse() else { return };
    for &leaf in near.iter() {
        let Leaf { corner, size, .. } = leaves.list[leaf as usize];
        let from = shares * (grid.position(corner) - first);
        let along = shares * (f64::from(size) * grid.unit);
        let share = |n: usize| (from[n] as f32, along.row(n).transpose().map(|by| by as f32));
        let shares = [0, 1, 2].map(share);
        if are_apart(&shares) {
            continue;
        }
        let bits = points_inside(shares);
        if bits != 0 {
            list.push((leaf, bits));
        }
    }
}

/// Whether one of the barycentric coordinates is negative all over a leaf: that of a face with the leaf in front of it.
#[inline(always)]
fn are_apart(shares: &[(f32, Vector3<f32>); 3]) -> bool {
    let rise = |along: &Vector3<f32>| along.x.max(0.0) + along.y.max(0.0) + along.z.max(0.0);
    let [a, b, c] = shares;
    let last = (1.0 - a.0 - b.0 - c.0, -(a.1 + b.1 + c.1));
    [a, b, c, &last].into_iter().any(|(from, along)| from + rise(along) < -BETWEEN)
}

/// The points of a leaf in a tetrahedron, a bit each, by three of its barycentric coordinates: at the lowest corner of the leaf, and how they
/// change along its edges.
#[inline(always)]
fn points_inside(shares: [(f32, Vector3<f32>); 3]) -> u16 {
    let [xs, ys, zs] = &*OFFSETS;
    let (mut least, mut last) = ([1.0_f32; POINTS], [1.0_f32; POINTS]);
    for (from, along) in shares {
        for n in 0..POINTS {
            let share = from + along.x * xs[n] + along.y * ys[n] + along.z * zs[n];
            least[n] = least[n].min(share);
            last[n] -= share;
        }
    }
    let is_inside = |n: usize| least[n].min(last[n]) >= -BETWEEN;
    (0..POINTS).fold(0, |bits, n| bits | u16::from(is_inside(n)) << n)
}

fn piece(points: &[Point]) -> Option<LostPiece> {
    let first = points.first()?.at;
    let volume: f64 = points.iter().map(|point| point.volume).sum();
    let mean = points.iter().map(|point| point.at * point.volume).sum::<Vector>() / volume;
    let off = |point: &&Point| (point.at - mean).norm();
    let nearest = points.iter().min_by(|one, other| off(one).total_cmp(&off(other)))?;
    let low = points.iter().fold(first, |low, point| low.inf(&point.at));
    let high = points.iter().fold(first, |high, point| high.sup(&point.at));
    Some(LostPiece { volume, at: nearest.at, low, high })
}
