//! The sweeps of a repair over the nodes of unproven cells.

use rayon::prelude::*;

use super::bounds::Bounds;
use super::node::Star;
use crate::mesh::jacobian::{bezier_coefficients, jacobian_sign, smallest_jacobian};
use crate::mesh::{Vector, VolumeMesh};
use crate::progress::Progress;
use crate::rows::Rows;

/// ε at first, and when sweeps gain nothing.
const MARGINS: [f64; 4] = [0.05, 0.1, 0.2, 0.02];

/// Sweeps without fewer unproven cells after which a margin has gained what it can.
const PATIENCE: usize = 20;

/// Report of a repair.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RepairReport {
    /// Cells whose Jacobian was not proven positive in every point.
    pub unproven_before: usize,
    pub sweeps: usize,
    pub nodes_moved: usize,
    /// Of the moved nodes, in mm.
    pub mean_move: f64,
    pub largest_move: f64,
    /// The cells that stay unproven, all of them, with what is known of their smallest Jacobian.
    pub unproven: Vec<UnprovenCell>,
}

/// A cell that moves within the bounds do not mend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnprovenCell {
    pub cell: u32,
    /// The smallest Jacobian that was found in it, in mm³; positive where only its proof is missing.
    pub smallest_jacobian: f64,
}

/// Moves nodes of a mesh until every cell is proven valid, or nothing more is gained.
pub fn repair(mesh: &mut VolumeMesh, bounds: &Bounds, progress: &dyn Progress) -> RepairReport {
    let cells: Vec<usize> = (0..mesh.cells.len()).collect();
    let mut unproven = unproven_cells(mesh, &cells);
    let mut report = RepairReport { unproven_before: unproven.len(), ..RepairReport::default() };
    if unproven.is_empty() {
        return report;
    }
    let first = mesh.nodes.clone();
    let around = cells_around(mesh);
    let scales = scales(mesh, &around);
    let mut work =
        Sweep { mesh: &mut *mesh, bounds, first: &first, around: &around, scales: &scales };
    // Sweeps may leave more cells unproven than there were: what is kept is the best on the way.
    let mut best = (unproven.clone(), first.clone());
    for margin in MARGINS {
        let (mut fewest, mut since) = (unproven.len(), 0);
        while !unproven.is_empty() && since < PATIENCE && !progress.is_cancelled() {
            let near = work.sweep(&unproven, margin);
            unproven = unproven_cells(work.mesh, &near);
            report.sweeps += 1;
            since = if unproven.len() < fewest { 0 } else { since + 1 };
            fewest = fewest.min(unproven.len());
            if unproven.len() < best.0.len() {
                best = (unproven.clone(), work.mesh.nodes.clone());
            }
        }
    }
    (unproven, mesh.nodes) = best;
    report.report_moves(&first, &mesh.nodes);
    report.unproven = named(mesh, &unproven);
    report
}

impl RepairReport {
    fn report_moves(&mut self, first: &[Vector], now: &[Vector]) {
        let moves = first.iter().zip(now).map(|(a, b)| (a - b).norm());
        let moves: Vec<f64> = moves.filter(|&length| length > 0.0).collect();
        self.nodes_moved = moves.len();
        self.mean_move = moves.iter().sum::<f64>() / moves.len().max(1) as f64;
        self.largest_move = moves.iter().copied().fold(0.0, f64::max);
    }
}

/// The cells of some that are not proven valid.
fn unproven_cells(mesh: &VolumeMesh, cells: &[usize]) -> Vec<usize> {
    let is_unproven = |cell: &&usize| {
        let corners: Vec<Vector> = mesh.corners(**cell).collect();
        !jacobian_sign(mesh.cells.shape(**cell), &corners).is_valid()
    };
    cells.par_iter().with_min_len(64).filter(is_unproven).copied().collect()
}

fn named(mesh: &VolumeMesh, cells: &[usize]) -> Vec<UnprovenCell> {
    let name = |&cell: &usize| {
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        let smallest_jacobian = smallest_jacobian(mesh.cells.shape(cell), &corners).upper;
        UnprovenCell { cell: cell as u32, smallest_jacobian }
    };
    cells.iter().map(name).collect()
}

fn cells_around(mesh: &VolumeMesh) -> Rows<u32> {
    let mut nodes = Rows::default();
    mesh.cells.iter().for_each(|(_, of_cell)| nodes.push(of_cell.iter().copied()));
    nodes.inverted(mesh.nodes.len())
}

/// For each cell the mean |J| of all cells that share a node with it.
fn scales(mesh: &VolumeMesh, around: &Rows<u32>) -> Vec<f64> {
    let own: Vec<f64> = (0..mesh.cells.len()).map(|cell| mesh.cell_volume(cell).abs()).collect();
    let mean = |cell: usize| {
        let neighbours = mesh.cells.nodes(cell).iter().flat_map(|&node| around.row(node as usize));
        let (sum, count) = neighbours.fold((0.0, 0), |(sum, n), &c| (sum + own[c as usize], n + 1));
        (sum / f64::from(count.max(1))).max(f64::MIN_POSITIVE)
    };
    (0..mesh.cells.len()).map(mean).collect()
}

struct Sweep<'a> {
    mesh: &'a mut VolumeMesh,
    bounds: &'a Bounds,
    first: &'a [Vector],
    around: &'a Rows<u32>,
    scales: &'a [f64],
}

impl Sweep<'_> {
    /// Moves the nodes of some cells one after the other; returns the cells that may have changed, ascending.
    fn sweep(&mut self, cells: &[usize], margin: f64) -> Vec<usize> {
        let mut nodes: Vec<u32> =
            cells.iter().flat_map(|&cell| self.mesh.cells.nodes(cell)).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut near = cells.to_vec();
        for node in nodes {
            self.place(node as usize, margin);
            near.extend(self.around.row(node as usize).iter().map(|&cell| cell as usize));
        }
        near.sort_unstable();
        near.dedup();
        near
    }

    fn place(&mut self, node: usize, margin: f64) {
        let mut star = Star::new(self.first[node], self.bounds, node);
        for &cell in self.around.row(node) {
            self.add_cell(&mut star, cell as usize, node);
        }
        self.mesh.nodes[node] = star.best(self.mesh.nodes[node], margin);
    }

    /// The coefficients of a cell as affine functions of the place of one node: their values and slopes.
    fn add_cell(&self, star: &mut Star, cell: usize, node: usize) {
        let shape = self.mesh.cells.shape(cell);
        let mut corners: Vec<Vector> = self.mesh.corners(cell).collect();
        let nodes = self.mesh.cells.nodes(cell);
        let Some(local) = nodes.iter().position(|&other| other as usize == node) else { return };
        let base = bezier_coefficients(shape, &corners);
        let place = corners[local];
        let step = self.scales[cell].cbrt();
        let moved = [Vector::x(), Vector::y(), Vector::z()].map(|axis| {
            corners[local] = place + axis * step;
            bezier_coefficients(shape, &corners)
        });
        let scale = 1.0 / self.scales[cell];
        for (k, &value) in base.iter().enumerate() {
            let slope = Vector::new(moved[0][k] - value, moved[1][k] - value, moved[2][k] - value);
            star.add(value * scale, slope * (scale / step), &place);
        }
    }
}
