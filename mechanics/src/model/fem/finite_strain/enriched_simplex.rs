//! A tetrahedron at rest at finite strain with functions on its edges, in closed form.
//!
//! The integrals of `discretisation_error::simplex` with the tangent moduli at F, and h = F^-T g where a pressure acts.

use super::edge_block::stiff_enough;
use super::simplices::Simplex;
use crate::element::MAX_NODES;
use crate::element::tetrahedron10::EDGES;
use crate::material::hyperelastic::point::{Corner, Point};
use crate::mesh::Vector;
use crate::model::fem::discretisation_error::{AtCorners, EdgeEquation, MAX_EDGES};

/// The pressures of the corners in kPa, where it has any, and the shear modulus.
pub(super) struct CornerPressures {
    pub values: Option<[f64; 4]>,
    pub mu: f64,
}

pub(super) struct EnrichedSimplex<'a> {
    at_rest: &'a Simplex,
    point: &'a Point,
    corners: [Corner; 4],
    pressures: CornerPressures,
}

impl<'a> EnrichedSimplex<'a> {
    pub fn new(at_rest: &'a Simplex, point: &'a Point, pressures: CornerPressures) -> Self {
        let corners = at_rest.gradients.map(|g| point.corner(&g));
        EnrichedSimplex { at_rest, point, corners, pressures }
    }

    /// F^-T g of the corners.
    fn turned(&self) -> [Vector; 4] {
        let det_f = self.point.volume();
        self.corners.map(|corner| corner.of_log_volume(det_f))
    }

    /// Writes r and D of each edge.
    pub fn equations(&self, equations: &mut [EdgeEquation; MAX_EDGES]) {
        let (g, volume) = (&self.at_rest.gradients, self.at_rest.volume);
        // That of the mean of the pressures.
        let stress = self.point.stress() * volume;
        let own = self.corners.map(|corner| self.point.block(&corner, &corner) * 2.0);
        let (turned, weight) = (self.turned(), 0.8 * volume);
        for (equation, [i, j]) in equations.iter_mut().zip(EDGES) {
            equation.residual = -(stress * (g[i] + g[j]));
            if let Some(p) = &self.pressures.values {
                let mean = 0.25 * p.iter().sum::<f64>();
                let beside = turned[j] * (p[i] - mean) + turned[i] * (p[j] - mean);
                equation.residual -= beside * (volume / 5.0);
            }
            let both = self.point.block(&self.corners[i], &self.corners[j]);
            let block = own[i] + own[j] + both + both.transpose();
            let squares = 2.0 * (g[i].norm_squared() + g[j].norm_squared() + g[i].dot(&g[j]));
            let shear = self.pressures.mu * squares;
            equation.stiffness = stiff_enough(block * weight, shear * weight);
        }
    }

    /// The forces on the corners of coefficients of the edges, and the volumes of its pressures.
    pub fn at_corners(&self, of_edges: &[Vector; MAX_EDGES]) -> AtCorners {
        let mut sums = [Vector::zeros(); 4];
        for (b, [i, j]) in of_edges.iter().zip(EDGES) {
            sums[i] += b;
            sums[j] += b;
        }
        let mut forces = [Vector::zeros(); MAX_NODES];
        for (force, own) in forces.iter_mut().zip(&self.corners) {
            let pairs = self.corners.iter().zip(&sums);
            let all: Vector = pairs.map(|(c, sum)| self.point.block(own, c) * sum).sum();
            *force = all * self.at_rest.volume;
        }
        (forces, self.volumes(of_edges))
    }

    /// int L_k div b + (M - Mbar) p / mu of each corner, div along h; zero without pressures.
    fn volumes(&self, of_edges: &[Vector; MAX_EDGES]) -> [f64; 4] {
        let Some(p) = &self.pressures.values else { return [0.0; 4] };
        let (h, v) = (self.turned(), self.at_rest.volume);
        let all: f64 = p.iter().sum();
        let mut volumes =
            p.map(|own| (v / 20.0 * (all + own) - v / 16.0 * all) / self.pressures.mu);
        for (b, [i, j]) in of_edges.iter().zip(EDGES) {
            let (along_i, along_j) = (b.dot(&h[i]) * v / 5.0, b.dot(&h[j]) * v / 5.0);
            volumes.iter_mut().for_each(|volume| *volume += along_i + along_j);
            volumes[i] += along_j;
            volumes[j] += along_i;
        }
        volumes
    }
}
