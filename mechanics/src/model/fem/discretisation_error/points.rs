//! A cell of several quadrature points with functions on its edges: hexahedra and wedges.
//!
//! With mean dilatation the volume change of the edge functions is taken as its mean over the cell too, as that of the corners
//! is (`cell_stiffness`), and the stress of it is that of `mean_stress`.
//!
//! What the cell by itself does better, its inner modes, comes first: edges see the stress that these leave. Edges of hexahedra resist the
//! moments of volume as modes do: without them bending of nearly incompressible cells would be estimated with the wrong sign. Those of
//! wedges do not: nine of them stand against moments that four modes leave in half of a hexahedron, and would do next to nothing.
//!
//! Gradients stand on the reference cell, where they are the same for all cells of a shape; a field and a stress are brought
//! there and back by one matrix at each point.

use nalgebra::Matrix3;

use super::edge_equations::EdgeEquation;
use super::edge_functions::{AtPoint, MAX_EDGES, reference_edges};
use super::inner_modes::{
    MAX_MODES, ModeEquations, Modes, mode_gradients, moment_weights, sums_of_edges,
};
use super::two_level::Coefficients;
use crate::element::{MAX_NODES, ReferencePoint};
use crate::material::ElasticTensor;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::fem::cell_stiffness::Dilatation;
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// A quadrature point of a cell.
struct Point {
    corners: &'static ReferencePoint,
    edges: &'static AtPoint,
    /// J^-T: a gradient on the reference cell times this is that in 1/mm.
    to_cell: Matrix3<f64>,
    /// That it stands for, in mm³.
    volume: f64,
    /// The gradients of the inner modes in 1/mm.
    modes: Modes,
    /// y_k dV of the three moments of volume (`inner_modes`); zero without mean dilatation.
    moments: [f64; 3],
}

impl Point {
    /// The gradient of a displacement of the corners.
    fn of_corners(&self, displacement: &[Vector]) -> Matrix3<f64> {
        gradient_of(displacement, &self.corners.gradients) * self.to_cell.transpose()
    }

    /// The same of coefficients of the edges.
    fn of_edges(&self, coefficients: &[Vector]) -> Matrix3<f64> {
        gradient_of(coefficients, &self.edges.gradients) * self.to_cell.transpose()
    }

    /// The stress of moments of volume at it, times its volume.
    fn linear(&self, of_moments: &[Matrix3<f64>; 3]) -> Matrix3<f64> {
        of_moments.iter().zip(self.moments).map(|(moment, y)| moment * y).sum()
    }
}

