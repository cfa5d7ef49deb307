//! Degrees of freedom: boundary conditions and forces as the known part of a linear system, along the axes of the
//! constraints, by row, and back.

use std::sync::Arc;

use rayon::prelude::*;

use super::problem::{InvertedCell, LoadCase};
use crate::boundary::Constraint;
use crate::mesh::{Vector, VolumeMesh, bounds_of};
use crate::progress::Progress;
use crate::solver::element_connectivity::{ElementConnectivity, ElementsOfRow, renumbered};
use crate::solver::half_matrix::{HalfMatrix, Pattern};
use crate::solver::lanes::Lanes;
use crate::solver::row_ordering::RowOrdering;
use crate::solver::{Block, PartlyHeld, SolverError, System, Unknowns};

/// Numbered nodes of which some are held, each along the first axes of a frame of its own.
pub struct Constrained<'a> {
    pub constraints: &'a [Constraint],
    pub dof_map: &'a DofMap,
}

/// Prescribed displacements and forces of a load case, by row, along the axes of the rows.
pub struct PrescribedValues {
    /// Zero where free.
    pub displacement: Vec<Lanes<f64, 3, 1>>,
    pub force: Unknowns,
}

/// The degree-of-freedom map of nodes at positions. Nodes held in all directions have no free unknown, nor have nodes
/// of no cell, which nothing couples.
pub fn number(
    cells: &ElementConnectivity,
    positions: &[Vector],
    constraints: &[Constraint],
) -> DofMap {
    let mut held = vec![true; positions.len()];
    for cell in 0..cells.len() {
        cells.row(cell).iter().for_each(|&node| held[node as usize] = false);
    }
    let whole = constraints.iter().filter(|constraint| constraint.count() == 3);
    whole.for_each(|constraint| held[constraint.node as usize] = true);
    DofMap::of(cells, positions, &held)
}

impl Constrained<'_> {
    /// The system of a matrix, with partly held rows along their own axes. Positions are those of the nodes.
    pub fn system(&self, mut matrix: HalfMatrix<f64, 3>, positions: &[Vector]) -> System {
        let partly_constrained = partly_constrained(self.constraints, self.dof_map);
        rotate_into_local_axes(&mut matrix, &partly_constrained);
        let positions = self.dof_map.by_row(positions);
        System { ordering: self.dof_map.ordering.clone(), matrix, partly_constrained, positions }
    }

    /// The number of unknowns that are not held.
    pub fn free_unknowns(&self) -> usize {
        let partly = self.constraints.iter().filter(|constraint| constraint.count() < 3);
        3 * self.dof_map.ordering.free - partly.map(Constraint::count).sum::<usize>()
    }

    /// The values of the constraints and forces of a load case.
    pub fn known(&self, case: &LoadCase) -> PrescribedValues {
        let rows = self.dof_map.ordering.place.len();
        let mut known =
            PrescribedValues { displacement: vec![[[0.0]; 3]; rows], force: vec![[0.0; 3]; rows] };
        for (force, &row) in case.forces.iter().zip(&self.dof_map.ordering.place) {
            known.force[row as usize] = (*force).into();
        }
        for (constraint, values) in self.constraints.iter().zip(&case.held) {
            let row = self.dof_map.row(constraint.node);
            known.displacement[row] =
                std::array::from_fn(|k| [if k < constraint.count() { values[k] } else { 0.0 }]);
            if !constraint.is_aligned() {
                let own = constraint.axes().transpose() * Vector::from(known.force[row]);
                known.force[row] = own.into();
            }
        }
        known
    }

    /// Forces of nodes on the free unknowns, zero where held.
    pub fn free_forces(&self, system: &System, forces: &[Vector]) -> Unknowns {
        let mut by_row = vec![[0.0; 3]; self.dof_map.ordering.place.len()];
        for (force, &row) in forces.iter().zip(&self.dof_map.ordering.place) {
            by_row[row as usize] = (*force).into();
        }
        by_row.truncate(system.ordering.free);
        for partly in &system.partly_constrained {
            let own = partly.axes.transpose() * Vector::from(by_row[partly.row]);
            let free = |k: usize| if partly.held[k] { 0.0 } else { own[k] };
            by_row[partly.row] = std::array::from_fn(free);
        }
        by_row
    }

    /// Nodal vectors along the axes of the coordinates.
    pub fn displacement(&self, total: &[Lanes<f64, 3, 1>]) -> Vec<Vector> {
        let places = self.dof_map.ordering.place.iter();
        let mut displacement: Vec<Vector> =
            places.map(|&row| Vector::from(total[row as usize].map(|[value]| value))).collect();
        for constraint in self.constraints.iter().filter(|constraint| !constraint.is_aligned()) {
            let own = displacement[constraint.node as usize];
            displacement[constraint.node as usize] = constraint.axes() * own;
        }
        displacement
    }

    /// Reaction force of each constraint: the internal force less the acting one along its constrained axes, along the
    /// axes of the coordinates.
    pub fn reactions(&self, internal: &[Lanes<f64, 3, 1>], force: &Unknowns) -> Vec<Vector> {
        let reaction = |constraint: &Constraint| {
            let row = self.dof_map.row(constraint.node);
            let own = Vector::from_fn(|k, _| match k < constraint.count() {
                true => internal[row][k][0] - force[row][k],
                false => 0.0,
            });
            constraint.axes() * own
        };
        self.constraints.iter().map(reaction).collect()
    }

    /// A row of the solver is a node of the mesh.
    pub fn in_nodes(&self, error: SolverError) -> SolverError {
        match error {
            SolverError::Singular { node: row } => {
                let place = |place: &u32| *place as usize == row;
                let node = self.dof_map.ordering.place.iter().position(place);
                SolverError::Singular { node: node.unwrap_or(row) }
            }
            other => other,
        }
    }
}

