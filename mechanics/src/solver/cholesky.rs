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

use super::lanes::Lanes;
use super::ordering::Ordering;
use super::scaling::scaled;
use super::vector::{column, norm, pack_lanes};
use super::{Solution, SolveReport, SolverError, System, Tolerance, Unknowns, tell};
use crate::progress::Progress;

/// Corrections after which a residual that is still too large will stay so.
const MOST_REFINEMENTS: usize = 6;

/// L of a system, for any number of right-hand sides.
pub struct Factor {
    free: FreeUnknowns,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

/// Solves by a factorisation in the given order. The factorisation itself cannot be interrupted.
pub fn solve(
    system: &System,
    ordering: &Ordering,
    right_hand_sides: &[Unknowns],
    tolerance: &Tolerance,
    progress: &dyn Progress,
) -> Result<Vec<Solution>, SolverError> {
    let factor = Factor::new(system, ordering)?;
    let wanted = tolerance.relative_residual;
    right_hand_sides.iter().map(|side| factor.solve(system, side, wanted, progress)).collect()
}

impl Factor {
    /// Factorises in the given order.
    pub fn new(system: &System, ordering: &Ordering) -> Result<Self, SolverError> {
        let free = FreeUnknowns::new(system, ordering);
        let columns = free.lower_columns(system);
        let symbolic = columns.symbolic(&free)?;
        let mut values = vec![0.0; symbolic.len_val()];
        columns.factorise(&symbolic, &mut values, &free)?;
        Ok(Factor { free, symbolic, values })
    }

    /// Solves for one right-hand side of the system that was factorised, to a relative residual.
    pub fn solve(
        &self,
        system: &System,
        right_hand_side: &Unknowns,
        wanted: f64,
        progress: &dyn Progress,
    ) -> Result<Solution, SolverError> {
        let factor = LltRef::new(&self.symbolic, &self.values);
        let refined = Refined { system, free: &self.free, factor: &factor };
        let alone = std::slice::from_ref(right_hand_side);
        let solve = |sides: &[Unknowns]| Ok(vec![refined.solve(&sides[0], wanted, progress)?]);
        scaled(alone, solve).map(|mut solutions| solutions.remove(0))
    }

    /// Adds K^-1 `residual` to `x`, without refinement.
    pub(super) fn correct<const N: usize>(
        &self,
        residual: &[Lanes<f64, 3, N>],
        x: &mut [Lanes<f64, 3, N>],
    ) {
        self.free.correct(&LltRef::new(&self.symbolic, &self.values), residual, x);
    }
}

/// A factor and the system whose residual refines what it solves.
struct Refined<'a> {
    system: &'a System,
    free: &'a FreeUnknowns,
    factor: &'a LltRef<'a, usize, f64>,
}

impl Refined<'_> {
    fn solve(
        &self,
        right_hand_side: &Unknowns,
        wanted: f64,
        progress: &dyn Progress,
    ) -> Result<Solution, SolverError> {
        let right_hand_side = pack_lanes::<1, 3>(std::slice::from_ref(right_hand_side));
        let [scale] = norm(right_hand_side.as_flattened());
        let mut x = vec![[[0.0; 1]; 3]; right_hand_side.len()];
        let mut residual = right_hand_side.clone();
        let mut history = vec![if scale > 0.0 { 1.0 } else { 0.0 }];
        while history[history.len() - 1] > wanted {
            let refinements = history.len() - 1;
            if refinements > MOST_REFINEMENTS {
                let (iterations, residual) = (refinements, history[refinements]);
                return Err(SolverError::NotConverged { iterations, residual, wanted, history });
            }
            self.free.correct(self.factor, &residual, &mut x);
            self.system.residual(&right_hand_side, &x, &mut residual);
            let relative = norm(residual.as_flattened())[0] / scale;
            if !relative.is_finite() {
                return Err(SolverError::NotFinite);
            }
            history.push(relative);
            tell(progress, history.len() - 1, relative, wanted)?;
        }
        Ok(Solution {
            unknowns: column(&x, 0),
            report: SolveReport {
                method: "cholesky",
                preconditioner: "none",
                why: String::new(),
                unknowns: self.free.unknown.len(),
                iterations: history.len() - 1,
                relative_residual: history[history.len() - 1],
                wanted_residual: wanted,
                history: Vec::new(),
                steps: 1,
                newton: None,
            },
        })
    }
}

