//! Tetrahedra at positions: energy, internal forces, tangent, and how far they may go.

use std::sync::Arc;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::elements::{CellBulkModulus, rounded};
use super::fibres::FibreField;
use super::problem::FiniteStrain;
use super::step_length::Volume;
use crate::material::hyperelastic::Law;
use crate::material::hyperelastic::point::{Point, PressureShare};
use crate::mesh::{CellShape, Vector};
use crate::model::dofs::DofMap;
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::fem::inner_stress::InnerStress;
use crate::model::problem::InvertedCell;
use crate::progress::Progress;
use crate::solver::half_matrix::{HalfMatrix, RowChunk};
use crate::solver::{Block, SolverError};

/// Cells or rows that one thread takes at a time.
const CHUNK: usize = 1024;

/// A tetrahedron at rest, as it has grown.
pub(super) struct Simplex {
    pub rows: [u32; 4],
    pub gradients: [Vector; 4],
    /// In mm^3.
    pub volume: f64,
    pub law: u16,
    pub cell: u32,
    /// The part of the bulk modulus that a pressure carries, in kPa; 0 where there is none.
    pub carried: f64,
}

/// The tetrahedra of a mesh, in the order of the degree-of-freedom map.
pub(super) struct Simplices<'a> {
    laws: &'a [Law],
    fibres: FibreField<'a>,
    inner: Arc<InnerStress>,
    pub cells: Vec<Simplex>,
    /// For each element of the degree-of-freedom map its tetrahedron, or `u32::MAX`; empty where all elements are tetrahedra.
    of_element: Vec<u32>,
}

pub(super) struct DeformedSimplices<'a> {
    simplices: &'a Simplices<'a>,
    points: Vec<Point>,
}

impl<'a> Simplices<'a> {
    pub fn new(
        problem: &FiniteStrain<'a>,
        dof_map: &DofMap,
        kept: &CellBulkModulus,
    ) -> Result<Self, InvertedCell> {
        let FiniteStrain { mesh, laws, law_of_cell, elements, fibres, .. } = *problem;
        let inner = Arc::clone(&problem.inner);
        let order = &dof_map.ordering.element_order;
        let is_simplex = |&element: &usize| {
            !elements.quadratic && mesh.cells.shape(order[element] as usize) == CellShape::Tet4
        };
        let own_elements: Vec<usize> = (0..order.len()).filter(is_simplex).collect();
        let cell = |&element: &usize| {
            let cell = order[element] as usize;
            let (volume, gradients) = tetrahedron(mesh, cell)?;
            let grown = inner.grown(cell);
            let (volume, gradients) =
                (volume * grown.volume, gradients.map(|g| grown.gradient(&g)));
            let members = dof_map.connectivity.row(element);
            let (rows, law) = (std::array::from_fn(|k| members[k]), law_of_cell[cell]);
            let carried = match elements.stabilised {
                true => kept.of(&laws[usize::from(law)], cell).carried.max(0.0),
                false => 0.0,
            };
            Ok(Simplex { rows, gradients, volume, law, cell: cell as u32, carried })
        };
        let cells = own_elements.par_iter().map(cell).collect::<Result<Vec<_>, _>>()?;
        let mut of_element = Vec::new();
        if cells.len() < order.len() {
            of_element = vec![u32::MAX; order.len()];
            for (simplex, &element) in own_elements.iter().enumerate() {
                of_element[element] = simplex as u32;
            }
        }
        Ok(Simplices { laws, fibres, inner, cells, of_element })
    }

    pub fn megabytes(&self) -> f64 {
        (self.cells.len() * (size_of::<Simplex>() + size_of::<Point>())) as f64 / 1e6
    }

