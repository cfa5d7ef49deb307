//! The lattice of a graded octree fills it.

use std::collections::HashMap;

use super::draft::FACES;
use super::grid::Grid;
use super::lattice::Lattice;
use super::octree::Octree;
use super::shape::{determinant, worst_sine};
use super::size::SizeField;
use super::watch::Watch;
use crate::domain::{Boundary, Coverage, Crossing, Domain};
use crate::mesh::Vector;
use crate::progress::Unobserved;

/// Tissue without end.
struct UnboundedTissue;

impl Domain for UnboundedTissue {
    fn bounds(&self) -> (Vector, Vector) {
        (Vector::zeros(), Vector::repeat(32.0))
    }

    fn coverage(&self, _: &Vector, _: f64) -> Coverage {
        Coverage::Inside
    }

    fn value(&self, _: &Vector) -> f64 {
        1.0
    }

    fn crossing(&self, inside: &Vector, _: &Vector) -> Crossing {
        Crossing { point: *inside, boundary: Boundary::Skin }
    }

    fn projection(&self, point: &Vector, _: Boundary) -> Vector {
        *point
    }

    fn thickness(&self, _: &Vector) -> f64 {
        f64::INFINITY
    }
}

/// One corner of a box divided again and again.
fn graded() -> Lattice {
    let size = SizeField { finest: 1.0, coarsest: 16.0, ..SizeField::uniform(1.0) };
    let (low, high) = UnboundedTissue.bounds();
    let mut tree = Octree::new(Grid::new(&low, &high, &size).unwrap());
    let depth = tree.grid.depth;
    assert!(depth >= 3);
    let middle = tree.levels[0].len() as u32 / 2;
    tree.split(middle);
    for level in 1..depth {
        let cells = tree.levels[usize::from(level)].clone();
        tree.split(cells[usize::from(level) % cells.len()]);
        tree.split(*cells.last().unwrap());
    }
    tree.balance();
    let leaves = tree.into_leaves();
    Lattice::new(&leaves, &UnboundedTissue, &Watch::new(&Unobserved, 1)).unwrap()
}

#[test]
fn a_graded_lattice_has_no_hanging_node_and_all_its_cells_are_the_right_way_round() {
    let lattice = graded();
    let mut faces: HashMap<[u32; 3], Vec<u32>> = HashMap::new();
    for (number, tet) in lattice.tetrahedra.iter().enumerate() {
        let corners = tet.map(|node| lattice.position(node));
        assert!(determinant(&corners) > 0.0);
        // 45 degrees.
        assert!(worst_sine(&corners) > 0.707, "{}", worst_sine(&corners));
        for face in FACES {
            let mut nodes = face.map(|local| tet[local]);
            nodes.sort_unstable();
            faces.entry(nodes).or_default().push(number as u32);
        }
    }
    assert!(faces.values().all(|cells| cells.len() <= 2));
    // Alone are only faces of cells that would reach beyond the octree: those over its outermost leaves' hulls.
    let size = lattice.grid.cell_units(0);
    let far = lattice.grid.roots.map(|roots| roots * size);
    let within = |node: u32| {
        let at = lattice.coordinates[node as usize];
        (0..3).all(|axis| at[axis] >= size && at[axis] + size <= far[axis])
    };
    for (nodes, cells) in faces {
        if nodes.iter().all(|&node| within(node)) {
            assert_eq!(
                cells.len(),
                2,
                "{:?}",
                nodes.map(|node| lattice.coordinates[node as usize])
            );
        }
    }
}
