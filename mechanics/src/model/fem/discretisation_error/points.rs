//! A cell of several quadrature points with functions on its edges: hexahedra and wedges.
//!
//! With mean dilatation the volume change of the edge functions is taken as its mean over the cell too, as that of the corners
//! is (`cell_stiffness`), and the stress of it is that of `mean_stress`.
//!
//! What the cell by itself does better, its inner modes, comes first: edges see the stress that these leave.

use nalgebra::Matrix3;

use super::edge_equations::EdgeEquation;
use super::edge_functions::{Corners, MAX_EDGES, at_point};
use super::inner_modes::{
    MAX_MODES, ModeEquations, Modes, NO_MODES, mode_gradients, moment_weights,
};
use super::two_level::Coefficients;
use crate::element::MAX_NODES;
use crate::material::ElasticTensor;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

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
    /// Of the points.
    tensor: ElasticTensor,
    points: Vec<Gradients>,
    /// With mean dilatation.
    of_volume: Option<Box<VolumeChange>>,
}

/// What the change of volume of a cell resists.
struct VolumeChange {
    tensor: ElasticTensor,
    mean: Gradients,
    /// Moments of volume that the mean does not hold; they count for the modes alone and leave edges out.
    moments: [Gradients; 3],
}

impl VolumeChange {
    fn new(tensor: ElasticTensor, points: &[Gradients], positions: &[Vector]) -> Self {
        let volumes: Vec<f64> = points.iter().map(|point| point.volume).collect();
        let weights = moment_weights(positions, &volumes);
        let volume: f64 = volumes.iter().sum();
        let mut mean = Gradients::ZERO;
        for point in points {
            mean.add(point, point.volume / volume);
            let edges = mean.edges.iter_mut().zip(&point.edges);
            edges.for_each(|(sum, gradient)| *sum += gradient * (point.volume / volume));
        }
        mean.volume = volume;
        let moments = std::array::from_fn(|k| {
            let mut moment = Gradients::ZERO;
            points.iter().zip(&weights).for_each(|(point, y)| moment.add(point, y[k]));
            moment.volume = 1.0;
            moment
        });
        VolumeChange { tensor, mean, moments }
    }
}

impl EnrichedCell {
    pub fn new(
        mesh: &VolumeMesh,
        cell: usize,
        tensor: &ElasticTensor,
        dilatation: Dilatation,
    ) -> Result<Self, InvertedCell> {
        let shape = mesh.cells.shape(cell);
        let corners = &of_corners(mesh, cell, &mesh.nodes);
        let points = gradients_at_points(shape, corners).ok_or(InvertedCell { cell })?;
        let (tensor, of_volume) = match dilatation {
            Dilatation::Pointwise => (*tensor, None),
            Dilatation::Mean => {
                let (of_shape, of_volume) = tensor.split_volume();
                let reference = reference_cell(shape).points.iter();
                let positions: Vec<Vector> = reference.map(|p| p.position(corners)).collect();
                (of_shape, Some(Box::new(VolumeChange::new(of_volume, &points, &positions))))
            }
        };
        Ok(EnrichedCell { shape, tensor, points, of_volume })
    }

    /// The points and the mean.
    fn places(&self) -> impl Iterator<Item = (&Gradients, &ElasticTensor)> {
        let mean = self.of_volume.as_deref().into_iter().map(|all| (&all.mean, &all.tensor));
        self.points.iter().map(|point| (point, &self.tensor)).chain(mean)
    }

    fn moments(&self) -> impl Iterator<Item = (&Gradients, &ElasticTensor)> {
        self.of_volume.as_deref().into_iter().flat_map(
            |VolumeChange { tensor, moments, .. }| {
                moments.iter().map(move |moment| (moment, tensor))
            },
        )
    }

    /// The equations of the inner modes where the corners are displaced. Modes have no mean.
    fn mode_equations(&self, displacement: &[Vector]) -> ModeEquations {
        let mut equations = ModeEquations::new(self.shape);
        for (place, tensor) in self.points.iter().map(|p| (p, &self.tensor)).chain(self.moments()) {
            let stress = tensor.stress(&gradient_of(displacement, &place.corners)) * place.volume;
            for mode in equations.modes() {
                equations.add_force(mode, &(-(stress * place.modes[mode])));
            }
        }
        for (a, b) in equations.pairs() {
            let of_points = products(&self.points, |point| [point.modes[a], point.modes[b]]);
            let mut block = self.tensor.block(&of_points);
            if let Some(VolumeChange { tensor, moments, .. }) = self.of_volume.as_deref() {
                let of_moments = products(moments, |moment| [moment.modes[a], moment.modes[b]]);
                block += tensor.block(&of_moments);
            }
            equations.add_block((a, b), &block);
        }
        equations
    }

    /// The coefficients of the inner modes where the corners are displaced.
    pub fn modes(&self, displacement: &[Vector]) -> Modes {
        self.mode_equations(displacement).solve()
    }

    /// v . (K_i - K) v of displaced corners, in mN mm: what moments resist, less what modes give way.
    pub fn stiffening(&self, displacement: &[Vector]) -> f64 {
        let moment = |(place, tensor): (&Gradients, &ElasticTensor)| {
            let gradient = gradient_of(displacement, &place.corners);
            tensor.stress(&gradient).dot(&gradient) * place.volume
        };
        let equations = self.mode_equations(displacement);
        let modes = equations.solve();
        self.moments().map(moment).sum::<f64>() - equations.work(&modes)
    }

