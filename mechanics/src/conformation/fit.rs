//! The displacement field of least pull and bending on a lattice.
//!
//! E(u) = Σ (x_i + u(x_i) - y_i)ᵀ S_i (x_i + u(x_i) - y_i) + λ ∫ |∂²u|², the integral by second differences of the
//! control points, 1/h Σ |Δ²c|²; solved by conjugate gradients with the diagonal blocks as preconditioner.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::lattice::{Difference, Field, Lattice, Support};
use super::pull::Pull;
use crate::mesh::Vector;

/// Share of the first residual that is small enough: targets move on with the next matches anyway.
const TOLERANCE: f64 = 1e-3;
const MOST_ITERATIONS: usize = 150;

struct SpringToTarget {
    support: Support,
    stiffness: Matrix3<f64>,
    to: Vector,
}

/// The quadratic form of pulls and bending on a lattice.
pub(super) struct Energy<'a> {
    lattice: &'a Lattice,
    held: Vec<SpringToTarget>,
    differences: Vec<Difference>,
    /// λ / h.
    bending: f64,
}

impl<'a> Energy<'a> {
    pub fn new(lattice: &'a Lattice, pulls: &[Pull], bending: f64) -> Self {
        let held = pulls.par_iter().map(|pull| SpringToTarget {
            support: lattice.support(&pull.at),
            stiffness: pull.stiffness(),
            to: pull.to - pull.at,
        });
        let (held, differences) = (held.collect(), lattice.differences());
        Energy { lattice, held, differences, bending: bending / lattice.spacing }
    }

    /// The field of least energy, from one that is near.
    pub fn minimised(&self, start: Vec<Vector>) -> Vec<Vector> {
        let mut x = start;
        let mut r = self.residual(&x);
        let blocks = self.inverse_blocks();
        let scaled = |r: &[Vector]| -> Vec<Vector> {
            r.iter().zip(&blocks).map(|(r, block)| block * r).collect()
        };
        let mut z = scaled(&r);
        let mut p = z.clone();
        let mut rho = dot(&r, &z);
        let enough = TOLERANCE * TOLERANCE * dot(&self.forces(), &scaled(&self.forces()));
        for _ in 0..MOST_ITERATIONS {
            if rho <= enough {
                break;
            }
            let product = self.multiplied(&p);
            let step = rho / dot(&p, &product);
            axpy(&mut x, &p, step);
            axpy(&mut r, &product, -step);
            z = scaled(&r);
            let next = dot(&r, &z);
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + *p * (next / rho));
            rho = next;
        }
        x
    }

    fn forces(&self) -> Vec<Vector> {
        let mut forces = vec![Vector::zeros(); self.lattice.len()];
        for held in &self.held {
            let force = held.stiffness * held.to;
            self.lattice.each(&held.support, |control, weight| forces[control] += force * weight);
        }
        forces
    }

    fn residual(&self, x: &[Vector]) -> Vec<Vector> {
        let product = self.multiplied(x);
        self.forces().iter().zip(&product).map(|(f, p)| f - p).collect()
    }

    fn multiplied(&self, x: &[Vector]) -> Vec<Vector> {
        let mut product = vec![Vector::zeros(); x.len()];
        let forces: Vec<Vector> = self
            .held
            .par_iter()
            .with_min_len(512)
            .map(|held| {
                let mut sum = Vector::zeros();
                self.lattice.each(&held.support, |control, weight| sum += x[control] * weight);
                held.stiffness * sum
            })
            .collect();
        for (held, force) in self.held.iter().zip(&forces) {
            self.lattice.each(&held.support, |control, weight| product[control] += force * weight);
        }
        for difference in &self.differences {
            let controls = difference.controls.map(|control| control as usize);
            let parts = controls.iter().zip(difference.weights);
            let value: Vector = parts.map(|(&control, weight)| x[control] * weight).sum();
            let force = value * (self.bending * difference.count);
            for (control, weight) in controls.into_iter().zip(difference.weights) {
                product[control] += force * weight;
            }
        }
        product
    }

    fn inverse_blocks(&self) -> Vec<Matrix3<f64>> {
        let mut blocks = vec![Matrix3::zeros(); self.lattice.len()];
        for held in &self.held {
            self.lattice.each(&held.support, |control, weight| {
                blocks[control] += held.stiffness * (weight * weight);
            });
        }
        for difference in &self.differences {
            for (&control, weight) in difference.controls.iter().zip(difference.weights) {
                let square = self.bending * difference.count * weight * weight;
                blocks[control as usize] += Matrix3::identity() * square;
            }
        }
        blocks.iter().map(|block| block.try_inverse().unwrap_or_else(Matrix3::identity)).collect()
    }
}

fn dot(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn axpy(x: &mut [Vector], p: &[Vector], step: f64) {
    x.iter_mut().zip(p).for_each(|(x, p)| *x += p * step);
}

impl Field {
    /// The field on the same lattice of least pull and bending.
    pub(super) fn fitted(&self, pulls: &[Pull], bending: f64) -> Field {
        let controls = Energy::new(&self.lattice, pulls, bending).minimised(self.controls.clone());
        Field { lattice: self.lattice.clone(), controls }
    }
}
