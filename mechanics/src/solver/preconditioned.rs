//! A system of displacements, or of displacements and pressures, with the preconditioner that its own iteration has: one
//! multigrid cycle, under pressures the block triangular one of `mixed`.
//!
//! Residuals and products of pressures carry the weights W of `mixed`, which make forces of volumes.

use super::System;
use super::lanes::{Lanes, MOST_LANES};
use super::mixed_system::Coupling;
use super::multigrid::Multigrid;

/// Of the pressure Schur complement, S = D / 3 as in `mixed`.
const SCHUR: f64 = 3.0;

/// The left side of an equation: coefficients of unknowns, three for each free row and then the pressures.
pub type Equation = Vec<(u32, f64)>;

/// A matrix and what approximates its inverse.
pub struct Preconditioned<'a> {
    system: &'a System,
    multigrid: &'a Multigrid,
    /// With W.
    pressures: Option<(&'a Coupling, Vec<f64>)>,
}

impl<'a> Preconditioned<'a> {
    pub fn new(
        system: &'a System,
        coupling: Option<&'a Coupling>,
        multigrid: &'a Multigrid,
    ) -> Self {
        let pressures = coupling.map(|coupling| (coupling, coupling.weights()));
        Preconditioned { system, multigrid, pressures }
    }

    /// Three for each free row, then the pressures.
    pub fn unknowns(&self) -> usize {
        self.displacements() + self.pressures.as_ref().map_or(0, |(own, _)| own.mass.len())
    }

    /// Unknowns that are displacements.
    pub fn displacements(&self) -> usize {
        3 * self.system.ordering.free
    }

    /// A x.
    pub fn product(&self, x: &[[f64; 1]]) -> Vec<[f64; 1]> {
        let mut product = vec![[0.0]; x.len()];
        let (u, p) = x.split_at(self.displacements());
        let (force, volume) = product.split_at_mut(self.displacements());
        let force: &mut [Lanes<f64, 3, 1>] = force.as_chunks_mut().0;
        self.system.multiply(u.as_chunks().0, force);
        let Some((coupling, weights)) = &self.pressures else { return product };
        coupling.gradient.add_expanded(p, force);
        self.system.zero_constrained(force);
        let mut divergence = vec![[0.0]; p.len()];
        coupling.divergence.contract(u.as_chunks().0, &mut divergence);
        coupling.compliance.multiply(p, volume);
        for (([value], [given]), weight) in volume.iter_mut().zip(&divergence).zip(weights) {
            *value = weight * (given - *value);
        }
        product
    }

    /// P^-1 r.
    pub fn precondition(&self, r: &[[f64; 1]]) -> Vec<[f64; 1]> {
        self.apply::<1>(r)
    }

    /// P^-1 of equations that pressures do not take part in, at most eight of them.
    pub fn columns(&self, equations: &[&Equation]) -> Vec<Vec<f32>> {
        let mut right = vec![[0.0; MOST_LANES]; self.unknowns()];
        for (lane, equation) in equations.iter().enumerate() {
            equation.iter().for_each(|&(at, value)| right[at as usize][lane] += value);
        }
        let answers = self.apply::<MOST_LANES>(&right);
        let column = |lane: usize| answers.iter().map(|values| values[lane] as f32).collect();
        (0..equations.len()).map(column).collect()
    }

    fn apply<const N: usize>(&self, r: &[[f64; N]]) -> Vec<[f64; N]> {
        let (forces, volumes) = r.split_at(self.displacements());
        let mut workspace = self.multigrid.workspace();
        let correction = self.multigrid.apply(forces.as_chunks().0, &mut workspace);
        let mut answer = vec![[0.0; N]; r.len()];
        let (u, p) = answer.split_at_mut(self.displacements());
        for (u, z) in u.iter_mut().zip(correction.values.as_flattened()) {
            *u = std::array::from_fn(|n| correction.scale[n] * f64::from(z[n]));
        }
        let Some((coupling, weights)) = &self.pressures else { return answer };
        coupling.divergence.contract(u.as_chunks().0, p);
        for (i, p) in p.iter_mut().enumerate() {
            let factor = SCHUR / coupling.mass[i];
            for n in 0..N {
                p[n] = factor * (p[n] - volumes[i][n] / weights[i]);
            }
        }
        answer
    }
}
