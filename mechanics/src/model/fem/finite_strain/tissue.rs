//! Tissue at positions and pressures: what its elements together exert, how it yields, and how far it may go.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::bricks::{Bricks, DeformedBricks};
use super::elements::{CellBulkModulus, Elements};
use super::pressures::{PressureCell, Pressures};
use super::problem::FiniteStrain;
use super::sheet::{DeformedSheet, Sheet};
use super::simplices::{DeformedSimplices, Simplices};
use crate::material::hyperelastic::Law;
use crate::mesh::{Vector, Warning};
use crate::model::dofs::DofMap;
use crate::model::problem::InvertedCell;
use crate::progress::Progress;
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::{NewtonReport, SolverError};

/// What the last digits of a sum of a few terms lose, with some room.
const ROUNDING: f64 = 1e-15;

/// A cell whose volume is less by this part is compressed.
const COMPRESSED: f64 = 1e-9;

/// What a cell may lose of its volume in one step. Where cells do not share their volume it is less above twelve times the
/// shear modulus: what a loss does to the forces grows with their ratio.
const LOSS: f64 = 0.3;
const SOFT: f64 = 12.0;

/// The elements of a mesh.
pub(super) struct Tissue<'a> {
    pub dof_map: &'a DofMap,
    simplices: Simplices<'a>,
    bricks: Bricks<'a>,
    sheet: Sheet,
    /// Positions at rest, by row.
    pub rest: Vec<Vector>,
    /// The share of its volume that a cell keeps in one step.
    keep: f64,
    /// The bulk modulus that stays in cells whose volume is shared, as a multiple of mu, and how many cells keep it.
    pub bulk_in_cells: f64,
    pub cells_with_bulk: usize,
    /// Whether all cells share their volume that are not pressed.
    pub shares_all: bool,
}

/// Tissue at positions whose points all have a positive volume.
pub(super) struct Deformed<'a> {
    pub tissue: &'a Tissue<'a>,
    pub simplices: DeformedSimplices<'a>,
    pub bricks: DeformedBricks<'a>,
    sheet: DeformedSheet<'a>,
    /// By row, in mN.
    pub forces: Vec<Vector>,
    /// Those that a step has to balance, where cells have mean volume changes of their own; empty where there are none.
    of_step: Vec<Vector>,
    /// What the pressures leave of the volumes, in mm^3; none where there are none.
    pub volumes: Vec<f64>,
}

impl<'a> Tissue<'a> {
    pub fn new(
        problem: &FiniteStrain<'a>,
        dof_map: &'a DofMap,
        kept: &CellBulkModulus,
    ) -> Result<Self, InvertedCell> {
        let FiniteStrain { nodes, laws, .. } = *problem;
        let simplices = Simplices::new(problem, dof_map, kept)?;
        let bricks = Bricks::new(problem, dof_map, kept)?;
        let sheet = Sheet::new(problem, dof_map);
        let rest = dof_map.by_row(nodes);
        let carries_all =
            bricks.all_share() && simplices.cells.iter().all(|cell| cell.carried > 0.0);
        let stiffest = laws.iter().map(Law::at_rest).map(|(lambda, mu)| lambda / mu);
        let keep = match carries_all {
            true => 1.0 - LOSS,
            false => 1.0 - LOSS * (SOFT / stiffest.fold(0.0, f64::max)).sqrt().min(1.0),
        };
        let sharing = simplices.cells_that_share().chain(bricks.cells_that_share());
        let shares: Vec<f64> = sharing.map(|cell| kept.share(cell)).collect();
        let bulk_in_cells = shares.iter().copied().fold(0.0, f64::max);
        let cells_with_bulk = shares.iter().filter(|&&share| share > 0.0).count();
        Ok(Tissue {
            dof_map,
            simplices,
            bricks,
            sheet,
            rest,
            keep,
            bulk_in_cells,
            cells_with_bulk,
            shares_all: kept.is_of_pressed(),
        })
    }

    /// Whether all cells of strained tissue at rest keep bulk modulus, because it jams where only pressed ones do.
    pub fn is_bulk_in_all(&self, rest: &NewtonReport) -> bool {
        self.bulk_in_cells > 0.0 && !self.shares_all && rest.least_det_f < 1.0 - COMPRESSED
    }

