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
use super::edge_nodes::{EdgeNodes, WithEdges};
use crate::element::tetrahedron10;
use crate::material::ElasticTensor;
use crate::mesh::Vector;
use crate::model::dofs::DofMap;
use crate::model::dofs::{Constrained, number};
use crate::model::problem::InvertedCell;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
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
    let with = WithEdges::new(mesh, problem.constraints);
    let dof_map = number(&with.cells, &with.positions, &with.constraints);
    let assembled = assemble(&problem.tissue, &dof_map, &with.edges, progress)?;
    let matrix = assembled.ok_or(SolverError::Stopped)?;

    // 2. Each load case with values for edge nodes too.
    let cases: Vec<LoadCase> = cases.iter().map(|case| with.case(case)).collect();
    let constrained = Constrained { constraints: &with.constraints, dof_map: &dof_map };
    let system = constrained.system(matrix, &with.positions);
    let solve = |system: &System, right_hand_sides: &[Unknowns]| {
        solver::solve(system, right_hand_sides, &problem.tolerance, progress)
    };
    let mut equilibria = solve_displacement(&constrained, &system, &cases, progress, &solve)?;

    // 3. Back to the holds that were given.
    for equilibrium in &mut equilibria {
        with.gather_reactions(equilibrium);
        equilibrium.warnings.extend(with.inverted_cells(mesh, &equilibrium.displacement));
    }
    Ok(equilibria)
}

/// K over all nodes, in kPa mm.
fn assemble(
    tissue: &Tissue,
    dof_map: &DofMap,
    edges: &EdgeNodes,
    progress: &dyn Progress,
) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
    let mut matrix = HalfMatrix::zeros(dof_map.pattern.clone());
    let all: Vec<usize> = (0..tissue.mesh.cells.len()).collect();
    let finished = dof_map.add_cells(&mut matrix, &all, progress, |cell| {
        let (volume, gradients) = tetrahedron(tissue.mesh, cell)?;
        Ok(cell_stiffness(volume, &gradients, &tissue.tensor(cell)))
    })?;
    if let Some(membrane) = tissue.membrane {
        membrane.add_quadratic(&mut matrix, dof_map, tissue.mesh, edges);
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
