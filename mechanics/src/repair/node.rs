//! The best place of one node: a convex function of it, in a ball, or in a disc along a surface.

use nalgebra::Matrix3;

use super::bounds::Bounds;
use crate::mesh::Vector;

/// Newton steps for one node; it is visited again in the next sweep.
const STEPS: usize = 4;

/// Curvature that is added, so that a node stays where nothing pulls it, as a share of the largest.
const DAMPING: f64 = 1e-6;

/// A node, and the coefficients of the cells around it as affine functions of its place.
pub(super) struct Star {
    first: Vector,
    farthest: f64,
    /// Onto the directions in which it may go.
    projector: Matrix3<f64>,
    /// Value at the origin of space, and slope.
    functions: Vec<(f64, Vector)>,
}

impl Star {
    pub fn new(first: Vector, bounds: &Bounds, node: usize) -> Star {
        let normal = bounds.normals[node].unwrap_or_default();
        let projector = Matrix3::identity() - normal * normal.transpose();
        Star { first, farthest: bounds.farthest[node], projector, functions: Vec::new() }
    }

    /// A coefficient with its value and slope at a place.
    pub fn add(&mut self, value: f64, slope: Vector, place: &Vector) {
        // Relative to the first place, so that points far from the origin keep their digits.
        self.functions.push((value - slope.dot(&(place - self.first)), slope));
    }

    /// A place that is no worse than `place`.
    pub fn best(&self, place: Vector, margin: f64) -> Vector {
        let mut at = place - self.first;
        let mut energy = self.energy(&at, margin);
        for _ in 0..STEPS {
            if energy == 0.0 {
                break;
            }
            let Some(step) = self.newton(&at, margin) else { break };
            let Some((next, less)) = self.lower(&at, &step, energy, margin) else { break };
            (at, energy) = (next, less);
        }
        self.first + at
    }

    fn energy(&self, at: &Vector, margin: f64) -> f64 {
        self.missing(at, margin).map(|(missing, _)| missing * missing).sum()
    }

    /// What coefficients lack of the margin, and their slopes.
    fn missing<'a>(
        &'a self,
        at: &'a Vector,
        margin: f64,
    ) -> impl Iterator<Item = (f64, &'a Vector)> + 'a {
        let functions = self.functions.iter();
        let missing = functions.map(move |(value, slope)| (margin - value - slope.dot(at), slope));
        missing.filter(|(missing, _)| *missing > 0.0)
    }

    fn newton(&self, at: &Vector, margin: f64) -> Option<Vector> {
        let (mut gradient, mut curvature) = (Vector::zeros(), Matrix3::zeros());
        for (missing, slope) in self.missing(at, margin) {
            gradient += slope * missing;
            curvature += slope * slope.transpose();
        }
        let p = &self.projector;
        let held = Matrix3::identity() - p;
        let size = curvature.trace();
        let curvature = p * curvature * p + (held + Matrix3::identity() * DAMPING) * size;
        curvature.cholesky().map(|factor| factor.solve(&(p * gradient)))
    }

    /// The first of ever shorter steps, cut by the ball, that lowers the energy.
    fn lower(&self, at: &Vector, step: &Vector, energy: f64, margin: f64) -> Option<(Vector, f64)> {
        let mut length = 1.0;
        for _ in 0..8 {
            let mut next = at + step * length;
            if next.norm() > self.farthest {
                next *= self.farthest / next.norm();
            }
            let less = self.energy(&next, margin);
            if less < energy * (1.0 - 1e-9) {
                return Some((next, less));
            }
            length *= 0.5;
        }
        None
    }
}