    /// The warning of tissue all of whose cells keep bulk modulus at rest; of load steps, the last of which is that rest, for the
    /// first one where they do.
    pub fn bulk_warning(&self, rest: &NewtonReport) -> Option<Warning> {
        let told = |bulk: f64, cells: usize, at: &str| {
            let detail = format!(
                "strong compression: the solver needed an extra bulk modulus of {bulk:.2} times the shear modulus in all {cells} cells, not in \
                 the compressed ones alone{at}; a slightly different plan may change the skin by some tenths of a millimetre"
            );
            let warning = Warning::new("bulk-in-all-cells", detail);
            warning.with("bulk_in_cells", bulk).with("cells", cells as f64)
        };
        let steps = &rest.load_steps;
        let Some(first) = steps.iter().position(|step| step.is_bulk_in_all) else {
            let is_in_all = self.is_bulk_in_all(rest);
            return is_in_all.then(|| told(self.bulk_in_cells, self.cells_with_bulk, ""));
        };
        let count = steps.iter().filter(|step| step.is_bulk_in_all).count();
        let at =
            format!(", at load step {} of {} first, and at {count} in all", first + 1, steps.len());
        let warning = told(steps[first].bulk_in_cells, steps[first].cells_with_bulk, &at);
        Some(warning.with("load_step", (first + 1) as f64).with("load_steps", count as f64))
    }

    /// The pressures of stabilised tetrahedra; none where there are none.
    pub fn pressures(
        &self,
        problem: &FiniteStrain,
        kept: &CellBulkModulus,
        axes: BTreeMap<u32, Matrix3<f64>>,
    ) -> Option<Pressures> {
        let laws = problem.laws;
        let cells: Vec<PressureCell> = (0..)
            .zip(&self.simplices.cells)
            .filter(|(_, cell)| cell.carried > 0.0)
            .map(|(simplex, cell)| PressureCell {
                simplex,
                rows: cell.rows,
                kind: problem.pressure_of_cell[cell.cell as usize],
                volume: cell.volume,
                exchange: kept.of(&laws[usize::from(cell.law)], cell.cell as usize),
            })
            .collect();
        let at_rest = |simplex: u32| self.simplices.cells[simplex as usize].gradients;
        let rows = self.rest.len();
        (!cells.is_empty()).then(|| Pressures::new(cells, rows, axes, &at_rest))
    }

    pub fn megabytes(&self) -> f64 {
        self.simplices.megabytes() + self.bricks.megabytes()
    }

    /// What rounding leaves: the norm of forces in mN, since stress is a difference of terms as large as the moduli, and
    /// energy in mN mm.
    pub fn rounding(&self) -> Rounding {
        let farthest = self.rest.iter().map(Vector::norm).fold(0.0, f64::max);
        let of_cells = || self.simplices.moduli(farthest).chain(self.bricks.moduli(farthest));
        let moduli = || of_cells().chain(self.sheet.moduli(farthest));
        let squares: f64 = moduli().map(|(force, _)| force * force).sum();
        let energy: f64 = moduli().map(|(_, energy)| energy).sum();
        Rounding { force: ROUNDING * squares.sqrt(), energy: ROUNDING * energy }
    }

    /// At positions, one for each row.
    pub fn at(&self, x: &[Vector], p: &[f64], pressures: Option<&Pressures>) -> Deformed<'_> {
        self.on_the_way(x, p, pressures, &[])
    }

    /// The same where hexahedra and wedges have mean volume changes of their own (`bricks`).
    pub fn on_the_way(
        &self,
        x: &[Vector],
        p: &[f64],
        pressures: Option<&Pressures>,
        of_bricks: &[f64],
    ) -> Deformed<'_> {
        let mut means = Vec::new();
        if let Some(pressures) = pressures {
            means = vec![0.0; self.simplices.cells.len()];
            pressures.means(p).for_each(|(cell, mean)| means[cell as usize] = mean);
        }
        let (simplices, bricks) = (self.simplices.at(x, &means), self.bricks.at(x, of_bricks));
        let mut forces = simplices.forces(self.dof_map);
        let sheet = self.sheet.at(x);
        sheet.add_forces(&mut forces);
        let mut of_step = if of_bricks.is_empty() { Vec::new() } else { forces.clone() };
        bricks.add_forces(&mut forces, &mut of_step);
        let log_volume = |cell: u32| simplices.log_volume(cell);
        let volumes = pressures.map(|pressures| pressures.residual(p, &log_volume));
        let volumes = volumes.unwrap_or_default();
        Deformed { tissue: self, forces, of_step, volumes, simplices, bricks, sheet }
    }

    /// The cell of the mesh of each tetrahedron.
    pub fn cells_of_simplices(&self) -> impl Iterator<Item = usize> {
        self.simplices.cells.iter().map(|simplex| simplex.cell as usize)
    }

    /// The cells of the mesh that are taken point by point.
    pub fn cells_of_bricks(&self) -> impl Iterator<Item = usize> {
        self.bricks.cells()
    }

    /// The mean volume changes that hexahedra and wedges have of their own: those that are stated, or those at rest; empty where none
    /// takes volume as a mean.
    pub fn means_from(&self, stated: Vec<f64>) -> Vec<f64> {
        let at_rest = self.bricks.means_at_rest();
        if at_rest.is_empty() || stated.is_empty() { at_rest } else { stated }
    }

    /// Those of positions.
    pub fn means_at(&self, x: &[Vector]) -> Vec<f64> {
        self.bricks.means_at(x)
    }

    /// In mN mm, of tissue without pressures.
    pub fn energy(&self, x: &[Vector]) -> f64 {
        self.simplices.energy(x) + self.bricks.energy(x) + self.sheet.at(x).energy()
    }

    /// The largest part of a step up to the whole in which every point keeps enough of its volume.
    pub fn longest_step(&self, x: &[Vector], step: &[Vector]) -> f64 {
        let of_simplices = self.simplices.longest_step(x, step, self.keep);
        of_simplices.min(self.bricks.longest_step(x, step, self.keep))
    }
}

