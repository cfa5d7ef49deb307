//! Pressures of stabilised tetrahedra: their numbers, their equations and the matrices that tie them to displacements.
//!
//! r_a = sum_cells V/4 ln J - (C p)_a, C = M/c + (M - Mbar)/mu, dr_a/du_b = V/4 h_b with h = F^-T g (docs/methods.md#newton).

use std::collections::BTreeMap;

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::elements::Exchange;
use crate::mesh::Vector;
use crate::solver::mixed_system::Coupling;
use crate::solver::slots::Slots;
use crate::solver::sparse_rows::{Couplings, SparseRows};

/// A tetrahedron with pressures.
pub(super) struct PressureCell {
    /// Its number among the simplices.
    pub simplex: u32,
    pub rows: [u32; 4],
    /// Cells share a pressure at a node only within a kind of tissue: pressure jumps where stiffness does.
    pub kind: u16,
    pub volume: f64,
    pub exchange: Exchange,
}

/// Pressures of the cells that have them.
pub(super) struct Pressures {
    cells: Vec<PressureCell>,
    numbers: Vec<[u32; 4]>,
    coupling: Coupling,
    slots_of_divergence: Slots,
    slots_of_gradient: Slots,
    /// Of rows with axes of their own.
    axes: BTreeMap<u32, Matrix3<f64>>,
    /// For each pressure the sums of V/4 and of V/4c of the cells around it.
    lumps: Vec<[f64; 2]>,
    /// W: turns volumes that are left over into the forces that their pressure would exert, in mN/mm^3.
    weights: Vec<f64>,
}

impl Pressures {
    /// `gradients` are those of the corners at rest; there are as many `node_rows` as rows of nodes, of which the last may have no pressure.
    pub fn new(
        cells: Vec<PressureCell>,
        node_rows: usize,
        axes: BTreeMap<u32, Matrix3<f64>>,
        gradients: &(dyn Fn(u32) -> [Vector; 4] + Sync),
    ) -> Self {
        let (numbers, count) = numbers(&cells);
        let rows: Vec<[u32; 4]> = cells.iter().map(|cell| cell.rows).collect();
        let by_pressure = Couplings { rows: &numbers, columns: &rows };
        let by_node = Couplings { rows: &rows, columns: &numbers };
        let among = Couplings { rows: &numbers, columns: &numbers };
        let compliance = |cell: usize, a: usize, b: usize| {
            let PressureCell { volume, exchange: Exchange { carried, mu }, .. } = cells[cell];
            let mass = volume / 20.0 * if a == b { 2.0 } else { 1.0 };
            mass / carried + (mass - volume / 16.0) / mu
        };
        let (mut mass, mut lumps) = (vec![0.0; count], vec![[0.0; 2]; count]);
        for (numbers, cell) in numbers.iter().zip(&cells) {
            let (Exchange { carried, mu }, quarter) = (cell.exchange, cell.volume / 4.0);
            for &number in numbers {
                mass[number as usize] += quarter * (1.0 / mu + 1.0 / carried);
                lumps[number as usize][0] += quarter;
                lumps[number as usize][1] += quarter / carried;
            }
        }
        let columns = columns(&cells, &axes, gradients);
        let coupling = Coupling {
            divergence: SparseRows::assemble(count, &by_pressure, |cell, _, b| columns[cell][b]),
            gradient: SparseRows::assemble(node_rows, &by_node, |cell, a, _| columns[cell][a]),
            compliance: SparseRows::assemble(count, &among, compliance),
            mass,
        };
        let weights = coupling.weights();
        Pressures {
            slots_of_divergence: Slots::new(&coupling.divergence, &by_pressure),
            slots_of_gradient: Slots::new(&coupling.gradient, &by_node),
            cells,
            numbers,
            coupling,
            axes,
            lumps,
            weights,
        }
    }

    pub fn count(&self) -> usize {
        self.coupling.mass.len()
    }

    /// The numbers of the pressures of each tetrahedron that has some, by its number among the simplices.
    pub fn numbers(&self) -> impl Iterator<Item = (usize, [u32; 4])> {
        self.cells.iter().map(|cell| cell.simplex as usize).zip(self.numbers.iter().copied())
    }

    pub fn megabytes(&self) -> f64 {
        let cell = size_of::<PressureCell>() + size_of::<[u32; 4]>();
        2.0 * self.coupling.megabytes() + (self.cells.len() * cell) as f64 / 1e6
    }