    /// What rounding of each cell is relative to, lambda + 2 mu its modulus (`rounded`).
    pub fn moduli(&self, farthest: f64) -> impl Iterator<Item = (f64, f64)> {
        let at_rest: Vec<f64> =
            self.laws.iter().map(Law::at_rest).map(|(lambda, mu)| lambda + 2.0 * mu).collect();
        self.cells.iter().map(move |cell| {
            rounded(cell.volume * at_rest[usize::from(cell.law)], &cell.gradients, farthest)
        })
    }

    fn point(&self, cell: &Simplex, x: &[Vector], pressure: f64) -> Point {
        let fibres = self.fibres.along(cell.law, cell.cell as usize);
        let point = Point::new(&self.laws[usize::from(cell.law)], fibres, cell.gradient(x));
        let point = point.pulled(self.inner.pulls(cell.cell as usize));
        match cell.carried > 0.0 {
            true => point.carried(PressureShare { pressure, modulus: cell.carried }),
            false => point,
        }
    }

    /// At positions, one for each row, with the mean pressure of each cell; none where none has one.
    pub fn at(&self, x: &[Vector], pressures: &[f64]) -> DeformedSimplices<'_> {
        let pressure = |cell: usize| pressures.get(cell).copied().unwrap_or(0.0);
        let cells = self.cells.par_iter().enumerate();
        let points = cells.map(|(number, cell)| self.point(cell, x, pressure(number))).collect();
        DeformedSimplices { simplices: self, points }
    }

    /// Cells of the mesh whose volume pressures share.
    pub fn cells_that_share(&self) -> impl Iterator<Item = usize> {
        self.cells.iter().filter(|cell| cell.carried > 0.0).map(|cell| cell.cell as usize)
    }

    /// In mN mm, of tetrahedra without pressures.
    pub fn energy(&self, x: &[Vector]) -> f64 {
        let energy = |cell: &Simplex| cell.volume * self.point(cell, x, 0.0).energy();
        let sums: Vec<f64> =
            self.cells.par_chunks(CHUNK).map(|cells| cells.iter().map(energy).sum()).collect();
        sums.iter().sum()
    }

    /// The largest part of a step up to the whole in which every cell keeps that share of its volume.
    pub fn longest_step(&self, x: &[Vector], step: &[Vector], keep: f64) -> f64 {
        let longest = |cells: &[Simplex]| {
            cells.iter().fold(1.0_f64, |most, cell| {
                let (f, d) = (cell.gradient(x), cell.gradient(step));
                Volume::along(&f, &d, keep).positive_until(most)
            })
        };
        self.cells.par_chunks(CHUNK).map(longest).reduce(|| 1.0, f64::min)
    }

    fn of_element(&self, element: u32) -> Option<usize> {
        match self.of_element.get(element as usize) {
            None => Some(element as usize),
            Some(&u32::MAX) => None,
            Some(&simplex) => Some(simplex as usize),
        }
    }
}

impl Simplex {
    /// F at positions, or the derivative of F along a step.
    fn gradient(&self, x: &[Vector]) -> Matrix3<f64> {
        let nodes = self.rows.iter().zip(&self.gradients);
        nodes.map(|(&row, g)| x[row as usize] * g.transpose()).sum()
    }

    fn corner_of(&self, row: usize) -> usize {
        self.rows.iter().position(|&own| own as usize == row).unwrap_or_default()
    }
}

