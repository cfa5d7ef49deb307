//! Smoothed stress of the mean volume change of wedges.
//!
//! There are two wedges for each node, and with one volume change each their pressures alternate between neighbours in patterns
//! that grow with lambda. Edge functions see such a pattern as a load. Its mean around the nodes of a kind of tissue, and of these over the
//! cell, is what the answer means (Hughes, The Finite Element Method, 1987, section 4.4). Hexahedra keep their own: their
//! patterns are weak, and in thin layers the mean takes away what is left of the pressure's slope.

use std::iter::Sum;
use std::ops::{AddAssign, Div, Mul};

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::points::{gradient_of, of_corners};
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::fem::assembly::Tissue;
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::reference_cell;

/// Something of a cell, and the volume in mm³ that it counts with.
#[derive(Clone, Copy)]
pub(in crate::model::fem) struct Weighted<T> {
    pub value: T,
    pub volume: f64,
}

/// Quantity to be averaged: a pressure, a stress.
pub(in crate::model::fem) trait Averaged:
    Copy + Send + AddAssign + Sum + Mul<f64, Output = Self> + Div<f64, Output = Self>
{
}

impl Averaged for f64 {}
impl Averaged for Matrix3<f64> {}

/// Of the cells around a node that are of one kind of tissue.
struct AroundNode<T> {
    kind: u16,
    sum: T,
    volume: f64,
}

/// For each wedge that takes volume as a mean the stress of it, smooth within each kind of tissue.
/// What a cell has grown by, `growth`, is not stress of it, and jumps where it likes: it is left out of the mean.
pub(super) fn smooth(
    tissue: &Tissue,
    displacement: &[Vector],
    growth: &[f64],
) -> Vec<Option<Matrix3<f64>>> {
    let cells = &tissue.mesh.cells;
    if !has_wedges(tissue.mesh) {
        return vec![None; cells.len()];
    }
    let own: Vec<Option<Weighted<Matrix3<f64>>>> =
        (0..cells.len()).into_par_iter().map(|cell| of_cell(tissue, cell, displacement)).collect();
    let of_growth = |cell: usize| {
        let strain = growth.get(cell).copied().unwrap_or_default();
        let (_, of_volume) = tissue.tensor(cell).split_volume();
        of_volume.stress(&Matrix3::from_diagonal_element(strain))
    };
    if growth.is_empty() {
        return smooth_in_wedges(tissue, &own);
    }
    let elastic = own
        .iter()
        .enumerate()
        .map(|(cell, own)| own.map(|own| Weighted { value: own.value - of_growth(cell), ..own }));
    let smooth = smooth_in_wedges(tissue, &elastic.collect::<Vec<_>>());
    let whole = smooth.into_iter().enumerate();
    whole.map(|(cell, mean)| mean.map(|mean| mean + of_growth(cell))).collect()
}

pub(in crate::model::fem) fn has_wedges(mesh: &VolumeMesh) -> bool {
    mesh.cells.iter().any(|(shape, _)| shape == CellShape::Wedge6)
}

/// The means over the nodes of each wedge of the means around them.
pub(in crate::model::fem) fn smooth_in_wedges<T: Averaged>(
    tissue: &Tissue,
    own: &[Option<Weighted<T>>],
) -> Vec<Option<T>> {
    let cells = &tissue.mesh.cells;
    let mut around: Vec<Vec<AroundNode<T>>> = Vec::new();
    around.resize_with(tissue.mesh.nodes.len(), Vec::new);
    for (cell, own) in own.iter().enumerate() {
        let Some(Weighted { value, volume }) = *own else { continue };
        let (kind, value) = (tissue.pressure_of_cell[cell], value * volume);
        for &node in cells.nodes(cell) {
            let known = &mut around[node as usize];
            match known.iter_mut().find(|known| known.kind == kind) {
                Some(known) => {
                    known.sum += value;
                    known.volume += volume;
                }
                None => known.push(AroundNode { kind, sum: value, volume }),
            }
        }
    }
    let mean = |cell: usize| {
        let (nodes, kind) = (cells.nodes(cell), tissue.pressure_of_cell[cell]);
        let at_nodes = nodes.iter().filter_map(|&node| {
            let own = around[node as usize].iter().find(|known| known.kind == kind)?;
            Some(own.sum / own.volume)
        });
        at_nodes.sum::<T>() / nodes.len() as f64
    };
    let is_wedge = |cell: usize| cells.shape(cell) == CellShape::Wedge6;
    own.iter()
        .enumerate()
        .map(|(cell, own)| own.filter(|_| is_wedge(cell)).map(|_| mean(cell)))
        .collect()
}

fn of_cell(
    tissue: &Tissue,
    cell: usize,
    displacement: &[Vector],
) -> Option<Weighted<Matrix3<f64>>> {
    let shape = tissue.mesh.cells.shape(cell);
    if (tissue.dilatation)(shape) == Dilatation::Pointwise {
        return None;
    }
    let corners: Vec<Vector> = tissue.mesh.corners(cell).collect();
    let moved = of_corners(tissue.mesh, cell, displacement);
    let (mut gradient, mut volume) = (Matrix3::zeros(), 0.0);
    for point in &reference_cell(shape).points {
        let physical = point.at(&corners)?;
        gradient += gradient_of(&moved, &physical.gradients) * physical.volume;
        volume += physical.volume;
    }
    let (_, of_volume) = tissue.tensor(cell).split_volume();
    Some(Weighted { value: of_volume.stress(&(gradient / volume)), volume })
}
