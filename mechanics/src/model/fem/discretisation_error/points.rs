//! A cell of several quadrature points with functions on its edges: hexahedra and wedges.
//!
//! With mean dilatation the volume change of the edge functions is taken as its mean over the cell too, as that of the corners
//! is (`cell_stiffness`), and the stress of it is that of `mean_stress`.

use nalgebra::Matrix3;

use super::edge_equations::EdgeEquation;
use super::edge_functions::{Corners, MAX_EDGES, at_point};
use crate::element::MAX_NODES;
use crate::material::ElasticTensor;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;
use crate::solver::Block;

/// Gradients at a point, or their means over a cell, and the volume that it stands for in mm³.
struct Gradients {
    corners: [Vector; MAX_NODES],
    edges: [Vector; MAX_EDGES],
    volume: f64,
}

/// Places at which gradients are taken, with the stiffness that counts there.
pub(super) struct EnrichedCell {
    shape: CellShape,
    points: Vec<(Gradients, ElasticTensor)>,
}

impl EnrichedCell {
    pub fn new(
        mesh: &VolumeMesh,
        cell: usize,
        tensor: &ElasticTensor,
        dilatation: Dilatation,
    ) -> Result<Self, InvertedCell> {
        let shape = mesh.cells.shape(cell);
        let corners: Vec<Vector> = mesh.corners(cell).collect();
        let (at_points, of_mean) = match dilatation {
            Dilatation::Pointwise => (*tensor, None),
            Dilatation::Mean => {
                let (of_shape, of_volume) = tensor.split_volume();
                (of_shape, Some(of_volume))
            }
        };
        let reference = &reference_cell(shape).points;
        let mut points = Vec::with_capacity(reference.len() + 1);
        for point in reference {
            let physical = point.at(&corners).ok_or(InvertedCell { cell })?;
            let (values, gradients) = (&point.values, &physical.gradients);
            let edges = at_point(shape, &Corners { values, gradients }).gradients;
            let volume = physical.volume;
            points.push((Gradients { corners: physical.gradients, edges, volume }, at_points));
        }
        if let Some(of_volume) = of_mean {
            let mean = Gradients::mean(points.iter().map(|(point, _)| point));
            points.push((mean, of_volume));
        }
        Ok(EnrichedCell { shape, points })
    }

    /// r and D of each edge where the corners are displaced; `mean_stress` is that of the mean volume change.
    pub fn equations(
        &self,
        displacement: &[Vector],
        mean_stress: &Option<Matrix3<f64>>,
    ) -> [EdgeEquation; MAX_EDGES] {
        let mut equations = [EdgeEquation::ZERO; MAX_EDGES];
        let share = self.share_of_mean();
        for (place, (point, tensor)) in self.points.iter().enumerate() {
            let stress = match mean_stress {
                Some(smooth) if place == self.pointwise() => *smooth,
                _ => tensor.stress(&gradient_of(displacement, &point.corners)),
            };
            for (number, equation) in self.edges().zip(&mut equations) {
                equation.residual -= stress * point.edges[number] * point.volume;
            }
        }
        for (number, equation) in self.edges().zip(&mut equations) {
            equation.stiffness = self.block(number, number, share);
        }
        equations
    }

    /// The block of two edges.
    #[cfg(test)]
    pub fn stiffness(&self, edge: usize, other: usize) -> Matrix3<f64> {
        self.block(edge, other, 1.0)
    }

    /// How many places are points: the mean comes after them.
    fn pointwise(&self) -> usize {
        reference_cell(self.shape).points.len()
    }

    /// The share of the mean that counts in D. The one volume change of a wedge stands against nine edges and would let each
    /// of them do a third of what they do together; without it they overshoot the more the larger lambda is. It counts with
    /// the shear modulus in place of lambda.
    fn share_of_mean(&self) -> f64 {
        let [.., (_, of_volume)] = &self.points[..] else { return 1.0 };
        let has_mean = self.points.len() > self.pointwise();
        match self.shape {
            CellShape::Wedge6 if has_mean => (self.points[0].1.mu / of_volume.lambda).min(1.0),
            CellShape::Tet4 | CellShape::Hex8 | CellShape::Wedge6 => 1.0,
        }
    }

    fn block(&self, edge: usize, other: usize, share_of_mean: f64) -> Matrix3<f64> {
        let mut block: Block = [[0.0; 3]; 3];
        for (place, (point, tensor)) in self.points.iter().enumerate() {
            let share = if place == self.pointwise() { share_of_mean } else { 1.0 };
            let pair = [&point.edges[edge], &point.edges[other]];
            tensor.add_pair(&mut block, pair, point.volume * share);
        }
        Matrix3::from_fn(|i, j| block[i][j])
    }

    /// The forces on the corners of coefficients of the edges.
    pub fn forces(&self, of_edges: &[Vector; MAX_EDGES]) -> [Vector; MAX_NODES] {
        let mut forces = [Vector::zeros(); MAX_NODES];
        let count = self.shape.edges().len();
        for (point, tensor) in &self.points {
            let gradient = gradient_of(&of_edges[..count], &point.edges);
            let stress = tensor.stress(&gradient) * point.volume;
            for (force, slope) in forces.iter_mut().zip(&point.corners) {
                *force += stress * slope;
            }
        }
        forces
    }

    fn edges(&self) -> std::ops::Range<usize> {
        0..self.shape.edges().len()
    }
}

impl Gradients {
    fn mean<'a>(points: impl Iterator<Item = &'a Gradients>) -> Self {
        let (corners, edges) = ([Vector::zeros(); MAX_NODES], [Vector::zeros(); MAX_EDGES]);
        let mut mean = Gradients { corners, edges, volume: 0.0 };
        for point in points {
            mean.volume += point.volume;
            let own = point.corners.iter().chain(&point.edges);
            for (sum, gradient) in mean.corners.iter_mut().chain(&mut mean.edges).zip(own) {
                *sum += gradient * point.volume;
            }
        }
        let volume = mean.volume;
        mean.corners.iter_mut().chain(&mut mean.edges).for_each(|gradient| *gradient /= volume);
        mean
    }
}

/// grad v of v = sum_a v_a N_a.
pub(super) fn gradient_of(values: &[Vector], gradients: &[Vector]) -> Matrix3<f64> {
    values.iter().zip(gradients).fold(Matrix3::zeros(), |sum, (v, g)| sum + v * g.transpose())
}
