//! Locking-free tetrahedra: linear displacement and linear pressure, stabilised by projection.
//!
//! With p = lambda div u: find u, p with
//!   int 2 mu eps(u) : eps(v) + int p div v = f(v)                             K u + B^T p = f
//!   int q div u - int p q / lambda - int (p - Pi p)(q - Pi q) / mu = 0        B u - C p = 0
//! where Pi is the mean over a cell. On a tetrahedron of volume V: B_ab = V/4 grad N_b,
//! C = M / lambda + (M - Mbar) / mu, M_ab = V/20 (1 + delta_ab), Mbar_ab = V/16.
//! With fibres lambda and mu are those of `ElasticTensor::pressure_part`, and instead of 2 mu eps(u) stands what
//! the pressure leaves of the stress, (stiffness - lambda (1 x 1)) eps(u), which is positive definite.
//!
//! Source: Dohrmann, Bochev, A stabilized finite element method for the Stokes problem based on polynomial
//! pressure projections, International Journal for Numerical Methods in Fluids 46, 2004; the compressible
//! term M / lambda is that of linear elasticity.
//! A node has one pressure for each material around it, because pressure jumps where stiffness does; mixtures
//! take part in the pressure of their largest part.
//! Hexahedra and wedges keep their mean dilatation and have no pressure; nor have tetrahedra with nu = 0,
//! whose pressure is zero.

use std::collections::BTreeMap;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::assembly::Tissue;
use super::cell_stiffness::tetrahedron;
use crate::material::ElasticTensor;
use crate::material::elastic_tensor::PressurePart;
use crate::mesh::{CellShape, Vector};
use crate::model::dofs::{Constrained, DofMap};
use crate::model::problem::InvertedCell;
use crate::progress::Progress;
use crate::solver::mixed;
use crate::solver::mixed_system::Coupling;
use crate::solver::sparse_rows::{Couplings, SparseRows};
use crate::solver::{HalfMatrix, SolverError, System};

/// Refuses matrices that take more than they may with what the iteration adds.
pub(super) fn check_memory(
    stiffness: &System,
    coupling: &Coupling,
    allowed_mb: f64,
) -> Result<(), SolverError> {
    let needed_mb = mixed::megabytes(stiffness, coupling);
    match needed_mb <= allowed_mb {
        true => Ok(()),
        false => Err(SolverError::OverBudget { needed_mb, allowed_mb }),
    }
}

/// K: tetrahedra with what no pressure carries, 2 mu eps : eps where they are isotropic.
pub(super) fn shear_stiffness(
    tissue: &Tissue,
    dof_map: &DofMap,
    progress: &dyn Progress,
) -> Result<Option<HalfMatrix<f64, 3>>, InvertedCell> {
    let tensor = |cell: usize| {
        let tensor = tissue.tensor(cell);
        match tissue.mesh.cells.shape(cell) {
            CellShape::Tet4 => without_pressure_part(tensor),
            CellShape::Hex8 | CellShape::Wedge6 => tensor,
        }
    };
    tissue.assemble_with(dof_map, progress, &tensor)
}

/// The stiffness without the part that pressures carry.
pub(super) fn without_pressure_part(tensor: ElasticTensor) -> ElasticTensor {
    let lambda = tensor.lambda - tensor.pressure_part().lambda;
    ElasticTensor { lambda, ..tensor }
}

/// Whether a cell has pressures, where tetrahedra carry any.
pub(super) fn carries_pressure(shape: CellShape, tensor: &ElasticTensor) -> bool {
    shape == CellShape::Tet4 && tensor.pressure_part().lambda > 0.0
}

/// Tetrahedra that have pressures, one for each corner.
pub struct PressureCells {
    pub cells: Vec<u32>,
    /// For each of the cells the rows of its nodes.
    pub rows: Vec<[u32; 4]>,
    /// For each of the cells the numbers of its pressures.
    pub pressures: Vec<[u32; 4]>,
    pub pressure_count: usize,
}

