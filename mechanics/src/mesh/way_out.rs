//! Way out of tissue from a place in it: cells are visited from that which it is in, the nearest first, up to the closest place of
//! their boundary.
//!
//! Tissue around what has the place itself is not taken for that unless it is connected within this distance.

use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;

use super::bounds::to_parry;
use super::{Cells, TriangleSurface, Vector, bounds_of};
use crate::rows::Rows;

/// Distances that differ by less than this part are one.
pub(super) const ROUNDING: f64 = 1e-9;

/// Cells and their boundary, from node to node.
pub(super) struct WaysOut<'a> {
    cells: &'a Cells,
    positions: &'a [Vector],
    boundary: &'a TriangleSurface,
    node_of: &'a [u32],
    /// The cells around each node.
    around: Rows<u32>,
    /// The triangles of the boundary around each node.
    fans: Rows<u32>,
}

/// A cell that is to be visited, the nearest first.
#[derive(PartialEq)]
struct Ahead {
    squared_distance: f64,
    cell: u32,
}

impl Eq for Ahead {}

impl Ord for Ahead {
    fn cmp(&self, other: &Self) -> Ordering {
        let nearer = other.squared_distance.total_cmp(&self.squared_distance);
        nearer.then(other.cell.cmp(&self.cell))
    }
}

impl PartialOrd for Ahead {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<'a> WaysOut<'a> {
    pub fn new(
        cells: &'a Cells,
        positions: &'a [Vector],
        boundary: &'a TriangleSurface,
        node_of: &'a [u32],
    ) -> Self {
        let mut corners = Rows::default();
        for triangle in &boundary.triangles {
            corners.push(triangle.map(|corner| node_of[corner as usize]));
        }
        let (around, fans) = (cells.around(positions.len()), corners.inverted(positions.len()));
        WaysOut { cells, positions, boundary, node_of, around, fans }
    }

    /// From a place in a cell, which is one of a point of the boundary or of an edge between two, in mm; none where it lies in front
    /// of the boundary after all, as beside a face that is not flat.
    pub fn shortest(&self, at: &Vector, own: &[u32], first: u32) -> Option<f64> {
        let (mut shortest, mut is_behind) = (f64::INFINITY, false);
        let mut seen = BTreeSet::from([first]);
        let mut ahead = BinaryHeap::from([Ahead { squared_distance: 0.0, cell: first }]);
        while let Some(Ahead { squared_distance, cell }) = ahead.pop() {
            if squared_distance >= shortest * shortest {
                break;
            }
            let nodes = self.cells.nodes(cell as usize);
            let triangles = nodes.iter().flat_map(|&node| self.fans.row(node as usize));
            for &triangle in triangles {
                let (distance, behind) = self.distance(at, triangle, (own, nodes));
                // At an edge it is behind one of both.
                if distance < shortest * (1.0 - ROUNDING) {
                    (shortest, is_behind) = (distance, behind);
                } else if distance <= shortest * (1.0 + ROUNDING) {
                    is_behind |= behind;
                }
            }
            for &next in nodes.iter().flat_map(|&node| self.around.row(node as usize)) {
                if seen.insert(next) {
                    let squared_distance = self.squared_distance(at, next);
                    ahead.push(Ahead { squared_distance, cell: next });
                }
            }
        }
        is_behind.then_some(shortest)
    }

    /// From a triangle of the boundary that is of a cell, but not around what has the place; and whether the place is behind it.
    fn distance(&self, at: &Vector, triangle: u32, (own, nodes): (&[u32], &[u32])) -> (f64, bool) {
        let corners = &self.boundary.triangles[triangle as usize];
        let is_of_cell = corners.iter().all(|&one| nodes.contains(&self.node_of[one as usize]));
        if !is_of_cell || own.iter().all(|point| corners.contains(point)) {
            return (f64::INFINITY, false);
        }
        let triangle = triangle as usize;
        let places = self.boundary.corners(triangle).map(|corner| corner - at);
        let is_behind = self.boundary.area_vector(triangle).dot(&places[0]) > 0.0;
        let [a, b, c] = places.map(|corner| to_parry(&corner));
        let distance = Triangle::new(a, b, c).distance_to_local_point(ParryVector::ZERO, true);
        (distance, is_behind)
    }

    /// From the box around a cell.
    fn squared_distance(&self, at: &Vector, cell: u32) -> f64 {
        let corners = self.cells.nodes(cell as usize).iter();
        let bounds = bounds_of(corners.map(|&node| &self.positions[node as usize]));
        bounds.map_or(f64::INFINITY, |[low, high]| {
            (low - at).sup(&(at - high)).sup(&Vector::zeros()).norm_squared()
        })
    }
}
