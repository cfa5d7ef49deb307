//! Stress and strain of cells by the law that their tissue has at finite strain.
//!
//! sigma = P F^T / J; its mean over the deformed cell is (1/v) sum_q V_q P F^T with v = sum_q V_q J. Green's strain
//! E = (F^T F - 1) / 2, its mean is that over the cell at rest. What a pressure or a mean dilatation carries of the law is
//! what it carries in the forces: at second order (`force_series`) c ln J of the law is replaced by p, or by that of the mean of J, and
//! linear fibres add F (C_f : E) F^T. Where tissue grows and muscles pull, F is F_e of the stress, in the grown cell, and S is one more
//! second Piola-Kirchhoff stress (`finite_strain::inner`); strain is that of F with its growth.
//!
//! Source: Holzapfel, Nonlinear solid mechanics, 2000, sections 2.5 and 3.1.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::assembly::Tissue;
use super::cell_stiffness::Dilatation;
use crate::material::ElasticTensor;
use crate::material::hyperelastic::point::{MeanShare, Point, PressureShare};
use crate::material::hyperelastic::{Law, NeoHookean, VolumeEnergy};
use crate::mesh::Vector;
use crate::model::cell_state::CellState;
use crate::model::fem::inner_stress::{Grown, InnerStress};
use crate::model::reference_cell;

/// Sums over the points of a cell.
#[derive(Clone, Copy, Default)]
pub(super) struct CellSums {
    /// sum V P F^T.
    stress: Matrix3<f64>,
    /// sum V E.
    strain: Matrix3<f64>,
    /// At rest and deformed, in mm^3.
    at_rest: f64,
    deformed: f64,
}

impl CellSums {
    /// Adds a point that stands for so many mm^3 at rest.
    pub fn add(&mut self, point: &Point, volume: f64) {
        self.stress += point.kirchhoff() * volume;
        self.strain += point.green_strain() * volume;
        self.at_rest += volume;
        self.deformed += volume * point.volume();
    }

    /// Of a cell that has grown by these factors.
    pub fn means(self, grown: &Grown) -> CellState {
        let strain = grown.green_strain(&(self.strain / self.at_rest));
        CellState { stress: self.stress / self.deformed, strain }
    }
}

/// The state of every cell of an answer to second order, by the law at its displacement; none of a cell that it turns inside
/// out. `pressures` are those of `linear_states::Displaced`.
pub fn at_second_order(
    tissue: &Tissue,
    inner: &InnerStress,
    displacement: &[Vector],
    pressures: &[Option<f64>],
) -> Vec<Option<CellState>> {
    let state = |cell: usize| {
        let pressure = pressures.get(cell).copied().flatten();
        of_cell(tissue, inner, cell, &NodalAnswer { displacement, pressure })
    };
    (0..tissue.mesh.cells.len()).into_par_iter().map(state).collect()
}

/// Displacements of the nodes in mm, and the mean pressure of a cell in kPa where it has one.
struct NodalAnswer<'a> {
    displacement: &'a [Vector],
    pressure: Option<f64>,
}

fn of_cell(
    tissue: &Tissue,
    inner: &InnerStress,
    cell: usize,
    &NodalAnswer { displacement, pressure }: &NodalAnswer,
) -> Option<CellState> {
    let (mesh, grown) = (tissue.mesh, inner.grown(cell));
    let (shape, nodes) = (mesh.cells.shape(cell), mesh.cells.nodes(cell));
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    // Tissue with linear fibres is across them what its tensor says, not what it is without.
    let tensor = tissue.tensor(cell);
    let of_tensor = NeoHookean { lambda: tensor.lambda, mu: tensor.mu };
    let material = &tissue.materials[tissue.material_of_cell[cell] as usize];
    let law = material.stated_law().copied().unwrap_or(Law::NeoHookean(of_tensor));
    let mut points = Vec::new();
    for point in &reference_cell(shape).points {
        let at = point.at(&corners)?;
        let moved = nodes.iter().zip(&at.gradients);
        let gradient: Matrix3<f64> =
            moved.map(|(&node, g)| displacement[node as usize] * g.transpose()).sum();
        let f = (Matrix3::identity() + gradient) / grown.length;
        if f.determinant() <= 0.0 {
            return None;
        }
        points.push((Point::new(&law, None, f).pulled(inner.pulls(cell)), at.volume));
    }
    let modulus = tensor.pressure_part().lambda;
    let mean = match (pressure, (tissue.dilatation)(shape)) {
        (None, Dilatation::Mean) => Some(of_mean(&points, &tensor)),
        (Some(_), _) | (None, Dilatation::Pointwise) => None,
    };
    let along_fibres = ElasticTensor { lambda: 0.0, mu: 0.0, ..tensor };
    let mut sums = CellSums::default();
    for (point, volume) in points {
        let fibres = point.pushed(&along_fibres.stress(&point.green_strain()));
        sums.stress += fibres * volume;
        let point = match (pressure, mean) {
            (Some(pressure), _) => point.carried(PressureShare { pressure, modulus }),
            (None, Some(by)) => point.of_mean(by),
            (None, None) => point,
        };
        sums.add(&point, volume);
    }
    Some(sums.means(&grown))
}

/// What is taken at the mean of J: lambda, and what its points have less.
fn of_mean(points: &[(Point, f64)], tensor: &ElasticTensor) -> MeanShare {
    let volume: f64 = points.iter().map(|(_, volume)| volume).sum();
    let deformed: f64 = points.iter().map(|(point, volume)| point.volume() * volume).sum();
    let bounded = -tensor.split_volume().0.lambda;
    let energy = VolumeEnergy { logarithmic: tensor.lambda, bounded };
    MeanShare { pressure: energy.at(deformed / volume).first, energy }
}
