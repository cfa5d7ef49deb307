//! Edge functions beside each other: conjugate gradients with the blocks of single edges as preconditioner.
//!
//! One step of block Jacobi overshoots where cells are well shaped and sees little of what flat cells do, whose edges are stiff one by
//! one and soft together. A few steps of conjugate gradients are within a tenth of the energy of the exact coefficients on either.

use super::edge_equations::EdgeEquations;
use super::edge_functions::MAX_EDGES;
use super::edges::Edges;
use super::held_edges::HeldEdges;
use super::two_level::{EnrichedCells, TwoLevel};
use crate::mesh::Vector;
use crate::model::problem::InvertedCell;

/// Steps of conjugate gradients.
const STEPS: usize = 3;

impl<C: EnrichedCells> TwoLevel<'_, C> {
    /// b of all edges, from what each would be by itself. At finite strain it ends where the tangent is not positive definite.
    pub(super) fn together(
        &self,
        edges: &Edges,
        equations: &EdgeEquations,
        held: &HeldEdges,
        alone: Vec<Vector>,
    ) -> Result<Vec<Vector>, InvertedCell> {
        let mut residual = equations.residual.clone();
        let mut work = dot(&alone, &residual);
        let mut direction = alone.clone();
        let mut together: Option<Vec<Vector>> = None;
        for _ in 0..STEPS {
            let product = self.product(edges, equations, &direction)?;
            let resisted = dot(&direction, &product);
            if !(work > 0.0 && resisted > 0.0) {
                break;
            }
            let length = work / resisted;
            let sum = together.get_or_insert_with(|| vec![Vector::zeros(); direction.len()]);
            sum.iter_mut().zip(&direction).for_each(|(b, way)| *b += way * length);
            residual.iter_mut().zip(&product).for_each(|(r, product)| *r -= product * length);
            let answer = equations.answer(&residual, held);
            let before = std::mem::replace(&mut work, dot(&answer, &residual));
            let kept = work / before;
            direction.iter_mut().zip(&answer).for_each(|(way, own)| *way = own + *way * kept);
        }
        Ok(together.unwrap_or(alone))
    }

    /// What coefficients of all edges do to the edges.
    fn product(
        &self,
        edges: &Edges,
        equations: &EdgeEquations,
        of: &[Vector],
    ) -> Result<Vec<Vector>, InvertedCell> {
        let mut product = vec![Vector::zeros(); of.len()];
        edges.each_cell(
            [Vector::zeros(); MAX_EDGES],
            |cell, numbers, own| {
                *own = self.cells.on_edges(cell, &numbers.gather(of))?;
                Ok(())
            },
            |_, numbers, own| {
                numbers.numbers().zip(own).for_each(|(edge, force)| product[edge] += force);
            },
        )?;
        if let Some(sheet) = self.sheet(edges, equations) {
            sheet.add_forces_on_edges(of, &mut product);
        }
        Ok(product)
    }
}

fn dot(one: &[Vector], other: &[Vector]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a.dot(b)).sum()
}
