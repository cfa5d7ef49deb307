//! Cells at rest at finite strain with functions on their edges.
//!
//! With g the gradients at rest and the tangent moduli A = d2W/dF2 at F:
//!   r = f(phi) - int P : grad phi,   D = int grad phi . A . grad phi,   K_cb b = int grad N . A : grad (sum b phi).
//! (`edge_block` keeps D positive definite).

use super::enriched_brick::EnrichedBrick;
use super::enriched_simplex::{CornerPressures, EnrichedSimplex};
use super::pressures::Pressures;
use super::tissue::{Deformed, Tissue};
use crate::material::hyperelastic::Law;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::fem::assembly;
use crate::model::fem::discretisation_error::{
    AtCorners, Coefficients, EnrichedCells, OfEdges, Weighted, has_wedges, of_corners,
    smooth_in_wedges,
};
use crate::model::problem::InvertedCell;

/// Cells of tissue at rest.
pub(super) struct Enriched<'a> {
    mesh: &'a VolumeMesh,
    deformed: &'a Deformed<'a>,
    /// Of each law, in kPa.
    shear_moduli: Vec<f64>,
    /// For each cell its number among the simplices.
    simplex_of_cell: Vec<u32>,
    /// For each simplex the numbers of its pressures, and all pressures in kPa.
    numbers: Vec<Option<[u32; 4]>>,
    pressures: &'a [f64],
    /// The smooth pressure of each wedge that has one for its cell (`discretisation_error::mean_stress`).
    of_wedges: Vec<Option<f64>>,
}

/// Pressures, and where they belong.
pub(super) struct NodalPressures<'p, 'a> {
    pub pressures: Option<&'p Pressures>,
    pub values: &'a [f64],
}

impl<'a> Enriched<'a> {
    pub fn new(
        linear: &assembly::Tissue<'a>,
        laws: &[Law],
        tissue: &Tissue,
        deformed: &'a Deformed<'a>,
        pressed: &NodalPressures<'_, 'a>,
    ) -> Self {
        let mesh = linear.mesh;
        let mut simplex_of_cell = vec![u32::MAX; mesh.cells.len()];
        let mut simplices = 0;
        for cell in tissue.cells_of_simplices() {
            simplex_of_cell[cell] = simplices as u32;
            simplices += 1;
        }
        let mut numbers = vec![None; simplices];
        for (simplex, own) in pressed.pressures.into_iter().flat_map(Pressures::numbers) {
            numbers[simplex] = Some(own);
        }
        let shear_moduli = laws.iter().map(|law| law.at_rest().1).collect();
        let pressures = pressed.values;
        let of_wedges = smooth_pressures(linear, deformed);
        Enriched { mesh, deformed, shear_moduli, simplex_of_cell, numbers, pressures, of_wedges }
    }

    fn simplex(&self, cell: usize) -> EnrichedSimplex<'_> {
        let (simplex, point) = self.deformed.simplices.at_cell(self.simplex_of_cell[cell] as usize);
        let numbers = self.pressure_numbers(cell);
        let pressures = numbers.map(|own| own.map(|number| self.pressures[number as usize]));
        let mu = self.shear_moduli[usize::from(simplex.law)];
        EnrichedSimplex::new(simplex, point, CornerPressures { values: pressures, mu })
    }

    fn brick(&self, cell: usize) -> EnrichedBrick<'_> {
        let brick = self.deformed.bricks.at_cell(cell);
        let mu = self.shear_moduli[usize::from(brick.law)];
        let smooth = self.of_wedges.get(cell).copied().flatten();
        let (shape, corners) = (self.mesh.cells.shape(cell), self.mesh.corners(cell).collect());
        EnrichedBrick { shape, brick, corners, mu, smooth }
    }
}

/// Empty where there are no wedges.
fn smooth_pressures(linear: &assembly::Tissue, deformed: &Deformed) -> Vec<Option<f64>> {
    let cells = &linear.mesh.cells;
    if !has_wedges(linear.mesh) {
        return Vec::new();
    }
    let of_cell = |(cell, (shape, _)): (usize, (CellShape, &[u32]))| {
        if shape == CellShape::Tet4 {
            return None;
        }
        let brick = deformed.bricks.at_cell(cell);
        brick.mean.map(|mean| Weighted { value: mean.first, volume: brick.volume() })
    };
    let own: Vec<Option<Weighted<f64>>> = cells.iter().enumerate().map(of_cell).collect();
    smooth_in_wedges(linear, &own)
}

impl EnrichedCells for Enriched<'_> {
    fn is_finite(&self) -> bool {
        true
    }

    fn pressure_numbers(&self, cell: usize) -> Option<[u32; 4]> {
        *self.numbers.get(self.simplex_of_cell[cell] as usize)?
    }

    fn equations(&self, cell: usize, of_edges: &mut OfEdges) -> Result<(), InvertedCell> {
        match self.mesh.cells.shape(cell) {
            CellShape::Tet4 => self.simplex(cell).equations(&mut of_edges.equations),
            CellShape::Hex8 | CellShape::Wedge6 => self.brick(cell).equations(of_edges),
        }
        Ok(())
    }

    fn at_corners(&self, cell: usize, of: &Coefficients) -> Result<AtCorners, InvertedCell> {
        Ok(match self.mesh.cells.shape(cell) {
            CellShape::Tet4 => self.simplex(cell).at_corners(&of.edges),
            CellShape::Hex8 | CellShape::Wedge6 => {
                (self.brick(cell).forces(of), Default::default())
            }
        })
    }

    fn stiffening(&self, cell: usize, of_nodes: &[Vector]) -> Result<f64, InvertedCell> {
        let own = || of_corners(self.mesh, cell, of_nodes);
        Ok(match self.mesh.cells.shape(cell) {
            CellShape::Tet4 => 0.0,
            CellShape::Hex8 | CellShape::Wedge6 => self.brick(cell).stiffening(&own()),
        })
    }
}
