//! Orderings that keep the factor of a block matrix small, and what that factor will cost.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::System;

/// An elimination order of the free rows.
pub struct Ordering {
    /// `order[k]` is the row that is eliminated as the k-th.
    pub order: Vec<usize>,
    /// Multiplications that the numeric factorisation takes.
    pub multiplications: f64,
    /// Memory of the factor in MB.
    pub factor_mb: f64,
}

/// Approximate minimum degree on the graph of the blocks (Amestoy, Davis, Duff 1996): nine times less
/// to order than the unknowns, and the three unknowns of a row stay together.
pub fn minimum_degree(system: &System) -> Ordering {
    let rows = system.ordering.free;
    let mut starts = Vec::with_capacity(rows + 1);
    starts.push(0);
    let mut upper: Vec<usize> = Vec::new();
    for row in 0..rows {
        upper.extend(system.matrix.pattern.columns(row).iter().map(|&c| c as usize));
        upper.push(row);
        starts.push(upper.len());
    }
    let pattern = SymbolicSparseColMatRef::new_checked(rows, rows, &starts, None, &upper);
    let mut order = vec![0; rows];
    let mut position = vec![0; rows];
    let mut memory = MemBuffer::new(amd::order_scratch::<usize>(rows, upper.len()));
    let stack = MemStack::new(&mut memory);
    let flops = amd::order(&mut order, &mut position, pattern, amd::Control::default(), stack)
        .expect("the pattern is square and its indices fit");
    Ordering {
        order,
        multiplications: 27.0 * flops.n_mult_subs_ldl,
        factor_mb: 72.0 * (flops.n_div + rows as f64) / 1e6,
    }
}