impl Deformed<'_> {
    /// The derivatives of the internal forces by the positions, in kPa mm.
    pub fn tangent(&self, progress: &dyn Progress) -> Result<HalfMatrix<f64, 3>, SolverError> {
        let dof_map = self.tissue.dof_map;
        let mut matrix = self.simplices.tangent(dof_map, progress)?;
        self.bricks.add_tangent(&mut matrix, dof_map, progress)?;
        self.sheet.add_tangent(&mut matrix);
        Ok(matrix)
    }

    /// What a step has to balance, by row in mN.
    pub fn forces_of_step(&self) -> &[Vector] {
        if self.of_step.is_empty() { &self.forces } else { &self.of_step }
    }

    /// F^-T g of the corners of a tetrahedron.
    pub fn gradients(&self, simplex: u32) -> [Vector; 4] {
        self.simplices.gradients(simplex)
    }

    /// The least det F.
    pub fn least_volume(&self) -> f64 {
        self.simplices.least_volume().min(self.bricks.least_volume())
    }

    /// For each cell of the mesh whether det F of one of its points is below a limit.
    pub fn pressed(&self, limit: f64) -> Vec<bool> {
        let least = self.simplices.least_volumes().chain(self.bricks.least_volumes());
        let mut pressed = vec![false; self.tissue.dof_map.ordering.element_order.len()];
        least.for_each(|(cell, volume)| pressed[cell] = volume < limit);
        pressed
    }

    /// Of each cell of the mesh without its muscles' pull, in mN mm: of tetrahedra with shared pressures p ln J in the place of
    /// c/2 ln² J.
    pub fn passive_energies(&self) -> impl Iterator<Item = (usize, f64)> {
        let of_simplices = self.tissue.cells_of_simplices().enumerate().map(|(number, cell)| {
            let (at_rest, point) = self.simplices.at_cell(number);
            (cell, at_rest.volume * point.passive_energy())
        });
        let of_bricks = self.tissue.cells_of_bricks();
        of_simplices.chain(of_bricks.map(|cell| (cell, self.bricks.at_cell(cell).passive_energy())))
    }

    /// In mN mm, at these pressures.
    pub fn energy(&self, x: &[Vector]) -> f64 {
        self.simplices.energy() + self.tissue.bricks.energy(x) + self.sheet.energy()
    }
}

/// The norm of forces in mN, and energy in mN mm.
pub(super) struct Rounding {
    pub force: f64,
    pub energy: f64,
}

impl Elements {
    /// Four-node tetrahedra and full integration of the others.
    pub const PLAIN: Elements =
        Elements { stabilised: false, mean_dilatation: false, quadratic: false };
    /// Elements that do not lock.
    pub const STABLE: Elements =
        Elements { stabilised: true, mean_dilatation: true, ..Self::PLAIN };
    /// Ten-node tetrahedra.
    pub const QUADRATIC: Elements = Elements { quadratic: true, ..Self::PLAIN };
}

#[cfg(test)]
#[path = "at_rest_tests.rs"]
mod at_rest_tests;