impl PressureCells {
    /// Numbers the pressures: corners share one where they share node and kind of tissue.
    pub(super) fn new(tissue: &Tissue, dof_map: &DofMap) -> Self {
        let mut cells_of_kind: BTreeMap<u16, Vec<u32>> = BTreeMap::new();
        for &cell in &dof_map.ordering.element_order {
            let (cell, shape) = (cell as usize, tissue.mesh.cells.shape(cell as usize));
            let kind = tissue.pressure_of_cell[cell];
            if carries_pressure(shape, &tissue.tensor(cell)) {
                cells_of_kind.entry(kind).or_default().push(cell as u32);
            }
        }
        let (cells, rows, pressures) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = PressureCells { cells, rows, pressures, pressure_count: 0 };
        // Numbers below the first of a kind are those of other kinds.
        let mut number_of_node = vec![0; tissue.mesh.nodes.len()];
        for cells in cells_of_kind.values() {
            let first = all.pressure_count as u32 + 1;
            for &cell in cells {
                let corners = tissue.mesh.cells.nodes(cell as usize);
                let corners: [u32; 4] = std::array::from_fn(|corner| corners[corner]);
                let numbers = corners.map(|node| {
                    let number = &mut number_of_node[node as usize];
                    if *number < first {
                        all.pressure_count += 1;
                        *number = all.pressure_count as u32;
                    }
                    *number - 1
                });
                all.rows.push(corners.map(|node| dof_map.ordering.place[node as usize]));
                all.pressures.push(numbers);
            }
            all.cells.extend_from_slice(cells);
        }
        all
    }
}

impl PressureCells {
    /// For each of so many cells of the mesh the mean of its pressures, where it has any.
    pub fn means(&self, pressures: &[f64], cells: usize) -> Vec<Option<f64>> {
        let mut means = vec![None; cells];
        for (&cell, numbers) in self.cells.iter().zip(&self.pressures) {
            let sum: f64 = numbers.iter().map(|&number| pressures[number as usize]).sum();
            means[cell as usize] = Some(sum / 4.0);
        }
        means
    }
}

/// One tetrahedron: its volume in mm³, grad N in 1/mm along the axes of its nodes, its moduli in kPa.
struct CellTerms {
    volume: f64,
    gradients: [Vector; 4],
    mu: f64,
    lambda: f64,
}

/// B, B^T, C and D.
pub(super) fn couple(
    tissue: &Tissue,
    constrained: &Constrained,
    all: &PressureCells,
) -> Result<Coupling, InvertedCell> {
    let turned = constrained.constraints.iter().filter(|constraint| !constraint.is_aligned());
    let axes: BTreeMap<u32, Matrix3<f64>> =
        turned.map(|constraint| (constraint.node, *constraint.axes())).collect();
    let terms: Result<Vec<CellTerms>, InvertedCell> =
        all.cells.par_iter().map(|&cell| cell_terms(tissue, cell as usize, &axes)).collect();
    let terms = terms?;
    let volume_of = |cell: usize, node: usize| -> [f64; 3] {
        let CellTerms { volume, gradients, .. } = &terms[cell];
        (gradients[node] * (volume / 4.0)).into()
    };
    let by_pressure = Couplings { rows: &all.pressures, columns: &all.rows };
    let by_node = Couplings { rows: &all.rows, columns: &all.pressures };
    let among_pressures = Couplings { rows: &all.pressures, columns: &all.pressures };
    let compliance = |cell: usize, a: usize, b: usize| {
        let CellTerms { volume, mu, lambda, .. } = terms[cell];
        let mass = volume / 20.0 * if a == b { 2.0 } else { 1.0 };
        mass / lambda + (mass - volume / 16.0) / mu
    };
    let count = all.pressure_count;
    let mut mass = vec![0.0; count];
    for (numbers, cell) in all.pressures.iter().zip(&terms) {
        for &number in numbers {
            mass[number as usize] += cell.volume / 4.0 * (1.0 / cell.mu + 1.0 / cell.lambda);
        }
    }
    let node_count = tissue.mesh.nodes.len();
    Ok(Coupling {
        divergence: SparseRows::assemble(count, &by_pressure, |cell, _, b| volume_of(cell, b)),
        gradient: SparseRows::assemble(node_count, &by_node, |cell, a, _| volume_of(cell, a)),
        compliance: SparseRows::assemble(count, &among_pressures, compliance),
        mass,
    })
}

fn cell_terms(
    tissue: &Tissue,
    cell: usize,
    axes: &BTreeMap<u32, Matrix3<f64>>,
) -> Result<CellTerms, InvertedCell> {
    let (volume, gradients) = tetrahedron(tissue.mesh, cell)?;
    let PressurePart { lambda, mu } = tissue.tensor(cell).pressure_part();
    let nodes = tissue.mesh.cells.nodes(cell);
    let gradients = std::array::from_fn(|corner| match axes.get(&nodes[corner]) {
        Some(axes) => axes.transpose() * gradients[corner],
        None => gradients[corner],
    });
    Ok(CellTerms { volume, gradients, mu, lambda })
}
