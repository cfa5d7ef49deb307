//! Quadratic displacement on tetrahedra with straight edges: ten nodes a cell, the six new ones in the
//! middle of its edges. Converges one order faster than linear tetrahedra and does not lock at nu up to
//! about 0.499 (VERIFICATION V.4, V.29).
//!
//! K_jk = sum_q V/4 g_j.C.g_k, METHODS A2, with fibres A3 and A4.
//! An edge node is held where its edge lies on a boundary face all of whose nodes are held: see
//! `boundary::midpoint`.

use rayon::prelude::*;

use super::assembly::{InvertedCell, Numbering, Tissue};
use super::cell_stiffness::tetrahedron;
use super::displacement::{Assembled, Problem, solve_displacement};
use super::loads::FaceLoad;
use crate::boundary::{Hold, midpoint};
use crate::element::tetrahedron10;
use crate::material::ElasticTensor;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::dofs::{Constrained, number};
use crate::model::problem::{Equilibrium, LoadCase, ModelError, Observer};
use crate::solver::cliques::Cliques;
use crate::solver::{self, Block, HalfMatrix, SolverError, System, Unknowns, Watch};

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
            let (volume, _) = tetrahedron(tissue.mesh, cell)?;
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
) -> Result<Vec<Equilibrium>, ModelError> {
    // 1. The matrix over corners and edge nodes.
    observer.assembling();
    let mesh = problem.tissue.mesh;
    let edges = EdgeNodes::new(mesh);
    let (holds, parents) = edges.holds(mesh, problem.holds);
    let mut cells = Cliques::default();
    (0..mesh.cells.len()).for_each(|cell| cells.push(edges.of_cell(mesh, cell)));
    let positions = edges.positions(mesh);
    let numbering = number(&cells, &positions, &holds);
    let assembled = assemble(&problem.tissue, &numbering, &edges, observer)?;
    let matrix = assembled.ok_or(SolverError::Stopped)?;

    // 2. Each load case with values for edge nodes too.
    let forces = |case: &LoadCase| {
        let mut forces = case.forces.clone();
        forces.resize(positions.len(), Vector::zeros());
        forces
    };
    let cases: Vec<LoadCase> = cases
        .iter()
        .map(|case| LoadCase {
            held: values(case, problem.holds, &holds, &parents),
            forces: forces(case),
        })
        .collect();
    let constrained = Constrained { holds: &holds, numbering: &numbering };
    let assembled = Assembled { constrained, matrix, positions: &positions };
    let solve = |system: &System, right_hand_sides: &[Unknowns], watch: Watch| {
        solver::solve(system, right_hand_sides, &problem.tolerance, watch)
    };
    let mut equilibria = solve_displacement(assembled, &cases, observer, &solve)?;

    // 3. Back to the nodes of the mesh.
    for equilibrium in &mut equilibria {
        equilibrium.displacement.truncate(mesh.nodes.len());
        let of_edges = equilibrium.reactions.split_off(problem.holds.len());
        for (force, ends) in of_edges.into_iter().zip(&parents) {
            ends.iter().for_each(|&end| equilibrium.reactions[end] += force * 0.5);
        }
    }
    Ok(equilibria)
}

/// The values of all holds in a load case: those that are given, and those of edge nodes between them.
fn values(case: &LoadCase, given: &[Hold], holds: &[Hold], parents: &[[usize; 2]]) -> Vec<Vector> {
    let mut given = given.to_vec();
    for (hold, values) in given.iter_mut().zip(&case.held) {
        hold.set_values(values);
    }
    let of_edges = holds[given.len()..].iter().zip(parents);
    let middles = of_edges.filter_map(|(hold, &[a, b])| {
        midpoint::between(hold.node, &given[a], &given[b]).map(|hold| *hold.values())
    });
    given.iter().map(|hold| *hold.values()).chain(middles).collect()
}

/// K over all nodes, in kPa mm.
fn assemble(
    tissue: &Tissue,
    numbering: &Numbering,
    edges: &EdgeNodes,
    observer: &dyn Observer,
) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
    let mut matrix = HalfMatrix::zeros(numbering.pattern.clone());
    let all: Vec<usize> = (0..tissue.mesh.cells.len()).collect();
    let keep_going = || !observer.is_stopped();
    let finished = numbering.add_cells(&mut matrix, &all, &keep_going, |cell| {
        let (volume, gradients) = tetrahedron(tissue.mesh, cell)?;
        Ok(cell_stiffness(volume, &gradients, &tissue.tensor(cell)))
    })?;
    if let Some(membrane) = tissue.membrane {
        membrane.add_quadratic(&mut matrix, numbering, tissue.mesh, edges);
    }
    Ok(finished.then_some(matrix))
}

fn cell_stiffness(volume: f64, of_barycentric: &[Vector; 4], tensor: &ElasticTensor) -> Vec<Block> {
    let mut blocks = vec![[[0.0; 3]; 3]; 100];
    for point in tetrahedron10::points() {
        let g = tetrahedron10::gradients(&point, of_barycentric);
        for (entry, block) in blocks.iter_mut().enumerate() {
            tensor.add_pair(block, [&g[entry / 10], &g[entry % 10]], volume / 4.0);
        }
    }
    blocks
}