/// The unknowns that are not held, numbered in elimination order.
struct FreeUnknowns {
    /// The row and component at each place of the elimination order.
    unknown: Vec<(usize, usize)>,
    /// The place of each component of each row; `usize::MAX` where held.
    place: Vec<[usize; 3]>,
}

impl FreeUnknowns {
    fn new(system: &System, ordering: &Ordering) -> Self {
        let mut held = vec![[false; 3]; system.ordering.free];
        for partly in &system.partly_constrained {
            held[partly.row] = partly.held;
        }
        let unknown: Vec<(usize, usize)> = ordering
            .order
            .iter()
            .flat_map(|&row| (0..3).map(move |component| (row, component)))
            .filter(|&(row, component)| !held[row][component])
            .collect();
        let mut place = vec![[usize::MAX; 3]; system.ordering.free];
        for (at, &(row, component)) in unknown.iter().enumerate() {
            place[row][component] = at;
        }
        FreeUnknowns { unknown, place }
    }

    /// The lower triangle in elimination order, column by column.
    fn lower_columns(&self, system: &System) -> Columns {
        let mut entries: Vec<Vec<(usize, f64)>> = vec![Vec::new(); self.unknown.len()];
        let mut put = |row: usize, column: usize, value: f64| {
            if row != usize::MAX && column != usize::MAX {
                entries[row.min(column)].push((row.max(column), value));
            }
        };
        for (row, places) in self.place.iter().enumerate() {
            for i in 0..3 {
                for j in 0..=i {
                    put(places[i], places[j], system.matrix.diagonal[row][i][j]);
                }
            }
            for (column, block) in system.matrix.lower_row(row) {
                for (&place, values) in places.iter().zip(block) {
                    for (&other, &value) in self.place[column].iter().zip(values) {
                        put(place, other, value);
                    }
                }
            }
        }
        let mut columns = Columns { starts: vec![0], rows: Vec::new(), values: Vec::new() };
        for mut entries in entries {
            entries.sort_unstable_by_key(|&(row, _)| row);
            columns.rows.extend(entries.iter().map(|&(row, _)| row));
            columns.values.extend(entries.iter().map(|&(_, value)| value));
            columns.starts.push(columns.rows.len());
        }
        columns
    }

    /// x += K^-1 residual.
    fn correct<const N: usize>(
        &self,
        factor: &LltRef<'_, usize, f64>,
        residual: &[Lanes<f64, 3, N>],
        x: &mut [Lanes<f64, 3, N>],
    ) {
        let rows = self.unknown.len();
        let mut ordered: Vec<f64> = (0..N)
            .flat_map(|n| self.unknown.iter().map(move |&(row, c)| residual[row][c][n]))
            .collect();
        let mut memory = MemBuffer::new(factor.solve_in_place_scratch::<f64>(N, Par::Seq));
        let columns = MatMut::from_column_major_slice_mut(&mut ordered, rows, N);
        factor.solve_in_place_with_conj(Conj::No, columns, Par::Seq, MemStack::new(&mut memory));
        for n in 0..N {
            let corrections = &ordered[n * rows..(n + 1) * rows];
            for (&(row, component), correction) in self.unknown.iter().zip(corrections) {
                x[row][component][n] += correction;
            }
        }
    }
}

/// Compressed columns of a lower triangle, with the `usize` of faer, which reads them as they are.
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

    fn factorise(
        &self,
        symbolic: &SymbolicCholesky<usize>,
        values: &mut [f64],
        free: &FreeUnknowns,
    ) -> Result<(), SolverError> {
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
            .map(|_| ())
            .map_err(|LltError::NonPositivePivot { index }| {
                let (node, _) = free.unknown.get(index).copied().unwrap_or_default();
                SolverError::Singular { node }
            })
    }

    fn out_of_memory(&self) -> SolverError {
        let needed_mb = (self.rows.len() * 16) as f64 / 1e6;
        SolverError::OverBudget { needed_mb, allowed_mb: 0.0 }
    }
}
