//! Springs on the edges of tetrahedra: stiffness, energy, forces and tangent.
//!
//! k = sum_e E_e V_e / L^2 over the tetrahedra e around an edge of length L (Van Gelder, Approximate simulation
//! of elastic membranes by triangulated spring meshes, Journal of Graphics Tools 3, 1998; Kim et al. 2012, eq. 4)
//! W = sum k/2 (l - L)^2            l = |d|, d = p_j - p_i, n = d / l
//! dW/dp_j = k (l - L) n = -dW/dp_i
//! d2W/dp_j dp_j = k [ n n^T + g (I - n n^T) ],  g = 1 - L / l, negative in a spring that is pressed

use crate::mesh::Vector;
use crate::model::dofs::DofMap;
use crate::model::fem::assembly::Tissue;
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::problem::InvertedCell;
use crate::solver::{Block, HalfMatrix};

/// Corners of the six edges of a tetrahedron.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// A spring shorter than this share of its length at rest has no direction of its own.
const NO_LENGTH: f64 = 1e-12;

/// Joins two nodes, the lower number first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    pub nodes: [u32; 2],
    /// In mN/mm.
    pub stiffness: f64,
    /// At rest, in mm.
    pub length: f64,
}

/// Geometric stiffness of compressed springs in the tangent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GeometricStiffness {
    /// As they are: the matrix may be indefinite.
    Exact,
    /// At least `LEAST_SIDEWAYS` of their stiffness: the matrix is positive definite.
    Raised,
}

/// What is left of g at least, where it is raised: enough to hold a node whose springs lie in a plane.
const LEAST_SIDEWAYS: f64 = 1e-3;

/// All springs of a mesh, in ascending order of their nodes.
pub struct Springs {
    pub springs: Vec<Spring>,
    /// The sum of the stiffnesses around each node, in mN/mm.
    pub total_stiffness: Vec<f64>,
}

impl Spring {
    /// From the first node to the second: the distance and the direction.
    pub(super) fn span(&self, positions: &[Vector]) -> (f64, Vector) {
        let d = self.ends(positions);
        let l = d.norm();
        match l > NO_LENGTH * self.length {
            true => (l, d / l),
            false => (l, Vector::zeros()),
        }
    }

    fn ends(&self, vectors: &[Vector]) -> Vector {
        let [i, j] = self.nodes;
        vectors[j as usize] - vectors[i as usize]
    }

    /// The force on the second node and, reversed, on the first: what pulls them apart resists.
    fn force(&self, positions: &[Vector]) -> Vector {
        let (l, n) = self.span(positions);
        n * (self.stiffness * (l - self.length))
    }

    fn tangent(&self, positions: &[Vector], geometric: GeometricStiffness) -> Block {
        let (l, n) = self.span(positions);
        let exact = 1.0 - self.length / l.max(NO_LENGTH * self.length);
        let g = match geometric {
            GeometricStiffness::Exact => exact,
            GeometricStiffness::Raised => exact.max(LEAST_SIDEWAYS),
        };
        let (along, across) = (self.stiffness * (1.0 - g), self.stiffness * g);
        std::array::from_fn(|r| {
            std::array::from_fn(|c| along * n[r] * n[c] + if r == c { across } else { 0.0 })
        })
    }
}

impl Springs {
    /// One spring for each edge. Cells that are not tetrahedra have none.
    pub fn new(tissue: &Tissue) -> Result<Self, InvertedCell> {
        let mesh = tissue.mesh;
        // E V of each edge of each cell, those of one edge side by side and in the order of the cells.
        let mut shares: Vec<([u32; 2], f64)> = Vec::with_capacity(6 * mesh.cells.len());
        for cell in 0..mesh.cells.len() {
            let (volume, _) = tetrahedron(mesh, cell)?;
            let material = &tissue.materials[tissue.material_of_cell[cell] as usize];
            let nodes = mesh.cells.nodes(cell);
            for [a, b] in EDGES.map(|edge| edge.map(|corner| nodes[corner])) {
                shares.push(([a.min(b), a.max(b)], material.young_modulus() * volume));
            }
        }
        let mut total_stiffness = vec![0.0; mesh.nodes.len()];
        let mut springs = Vec::new();
        shares.sort_by_key(|(nodes, _)| *nodes);
        for of_edge in shares.chunk_by(|(nodes, _), (other, _)| nodes == other) {
            let nodes = of_edge[0].0;
            let [x, y] = nodes.map(|node| mesh.nodes[node as usize]);
            let length = (y - x).norm();
            let sum: f64 =
                of_edge.iter().map(|(_, modulus_times_volume)| modulus_times_volume).sum();
            let stiffness = sum / (length * length);
            nodes.iter().for_each(|&node| total_stiffness[node as usize] += stiffness);
            springs.push(Spring { nodes, stiffness, length });
        }
        Ok(Springs { springs, total_stiffness })
    }

    /// W in mN mm.
    pub fn energy(&self, positions: &[Vector]) -> f64 {
        let energy = |spring: &Spring| {
            let stretch = spring.span(positions).0 - spring.length;
            0.5 * spring.stiffness * stretch * stretch
        };
        self.springs.iter().map(energy).sum()
    }

    /// What a displacement adds to W, from the change of each spring: exact where both energies are nearly equal.
    pub(super) fn energy_change(&self, positions: &[Vector], displacement: &[Vector]) -> f64 {
        let change = |spring: &Spring| {
            let (before, by) = (spring.ends(positions), spring.ends(displacement));
            let (l, after) = (before.norm(), (before + by).norm());
            let longer = by.dot(&(before * 2.0 + by)) / (l + after).max(f64::MIN_POSITIVE);
            0.5 * spring.stiffness * longer * (l + after - 2.0 * spring.length)
        };
        self.springs.iter().map(change).sum()
    }

    /// dW/dp for each node, in mN: what the springs resist with.
    pub fn forces(&self, positions: &[Vector]) -> Vec<Vector> {
        self.sum(|spring| spring.force(positions))
    }

    /// The same for springs that keep their direction: k n (n . (u_j - u_i)).
    pub(super) fn linear_forces(&self, rest: &[Vector], displacement: &[Vector]) -> Vec<Vector> {
        self.sum(|spring| {
            let (_, n) = spring.span(rest);
            n * (spring.stiffness * n.dot(&spring.ends(displacement)))
        })
    }

    fn sum(&self, force: impl Fn(&Spring) -> Vector) -> Vec<Vector> {
        let mut forces = vec![Vector::zeros(); self.total_stiffness.len()];
        for spring in &self.springs {
            let force = force(spring);
            let [i, j] = spring.nodes;
            forces[i as usize] -= force;
            forces[j as usize] += force;
        }
        forces
    }

    /// d2W/dp dp over all nodes, in mN/mm.
    pub(super) fn tangent(
        &self,
        positions: &[Vector],
        geometric: GeometricStiffness,
        dof_map: &DofMap,
    ) -> HalfMatrix<f64, 3> {
        let mut matrix = HalfMatrix::zeros(dof_map.pattern.clone());
        for spring in &self.springs {
            let block = spring.tangent(positions, geometric);
            let [i, j] = spring.nodes.map(|node| dof_map.row(node));
            add(matrix.block_mut(i, i), &block, 1.0);
            add(matrix.block_mut(j, j), &block, 1.0);
            add(matrix.block_mut(i.max(j), i.min(j)), &block, -1.0);
        }
        matrix
    }
}

fn add(sum: &mut Block, block: &Block, factor: f64) {
    for (sum, value) in sum.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
        *sum += factor * value;
    }
}