/// A cell with functions on its edges.
pub(super) struct EnrichedCell {
    shape: CellShape,
    /// Of the points.
    tensor: ElasticTensor,
    /// With mean dilatation, of the change of volume: its mean and its moments.
    of_volume: Option<ElasticTensor>,
    points: Vec<Point>,
    /// In mm³.
    volume: f64,
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
        let mut points = points(shape, corners).ok_or(InvertedCell { cell })?;
        let volume = points.iter().map(|point| point.volume).sum();
        let (tensor, of_volume) = match dilatation {
            Dilatation::Pointwise => (*tensor, None),
            Dilatation::Mean => {
                let position = |point: &Point| point.corners.position(corners);
                let positions: Vec<Vector> = points.iter().map(position).collect();
                let volumes: Vec<f64> = points.iter().map(|point| point.volume).collect();
                let weights = moment_weights(&positions, &volumes);
                points.iter_mut().zip(weights).for_each(|(point, own)| point.moments = own);
                let (of_shape, of_volume) = tensor.split_volume();
                (of_shape, Some(of_volume))
            }
        };
        Ok(EnrichedCell { shape, tensor, of_volume, points, volume })
    }

    /// A field of gradients at the points.
    fn field(&self, at: impl Fn(&Point) -> Matrix3<f64>) -> Vec<Matrix3<f64>> {
        self.points.iter().map(at).collect()
    }

    /// The mean of a field over the cell.
    fn mean(&self, field: &[Matrix3<f64>]) -> Matrix3<f64> {
        let pairs = self.points.iter().zip(field);
        pairs.map(|(point, own)| own * (point.volume / self.volume)).sum()
    }

    /// The three moments of a field.
    fn moments(&self, field: &[Matrix3<f64>]) -> [Matrix3<f64>; 3] {
        let pairs = || self.points.iter().zip(field);
        std::array::from_fn(|k| pairs().map(|(point, own)| own * point.moments[k]).sum())
    }

    /// The equations of the inner modes at a field of the corners and its moments. Modes have no mean.
    fn mode_equations(&self, field: &[Matrix3<f64>], moments: &[Matrix3<f64>; 3]) -> ModeEquations {
        let mut equations = ModeEquations::new(self.shape);
        let of_moments = self.stress_of_moments(moments);
        for (point, own) in self.points.iter().zip(field) {
            let stress = self.tensor.stress(own) * point.volume + point.linear(&of_moments);
            for mode in equations.modes() {
                equations.add_force(mode, &-(stress * point.modes[mode]));
            }
        }
        let of_modes: [[Vector; 3]; MAX_MODES] = std::array::from_fn(|mode| {
            let of_point = |point: &Point, k: usize| point.modes[mode] * point.moments[k];
            std::array::from_fn(|k| self.points.iter().map(|point| of_point(point, k)).sum())
        });
        for (a, b) in equations.pairs() {
            let of_points = self.products(|point| [point.modes[a], point.modes[b]]);
            let mut block = self.tensor.block(&of_points);
            if let Some(tensor) = &self.of_volume {
                let pairs = of_modes[a].iter().zip(&of_modes[b]);
                let products: Matrix3<f64> = pairs.map(|(g, h)| g * h.transpose()).sum();
                block += tensor.block(&products);
            }
            equations.add_block((a, b), &block);
        }
        equations
    }

    /// The coefficients of the inner modes where the corners are displaced.
    pub fn modes(&self, displacement: &[Vector]) -> Modes {
        let field = self.field(|point| point.of_corners(displacement));
        self.mode_equations(&field, &self.moments(&field)).solve()
    }

    /// v . (K_i - K) v of displaced corners, in mN mm: what moments resist, less what modes give way.
    pub fn stiffening(&self, displacement: &[Vector]) -> f64 {
        let field = self.field(|point| point.of_corners(displacement));
        let moments = self.moments(&field);
        let equations = self.mode_equations(&field, &moments);
        let modes = equations.solve();
        let resisted = self.of_volume.as_ref().map_or(0.0, |tensor| {
            moments.iter().map(|moment| tensor.stress(moment).dot(moment)).sum()
        });
        resisted - equations.work(&modes)
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
        let field =
            self.field(|point| point.of_corners(displacement) + gradient_of(modes, &point.modes));
        let of_mean = self.of_volume.as_ref().map_or(Matrix3::zeros(), |tensor| {
            mean_stress.unwrap_or_else(|| tensor.stress(&self.mean(&field)))
        });
        let moments = match self.edges_resist_moments() {
            true => self.moments(&field),
            false => [Matrix3::zeros(); 3],
        };
        let of_moments = self.stress_of_moments(&moments);
        for (point, own) in self.points.iter().zip(&field) {
            let even = (self.tensor.stress(own) + of_mean) * point.volume;
            let stress = (even + point.linear(&of_moments)) * point.to_cell;
            let pairs = equations[..self.edge_count()].iter_mut().zip(&point.edges.gradients);
            pairs.for_each(|(equation, gradient)| equation.residual -= stress * gradient);
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
        match (self.shape, &self.of_volume) {
            (CellShape::Wedge6, Some(all)) => (self.tensor.mu / all.lambda).min(1.0),
            (CellShape::Tet4 | CellShape::Hex8 | CellShape::Wedge6, _) => 1.0,
        }
    }

    fn block(&self, edge: usize, other: usize, share_of_mean: f64) -> Matrix3<f64> {
        let of_edge = |point: &Point, edge: usize| point.to_cell * point.edges.gradients[edge];
        let of_points = self.products(|point| [of_edge(point, edge), of_edge(point, other)]);
        let block = self.tensor.block(&of_points);
        let Some(tensor) = &self.of_volume else { return block };
        let mean = |edge: usize| {
            let of_point = |point: &Point| of_edge(point, edge) * point.volume;
            self.points.iter().map(of_point).sum::<Vector>()
        };
        let of_mean = mean(edge) * (mean(other) / self.volume).transpose();
        let block = block + tensor.block(&of_mean) * share_of_mean;
        if !self.edges_resist_moments() {
            return block;
        }
        let moment = |edge: usize, k: usize| {
            let of_point = |point: &Point| of_edge(point, edge) * point.moments[k];
            self.points.iter().map(of_point).sum::<Vector>()
        };
        let of_moments: Matrix3<f64> =
            (0..3).map(|k| moment(edge, k) * moment(other, k).transpose()).sum();
        block + tensor.block(&of_moments)
    }

    /// Whether the moments of volume count for edges.
    fn edges_resist_moments(&self) -> bool {
        self.shape == CellShape::Hex8 && self.of_volume.is_some()
    }

    /// What the moments of a field of gradients make, in kPa; zero without mean dilatation.
    fn stress_of_moments(&self, moments: &[Matrix3<f64>; 3]) -> [Matrix3<f64>; 3] {
        let of_volume = self.of_volume.as_ref();
        of_volume.map_or([Matrix3::zeros(); 3], |own| moments.map(|moment| own.stress(&moment)))
    }

    /// The forces on the corners of coefficients of the edges, and of the modes and moments that displaced corners ask for.
    pub fn forces(&self, displacement: &[Vector], of: &Coefficients) -> [Vector; MAX_NODES] {
        let Coefficients { edges, modes } = of;
        let field = self.field(|point| point.of_edges(edges) + gradient_of(modes, &point.modes));
        let (mut of_mean, mut of_moments) = (Matrix3::zeros(), [Matrix3::zeros(); 3]);
        if let Some(tensor) = &self.of_volume {
            of_mean = tensor.stress(&self.mean(&field));
            let edges = if self.edges_resist_moments() { edges.as_slice() } else { &[] };
            let moved = self.field(|point| {
                let inner = point.of_corners(displacement) + gradient_of(modes, &point.modes);
                inner + point.of_edges(edges)
            });
            of_moments = self.stress_of_moments(&self.moments(&moved));
        }
        let mut forces = [Vector::zeros(); MAX_NODES];
        for (point, own) in self.points.iter().zip(&field) {
            let even = (self.tensor.stress(own) + of_mean) * point.volume;
            let stress = (even + point.linear(&of_moments)) * point.to_cell;
            let pairs = forces.iter_mut().zip(&point.corners.gradients);
            pairs.for_each(|(force, gradient)| *force += stress * gradient);
        }
        forces
    }

    /// sum g_a g_b^T dV over the points of two gradients of each.
    fn products(&self, pair: impl Fn(&Point) -> [Vector; 2]) -> Matrix3<f64> {
        self.points.iter().fold(Matrix3::zeros(), |sum, point| {
            let [a, b] = pair(point);
            sum + a * (b * point.volume).transpose()
        })
    }

    fn edge_count(&self) -> usize {
        self.shape.edges().len()
    }
}

/// The points of a cell; `None` where it is inverted.
fn points(shape: CellShape, corners: &[Vector]) -> Option<Vec<Point>> {
    let at_points = reference_cell(shape).points.iter().zip(reference_edges(shape));
    let mut points = Vec::with_capacity(8);
    for (of_corners, edges) in at_points {
        let (to_cell, volume) = of_corners.to_cell(corners)?;
        let modes = sums_of_edges(shape, &edges.gradients).map(|mode| to_cell * mode);
        let moments = [0.0; 3];
        points.push(Point { corners: of_corners, edges, to_cell, volume, modes, moments });
    }
    let modes = mode_gradients(points.iter().map(|point| (point.modes, point.volume)));
    points.iter_mut().zip(modes).for_each(|(point, modes)| point.modes = modes);
    Some(points)
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
