//! Quadratic displacement on tetrahedra with straight edges: ten nodes a cell, the six new ones in the
//! middle of its edges. Converges one order faster than linear tetrahedra and does not lock at nu up to
//! about 0.499 (VERIFICATION V.4, V.29).
//!
//! K_jk = sum_q V/4 [ lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I ], METHODS A2.
//! An edge node is held where its edge lies on a boundary face all of whose nodes are held: see
//! `boundary::midpoint`.

use rayon::prelude::*;

use super::assembly::{InvertedCell, Tissue, rotate_into_frames};
use super::constrained::Constrained;
use super::linear_fem::{Equilibrium, LinearFemError, LoadCase, Observer, Problem};
use super::load::FaceLoad;
use super::reference_cell;
use crate::boundary::{Hold, midpoint};
use crate::element::tetrahedron10;
use crate::material::LinearElastic;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::solver::{self, Block, BlockMatrix, LinearSystem, SolverError};

/// Cells whose matrices are computed side by side before they are added in cell order.
const CHUNK: usize = 2048;

/// The middles of the edges of a mesh of tetrahedra, numbered after its nodes.
pub struct EdgeNodes {
    /// The two ends of each edge, the lower first; edges ascending.
    ends: Vec<[u32; 2]>,
    corners: usize,
}

impl EdgeNodes {
    pub fn new(mesh: &VolumeMesh) -> Self {
        let edges = mesh.cells.iter().flat_map(|(shape, nodes)| {
            shape.edges().iter().map(move |&[a, b]| sorted([nodes[a], nodes[b]]))
        });
        let mut ends: Vec<[u32; 2]> = edges.collect();
        ends.par_sort_unstable();
        ends.dedup();
        EdgeNodes { ends, corners: mesh.nodes.len() }
    }

    /// Nodes of the mesh and of its edges.
    pub fn node_count(&self) -> usize {
        self.corners + self.ends.len()
    }

    /// The node in the middle of an edge of the mesh.
    pub fn between(&self, a: u32, b: u32) -> u32 {
        let edge = self.ends.binary_search(&sorted([a, b]));
        (self.corners + edge.expect("both nodes belong to one cell of the mesh")) as u32
    }

    /// The positions of all nodes in mm.
    pub fn positions(&self, mesh: &VolumeMesh) -> Vec<Vector> {
        let middle = |[a, b]: &[u32; 2]| (mesh.nodes[*a as usize] + mesh.nodes[*b as usize]) * 0.5;
        mesh.nodes.iter().copied().chain(self.ends.iter().map(middle)).collect()
    }

    /// The ten nodes of a cell, corners first.
    pub fn of_cell(&self, mesh: &VolumeMesh, cell: usize) -> [u32; 10] {
        let corners = mesh.cells.nodes(cell);
        std::array::from_fn(|k| match k {
            0..4 => corners[k],
            _ => {
                let [a, b] = tetrahedron10::EDGES[k - 4];
                self.between(corners[a], corners[b])
            }
        })
    }

    fn of_cells(&self, mesh: &VolumeMesh) -> Vec<[u32; 10]> {
        (0..mesh.cells.len()).map(|cell| self.of_cell(mesh, cell)).collect()
    }

    /// Adds f_i = int N_i t dA over flat triangles: a third at the middle of each edge, nothing at corners.
    pub fn add_face_load(
        &self,
        mesh: &VolumeMesh,
        faces: &[BoundaryFace],
        load: FaceLoad,
        forces: &mut [Vector],
    ) {
        for [a, b, c] in faces.iter().flat_map(BoundaryFace::triangles) {
            let [pa, pb, pc] = [a, b, c].map(|node| mesh.nodes[node as usize]);
            let area = (pb - pa).cross(&(pc - pa)) * 0.5;
            let force = match load {
                FaceLoad::Traction(traction) => traction * area.norm(),
                FaceLoad::Pressure(pressure) => -area * pressure,
            };
            for (from, to) in [(a, b), (b, c), (c, a)] {
                forces[self.between(from, to) as usize] += force / 3.0;
            }
        }
    }

    /// Adds f_i = int N_i rho g dV: -1/20 of the weight at each corner, 1/5 at each edge.
    pub fn add_gravity(
        &self,
        tissue: &Tissue,
        acceleration: Vector,
        forces: &mut [Vector],
    ) -> Result<(), InvertedCell> {
        for cell in 0..tissue.mesh.cells.len() {
            let (volume, _) = volume_and_gradients(tissue.mesh, cell)?;
            let density = tissue.materials[tissue.material_of_cell[cell] as usize].density();
            let weight = acceleration * (density * volume);
            for (k, node) in self.of_cell(tissue.mesh, cell).into_iter().enumerate() {
                forces[node as usize] += weight * if k < 4 { -0.05 } else { 0.2 };
            }
        }
        Ok(())
    }

