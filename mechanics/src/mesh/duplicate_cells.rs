//! Cells that stand twice in a mesh: their stiffness counts twice.

use rayon::prelude::*;

use super::{CellShape, VolumeMesh, Warning};

/// The code of their warning.
pub const DUPLICATE_CELLS: &str = "duplicate-cells";

/// The lowest two corners of a cell, which cells of the same corners share.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    lowest: [u32; 2],
    cell: u32,
}

/// The warning of cells with the same nodes as an earlier one, in whatever order.
pub fn duplicate_cells(mesh: &VolumeMesh) -> Option<Warning> {
    let nodes = |cell: u32| -> Vec<u32> {
        let mut nodes = mesh.cells.nodes(cell as usize).to_vec();
        nodes.sort_unstable();
        nodes
    };
    let mut keys: Vec<Key> = (0..mesh.cells.len() as u32).map(|cell| key(mesh, cell)).collect();
    keys.sort_unstable();
    let mut repeated: Vec<u32> = Vec::new();
    for group in keys.chunk_by(|one, other| one.lowest == other.lowest) {
        let mut same: Vec<(Vec<u32>, u32)> =
            group.iter().map(|key| (nodes(key.cell), key.cell)).collect();
        same.sort_unstable();
        let pairs = same.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        repeated.extend(pairs.map(|pair| pair[1].1));
    }
    let (count, first) = (repeated.len(), repeated.into_iter().min()?);
    let detail = format!(
        "{count} cells have the nodes of an earlier one, cell {first} the first of them: tissue is there twice, and twice \
         as stiff"
    );
    let warning = Warning::new(DUPLICATE_CELLS, detail).with("count", count as f64);
    Some(warning.with("first_cell", f64::from(first)))
}

fn key(mesh: &VolumeMesh, cell: u32) -> Key {
    let mut lowest = [u32::MAX; 2];
    for &node in mesh.cells.nodes(cell as usize) {
        if node < lowest[0] {
            lowest = [node, lowest[0]];
        } else if node < lowest[1] {
            lowest[1] = node;
        }
    }
    Key { lowest, cell }
}

/// A triangle of a face: its nodes, ascending, then its cell and which way round they are seen from outside.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side(u128);

impl Side {
    fn new(cell: usize, mut nodes: [u32; 3]) -> Side {
        let mut is_swapped = false;
        for [a, b] in [[0, 1], [1, 2], [0, 1]] {
            if nodes[a] > nodes[b] {
                nodes.swap(a, b);
                is_swapped = !is_swapped;
            }
        }
        let nodes = nodes.iter().fold(0, |bits, &node| bits << 32 | u128::from(node));
        Side(nodes << 32 | (cell as u128) << 1 | u128::from(is_swapped))
    }

    fn has_nodes_of(&self, other: &Side) -> bool {
        self.0 >> 32 == other.0 >> 32
    }

    fn cell(self) -> u32 {
        self.0 as u32 >> 1
    }

    fn is_swapped(self) -> bool {
        self.0 & 1 == 1
    }
}

/// The warning of cells that lie on the same side of a face, or of three nodes of a face of four, as a cell of another shape:
/// a layer that is there as hexahedra and as tetrahedra too.
pub fn cells_of_two_shapes(mesh: &VolumeMesh) -> Option<Warning> {
    let mut sides = sides_at_other_shapes(mesh);
    sides.par_sort_unstable();
    let mut doubled: Vec<[u32; 2]> = Vec::new();
    let shape = |side: Side| mesh.cells.shape(side.cell() as usize);
    // Of each shape the first on each side.
    let mut firsts: Vec<Side> = Vec::new();
    for same in sides.chunk_by(Side::has_nodes_of) {
        firsts.clear();
        for &later in same {
            let beside = || firsts.iter().filter(|own| own.is_swapped() == later.is_swapped());
            let double = beside().find(|own| lie_in_each_other(mesh, [own.cell(), later.cell()]));
            doubled.extend(double.map(|earlier| [later.cell(), earlier.cell()]));
            if beside().all(|own| shape(*own) != shape(later)) {
                firsts.push(later);
            }
        }
    }
    doubled.sort_unstable();
    doubled.dedup_by_key(|[later, _]| *later);
    let [later, earlier] = *doubled.first()?;
    let [shape, other] = [later, earlier].map(|cell| mesh.cells.shape(cell as usize).name());
    let detail = format!(
        "{} cells lie on the same side of a face as a cell of another shape, the first of them cell {later} ({shape}) where cell \
         {earlier} ({other}) is: tissue is there twice, and twice as stiff",
        doubled.len()
    );
    let warning = Warning::new(DUPLICATE_CELLS, detail).with("count", doubled.len() as f64);
    Some(warning.with("first_cell", f64::from(later)).with("other_cell", f64::from(earlier)))
}

/// The triangles of faces whose nodes belong to cells of another shape too; of a face of four each three of its nodes.
fn sides_at_other_shapes(mesh: &VolumeMesh) -> Vec<Side> {
    let bit = |shape: CellShape| match shape {
        CellShape::Tet4 => 1_u8,
        CellShape::Hex8 => 2,
        CellShape::Wedge6 => 4,
    };
    let mut shapes = vec![0_u8; mesh.nodes.len()];
    for (shape, nodes) in mesh.cells.iter() {
        nodes.iter().for_each(|&node| shapes[node as usize] |= bit(shape));
    }
    let mut sides = Vec::new();
    for (cell, (shape, nodes)) in mesh.cells.iter().enumerate() {
        let is_other = |node: &u32| shapes[*node as usize] != bit(shape);
        if nodes.iter().filter(|node| is_other(node)).count() < 3 {
            continue;
        }
        for face in shape.faces() {
            let at = |corner: usize| nodes[face[corner % face.len()]];
            let starts = if face.len() == 3 { 0..1 } else { 0..4 };
            let triangles = starts.map(|start| [at(start), at(start + 1), at(start + 2)]);
            let triangles = triangles.filter(|triangle| triangle.iter().all(is_other));
            sides.extend(triangles.map(|triangle| Side::new(cell, triangle)));
        }
    }
    sides
}

/// Whether two cells on one side of a triangle are of two shapes, and neither is a tetrahedron of the four corners of a face of
/// the other, which fills what a face that is not flat leaves open.
fn lie_in_each_other(mesh: &VolumeMesh, cells: [u32; 2]) -> bool {
    let [one, other] = cells.map(|cell| cell as usize);
    let fills_face = |filling: usize, cell: usize| {
        let (filling, nodes) = (mesh.cells.nodes(filling), mesh.cells.nodes(cell));
        let in_filling = |&local: &usize| filling.contains(&nodes[local]);
        let mut faces = mesh.cells.shape(cell).faces().iter();
        filling.len() == 4 && faces.any(|face| face.len() == 4 && face.iter().all(in_filling))
    };
    mesh.cells.shape(one) != mesh.cells.shape(other)
        && !fills_face(one, other)
        && !fills_face(other, one)
}
