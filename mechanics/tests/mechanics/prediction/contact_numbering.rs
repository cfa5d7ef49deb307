//! Contact does not depend on how a mesh is numbered: scenes with nodes and cells in another order, and with cells that begin at
//! another corner.

use std::sync::Arc;

use mechanics::draws::Draws;
use mechanics::mesh::{CellShape, VolumeMesh};
use mechanics::prediction::{Case, Method, Plan, Settings};

use super::contact::{blocks_of, jaws_of, raised, unilateral};
use crate::scenes::{SHAPES, solve};

/// The same cell that begins at the next corner of its base.
fn turned(shape: CellShape, nodes: &[u32]) -> Vec<u32> {
    let order: &[usize] = match shape {
        CellShape::Tet4 => &[1, 2, 0, 3],
        CellShape::Hex8 => &[1, 2, 3, 0, 5, 6, 7, 4],
        CellShape::Wedge6 => &[1, 2, 0, 4, 5, 3],
    };
    order.iter().map(|&place| nodes[place]).collect()
}

/// The numbers 0 to `count` - 1 in another order.
fn shuffled(count: usize, draws: &mut Draws) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    (1..count).for_each(|place| order.swap(place, draws.whole(0, place)));
    order
}

/// A case with nodes and cells in another order and cells that begin at other corners, and the number of each node in it.
fn renumbered(case: &Case, seed: u64) -> (Case, Vec<usize>) {
    let draws = &mut Draws::of(seed, 0);
    let old = &case.volume;
    let number = shuffled(old.nodes.len(), draws);
    let mut mesh = VolumeMesh { nodes: old.nodes.clone(), ..VolumeMesh::default() };
    old.nodes.iter().zip(&number).for_each(|(node, &number)| mesh.nodes[number] = *node);
    for cell in shuffled(old.cells.len(), draws) {
        let shape = old.cells.shape(cell);
        let own = old.cells.nodes(cell).iter().map(|&node| number[node as usize] as u32);
        let mut own: Vec<u32> = own.collect();
        (0..draws.whole(0, 3)).for_each(|_| own = turned(shape, &own));
        mesh.cells.push(shape, &own);
    }
    for (name, nodes) in &old.node_sets {
        let mut own: Vec<u32> = nodes.iter().map(|&node| number[node as usize] as u32).collect();
        own.sort_unstable();
        mesh.node_sets.insert(name.clone(), own);
    }
    (Case { volume: Arc::new(mesh), ..case.clone() }, number)
}

/// How far apart the answers of a scene in two numberings are at most, in mm.
fn difference(case: &Case, plan: &Plan, settings: &Settings) -> f64 {
    let found = solve(case, plan, settings).displacement;
    let (other, number) = renumbered(case, 7);
    let other = solve(&other, plan, settings).displacement;
    let pairs = found.iter().zip(&number);
    pairs.map(|(u, &number)| (u - other[number]).norm()).fold(0.0, f64::max)
}

/// But for normals of tissue, which may be 0.1 degrees old, and which of them are depends on rounding. Faces of four nodes were once cut
/// along the diagonal of their first node, and answers of hexahedra were .09 mm apart.
#[test]
fn contact_is_the_same_however_a_mesh_is_numbered() {
    for shape in SHAPES {
        let (blocks, pressed) = blocks_of(shape);
        for method in [Method::FemLinear, Method::FemNonlinear] {
            let settings = Settings { method: method.clone(), ..unilateral() };
            let off = difference(&blocks, &pressed, &settings);
            println!("blocks {shape:?} {method:?}: {off:.1e}");
            let most = if method == Method::FemLinear { 3e-3 } else { 5e-3 };
            assert!(off < most, "blocks {shape:?} {method:?}: {off:.1e}");
        }
        let off = difference(&jaws_of(shape, 2.5), &raised(6.0), &unilateral());
        println!("jaws {shape:?}: {off:.1e}");
        assert!(off < 1e-3, "jaws {shape:?}: {off:.1e}");
    }
}
