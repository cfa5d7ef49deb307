//! Connectivity of triangles over their edges: patches that agree on a side, pieces, and open edges.

use super::triangle::Corners;
use crate::mesh::disjoint_sets::DisjointSets;

/// One of the three edges of a triangle.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// Lower point first.
    ends: [u32; 2],
    triangle: u32,
    /// The triangle goes from the lower point to the higher.
    rises: bool,
    /// The number of the edge in its triangle.
    local: u8,
}

/// The sides of all triangles, those of one edge together.
pub(super) struct Edges {
    sides: Vec<Side>,
    triangles: usize,
}

/// Triangles that hang together over edges of two triangles each.
pub(super) struct Patches {
    /// Triangles to be turned so that those of a patch agree with the larger part of its area.
    pub turned: Vec<bool>,
    pub members: Vec<Vec<u32>>,
    /// In mm².
    pub areas: Vec<f64>,
}

/// Triangles that hang together over edges of any kind.
pub(super) struct Pieces {
    pub piece_of: Vec<u32>,
    pub count: usize,
}

impl Edges {
    pub(super) fn new(triangles: &[[u32; 3]]) -> Edges {
        let side = |triangle: usize, local: usize| {
            let corners = triangles[triangle];
            let (from, to) = (corners[local], corners[(local + 1) % 3]);
            let ends = [from.min(to), from.max(to)];
            Side { ends, triangle: triangle as u32, rises: from < to, local: local as u8 }
        };
        let count = triangles.len();
        let mut sides: Vec<Side> = (0..count)
            .flat_map(|n| (0..3).map(move |local| (n, local)))
            .map(|(n, local)| side(n, local))
            .collect();
        sides.sort_unstable_by_key(|side| (side.ends, side.triangle));
        Edges { sides, triangles: count }
    }

    fn of_one_edge(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.ends == b.ends)
    }

    pub(super) fn patches(&self, corners: &[Corners]) -> Patches {
        let across = self.neighbours();
        let mut turned = vec![false; self.triangles];
        let mut seen = vec![false; self.triangles];
        let (mut members, mut areas) = (Vec::new(), Vec::new());
        for first in 0..self.triangles {
            if std::mem::replace(&mut seen[first], true) {
                continue;
            }
            let mut patch = vec![first as u32];
            let mut next = 0;
            while let Some(&here) = patch.get(next) {
                next += 1;
                for &(there, differs) in across[here as usize].iter().flatten() {
                    if !std::mem::replace(&mut seen[there as usize], true) {
                        turned[there as usize] = turned[here as usize] != differs;
                        patch.push(there);
                    }
                }
            }
            areas.push(orient_by_majority(&patch, corners, &mut turned));
            members.push(patch);
        }
        Patches { turned, members, areas }
    }

    /// For each edge of a triangle the one other triangle at it, and whether that shows its other side.
    fn neighbours(&self) -> Vec<[Option<(u32, bool)>; 3]> {
        let mut across = vec![[None; 3]; self.triangles];
        for edge in self.of_one_edge() {
            if let [a, b] = edge {
                // Triangles of the same side go along their edge in opposite directions.
                let differs = a.rises == b.rises;
                across[a.triangle as usize][a.local as usize] = Some((b.triangle, differs));
                across[b.triangle as usize][b.local as usize] = Some((a.triangle, differs));
            }
        }
        across
    }

    pub(super) fn pieces(&self) -> Pieces {
        let mut sets = DisjointSets::new(self.triangles);
        for edge in self.of_one_edge() {
            edge.windows(2).for_each(|pair| sets.join(pair[0].triangle, pair[1].triangle));
        }
        let (piece_of, count) = sets.numbers();
        Pieces { piece_of, count: count as usize }
    }

    /// Of how many edges triangles go one way more often than the other.
    pub(super) fn open_count(&self, turned: &[bool]) -> usize {
        self.of_one_edge().filter(|edge| excess(edge, turned) != 0).count()
    }

    /// Edges of one triangle alone, each as that triangle goes along it.
    pub(super) fn borders(&self, turned: &[bool]) -> Vec<[u32; 2]> {
        let lone =
            self.of_one_edge().filter_map(|edge| if let [side] = edge { Some(side) } else { None });
        lone.map(|side| match side.rises != turned[side.triangle as usize] {
            true => side.ends,
            false => [side.ends[1], side.ends[0]],
        })
        .collect()
    }

    /// For each edge of each triangle its length in mm if triangles go along it one way more often than the other, times
    /// how much more often, shared by the triangles there; otherwise 0.
    pub(super) fn open_lengths(&self, corners: &[Corners], turned: &[bool]) -> Vec<[f64; 3]> {
        let mut lengths = vec![[0.0; 3]; self.triangles];
        for edge in self.of_one_edge() {
            let excess = excess(edge, turned);
            for side in edge.iter().filter(|_| excess != 0) {
                let corners = corners[side.triangle as usize].0;
                let (from, to) = (side.local as usize, (side.local as usize + 1) % 3);
                let share = f64::from(excess) / edge.len() as f64;
                lengths[side.triangle as usize][from] =
                    share * (corners[to] - corners[from]).norm();
            }
        }
        lengths
    }
}

fn excess(edge: &[Side], turned: &[bool]) -> u32 {
    let one_way = |side: &&Side| side.rises != turned[side.triangle as usize];
    let rising = edge.iter().filter(one_way).count();
    (2 * rising).abs_diff(edge.len()) as u32
}

/// Flips the whole patch where the larger part of its area was flipped; returns its area in mm².
fn orient_by_majority(patch: &[u32], corners: &[Corners], turned: &mut [bool]) -> f64 {
    let area = |n: u32| corners[n as usize].area_vector().norm();
    let all: f64 = patch.iter().map(|&n| area(n)).sum();
    let changed: f64 = patch.iter().filter(|&&n| turned[n as usize]).map(|&n| area(n)).sum();
    if changed > 0.5 * all {
        patch.iter().for_each(|&n| turned[n as usize] = !turned[n as usize]);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vector;

    /// Two triangles of a square, and one beside them that shares a corner.
    fn corners() -> ([[u32; 3]; 3], Vec<Corners>) {
        let at = |x: f64, y: f64| Vector::new(x, y, 0.0);
        let points =
            [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0), at(5.0, 5.0), at(5.0, 6.0)];
        let triangles = [[0, 1, 2], [0, 3, 2], [2, 4, 5]];
        let corners = triangles.map(|three: [u32; 3]| Corners(three.map(|p| points[p as usize])));
        (triangles, corners.to_vec())
    }

    #[test]
    fn triangles_of_two_sides_are_made_to_agree_and_their_edge_is_no_longer_open() {
        let (triangles, corners) = corners();
        let edges = Edges::new(&triangles);
        assert_eq!(edges.open_count(&[false; 3]), 8);
        let patches = edges.patches(&corners);
        assert_eq!(patches.turned, [false, true, false]);
        assert_eq!(edges.open_count(&patches.turned), 7);
        assert_eq!(patches.areas.len(), 2);
        assert_eq!(edges.pieces().count, 2);
        let open = edges.open_lengths(&corners, &patches.turned);
        assert_eq!(open[0], [1.0, 1.0, 0.0]);
        assert_eq!(open[1], [1.0, 1.0, 0.0]);
        // Twice the diagonal, half of it with each.
        let open = edges.open_lengths(&corners, &[false; 3]);
        assert!((open[0][2] - 2f64.sqrt()).abs() < 1e-12);
    }
}