    /// The holds and, after them, those of edge nodes that have none of their own yet; with the two holds
    /// between which each of these lies.
    fn holds(&self, mesh: &VolumeMesh, holds: &[Hold]) -> (Vec<Hold>, Vec<[usize; 2]>) {
        let mut hold_of = vec![None; self.node_count()];
        for (index, hold) in holds.iter().enumerate() {
            hold_of[hold.node as usize] = Some(index);
        }
        let mut all = holds.to_vec();
        let mut parents = Vec::new();
        for face in mesh.boundary_faces() {
            let nodes = face.nodes();
            let Some(held) =
                nodes.iter().map(|&n| hold_of[n as usize]).collect::<Option<Vec<usize>>>()
            else {
                continue;
            };
            for side in 0..nodes.len() {
                let next = (side + 1) % nodes.len();
                let middle = self.between(nodes[side], nodes[next]);
                if hold_of[middle as usize].is_some() {
                    continue;
                }
                let [a, b] = [held[side], held[next]];
                if let Some(hold) = midpoint::between(middle, &holds[a], &holds[b]) {
                    hold_of[middle as usize] = Some(all.len());
                    all.push(hold);
                    parents.push([a, b]);
                }
            }
        }
        (all, parents)
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Solves for each load case; the matrix is made once. Holds may name edge nodes themselves; forces may
/// leave them out. Displacement and reactions are those of the nodes of the mesh and of the given holds: what
/// an edge node's hold exerts counts half at each of its ends.
pub fn solve_cases(
    problem: &Problem,
    cases: &[LoadCase],
    observer: &dyn Observer,
) -> Result<Vec<Equilibrium>, LinearFemError> {
    observer.assembling();
    let mesh = problem.tissue.mesh;
    let edges = EdgeNodes::new(mesh);
    let (holds, parents) = edges.holds(mesh, problem.holds);
    let assembled = assemble(&problem.tissue, &edges, observer)?;
    let mut matrix = assembled.ok_or(SolverError::Stopped)?;
    rotate_into_frames(&mut matrix, &holds);
    let quadratic = Quadratic { problem, edges, holds, parents, matrix };
    observer.solving();
    cases.iter().map(|case| quadratic.solve(case, observer)).collect()
}

/// What is the same for all load cases.
struct Quadratic<'a> {
    problem: &'a Problem<'a>,
    edges: EdgeNodes,
    /// Those of the problem and then those of edge nodes.
    holds: Vec<Hold>,
    /// For each of the latter the two holds between which it lies.
    parents: Vec<[usize; 2]>,
    matrix: BlockMatrix,
}

impl Quadratic<'_> {
    fn solve(
        &self,
        case: &LoadCase,
        observer: &dyn Observer,
    ) -> Result<Equilibrium, LinearFemError> {
        // 1. What is known, and what it leaves to the free unknowns.
        let mesh = self.problem.tissue.mesh;
        let frames = Constrained { holds: &self.holds, nodes: self.edges.node_count() };
        let cells = self.edges.of_cells(mesh);
        let held = frames.held_unknowns(cells.iter().map(<[u32; 10]>::as_slice));
        let mut forces = case.forces.clone();
        forces.resize(self.edges.node_count(), Vector::zeros());
        let known = frames.known_displacement(&self.values(case));
        let acting = frames.acting_forces(&forces);
        let mut right_hand_side = vec![0.0; known.len()];
        self.matrix.multiply(&known, &mut right_hand_side);
        for (index, value) in right_hand_side.iter_mut().enumerate() {
            *value = if held[index] { 0.0 } else { acting[index] - *value };
        }

        // 2. The free unknowns.
        let system = LinearSystem {
            matrix: &self.matrix,
            held: &held,
            right_hand_side: &right_hand_side,
            positions: &self.edges.positions(mesh),
            axes: &frames.own_axes(),
        };
        let watch = |iteration, residual| observer.iterated(iteration, residual);
        let solution = solver::solve(&system, &self.problem.tolerance, &watch)?;

        // 3. Displacement and reactions, back in the frame of the coordinates.
        let total: Vec<f64> = known.iter().zip(&solution.unknowns).map(|(b, x)| b + x).collect();
        let mut internal = vec![0.0; total.len()];
        self.matrix.multiply(&total, &mut internal);
        if internal.iter().any(|force| !force.is_finite()) {
            return Err(SolverError::NotFinite.into());
        }
        let mut displacement = frames.to_coordinates(&total);
        displacement.truncate(mesh.nodes.len());
        let mut reactions = frames.reactions(&internal, &acting);
        let of_edges = reactions.split_off(self.problem.holds.len());
        for (force, ends) in of_edges.into_iter().zip(&self.parents) {
            ends.iter().for_each(|&end| reactions[end] += force * 0.5);
        }
        let unknowns = held.iter().filter(|held| !**held).count();
        Ok(Equilibrium { displacement, reactions, solution, unknowns })
    }

