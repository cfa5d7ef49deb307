//! Uniform refinement: every edge is halved and every cell becomes eight.
//!
//! A tetrahedron leaves an octahedron between its four corners, cut along the shortest of its three
//! diagonals. Hexahedra and wedges also get nodes in the middle of their quadrilaterals, hexahedra
//! one in their centre, so that mixed meshes stay conforming. Nodes keep their numbers, cell c
//! becomes cells 8c to 8c + 7, and new nodes are the mean of their parents.
//!
//! Source: Bey, Tetrahedral grid refinement, Computing 55, 1995, section 3; the choice of the
//! diagonal is that of Zhang, Houston Journal of Mathematics 21, 1995.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::{CellShape, Cells, Vector, VolumeMesh};

/// The mesh with every edge halved once; sets, labels and arrays follow.
///
/// A new node is in a node set when all its parents are; where they all lie on the boundary, their
/// edge or face must be one of the boundary too, or two walls that are one cell apart would grow
/// together through the tissue between them. A label is kept by the same rule, and nodes without
/// one carry the smallest label less one, which no selection asked for before.
pub fn refine(mesh: &VolumeMesh) -> VolumeMesh {
    let mut division = Division::of(mesh);
    let mut cells = Cells::default();
    for (shape, nodes) in mesh.cells.iter() {
        match shape {
            CellShape::Tet4 => division.divide_tetrahedron(nodes, &mut cells),
            CellShape::Hex8 => division.divide_hexahedron(nodes, &mut cells),
            CellShape::Wedge6 => division.divide_wedge(nodes, &mut cells),
        }
    }
    let together = division.on_one_wall();
    VolumeMesh {
        node_sets: mesh
            .node_sets
            .iter()
            .map(|(name, set)| (name.clone(), division.refined_set(set, &together)))
            .collect(),
        cell_sets: mesh
            .cell_sets
            .iter()
            .map(|(name, set)| (name.clone(), set.iter().flat_map(children).collect()))
            .collect(),
        node_labels: mesh
            .node_labels
            .iter()
            .map(|(name, labels)| (name.clone(), division.refined_labels(labels, &together)))
            .collect(),
        cell_labels: each(&mesh.cell_labels, |labels| {
            labels.iter().flat_map(|&label| [label; 8]).collect()
        }),
        node_vectors: each(&mesh.node_vectors, |vectors| {
            let mut all = vectors.clone();
            all.extend(division.parents.iter().map(|parents| mean(parents, vectors)));
            all
        }),
        cell_vectors: each(&mesh.cell_vectors, |vectors| {
            vectors.iter().flat_map(|&vector| [vector; 8]).collect()
        }),
        ignored: mesh.ignored.clone(),
        nodes: division.nodes,
        cells,
    }
}

fn each<T>(
    arrays: &BTreeMap<String, Vec<T>>,
    refined: impl Fn(&Vec<T>) -> Vec<T>,
) -> BTreeMap<String, Vec<T>> {
    arrays.iter().map(|(name, values)| (name.clone(), refined(values))).collect()
}

fn children(cell: &u32) -> std::ops::Range<u32> {
    8 * cell..8 * cell + 8
}

/// The nodes a new node lies between: 2 of an edge, 4 of a quadrilateral, 8 of a hexahedron.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Parents {
    nodes: [u32; 8],
    count: u8,
}

impl Parents {
    fn of(nodes: &[u32]) -> Self {
        let mut sorted = [u32::MAX; 8];
        sorted[..nodes.len()].copy_from_slice(nodes);
        sorted[..nodes.len()].sort_unstable();
        Parents { nodes: sorted, count: nodes.len() as u8 }
    }

    fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.nodes[..self.count as usize].iter().map(|&node| node as usize)
    }
}

fn mean(parents: &Parents, vectors: &[Vector]) -> Vector {
    parents.iter().map(|node| vectors[node]).sum::<Vector>() / f64::from(parents.count)
}

/// The nodes of the finer mesh as they come to be.
struct Division<'a> {
    mesh: &'a VolumeMesh,
    nodes: Vec<Vector>,
    /// Of each new node, in order.
    parents: Vec<Parents>,
    number_of: HashMap<Parents, u32>,
}

impl<'a> Division<'a> {
    fn of(mesh: &'a VolumeMesh) -> Self {
        Division { mesh, nodes: mesh.nodes.clone(), parents: Vec::new(), number_of: HashMap::new() }
    }

    /// The node in the middle of these nodes; a single node is its own middle.
    fn middle(&mut self, nodes: &[u32]) -> u32 {
        if let [node] = nodes {
            return *node;
        }
        let parents = Parents::of(nodes);
        *self.number_of.entry(parents).or_insert_with(|| {
            self.nodes.push(mean(&parents, &self.mesh.nodes));
            self.parents.push(parents);
            self.nodes.len() as u32 - 1
        })
    }