impl DeformedSimplices<'_> {
    /// Internal forces in mN, one for each row.
    pub fn forces(&self, dof_map: &DofMap) -> Vec<Vector> {
        let cells = &self.simplices.cells;
        let pairs = cells.par_iter().zip(&self.points);
        let stresses: Vec<Matrix3<f64>> =
            pairs.map(|(cell, point)| point.stress() * cell.volume).collect();
        let force = |row: usize| -> Vector {
            let around = dof_map.around.row(row).iter();
            let own = around.filter_map(|&element| self.simplices.of_element(element));
            own.map(|cell| stresses[cell] * cells[cell].gradients[cells[cell].corner_of(row)]).sum()
        };
        (0..dof_map.pattern.rows()).into_par_iter().with_min_len(CHUNK).map(force).collect()
    }

    /// The derivatives of the internal forces by the positions, in kPa mm.
    pub fn tangent(
        &self,
        dof_map: &DofMap,
        progress: &dyn Progress,
    ) -> Result<HalfMatrix<f64, 3>, SolverError> {
        let mut matrix = HalfMatrix::zeros(dof_map.pattern.clone());
        matrix.row_chunks(CHUNK).into_par_iter().try_for_each_init(
            || vec![0_u32; dof_map.pattern.rows()],
            |at, chunk| match progress.is_cancelled() {
                true => Err(SolverError::Stopped),
                false => {
                    self.add_rows(dof_map, chunk, at);
                    Ok(())
                }
            },
        )?;
        Ok(matrix)
    }

    /// Row by row: no two threads write to the same block, and cells are added in their order. `at` is scratch: where
    /// the block of each column of the row lies.
    fn add_rows(&self, dof_map: &DofMap, chunk: RowChunk<f64, 3>, at: &mut [u32]) {
        let begin = dof_map.pattern.range(chunk.first).start;
        for (local, diagonal) in chunk.diagonal.iter_mut().enumerate() {
            let row = chunk.first + local;
            let offset = dof_map.pattern.range(row).start - begin;
            for (k, &column) in dof_map.pattern.columns(row).iter().enumerate() {
                at[column as usize] = (offset + k) as u32;
            }
            for &element in dof_map.around.row(row) {
                let Some(cell) = self.simplices.of_element(element) else { continue };
                let (cell, point) = (&self.simplices.cells[cell], &self.points[cell]);
                let own = point.corner(&cell.gradients[cell.corner_of(row)]);
                for (&column, g) in cell.rows.iter().zip(&cell.gradients) {
                    let block = match (column as usize).cmp(&row) {
                        std::cmp::Ordering::Greater => continue,
                        std::cmp::Ordering::Equal => &mut *diagonal,
                        std::cmp::Ordering::Less => &mut chunk.lower[at[column as usize] as usize],
                    };
                    add(block, &point.block(&own, &point.corner(g)), cell.volume);
                }
            }
        }
    }

    /// The least det F.
    pub fn least_volume(&self) -> f64 {
        self.points.par_iter().map(Point::volume).reduce(|| f64::INFINITY, f64::min)
    }

    /// Each cell of the mesh that is a tetrahedron, and its det F.
    pub fn least_volumes(&self) -> impl Iterator<Item = (usize, f64)> {
        let cells = self.simplices.cells.iter().zip(&self.points);
        cells.map(|(cell, point)| (cell.cell as usize, point.volume()))
    }

    /// A tetrahedron at rest and its point.
    pub fn at_cell(&self, simplex: usize) -> (&Simplex, &Point) {
        (&self.simplices.cells[simplex], &self.points[simplex])
    }

    pub fn log_volume(&self, cell: u32) -> f64 {
        self.points[cell as usize].log_volume()
    }

    /// F^-T g of the corners of a cell.
    pub fn gradients(&self, cell: u32) -> [Vector; 4] {
        let (at_rest, point) = (&self.simplices.cells[cell as usize], &self.points[cell as usize]);
        let det_f = point.volume();
        at_rest.gradients.map(|g| point.corner(&g).of_log_volume(det_f))
    }

    /// In mN mm: that of the points, where pressures are what they are.
    pub fn energy(&self) -> f64 {
        let pairs = self.simplices.cells.iter().zip(&self.points);
        pairs.map(|(cell, point)| cell.volume * point.energy()).sum()
    }
}

fn add(sum: &mut Block, block: &Matrix3<f64>, volume: f64) {
    for (i, sums) in sum.iter_mut().enumerate() {
        for (j, sum) in sums.iter_mut().enumerate() {
            *sum += volume * block[(i, j)];
        }
    }
}