impl PrescribedValues {
    /// f - K u_b of the free unknowns, zero for held ones.
    pub fn right_hand_side(&self, system: &System) -> Unknowns {
        let product = product_at_constraints(system, &self.displacement);
        let mut result: Unknowns = self.force[..system.ordering.free].to_vec();
        for (value, [x, y, z]) in result.iter_mut().zip(&product) {
            *value = [value[0] - x[0], value[1] - y[0], value[2] - z[0]];
        }
        for partly in &system.partly_constrained {
            for (value, _) in result[partly.row].iter_mut().zip(partly.held).filter(|(_, h)| *h) {
                *value = 0.0;
            }
        }
        result
    }

    /// Prescribed and computed displacements together.
    pub fn total(&self, solved: &Unknowns) -> Vec<Lanes<f64, 3, 1>> {
        let mut total = self.displacement.clone();
        for (total, solved) in total.iter_mut().zip(solved) {
            total.iter_mut().zip(solved).for_each(|(total, solved)| total[0] += solved);
        }
        total
    }
}

/// K x where it is of use: in the rows of held nodes, and what held nodes do to free ones. Partly held
/// nodes lie among the free ones, and with them every row counts.
pub fn product_at_constraints(system: &System, x: &[Lanes<f64, 3, 1>]) -> Vec<Lanes<f64, 3, 1>> {
    let mut product = vec![[[0.0]; 3]; x.len()];
    let first = if system.partly_constrained.is_empty() { system.ordering.free } else { 0 };
    system.matrix.add_rows(first..x.len(), x, &mut product);
    product
}

/// Cells whose matrices are computed side by side before they are added in cell order, which keeps the
/// bits independent of the number of threads.
const CHUNK: usize = 4096;

/// Where nodes and cells go in the matrix. It depends on the cells and on which nodes are held, and
/// serves any materials.
pub struct DofMap {
    pub ordering: Arc<RowOrdering>,
    pub pattern: Arc<Pattern>,
    /// Places of the nodes of each cell, cells in the order of the layout.
    pub connectivity: ElementConnectivity,
    pub around: ElementsOfRow,
}

impl DofMap {
    /// For the nodes of a mesh. `held` tells those without a free unknown.
    pub fn new(mesh: &VolumeMesh, held: &[bool]) -> Self {
        DofMap::of(&nodes_of_cells(mesh), &mesh.nodes, held)
    }

    /// For nodes at positions that stand in cells of any kind.
    pub fn of(connectivity: &ElementConnectivity, positions: &[Vector], held: &[bool]) -> Self {
        let rows = positions.len();
        let around = connectivity.inverted(rows);
        let ordering = RowOrdering::new(connectivity, &around, held, 3, far_end(positions));
        let connectivity = renumbered(connectivity, &ordering.element_order, &ordering.place);
        let around = connectivity.inverted(rows);
        let pattern = Arc::new(Pattern::new(&connectivity, &around, rows));
        DofMap { ordering: Arc::new(ordering), pattern, connectivity, around }
    }

