//! A cell of several quadrature points with functions on its edges: hexahedra and wedges.
//!
//! With mean dilatation the volume change of the edge functions is taken as its mean over the cell too, as that of the corners
//! is (`cell_stiffness`), and the stress of it is that of `mean_stress`.
//!
//! What the cell by itself does better, its inner modes, comes first: edges see the stress that these leave.

use nalgebra::Matrix3;

use super::edge_equations::EdgeEquation;
use super::edge_functions::{Corners, MAX_EDGES, at_point};
use super::inner_modes::{MAX_MODES, ModeEquations, mode_gradients, moment_weights};
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
    modes: [Vector; MAX_MODES],
    volume: f64,
}

/// Places at which gradients are taken, with the stiffness that counts there.
pub(super) struct EnrichedCell {
    shape: CellShape,
    points: Vec<(Gradients, ElasticTensor)>,
    /// Moments of volume that the mean does not hold; they count for the modes alone.
    moments: Vec<(Gradients, ElasticTensor)>,
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
        let (points, positions) =
            gradients_at_points(shape, &corners).ok_or(InvertedCell { cell })?;
        let mut moments = Vec::new();
        let mut mean = None;
        if let Some(of_volume) = of_mean {
            let volumes: Vec<f64> = points.iter().map(|point| point.volume).collect();
            let weights = moment_weights(&positions, &volumes);
            let moment = |k: usize| {
                let weighted = points.iter().zip(&weights).map(|(point, y)| (point, y[k]));
                (Gradients::sum(weighted, 1.0), of_volume)
            };
            moments = (0..3).map(moment).collect();
            mean = Some((Gradients::mean(&points), of_volume));
        }
        let points = points.into_iter().map(|point| (point, at_points)).chain(mean).collect();
        Ok(EnrichedCell { shape, points, moments })
    }

    /// The equations of the inner modes where the corners are displaced.
    fn mode_equations(&self, displacement: &[Vector]) -> ModeEquations {
        let mut equations = ModeEquations::new(self.shape);
        for (place, tensor) in self.points.iter().chain(&self.moments) {
            let stress = tensor.stress(&gradient_of(displacement, &place.corners)) * place.volume;
            for mode in equations.modes() {
                equations.add_force(mode, &(-(stress * place.modes[mode])));
            }
            for (a, b) in equations.pairs() {
                let mut block: Block = [[0.0; 3]; 3];
                tensor.add_pair(&mut block, [&place.modes[a], &place.modes[b]], place.volume);
                equations.add_block((a, b), &Matrix3::from_fn(|i, j| block[i][j]));
            }
        }
        equations
    }

    /// The coefficients of the inner modes where the corners are displaced.
    fn modes(&self, displacement: &[Vector]) -> [Vector; MAX_MODES] {
        self.mode_equations(displacement).solve(&[0.0; MAX_MODES])
    }

    /// v . (K_i - K) v of displaced corners, in mN mm: what moments resist, less what modes give way.
    pub fn stiffening(&self, displacement: &[Vector]) -> f64 {
        let moment = |(place, tensor): &(Gradients, ElasticTensor)| {
            let gradient = gradient_of(displacement, &place.corners);
            tensor.stress(&gradient).dot(&gradient) * place.volume
        };
        let equations = self.mode_equations(displacement);
        let modes = equations.solve(&[0.0; MAX_MODES]);
        self.moments.iter().map(moment).sum::<f64>() - equations.work(&modes)
    }

    /// r and D of each edge where the corners are displaced; `mean_stress` is that of the mean volume change.
    pub fn equations(
        &self,
        displacement: &[Vector],
        mean_stress: &Option<Matrix3<f64>>,
    ) -> [EdgeEquation; MAX_EDGES] {
        let mut equations = [EdgeEquation::ZERO; MAX_EDGES];
        let share = self.share_of_mean();
        let modes = self.modes(displacement);
        for (place, (point, tensor)) in self.points.iter().enumerate() {
            let stress = match mean_stress {
                Some(smooth) if place == self.pointwise() => *smooth,
                _ => {
                    let of_corners = gradient_of(displacement, &point.corners);
                    tensor.stress(&(of_corners + gradient_of(&modes, &point.modes)))
                }
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

    /// The forces on the corners of coefficients of the edges, and of the modes and moments that displaced corners ask for.
    pub fn forces(
        &self,
        displacement: &[Vector],
        of_edges: &[Vector; MAX_EDGES],
    ) -> [Vector; MAX_NODES] {
        let mut forces = [Vector::zeros(); MAX_NODES];
        let modes = self.modes(displacement);
        let of_edges = &of_edges[..self.shape.edges().len()];
        let mut add = |(place, tensor): &(Gradients, ElasticTensor), gradient: Matrix3<f64>| {
            let gradient = gradient + gradient_of(&modes, &place.modes);
            let stress = tensor.stress(&gradient) * place.volume;
            for (force, slope) in forces.iter_mut().zip(&place.corners) {
                *force += stress * slope;
            }
        };
        for place in &self.points {
            add(place, gradient_of(of_edges, &place.0.edges));
        }
        for place in &self.moments {
            add(place, gradient_of(displacement, &place.0.corners));
        }
        forces
    }

    fn edges(&self) -> std::ops::Range<usize> {
        0..self.shape.edges().len()
    }
}

/// Gradients at the points of a cell and their positions; `None` where it is inverted.
fn gradients_at_points(
    shape: CellShape,
    corners: &[Vector],
) -> Option<(Vec<Gradients>, Vec<Vector>)> {
    let reference = &reference_cell(shape).points;
    let mut points = Vec::with_capacity(reference.len());
    for point in reference {
        let physical = point.at(corners)?;
        let (values, gradients) = (&point.values, &physical.gradients);
        let edges = at_point(shape, &Corners { values, gradients }).gradients;
        let (corners, volume) = (physical.gradients, physical.volume);
        points.push(Gradients { corners, edges, modes: [Vector::zeros(); MAX_MODES], volume });
    }
    let edges: Vec<_> = points.iter().map(|point| point.edges).collect();
    let volumes: Vec<f64> = points.iter().map(|point| point.volume).collect();
    for (point, modes) in points.iter_mut().zip(mode_gradients(shape, &edges, &volumes)) {
        point.modes = modes;
    }
    Some((points, reference.iter().map(|point| point.position(corners)).collect()))
}

impl Gradients {
    /// Their weighted sum over points, which counts with `volume`.
    fn sum<'a>(points: impl Iterator<Item = (&'a Gradients, f64)>, volume: f64) -> Self {
        let (corners, edges) = ([Vector::zeros(); MAX_NODES], [Vector::zeros(); MAX_EDGES]);
        let mut all = Gradients { corners, edges, modes: [Vector::zeros(); MAX_MODES], volume };
        for (point, weight) in points {
            let own = point.corners.iter().chain(&point.edges).chain(&point.modes);
            let sums = all.corners.iter_mut().chain(&mut all.edges).chain(&mut all.modes);
            sums.zip(own).for_each(|(sum, gradient)| *sum += gradient * weight);
        }
        all
    }

    fn mean(points: &[Gradients]) -> Self {
        let volume: f64 = points.iter().map(|point| point.volume).sum();
        Self::sum(points.iter().map(|point| (point, point.volume / volume)), volume)
    }
}

/// grad v of v = sum_a v_a N_a.
pub(in crate::model::fem) fn gradient_of(values: &[Vector], gradients: &[Vector]) -> Matrix3<f64> {
    values.iter().zip(gradients).fold(Matrix3::zeros(), |sum, (v, g)| sum + v * g.transpose())
}
