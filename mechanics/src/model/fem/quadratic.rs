//! Quadratic displacement on tetrahedra with straight edges: ten nodes a cell, the six new ones in the
//! middle of its edges. Converges one order faster than linear tetrahedra and does not lock at nu up to
//! about 0.499 (docs/verification.md#v4, docs/verification.md#v29).
//!
//! K_jk = sum_q V/4 g_j.C.g_k (docs/methods.md#linear-elasticity), with fibres as in `material::elastic_tensor`.
//! An edge node is held where its edge lies on a boundary face all of whose nodes are held: see
//! `boundary::midpoint`.

use super::assembly::Tissue;
use super::cell_stiffness::tetrahedron;
use super::displacement::{Problem, solve_displacement};
use super::edge_nodes::EdgeNodes;
use crate::boundary::{Hold, midpoint};
use crate::element::tetrahedron10;
use crate::material::ElasticTensor;
use crate::mesh::Vector;
use crate::model::dofs::Numbering;
use crate::model::dofs::{Constrained, number};
use crate::model::problem::InvertedCell;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::cliques::Cliques;
use crate::solver::{self, Block, HalfMatrix, SolverError, System, Unknowns};

/// Solves for each load case; the matrix is made once. Holds may name edge nodes themselves; forces may
/// leave them out. Displacement and reactions are those of the nodes of the mesh and of the given holds: what
/// an edge node's hold exerts counts half at each of its ends.
pub fn solve_cases(
    problem: &Problem,
    cases: &[LoadCase],
    progress: &dyn Progress,
) -> Result<Vec<Equilibrium>, ModelError> {
    let mut equilibria = solve_with_edges(problem, cases, progress)?;
    let nodes = problem.tissue.mesh.nodes.len();
    equilibria.iter_mut().for_each(|equilibrium| equilibrium.displacement.truncate(nodes));
    Ok(equilibria)
}

/// The same, with the displacements of edge nodes after those of the nodes of the mesh.
pub fn solve_with_edges(
    problem: &Problem,
    cases: &[LoadCase],
    progress: &dyn Progress,
) -> Result<Vec<Equilibrium>, ModelError> {
    // 1. The matrix over corners and edge nodes.
    progress.phase(Phase::Assemble);
    let mesh = problem.tissue.mesh;
    let edges = EdgeNodes::new(mesh);
    let (holds, parents) = edges.holds(mesh, problem.holds);
    let mut cells = Cliques::default();
    (0..mesh.cells.len()).for_each(|cell| cells.push(edges.of_cell(mesh, cell)));
    let positions = edges.positions(mesh);
    let numbering = number(&cells, &positions, &holds);
    let assembled = assemble(&problem.tissue, &numbering, &edges, progress)?;
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
            ..LoadCase::default()
        })
        .collect();
    let constrained = Constrained { holds: &holds, numbering: &numbering };
    let system = constrained.system(matrix, &positions);
    let solve = |system: &System, right_hand_sides: &[Unknowns]| {
        solver::solve(system, right_hand_sides, &problem.tolerance, progress)
    };
    let mut equilibria = solve_displacement(&constrained, &system, &cases, progress, &solve)?;

    // 3. Back to the holds that were given.
    for equilibrium in &mut equilibria {
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
    progress: &dyn Progress,
) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
    let mut matrix = HalfMatrix::zeros(numbering.pattern.clone());
    let all: Vec<usize> = (0..tissue.mesh.cells.len()).collect();
    let finished = numbering.add_cells(&mut matrix, &all, progress, |cell| {
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