    /// Values of nodes in the order of rows.
    pub fn by_row<T: Copy>(&self, of_node: &[T]) -> Vec<T> {
        let mut by_row = of_node.to_vec();
        for (value, &row) in of_node.iter().zip(&self.ordering.place) {
            by_row[row as usize] = *value;
        }
        by_row
    }

    /// The row of a node.
    pub fn row(&self, node: u32) -> usize {
        self.ordering.place[node as usize] as usize
    }

    /// Adds the matrices of whole cells, given by their places in the order of the layout; false where it
    /// was cancelled.
    pub fn add_cells<M: AsRef<[Block]> + Send>(
        &self,
        matrix: &mut HalfMatrix<f64, 3>,
        elements: &[usize],
        progress: &dyn Progress,
        cell_matrix: impl Fn(usize) -> Result<M, InvertedCell> + Sync,
    ) -> Result<bool, InvertedCell> {
        for chunk in elements.chunks(CHUNK) {
            if progress.is_cancelled() {
                return Ok(false);
            }
            let cell =
                |&element: &usize| cell_matrix(self.ordering.element_order[element] as usize);
            let matrices: Vec<Result<M, InvertedCell>> = chunk.par_iter().map(cell).collect();
            for (&element, blocks) in chunk.iter().zip(matrices) {
                add_cell(matrix, self.connectivity.row(element), blocks?.as_ref());
            }
        }
        Ok(true)
    }
}

/// The nodes of each cell of a mesh.
pub(in crate::model) fn nodes_of_cells(mesh: &VolumeMesh) -> ElementConnectivity {
    let mut connectivity = ElementConnectivity::default();
    mesh.cells.iter().for_each(|(_, nodes)| connectivity.push(nodes.iter().copied()));
    connectivity
}

/// The node at one end of the longest extent.
fn far_end(nodes: &[Vector]) -> usize {
    let [low, high] = bounds_of(nodes).unwrap_or_default();
    let axis = (high - low).imax();
    let ends = (0..nodes.len()).min_by(|&a, &b| nodes[a][axis].total_cmp(&nodes[b][axis]));
    ends.unwrap_or_default()
}

/// Adds the blocks of a cell, row by row, to the rows of its nodes.
pub(crate) fn add_cell(matrix: &mut HalfMatrix<f64, 3>, rows: &[u32], blocks: &[Block]) {
    for (j, &row) in rows.iter().enumerate() {
        for (k, &column) in rows.iter().enumerate().filter(|(_, column)| **column <= row) {
            let sum = matrix.block_mut(row as usize, column as usize);
            let block = &blocks[j * rows.len() + k];
            for (sum, value) in sum.as_flattened_mut().iter_mut().zip(block.as_flattened()) {
                *sum += value;
            }
        }
    }
}

/// The rows of partly constrained nodes.
pub fn partly_constrained(constraints: &[Constraint], dof_map: &DofMap) -> Vec<PartlyHeld> {
    constraints
        .iter()
        .map(|constraint| (constraint, dof_map.row(constraint.node)))
        .filter(|(constraint, row)| *row < dof_map.ordering.free && constraint.count() > 0)
        .map(|(constraint, row)| PartlyHeld {
            row,
            held: std::array::from_fn(|k| k < constraint.count()),
            axes: *constraint.axes(),
        })
        .collect()
}

/// Rotates the rows and columns of partly constrained nodes into their own axes: Q^T K Q.
pub fn rotate_into_local_axes(matrix: &mut HalfMatrix<f64, 3>, partly_constrained: &[PartlyHeld]) {
    if partly_constrained.is_empty() {
        return;
    }
    let mut axes = vec![None; matrix.rows()];
    for partly in partly_constrained {
        axes[partly.row] = Some(partly.axes);
    }
    let pattern = matrix.pattern.clone();
    for row in 0..matrix.rows() {
        let turned = |block: &Block, column: usize| -> Block {
            let mut result = nalgebra::Matrix3::from_fn(|i, j| block[i][j]);
            if let Some(q) = &axes[row] {
                result = q.transpose() * result;
            }
            if let Some(q) = &axes[column] {
                result *= q;
            }
            std::array::from_fn(|i| std::array::from_fn(|j| result[(i, j)]))
        };
        if axes[row].is_some() {
            matrix.diagonal[row] = turned(&matrix.diagonal[row], row);
        }
        for (at, &column) in pattern.range(row).zip(pattern.columns(row)) {
            if axes[row].is_some() || axes[column as usize].is_some() {
                matrix.lower[at] = turned(&matrix.lower[at], column as usize);
            }
        }
    }
}
