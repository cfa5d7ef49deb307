//! Transfer of sets, labels and arrays of a mesh to its refined cells.
//!
//! A new node lies inside an edge, a face or a cell of the first mesh, and belongs to a set of nodes where that does. An edge or
//! a face of the boundary belongs to a set where all nodes of a boundary face around it do; what lies inside the tissue, where all
//! nodes of a cell around it do. That both ends of an edge are in a set is not enough: through thin tissue an edge may run from
//! one wall to the other, and along the boundary it may leave a wall where that is jagged.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

use super::{Bisection, Support};
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{CellShape, Cells, Vector, VolumeMesh};

/// A refined mesh, and where its parts come from.
pub struct Carrier<'a> {
    bisection: &'a Bisection,
    /// The boundary of the first mesh.
    faces: Vec<BoundaryFace>,
    /// The number of each of these under its nodes, ascending.
    number_of_face: HashMap<[u32; 3], usize>,
    is_on_boundary: Vec<bool>,
}

impl<'a> Carrier<'a> {
    pub fn new(bisection: &'a Bisection) -> Self {
        let faces = bisection.first.boundary_faces();
        let mut is_on_boundary = vec![false; bisection.first.nodes.len()];
        faces.iter().flat_map(BoundaryFace::nodes).for_each(|&n| is_on_boundary[n as usize] = true);
        let number_of_face =
            faces.iter().enumerate().map(|(number, face)| (sorted(face.nodes()), number)).collect();
        Carrier { bisection, faces, number_of_face, is_on_boundary }
    }

    /// The refined mesh; sets, labels and arrays follow.
    pub fn mesh(&self) -> VolumeMesh {
        let Bisection { first, positions, cells: refined, .. } = self.bisection;
        let mut cells = Cells::default();
        refined.iter().for_each(|cell| cells.push(CellShape::Tet4, &cell.nodes));
        VolumeMesh {
            nodes: positions.clone(),
            cells,
            node_sets: each(&first.node_sets, |set| self.nodes(set)),
            cell_sets: each(&first.cell_sets, |set| self.cells_of(set)),
            node_labels: each(&first.node_labels, |labels| self.labels(labels)),
            cell_labels: each(&first.cell_labels, |labels| self.of_cells(labels)),
            node_vectors: each(&first.node_vectors, |vectors| self.vectors(vectors)),
            cell_vectors: each(&first.cell_vectors, |vectors| self.of_cells(vectors)),
            ignored: first.ignored.clone(),
        }
    }

    /// What is said of each cell of the first mesh, of each refined one.
    pub fn of_cells<T: Clone>(&self, of_first: &[T]) -> Vec<T> {
        self.bisection.cells.iter().map(|cell| of_first[cell.root as usize].clone()).collect()
    }

    /// The same; empty where nothing is said.
    pub fn of_cells_if_any<T: Clone>(&self, of_first: &[T]) -> Vec<T> {
        if of_first.is_empty() { Vec::new() } else { self.of_cells(of_first) }
    }

    fn cells_of(&self, set: &[u32]) -> Vec<u32> {
        let cells = (0_u32..).zip(&self.bisection.cells);
        cells.filter(|(_, cell)| set.binary_search(&cell.root).is_ok()).map(|(n, _)| n).collect()
    }

    /// A set of nodes, ascending.
    pub fn nodes(&self, set: &[u32]) -> Vec<u32> {
        let mut is_in = vec![None; self.bisection.first.nodes.len()];
        set.iter().for_each(|&node| is_in[node as usize] = Some(()));
        let new = self.agreed(&is_in).into_iter();
        let numbered = (is_in.len() as u32..).zip(new);
        let new = numbered.filter_map(|(node, of)| of.map(|()| node));
        let mut nodes: Vec<u32> = set.iter().copied().chain(new).collect();
        nodes.sort_unstable();
        nodes
    }

