//! Cells that stand twice in a mesh: their stiffness counts twice.

use super::{VolumeMesh, Warning};

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
    let warning = Warning::new("duplicate-cells", detail).with("count", count as f64);
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
