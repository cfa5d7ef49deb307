//! The edges of a triangle surface, sorted, so that triangles that meet lie side by side.

use super::TriangleSurface;

/// One side of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TriangleSide {
    /// The two points in ascending order.
    pub points: [u32; 2],
    pub triangle: u32,
    /// The triangle runs from the smaller to the larger point.
    pub ascending: bool,
}

/// How often edges are shared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EdgeCounts {
    /// Edges of one triangle only: the border of an open surface.
    pub open: u64,
    /// Edges of three triangles or more.
    pub nonmanifold: u64,
    /// Edges whose two triangles disagree about inside and outside.
    pub inconsistent: u64,
}

impl TriangleSurface {
    /// All sides of all triangles in the order of their points.
    pub fn sorted_sides(&self) -> Vec<TriangleSide> {
        let mut sides = Vec::with_capacity(self.triangles.len() * 3);
        for (triangle, &[a, b, c]) in self.triangles.iter().enumerate() {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                sides.push(TriangleSide {
                    points: [from.min(to), from.max(to)],
                    triangle: triangle as u32,
                    ascending: from < to,
                });
            }
        }
        sides.sort_unstable();
        sides
    }

    /// Whether every edge belongs to more than one triangle.
    pub fn is_closed(&self) -> bool {
        count_edges(&self.sorted_sides()).open == 0
    }

    /// The same surface with every triangle cut into four at the middles of its sides; a closed one stays closed.
    #[must_use]
    pub fn with_sides_halved(&self) -> TriangleSurface {
        let sides = self.sorted_sides();
        let halved: Vec<[u32; 2]> = edges(&sides).map(|edge| edge[0].points).collect();
        let first = self.points.len() as u32;
        let middle = |a: u32, b: u32| {
            let place = halved.binary_search(&[a.min(b), a.max(b)]).unwrap_or_default();
            first + place as u32
        };
        let centre =
            |[a, b]: &[u32; 2]| (self.points[*a as usize] + self.points[*b as usize]) * 0.5;
        let cut = |&[a, b, c]: &[u32; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        TriangleSurface {
            points: self.points.iter().copied().chain(halved.iter().map(centre)).collect(),
            triangles: self.triangles.iter().flat_map(cut).collect(),
            ..TriangleSurface::default()
        }
    }
}

/// The groups of sides that are the same edge.
pub fn edges(sides: &[TriangleSide]) -> impl Iterator<Item = &[TriangleSide]> {
    sides.chunk_by(|one, other| one.points == other.points)
}

pub fn count_edges(sides: &[TriangleSide]) -> EdgeCounts {
    let mut counts = EdgeCounts::default();
    for edge in edges(sides) {
        match edge {
            [_] => counts.open += 1,
            [one, other] => counts.inconsistent += u64::from(one.ascending == other.ascending),
            _ => counts.nonmanifold += 1,
        }
    }
    counts
}
