//! The cells of an answer with functions on their edges.

use nalgebra::Matrix3;

use super::mean_stress;
use super::points::{EnrichedCell, of_corners};
use super::simplex::{CornerPressures, Simplex};
use super::two_level::{AtCorners, Coefficients, EnrichedCells, OfEdges};
use crate::mesh::{CellShape, Vector};
use crate::model::fem::assembly::Tissue;
use crate::model::fem::displacement_pressure::{PressureCells, without_pressure_part};
use crate::model::fem::linear_system::LinearSystem;
use crate::model::problem::InvertedCell;

/// Tissue, and an answer of it.
pub(super) struct Cells<'a> {
    tissue: &'a Tissue<'a>,
    pub displacement: &'a [Vector],
    pressures: &'a [f64],
    /// The numbers of the pressures of its corners, for each cell that has them.
    numbers: Vec<Option<[u32; 4]>>,
    /// The stress of the mean volume change, for each cell that has one.
    mean_stresses: Vec<Option<Matrix3<f64>>>,
}

/// Displacements in mm and pressures in kPa, and eps_g of each cell of tissue that grows.
#[derive(Clone, Copy)]
pub(super) struct CellAnswer<'a> {
    pub displacement: &'a [Vector],
    pub pressures: &'a [f64],
    pub growth: &'a [f64],
}

/// One cell with functions on its edges.
enum Cell {
    Simplex(Simplex),
    Points(EnrichedCell),
}

impl<'a> Cells<'a> {
    pub fn new(
        tissue: &'a Tissue<'a>,
        system: &LinearSystem,
        CellAnswer { displacement, pressures, growth }: CellAnswer<'a>,
    ) -> Self {
        let mut numbers = vec![None; tissue.mesh.cells.len()];
        if let Some(all) = &system.pressures {
            let PressureCells { cells, pressures, .. } = &all.cells;
            for (&cell, own) in cells.iter().zip(pressures) {
                numbers[cell as usize] = Some(*own);
            }
        }
        let mean_stresses = mean_stress::smooth(tissue, displacement, growth);
        Cells { tissue, displacement, pressures, numbers, mean_stresses }
    }

    fn cell(&self, cell: usize) -> Result<Cell, InvertedCell> {
        let (mesh, tensor) = (self.tissue.mesh, self.tissue.tensor(cell));
        let shape = mesh.cells.shape(cell);
        match shape {
            CellShape::Tet4 => {
                let pressures = self.numbers[cell].map(|numbers| CornerPressures {
                    values: numbers.map(|number| self.pressures[number as usize]),
                    mu: tensor.pressure_part().mu,
                });
                let own = if pressures.is_some() { without_pressure_part(tensor) } else { tensor };
                Simplex::new(mesh, cell, own, pressures).map(Cell::Simplex)
            }
            CellShape::Hex8 | CellShape::Wedge6 => {
                let dilatation = (self.tissue.dilatation)(shape);
                EnrichedCell::new(mesh, cell, &tensor, dilatation).map(Cell::Points)
            }
        }
    }
}

impl EnrichedCells for Cells<'_> {
    fn is_finite(&self) -> bool {
        false
    }

    fn pressure_numbers(&self, cell: usize) -> Option<[u32; 4]> {
        self.numbers[cell]
    }

    fn equations(&self, cell: usize, of_edges: &mut OfEdges) -> Result<(), InvertedCell> {
        let moved = of_corners(self.tissue.mesh, cell, self.displacement);
        match self.cell(cell)? {
            Cell::Simplex(simplex) => simplex.equations(&moved, &mut of_edges.equations),
            Cell::Points(points) => {
                of_edges.modes = points.modes(&moved);
                let mean_stress = &self.mean_stresses[cell];
                of_edges.equations = points.equations(&moved, &of_edges.modes, mean_stress);
            }
        }
        Ok(())
    }

    fn at_corners(&self, cell: usize, of: &Coefficients) -> Result<AtCorners, InvertedCell> {
        Ok(match self.cell(cell)? {
            Cell::Simplex(simplex) => {
                (simplex.forces(&of.edges), simplex.volumes(&of.edges).unwrap_or_default())
            }
            Cell::Points(points) => (
                points.forces(&of_corners(self.tissue.mesh, cell, self.displacement), of),
                [0.0; 4],
            ),
        })
    }

    fn stiffening(&self, cell: usize, of_nodes: &[Vector]) -> Result<f64, InvertedCell> {
        Ok(match self.cell(cell)? {
            Cell::Simplex(_) => 0.0,
            Cell::Points(points) => {
                points.stiffening(&of_corners(self.tissue.mesh, cell, of_nodes))
            }
        })
    }
}