    /// r and D of each edge where the corners are displaced and the inner modes follow; `mean_stress` is that of the mean volume
    /// change.
    pub fn equations(
        &self,
        displacement: &[Vector],
        modes: &Modes,
        mean_stress: &Option<Matrix3<f64>>,
    ) -> [EdgeEquation; MAX_EDGES] {
        let mut equations = [EdgeEquation::ZERO; MAX_EDGES];
        for (place, (point, tensor)) in self.places().enumerate() {
            let stress = match mean_stress {
                Some(smooth) if place == self.points.len() => *smooth,
                _ => {
                    let of_corners = gradient_of(displacement, &point.corners);
                    tensor.stress(&(of_corners + gradient_of(modes, &point.modes)))
                }
            } * point.volume;
            for (equation, gradient) in equations[..self.edge_count()].iter_mut().zip(&point.edges)
            {
                equation.residual -= stress * gradient;
            }
        }
        let share = self.share_of_mean();
        for (number, equation) in equations[..self.edge_count()].iter_mut().enumerate() {
            equation.stiffness = self.block(number, number, share);
        }
        equations
    }

    /// The block of two edges.
    #[cfg(test)]
    pub fn stiffness(&self, edge: usize, other: usize) -> Matrix3<f64> {
        self.block(edge, other, 1.0)
    }

    /// The share of the mean that counts in D. The one volume change of a wedge stands against nine edges and would let each
    /// of them do a third of what they do together; without it they overshoot the more the larger lambda is. It counts with
    /// the shear modulus in place of lambda.
    fn share_of_mean(&self) -> f64 {
        match (self.shape, self.of_volume.as_deref()) {
            (CellShape::Wedge6, Some(all)) => (self.tensor.mu / all.tensor.lambda).min(1.0),
            (CellShape::Tet4 | CellShape::Hex8 | CellShape::Wedge6, _) => 1.0,
        }
    }

    fn block(&self, edge: usize, other: usize, share_of_mean: f64) -> Matrix3<f64> {
        let of_edges = |place: &Gradients| [place.edges[edge], place.edges[other]];
        let block = self.tensor.block(&products(&self.points, of_edges));
        let of_mean = self.of_volume.as_deref().map(|VolumeChange { tensor, mean, .. }| {
            tensor.block(&products(std::slice::from_ref(mean), of_edges)) * share_of_mean
        });
        block + of_mean.unwrap_or_default()
    }

    /// The forces on the corners of coefficients of the edges, and of the modes and moments that displaced corners ask for.
    pub fn forces(&self, displacement: &[Vector], of: &Coefficients) -> [Vector; MAX_NODES] {
        let mut forces = [Vector::zeros(); MAX_NODES];
        let Coefficients { edges, modes } = of;
        let mut add = |(place, tensor): (&Gradients, &ElasticTensor), gradient: Matrix3<f64>| {
            let gradient = gradient + gradient_of(modes, &place.modes);
            let stress = tensor.stress(&gradient) * place.volume;
            for (force, slope) in forces.iter_mut().zip(&place.corners) {
                *force += stress * slope;
            }
        };
        self.places().for_each(|place| add(place, gradient_of(edges, &place.0.edges)));
        self.moments().for_each(|place| add(place, gradient_of(displacement, &place.0.corners)));
        forces
    }

    fn edge_count(&self) -> usize {
        self.shape.edges().len()
    }
}

/// Gradients at the points of a cell; `None` where it is inverted.
fn gradients_at_points(shape: CellShape, corners: &[Vector]) -> Option<Vec<Gradients>> {
    let reference = &reference_cell(shape).points;
    let mut points = Vec::with_capacity(reference.len());
    for point in reference {
        let physical = point.at(corners)?;
        let (values, gradients) = (&point.values, &physical.gradients);
        let edges = at_point(shape, &Corners { values, gradients }).gradients;
        let (corners, volume) = (physical.gradients, physical.volume);
        points.push(Gradients { corners, edges, modes: NO_MODES, volume });
    }
    let modes = mode_gradients(shape, points.iter().map(|point| (&point.edges, point.volume)));
    points.iter_mut().zip(modes).for_each(|(point, modes)| point.modes = modes);
    Some(points)
}

/// sum g_a g_b^T dV over points of the two gradients of each.
fn products(points: &[Gradients], pair: impl Fn(&Gradients) -> [Vector; 2]) -> Matrix3<f64> {
    points.iter().fold(Matrix3::zeros(), |sum, point| {
        let [a, b] = pair(point);
        sum + a * (b * point.volume).transpose()
    })
}

impl Gradients {
    const ZERO: Gradients = Gradients {
        corners: [Vector::new(0.0, 0.0, 0.0); MAX_NODES],
        edges: [Vector::new(0.0, 0.0, 0.0); MAX_EDGES],
        modes: NO_MODES,
        volume: 0.0,
    };

    /// Adds those of corners and modes at a point.
    fn add(&mut self, point: &Gradients, weight: f64) {
        let own = point.corners.iter().chain(&point.modes);
        let sums = self.corners.iter_mut().chain(&mut self.modes);
        sums.zip(own).for_each(|(sum, gradient)| *sum += gradient * weight);
    }
}

/// The values of the corners of a cell; zero beyond its last.
pub(in crate::model::fem) fn of_corners(
    mesh: &VolumeMesh,
    cell: usize,
    of_nodes: &[Vector],
) -> [Vector; MAX_NODES] {
    let mut own = [Vector::zeros(); MAX_NODES];
    for (own, &node) in own.iter_mut().zip(mesh.cells.nodes(cell)) {
        *own = of_nodes[node as usize];
    }
    own
}

/// grad v of v = sum_a v_a N_a.
pub(in crate::model::fem) fn gradient_of(values: &[Vector], gradients: &[Vector]) -> Matrix3<f64> {
    values.iter().zip(gradients).fold(Matrix3::zeros(), |sum, (v, g)| sum + v * g.transpose())
}