    /// The mean of ln J around each pressure that it answers to, and back; rest where nothing is stated.
    pub fn log_volumes(&self, p: &[f64]) -> Vec<f64> {
        p.iter().zip(&self.lumps).map(|(p, [volume, compliance])| p * compliance / volume).collect()
    }

    pub fn of_log_volumes(&self, log_volumes: &[f64]) -> Vec<f64> {
        match log_volumes.is_empty() {
            true => vec![0.0; self.count()],
            false => log_volumes
                .iter()
                .zip(&self.lumps)
                .map(|(log, [volume, compliance])| log * volume / compliance)
                .collect(),
        }
    }

    /// The mean pressure of each cell that has one, by its number among the simplices.
    pub fn means<'a>(&'a self, p: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let mean = |numbers: &[u32; 4]| -> f64 {
            0.25 * numbers.iter().map(|&number| p[number as usize]).sum::<f64>()
        };
        self.cells.iter().zip(&self.numbers).map(move |(cell, own)| (cell.simplex, mean(own)))
    }

    /// r in mm^3; `log_volume` is ln J of a simplex.
    pub fn residual(&self, p: &[f64], log_volume: &dyn Fn(u32) -> f64) -> Vec<f64> {
        let p: Vec<[f64; 1]> = p.iter().map(|&p| [p]).collect();
        let mut stored = vec![[0.0]; p.len()];
        self.coupling.compliance.multiply(&p, &mut stored);
        let mut residual: Vec<f64> = stored.into_iter().map(|[stored]| -stored).collect();
        for (cell, numbers) in self.cells.iter().zip(&self.numbers) {
            let quarter = 0.25 * cell.volume * log_volume(cell.simplex);
            numbers.iter().for_each(|&number| residual[number as usize] += quarter);
        }
        residual
    }

    /// The energy -p.C p/2 that pressures hold, in mN mm.
    pub fn energy(&self, p: &[f64]) -> f64 {
        let p: Vec<[f64; 1]> = p.iter().map(|&p| [p]).collect();
        let mut stored = vec![[0.0]; p.len()];
        self.coupling.compliance.multiply(&p, &mut stored);
        -0.5 * p.iter().zip(&stored).map(|([p], [stored])| p * stored).sum::<f64>()
    }

    /// The squared norm of the forces that left over volumes stand for, in mN^2.
    pub fn squared_forces(&self, residual: &[f64]) -> f64 {
        residual.iter().zip(&self.weights).map(|(r, weight)| (r * weight).powi(2)).sum()
    }

    /// The matrices where the gradients of the corners of each simplex are these.
    pub fn coupling_at(&mut self, gradients: &(dyn Fn(u32) -> [Vector; 4] + Sync)) -> &Coupling {
        let columns = columns(&self.cells, &self.axes, gradients);
        let Coupling { divergence, gradient, .. } = &mut self.coupling;
        self.slots_of_divergence.fill(divergence, |cell, _, b| columns[cell][b]);
        self.slots_of_gradient.fill(gradient, |cell, a, _| columns[cell][a]);
        &self.coupling
    }
}

/// V/4 h of each corner, along the axes of its row.
fn columns(
    cells: &[PressureCell],
    axes: &BTreeMap<u32, Matrix3<f64>>,
    gradients: &(dyn Fn(u32) -> [Vector; 4] + Sync),
) -> Vec<[[f64; 3]; 4]> {
    let of_cell = |cell: &PressureCell| {
        let mut own = gradients(cell.simplex);
        if !axes.is_empty() {
            for (gradient, row) in own.iter_mut().zip(&cell.rows) {
                if let Some(axes) = axes.get(row) {
                    *gradient = axes.transpose() * *gradient;
                }
            }
        }
        own.map(|gradient| (gradient * (0.25 * cell.volume)).into())
    };
    cells.par_iter().map(of_cell).collect()
}

/// Corners share a pressure where they share node and kind.
fn numbers(cells: &[PressureCell]) -> (Vec<[u32; 4]>, usize) {
    let mut known: BTreeMap<u16, BTreeMap<u32, u32>> = BTreeMap::new();
    let mut count = 0;
    let number = |cell: &PressureCell| {
        let of_kind = known.entry(cell.kind).or_default();
        cell.rows.map(|row| {
            *of_kind.entry(row).or_insert_with(|| {
                count += 1;
                count - 1
            })
        })
    };
    let numbers = cells.iter().map(number).collect();
    (numbers, count as usize)
}