    /// The values of all holds in this load case.
    fn values(&self, case: &LoadCase) -> Vec<Vector> {
        let mut given = self.problem.holds.to_vec();
        for (hold, values) in given.iter_mut().zip(&case.held) {
            hold.set_values(values);
        }
        let of_edges = self.holds[given.len()..].iter().zip(&self.parents);
        let middles = of_edges.filter_map(|(hold, &[a, b])| {
            midpoint::between(hold.node, &given[a], &given[b]).map(|hold| *hold.values())
        });
        given.iter().map(|hold| *hold.values()).chain(middles).collect()
    }
}

/// K over all nodes, in kPa mm.
fn assemble(
    tissue: &Tissue,
    edges: &EdgeNodes,
    observer: &dyn Observer,
) -> Result<Option<BlockMatrix>, InvertedCell> {
    let mesh = tissue.mesh;
    let cells = edges.of_cells(mesh);
    let cliques = cells.iter().map(<[u32; 10]>::as_slice);
    let mut matrix = BlockMatrix::from_cliques(edges.node_count(), cliques);
    for begin in (0..cells.len()).step_by(CHUNK) {
        if observer.is_stopped() {
            return Ok(None);
        }
        let chunk = begin..(begin + CHUNK).min(cells.len());
        let stiffness = |cell: usize| -> Result<Box<CellBlocks>, InvertedCell> {
            let (volume, gradients) = volume_and_gradients(mesh, cell)?;
            let material = &tissue.materials[tissue.material_of_cell[cell] as usize];
            Ok(cell_stiffness(volume, &gradients, material))
        };
        let matrices: Vec<_> = chunk.clone().into_par_iter().map(stiffness).collect();
        for (cell, blocks) in chunk.zip(matrices) {
            for (row, blocks) in cells[cell].iter().zip(blocks?.iter()) {
                for (column, block) in cells[cell].iter().zip(blocks) {
                    let sum = matrix.block_mut(*row as usize, *column as usize);
                    sum.iter_mut().zip(block).for_each(|(sum, value)| *sum += value);
                }
            }
        }
    }
    Ok(Some(matrix))
}

type CellBlocks = [[Block; 10]; 10];

fn cell_stiffness(
    volume: f64,
    of_barycentric: &[Vector; 4],
    material: &LinearElastic,
) -> Box<CellBlocks> {
    let quarter = volume / 4.0;
    let (lambda, mu) = (material.lambda() * quarter, material.shear_modulus() * quarter);
    let mut blocks = Box::new([[[0.0; 9]; 10]; 10]);
    for point in tetrahedron10::points() {
        let g = tetrahedron10::gradients(&point, of_barycentric);
        for (j, row) in blocks.iter_mut().enumerate() {
            for (k, block) in row.iter_mut().enumerate() {
                let diagonal = mu * g[j].dot(&g[k]);
                for (entry, value) in block.iter_mut().enumerate() {
                    let (r, c) = (entry / 3, entry % 3);
                    let along = if r == c { diagonal } else { 0.0 };
                    *value += lambda * g[j][r] * g[k][c] + mu * g[k][r] * g[j][c] + along;
                }
            }
        }
    }
    blocks
}

/// The volume of a tetrahedron and the gradients of its barycentric coordinates.
fn volume_and_gradients(
    mesh: &VolumeMesh,
    cell: usize,
) -> Result<(f64, [Vector; 4]), InvertedCell> {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let point = reference_cell(CellShape::Tet4).points[0].at(&corners);
    let point = point.ok_or(InvertedCell { cell })?;
    Ok((point.volume, std::array::from_fn(|corner| point.gradients[corner])))
}