    fn divide_tetrahedron(&mut self, nodes: &[u32], cells: &mut Cells) {
        let [n01, n02, n03, n12, n13, n23] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
            .map(|[a, b]: [usize; 2]| self.middle(&[nodes[a], nodes[b]]));
        for corner in [
            [nodes[0], n01, n02, n03],
            [n01, nodes[1], n12, n13],
            [n02, n12, nodes[2], n23],
            [n03, n13, n23, nodes[3]],
        ] {
            cells.push(CellShape::Tet4, &corner);
        }
        // Each diagonal of the octahedron and the four nodes around it, so ordered that the
        // tetrahedra (from, to, ring, next of ring) are oriented as their parent is.
        let octahedra = [
            ([n01, n23], [n02, n03, n13, n12]),
            ([n02, n13], [n01, n12, n23, n03]),
            ([n03, n12], [n01, n02, n23, n13]),
        ];
        let squared_length = |[from, to]: [u32; 2]| {
            (self.nodes[to as usize] - self.nodes[from as usize]).norm_squared()
        };
        let mut shortest = octahedra[0];
        for octahedron in &octahedra[1..] {
            if squared_length(octahedron.0) < squared_length(shortest.0) {
                shortest = *octahedron;
            }
        }
        let ([from, to], ring) = shortest;
        for side in 0..4 {
            cells.push(CellShape::Tet4, &[from, to, ring[side], ring[(side + 1) % 4]]);
        }
    }

    fn divide_hexahedron(&mut self, nodes: &[u32], cells: &mut Cells) {
        const CORNERS: [[usize; 3]; 8] = [
            [0, 0, 0],
            [1, 0, 0],
            [1, 1, 0],
            [0, 1, 0],
            [0, 0, 1],
            [1, 0, 1],
            [1, 1, 1],
            [0, 1, 1],
        ];
        for child in CORNERS {
            let child_nodes = CORNERS.map(|corner| {
                // A place 0 or 2 of the lattice lies on a corner's side, 1 between both sides.
                let place = [0, 1, 2].map(|axis| child[axis] + corner[axis]);
                let around: Vec<u32> = (0..8)
                    .filter(|&local| {
                        (0..3)
                            .all(|axis| place[axis] == 1 || place[axis] == 2 * CORNERS[local][axis])
                    })
                    .map(|local| nodes[local])
                    .collect();
                self.middle(&around)
            });
            cells.push(CellShape::Hex8, &child_nodes);
        }
    }

    fn divide_wedge(&mut self, nodes: &[u32], cells: &mut Cells) {
        const PLACES: [&[usize]; 6] = [&[0], &[1], &[2], &[0, 1], &[1, 2], &[2, 0]];
        const TRIANGLES: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
        let levels: [&[usize]; 3] = [&[0], &[0, 3], &[3]];
        let lattice = levels.map(|offsets| {
            PLACES.map(|place| {
                let around: Vec<u32> = offsets
                    .iter()
                    .flat_map(|offset| place.iter().map(move |local| nodes[local + offset]))
                    .collect();
                self.middle(&around)
            })
        });
        for (low, high) in [(0, 1), (1, 2)] {
            for [a, b, c] in TRIANGLES {
                let [bottom, top] = [lattice[low], lattice[high]];
                let child = [bottom[a], bottom[b], bottom[c], top[a], top[b], top[c]];
                cells.push(CellShape::Wedge6, &child);
            }
        }
    }

    /// For each new node whether a selection of its parents selects what lies between them: not
    /// when they are all on the boundary and their edge or face runs through the interior.
    fn on_one_wall(&self) -> Vec<bool> {
        let mut on_boundary = vec![false; self.mesh.nodes.len()];
        let mut walls = HashSet::new();
        for face in self.mesh.boundary_faces() {
            let nodes = face.nodes();
            for (corner, &node) in nodes.iter().enumerate() {
                on_boundary[node as usize] = true;
                walls.insert(Parents::of(&[node, nodes[(corner + 1) % nodes.len()]]));
            }
            walls.insert(Parents::of(nodes));
        }
        self.parents
            .iter()
            .map(|parents| walls.contains(parents) || !parents.iter().all(|n| on_boundary[n]))
            .collect()
    }

    /// New nodes with whether what is said of all their parents holds for them, and their parents.
    fn new_nodes<'b>(
        &'b self,
        together: &'b [bool],
    ) -> impl Iterator<Item = (u32, bool, &'b Parents)> + 'b {
        let first = self.mesh.nodes.len() as u32;
        self.parents
            .iter()
            .zip(together)
            .enumerate()
            .map(move |(place, (parents, &together))| (first + place as u32, together, parents))
    }

    fn refined_set(&self, set: &[u32], together: &[bool]) -> Vec<u32> {
        let mut selected = vec![false; self.mesh.nodes.len()];
        for &node in set {
            selected[node as usize] = true;
        }
        let between = self
            .new_nodes(together)
            .filter(|(_, together, parents)| *together && parents.iter().all(|n| selected[n]))
            .map(|(node, _, _)| node);
        set.iter().copied().chain(between).collect()
    }

    fn refined_labels(&self, labels: &[i64], together: &[bool]) -> Vec<i64> {
        let none = labels.iter().min().map_or(0, |least| least.saturating_sub(1));
        let between = self.new_nodes(together).map(|(_, together, parents)| {
            let label = labels[parents.nodes[0] as usize];
            let agreed = together && parents.iter().all(|node| labels[node] == label);
            if agreed { label } else { none }
        });
        labels.iter().copied().chain(between).collect()
    }
}

#[cfg(test)]
#[path = "refinement_tests.rs"]
mod tests;
