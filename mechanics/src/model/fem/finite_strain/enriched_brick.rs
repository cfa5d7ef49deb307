//! A hexahedron or wedge at rest at finite strain with functions on its edges, integrated at its points.

use nalgebra::Matrix3;

use super::bricks::{BrickAt, PointAtRest};
use super::edge_block::stiff_enough;
use crate::element::{MAX_NODES, ReferencePoint};
use crate::material::hyperelastic::point::{Corner, Point};
use crate::mesh::{CellShape, Vector};
use crate::model::fem::discretisation_error::{
    Corners, EdgeEquation, MAX_EDGES, OfEdges, at_point,
};
use crate::model::reference_cell;

pub(super) struct EnrichedBrick<'a> {
    pub shape: CellShape,
    pub brick: BrickAt<'a>,
    /// The shear modulus in kPa.
    pub mu: f64,
    /// The pressure in kPa that stands for that of its cell in r, where there is such.
    pub smooth: Option<f64>,
}

impl EnrichedBrick<'_> {
    fn points(&self) -> impl Iterator<Item = (&PointAtRest, &Point, &ReferencePoint)> {
        let reference = &reference_cell(self.shape).points;
        let pairs = self.brick.at_rest.iter().zip(self.brick.points).zip(reference);
        pairs.map(|((at_rest, point), reference)| (at_rest, point, reference))
    }

    /// The gradients at rest of the functions of the edges at a point.
    fn edges_at(&self, at_rest: &PointAtRest, reference: &ReferencePoint) -> [Vector; MAX_EDGES] {
        let mut gradients = [Vector::zeros(); MAX_NODES];
        gradients[..at_rest.gradients.len()].copy_from_slice(&at_rest.gradients);
        let corners = Corners { values: &reference.values, gradients: &gradients };
        at_point(self.shape, &corners).gradients
    }

    /// Writes r and D of each edge. What the mean of a wedge resists counts with the shear modulus, as in
    /// `discretisation_error::points`.
    pub fn equations(&self, equations: &mut OfEdges) {
        *equations = [EdgeEquation::ZERO; MAX_EDGES];
        let (mut means, mut shears) = ([Vector::zeros(); MAX_EDGES], [0.0; MAX_EDGES]);
        let more = self.smooth.map_or(0.0, |smooth| smooth - self.brick.pressure());
        for (at_rest, point, reference) in self.points() {
            let (gradients, stress) = (self.edges_at(at_rest, reference), point.stress());
            for (edge, equation) in equations[..self.edge_count()].iter_mut().enumerate() {
                let (g, volume) = (&gradients[edge], at_rest.volume);
                let own = point.corner(g);
                equation.residual -= stress * g * volume;
                equation.stiffness += point.block(&own, &own) * volume;
                let of_log_volume = own.of_log_volume(point.volume()) * volume;
                equation.residual -= of_log_volume * more;
                means[edge] += of_log_volume;
                shears[edge] += self.mu * volume * g.norm_squared();
            }
        }
        let of_mean = match self.shape {
            CellShape::Wedge6 => self.brick.of_mean.min(self.mu / self.brick.volume()),
            CellShape::Hex8 | CellShape::Tet4 => self.brick.of_mean,
        };
        for (edge, equation) in equations[..self.edge_count()].iter_mut().enumerate() {
            let block = equation.stiffness + means[edge] * means[edge].transpose() * of_mean;
            equation.stiffness = stiff_enough(block, shears[edge]);
        }
    }

    /// The forces on the corners of coefficients of the edges.
    pub fn forces(&self, of_edges: &[Vector; MAX_EDGES]) -> [Vector; MAX_NODES] {
        let mut forces = [Vector::zeros(); MAX_NODES];
        let (mut means, mut change) = ([Vector::zeros(); MAX_NODES], 0.0);
        for (at_rest, point, reference) in self.points() {
            let (gradients, volume) = (self.edges_at(at_rest, reference), at_rest.volume);
            // H = sum b (x) grad phi, row by row: e_k (x) (H^T e_k).
            let pairs = of_edges.iter().zip(&gradients);
            let along: Matrix3<f64> = pairs.map(|(b, g)| b * g.transpose()).sum();
            let rows: [Corner; 3] =
                std::array::from_fn(|k| point.corner(&along.row(k).transpose()));
            for (k, row) in rows.iter().enumerate() {
                change += row.of_log_volume(point.volume())[k] * volume;
            }
            for (a, g) in at_rest.gradients.iter().enumerate() {
                let corner = point.corner(g);
                means[a] += corner.of_log_volume(point.volume()) * volume;
                for (k, row) in rows.iter().enumerate() {
                    forces[a] += point.block(&corner, row).column(k) * volume;
                }
            }
        }
        let pressure = self.brick.of_mean * change;
        forces.iter_mut().zip(&means).for_each(|(force, mean)| *force += mean * pressure);
        forces
    }

    fn edge_count(&self) -> usize {
        self.shape.edges().len()
    }
}
