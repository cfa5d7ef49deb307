//! Sparse Cholesky factorisation L L^T of the free unknowns (faer), refined to the wanted residual.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::ordering::Ordering;
use super::vector::norm;
use super::{LinearSystem, Solution, SolverError, Tolerance, Watch, residual_of};

/// Corrections after which a residual that is still too large will stay so.
const MOST_REFINEMENTS: usize = 6;

/// Solves by a factorisation in the given order. The factorisation itself cannot be interrupted.
pub fn solve(
    system: &LinearSystem,
    ordering: &Ordering,
    tolerance: &Tolerance,
    watch: Watch,
    why: String,
) -> Result<Solution, SolverError> {
    let free = FreeUnknowns::new(system, ordering);
    let columns = free.lower_columns(system);
    let symbolic = columns.symbolic(&free)?;
    let mut values = vec![0.0; symbolic.len_val()];
    let factor = columns.factorise(&symbolic, &mut values, &free)?;

    let wanted = tolerance.relative_residual;
    let scale = norm(system.right_hand_side);
    let mut x = vec![0.0; system.right_hand_side.len()];
    let mut residual = system.right_hand_side.to_vec();
    let mut history = vec![1.0];
    while history[history.len() - 1] > wanted {
        let refinements = history.len() - 1;
        if refinements > MOST_REFINEMENTS {
            let (iterations, residual) = (refinements, history[refinements]);
            return Err(SolverError::NotConverged { iterations, residual, wanted, history });
        }
        free.correct(&factor, &residual, &mut x);
        residual_of(system, &x, &mut residual);
        let relative = norm(&residual) / scale;
        if !relative.is_finite() {
            return Err(SolverError::NotFinite);
        }
        history.push(relative);
        if !watch(history.len() - 1, relative) {
            return Err(SolverError::Stopped);
        }
    }
    Ok(Solution {
        unknowns: x,
        method: "cholesky",
        preconditioner: "none",
        why,
        iterations: history.len() - 1,
        relative_residual: history[history.len() - 1],
    })
}

/// The unknowns that are not held, numbered in elimination order.
struct FreeUnknowns {
    /// The unknown at each place of the elimination order.
    unknown: Vec<usize>,
    /// The place of each unknown; `usize::MAX` where held.
    place: Vec<usize>,
}

impl FreeUnknowns {
    fn new(system: &LinearSystem, ordering: &Ordering) -> Self {
        let unknown: Vec<usize> = ordering
            .order
            .iter()
            .flat_map(|&row| 3 * row..3 * row + 3)
            .filter(|&unknown| !system.held[unknown])
            .collect();
        let mut place = vec![usize::MAX; system.held.len()];
        for (at, &unknown) in unknown.iter().enumerate() {
            place[unknown] = at;
        }
        FreeUnknowns { unknown, place }
    }

    /// The lower triangle in elimination order, column by column.
    fn lower_columns(&self, system: &LinearSystem) -> Columns {
        let mut columns = Columns { starts: vec![0], rows: Vec::new(), values: Vec::new() };
        let mut entries: Vec<(usize, f64)> = Vec::new();
        for (column, &unknown) in self.unknown.iter().enumerate() {
            entries.clear();
            for (other, block) in system.matrix.row(unknown / 3) {
                for component in 0..3 {
                    let row = self.place[3 * other + component];
                    if row != usize::MAX && row >= column {
                        entries.push((row, block[3 * (unknown % 3) + component]));
                    }
                }
            }
            entries.sort_unstable_by_key(|&(row, _)| row);
            columns.rows.extend(entries.iter().map(|&(row, _)| row));
            columns.values.extend(entries.iter().map(|&(_, value)| value));
            columns.starts.push(columns.rows.len());
        }
        columns
    }

    /// x += K^-1 residual.
    fn correct(&self, factor: &LltRef<'_, usize, f64>, residual: &[f64], x: &mut [f64]) {
        let mut ordered: Vec<f64> = self.unknown.iter().map(|&unknown| residual[unknown]).collect();
        let mut memory = MemBuffer::new(factor.solve_in_place_scratch::<f64>(1, Par::Seq));
        let rows = ordered.len();
        let column = MatMut::from_column_major_slice_mut(&mut ordered, rows, 1);
        factor.solve_in_place_with_conj(Conj::No, column, Par::Seq, MemStack::new(&mut memory));
        for (&unknown, correction) in self.unknown.iter().zip(&ordered) {
            x[unknown] += correction;
        }
    }
}

/// Compressed columns of a lower triangle.
struct Columns {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl Columns {
    fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        let size = self.starts.len() - 1;
        SymbolicSparseColMatRef::new_checked(size, size, &self.starts, None, &self.rows)
    }

    fn symbolic(&self, free: &FreeUnknowns) -> Result<SymbolicCholesky<usize>, SolverError> {
        let identity: Vec<usize> = (0..free.unknown.len()).collect();
        let order = PermRef::new_checked(&identity, &identity, identity.len());
        let ordering = SymmetricOrdering::Custom(order);
        let parameters = CholeskySymbolicParams::default();
        factorize_symbolic_cholesky(self.pattern(), Side::Lower, ordering, parameters)
            .map_err(|_| self.out_of_memory())
    }

    fn factorise<'a>(
        &self,
        symbolic: &'a SymbolicCholesky<usize>,
        values: &'a mut [f64],
        free: &FreeUnknowns,
    ) -> Result<LltRef<'a, usize, f64>, SolverError> {
        let matrix = SparseColMatRef::new(self.pattern(), &self.values);
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| self.out_of_memory())?;
        let stack = MemStack::new(&mut memory);
        let (side, regularisation) = (Side::Lower, Default::default());
        symbolic
            .factorize_numeric_llt(
                values,
                matrix,
                side,
                regularisation,
                Par::Seq,
                stack,
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| {
                let unknown = free.unknown.get(index).copied().unwrap_or_default();
                SolverError::NotPositiveDefinite { row: unknown / 3 }
            })
    }

    fn out_of_memory(&self) -> SolverError {
        let needed_mb = (self.rows.len() * 16) as f64 / 1e6;
        SolverError::OverBudget { needed_mb, allowed_mb: 0.0 }
    }
}
