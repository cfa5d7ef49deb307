//! Interior of a cell: the tetrahedra between its middle and the triangles of its faces.

use super::{Cells, Vector};

/// Whether a point lies in a cell whose nodes are at `positions`, in mm.
pub(super) fn contains(cells: &Cells, cell: usize, positions: &[Vector], at: &Vector) -> bool {
    let tetrahedra = Tetrahedron::of_cell(cells, cell, positions);
    tetrahedra.into_iter().any(|own| own.shares(at).iter().all(|share| *share >= 0.0))
}

/// Where a straight way from one place to another is in a cell, between the first and the last place there, as parts of the way;
/// none where it passes by or only touches a point.
pub(super) fn part_inside(
    cells: &Cells,
    cell: usize,
    positions: &[Vector],
    [from, to]: [&Vector; 2],
) -> Option<[f64; 2]> {
    let tetrahedra = Tetrahedron::of_cell(cells, cell, positions);
    let within = |own: Tetrahedron| {
        let ends = own.shares(from).into_iter().zip(own.shares(to));
        let part = ends.fold([0.0, 1.0], |[low, high], (at_from, at_to)| match at_to - at_from {
            slope if slope > 0.0 => [f64::max(low, -at_from / slope), high],
            slope if slope < 0.0 => [low, f64::min(high, -at_from / slope)],
            _ if at_from < 0.0 => [1.0, 0.0],
            _ => [low, high],
        });
        (part[0] < part[1]).then_some(part)
    };
    let parts = tetrahedra.into_iter().filter_map(within);
    parts.reduce(|[low, high], own| [low.min(own[0]), high.max(own[1])])
}

/// A tetrahedron by its apex and the ways from there to its other corners, which are counter-clockwise from outside.
struct Tetrahedron {
    apex: Vector,
    sides: [Vector; 3],
    /// Six times its volume, which is positive.
    volume: f64,
}

impl Tetrahedron {
    /// Those of a cell that are not turned inside out.
    fn of_cell(
        cells: &Cells,
        cell: usize,
        positions: &[Vector],
    ) -> impl IntoIterator<Item = Tetrahedron> {
        let nodes = cells.nodes(cell);
        let middle = nodes.iter().map(|&node| positions[node as usize]).sum::<Vector>();
        let apex = middle / nodes.len() as f64;
        let side = move |local: usize| positions[nodes[local] as usize] - apex;
        // The corners of a face are counter-clockwise from outside.
        let triangles = cells
            .shape(cell)
            .faces()
            .iter()
            .flat_map(|face| (1..face.len() - 1).map(move |k| [face[0], face[k], face[k + 1]]));
        triangles.filter_map(move |corners| {
            let sides = corners.map(side);
            let volume = sides[0].dot(&sides[1].cross(&sides[2]));
            (volume > 0.0).then_some(Tetrahedron { apex, sides, volume })
        })
    }

    /// How far a place is from each side, as a multiple of what the corner before it is, times six volumes: all are positive
    /// inside.
    fn shares(&self, at: &Vector) -> [f64; 4] {
        let at = at - self.apex;
        let [a, b, c] = &self.sides;
        let shares = [[&at, b, c], [a, &at, c], [a, b, &at]];
        let [of_a, of_b, of_c] = shares.map(|[a, b, c]| a.dot(&b.cross(c)));
        [of_a, of_b, of_c, self.volume - (of_a + of_b + of_c)]
    }
}