    /// Vectors at nodes; new ones have the mean of their parents.
    pub fn vectors(&self, of_first: &[Vector]) -> Vec<Vector> {
        let mut all = of_first.to_vec();
        for &[a, b] in &self.bisection.parents {
            all.push((all[a as usize] + all[b as usize]) * 0.5);
        }
        all
    }

    /// The nodes between which each new node lies, in their order; the first has the number of the first mesh's nodes.
    pub fn parents(&self) -> &[[u32; 2]] {
        &self.bisection.parents
    }

    /// The mesh that was refined.
    pub fn first(&self) -> &Arc<VolumeMesh> {
        &self.bisection.first
    }

    /// Labels of nodes; new ones to which none belongs have the smallest less one, which no selection asked for before.
    fn labels(&self, labels: &[i64]) -> Vec<i64> {
        let none = labels.iter().min().map_or(0, |least| least.saturating_sub(1));
        let of_first: Vec<Option<i64>> = labels.iter().copied().map(Some).collect();
        let new = self.agreed(&of_first).into_iter().map(|label| label.unwrap_or(none));
        labels.iter().copied().chain(new).collect()
    }

    /// The face of the first boundary, among `faces`, of which a face of the refined boundary is a part.
    pub fn face(&self, face: &BoundaryFace) -> Option<usize> {
        let support = face
            .nodes()
            .iter()
            .fold(Support::default(), |all, &node| all.with(&self.bisection.support(node)));
        self.number_of_face.get(&sorted(support.nodes())).copied()
    }

    /// The face of the first boundary with these nodes.
    pub fn face_of(&self, nodes: &[u32]) -> Option<usize> {
        self.number_of_face.get(&sorted(nodes)).copied()
    }

    /// For each new node what all corners of a face or a cell around it are called alike.
    fn agreed<T: Copy + PartialEq>(&self, of_first: &[Option<T>]) -> Vec<Option<T>> {
        let common = |nodes: &[u32]| {
            let first = of_first[*nodes.first()? as usize]?;
            nodes.iter().all(|&node| of_first[node as usize] == Some(first)).then_some(first)
        };
        let mut walls: HashSet<[u32; 3]> = HashSet::new();
        for face in self.faces.iter().filter(|face| common(face.nodes()).is_some()) {
            let [a, b, c] = sorted(face.nodes());
            walls.extend([[a, b, c], [a, b, u32::MAX], [a, c, u32::MAX], [b, c, u32::MAX]]);
        }
        let Bisection { first, supports, cells, .. } = self.bisection;
        let mut is_in_cell = vec![false; supports.len()];
        for cell in cells {
            if common(first.cells.nodes(cell.root as usize)).is_some() {
                let new =
                    cell.nodes.iter().filter_map(|&n| (n as usize).checked_sub(of_first.len()));
                new.for_each(|new| is_in_cell[new] = true);
            }
        }
        let is_of_boundary = |support: &Support| {
            support.nodes().iter().all(|&node| self.is_on_boundary[node as usize])
        };
        let agreed = |(support, is_in_cell): (&Support, bool)| {
            let belongs = match is_of_boundary(support) {
                true => support.count < 4 && walls.contains(&sorted(support.nodes())),
                false => is_in_cell,
            };
            common(support.nodes()).filter(|_| belongs)
        };
        supports.iter().zip(is_in_cell).map(agreed).collect()
    }
}

fn each<T, U>(
    arrays: &BTreeMap<String, Vec<T>>,
    carried: impl Fn(&[T]) -> Vec<U>,
) -> BTreeMap<String, Vec<U>> {
    arrays.iter().map(|(name, values)| (name.clone(), carried(values))).collect()
}

/// Up to three nodes ascending, `u32::MAX` where there are fewer.
fn sorted(nodes: &[u32]) -> [u32; 3] {
    let mut all = [u32::MAX; 3];
    all.iter_mut().zip(nodes).for_each(|(own, node)| *own = *node);
    all.sort_unstable();
    all
}
