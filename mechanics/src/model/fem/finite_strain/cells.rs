//! Tetrahedra at positions: energy, internal forces, tangent, and the least ratio of volumes.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::fibres::FibreField;
use super::step_length::Volume;
use crate::material::hyperelastic::Law;
use crate::material::hyperelastic::point::Point;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::dofs::Numbering;
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::problem::InvertedCell;
use crate::solver::Block;
use crate::solver::half_matrix::{HalfMatrix, RowChunk};

/// What the last digits of a sum of a few terms lose, with some room.
const ROUNDING: f64 = 1e-15;

/// Cells or rows that one thread takes at a time.
const CHUNK: usize = 1024;

/// A tetrahedron at rest.
struct Cell {
    rows: [u32; 4],
    gradients: [Vector; 4],
    /// In mm^3.
    volume: f64,
    law: u16,
    /// Its place in the mesh.
    number: u32,
}

/// The tetrahedra of a mesh in the order of its numbering.
pub(super) struct Cells<'a> {
    numbering: &'a Numbering,
    laws: &'a [Law],
    fibres: FibreField<'a>,
    cells: Vec<Cell>,
    /// Positions at rest, by row.
    pub rest: Vec<Vector>,
}

/// Tissue at positions whose cells all have a positive volume.
pub(super) struct Deformed<'a> {
    cells: &'a Cells<'a>,
    points: Vec<Point>,
}

impl<'a> Cells<'a> {
    pub fn new(
        mesh: &VolumeMesh,
        numbering: &'a Numbering,
        laws: &'a [Law],
        law_of_cell: &[u16],
    ) -> Result<Self, InvertedCell> {
        let order = &numbering.layout.clique_order;
        let cell = |(clique, &cell): (usize, &u32)| {
            let (volume, gradients) = tetrahedron(mesh, cell as usize)?;
            let members = numbering.cliques.row(clique);
            let rows = std::array::from_fn(|k| members[k]);
            Ok(Cell { rows, gradients, volume, law: law_of_cell[cell as usize], number: cell })
        };
        let cells = order.par_iter().enumerate().map(cell).collect::<Result<_, _>>()?;
        let fibres = FibreField::default();
        Ok(Cells { numbering, laws, fibres, cells, rest: numbering.by_row(&mesh.nodes) })
    }

    /// The same with fibres.
    pub fn fibred(self, fibres: FibreField<'a>) -> Self {
        Cells { fibres, ..self }
    }

    fn point(&self, cell: &Cell, x: &[Vector]) -> Point {
        let fibres = self.fibres.along(cell.law, cell.number as usize);
        Point::new(&self.laws[usize::from(cell.law)], fibres, Self::gradient(cell, x))
    }

    /// Of the cells at rest and at one set of positions, in MB.
    pub fn megabytes(&self) -> f64 {
        (self.cells.len() * (size_of::<Cell>() + size_of::<Point>())) as f64 / 1e6
    }

    /// The largest ratio of lambda and mu at rest among the laws.
    pub fn stiffest(&self) -> f64 {
        let at_rest = self.laws.iter().map(Law::at_rest);
        at_rest.map(|(lambda, mu)| lambda / mu).fold(0.0, f64::max)
    }

    /// V (lambda + 2 mu) of each cell, in mN mm: the energy that would double it.
    fn moduli(&self) -> impl Iterator<Item = f64> {
        let at_rest: Vec<f64> =
            self.laws.iter().map(Law::at_rest).map(|(lambda, mu)| lambda + 2.0 * mu).collect();
        self.cells.iter().map(move |cell| cell.volume * at_rest[usize::from(cell.law)])
    }

    /// Energy that rounding takes or gives, in mN mm.
    pub fn energy_rounding(&self) -> f64 {
        ROUNDING * self.moduli().sum::<f64>()
    }

    /// The norm of the forces that rounding leaves, in mN: stress is a difference of terms as large as the moduli.
    pub fn force_rounding(&self) -> f64 {
        let squared = |(modulus, cell): (f64, &Cell)| -> f64 {
            cell.gradients.iter().map(|g| (modulus * g.norm()).powi(2)).sum()
        };
        ROUNDING * self.moduli().zip(&self.cells).map(squared).sum::<f64>().sqrt()
    }

    /// F of a cell.
    fn gradient(cell: &Cell, x: &[Vector]) -> Matrix3<f64> {
        let nodes = cell.rows.iter().zip(&cell.gradients);
        nodes.map(|(&row, g)| x[row as usize] * g.transpose()).sum()
    }

    /// The tissue at positions, one for each row.
    pub fn at(&self, x: &[Vector]) -> Deformed<'_> {
        let point = |cell: &Cell| self.point(cell, x);
        Deformed { cells: self, points: self.cells.par_iter().map(point).collect() }
    }

    /// Energy at positions in mN mm.
    pub fn energy(&self, x: &[Vector]) -> f64 {
        let energy = |cell: &Cell| cell.volume * self.point(cell, x).energy();
        let sums: Vec<f64> =
            self.cells.par_chunks(CHUNK).map(|cells| cells.iter().map(energy).sum()).collect();
        sums.iter().sum()
    }

    /// The largest part of a step up to the whole in which every cell keeps that share of its volume.
    pub fn longest_step(&self, x: &[Vector], step: &[Vector], keep: f64) -> f64 {
        let longest = |cells: &[Cell]| {
            cells.iter().fold(1.0_f64, |most, cell| {
                let (f, d) = (Self::gradient(cell, x), Self::gradient(cell, step));
                Volume::along(&f, &d, keep).positive_until(most)
            })
        };
        self.cells.par_chunks(CHUNK).map(longest).reduce(|| 1.0, f64::min)
    }
}

impl Deformed<'_> {
    /// Internal forces in mN, one for each row.
    pub fn forces(&self) -> Vec<Vector> {
        let Cells { numbering, cells, .. } = self.cells;
        let stresses: Vec<Matrix3<f64>> = cells
            .par_iter()
            .zip(&self.points)
            .map(|(cell, point)| point.stress() * cell.volume)
            .collect();
        let force = |row: usize| -> Vector {
            let around = numbering.around.row(row).iter();
            around
                .map(|&clique| {
                    let cell = &cells[clique as usize];
                    let corner = corner_of(cell, row);
                    stresses[clique as usize] * cell.gradients[corner]
                })
                .sum()
        };
        (0..numbering.pattern.rows()).into_par_iter().with_min_len(CHUNK).map(force).collect()
    }

    /// The derivatives of the internal forces by the positions, in kPa mm.
    pub fn tangent(&self) -> HalfMatrix<f64, 3> {
        let numbering = self.cells.numbering;
        let mut matrix = HalfMatrix::zeros(numbering.pattern.clone());
        matrix.row_chunks(CHUNK).into_par_iter().for_each_init(
            || vec![0_u32; numbering.pattern.rows()],
            |at, chunk| self.add_rows(chunk, at),
        );
        matrix
    }

    /// Row by row: no two threads write to the same block, and cells are added in their order. `at` is scratch: where
    /// the block of each column of the row lies.
    fn add_rows(&self, chunk: RowChunk<f64, 3>, at: &mut [u32]) {
        let Cells { numbering, cells, .. } = self.cells;
        let begin = numbering.pattern.range(chunk.first).start;
        for (local, diagonal) in chunk.diagonal.iter_mut().enumerate() {
            let row = chunk.first + local;
            let offset = numbering.pattern.range(row).start - begin;
            for (k, &column) in numbering.pattern.columns(row).iter().enumerate() {
                at[column as usize] = (offset + k) as u32;
            }
            for &clique in numbering.around.row(row) {
                let (cell, point) = (&cells[clique as usize], &self.points[clique as usize]);
                let own = point.corner(&cell.gradients[corner_of(cell, row)]);
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
}

fn corner_of(cell: &Cell, row: usize) -> usize {
    cell.rows.iter().position(|&own| own as usize == row).unwrap_or_default()
}

fn add(sum: &mut Block, block: &Matrix3<f64>, volume: f64) {
    for (i, sums) in sum.iter_mut().enumerate() {
        for (j, sum) in sums.iter_mut().enumerate() {
            *sum += volume * block[(i, j)];
        }
    }
}
