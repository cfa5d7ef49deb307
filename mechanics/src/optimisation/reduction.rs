//! Thousands of target components reduced to as many rows as a response has columns.
//!
//! |W (B a - d)|² = |R a - y|² + rho²,   W [B d] = Q [R y; 0 rho]
//!
//! B holds the columns of the response at the targets and W the inverse standard deviations. The
//! orthogonal factor is never formed: rows are taken in blocks, each stacked under the triangle so far
//! (Golub, Van Loan, Matrix Computations, 4th ed., 2013, section 5.3). Whatever the targets, each
//! iteration then costs the same few thousand operations.

use nalgebra::{DMatrix, DVector};

use super::{OptimisationError, Question, SkinPoint};

/// Rows taken at once, or as many as there are columns: a block and the triangle stay in the cache.
const ROWS: usize = 256;

/// A column: its values at the skin nodes and the unit that they are in, in mm.
enum Column<'a> {
    Single(&'a [f32]),
    /// Of second order.
    Short(&'a [i16], f32),
}

impl Column<'_> {
    fn sample(&self, point: &SkinPoint, component: usize) -> f64 {
        match self {
            Column::Single(values) => point.sample(values, component),
            Column::Short(values, unit) => f64::from(*unit) * point.sample(values, component),
        }
    }
}

/// The columns of a question in the order of `Unknowns::coefficients`.
fn columns<'a>(question: &Question<'a>) -> Vec<Column<'a>> {
    let response = question.response;
    let length = 3 * response.nodes.len().max(1);
    let of_constants = question.constants.iter().map(|own| own.derivative.as_slice());
    let first = response.columns.chunks_exact(length).chain(of_constants).map(Column::Single);
    let second = question.second_order.into_iter().flat_map(|form| {
        form.values
            .chunks_exact(length)
            .zip(&form.scales)
            .map(|(own, unit)| Column::Short(own, *unit))
    });
    first.chain(second).collect()
}

/// What the targets ask of the numbers that the columns are multiplied by.
pub struct Reduction {
    /// R.
    matrix: DMatrix<f64>,
    /// y.
    wanted: DVector<f64>,
    /// rho²: what no movement changes.
    pub unreachable: f64,
    /// Components of targets that were reduced.
    pub components: usize,
}

impl Reduction {
    pub fn new(question: &Question) -> Result<Self, OptimisationError> {
        let columns = columns(question);
        let width = columns.len() + 1;
        let mut triangle = DMatrix::zeros(0, width);
        let rows = ROWS.max(width);
        let mut block: Vec<f64> = Vec::with_capacity(rows * width);
        let mut components = 0;
        for target in question.targets {
            for goal in &target.goals {
                for (component, wanted) in goal.displacement.into_iter().enumerate() {
                    let Some(wanted) = wanted else { continue };
                    let sample = |column: &Column| column.sample(&goal.point, component);
                    block.extend(columns.iter().map(|column| sample(column) / target.sigma));
                    block.push(wanted / target.sigma);
                    components += 1;
                    if block.len() == rows * width {
                        triangle = reduced(&triangle, &block);
                        block.clear();
                    }
                }
            }
        }
        if components == 0 {
            return Err(OptimisationError::NoTarget);
        }
        triangle = reduced(&triangle, &block);
        if !triangle.iter().all(|value| value.is_finite()) {
            return Err(OptimisationError::NotFinite);
        }
        let rows = triangle.nrows().min(width - 1);
        let unreachable = triangle.rows(rows, triangle.nrows() - rows).norm_squared();
        let matrix = triangle.view((0, 0), (rows, width - 1)).into_owned();
        let wanted = triangle.view((0, width - 1), (rows, 1)).column(0).into_owned();
        Ok(Reduction { matrix, wanted, unreachable, components })
    }

    /// R a - y.
    pub fn residual(&self, coefficients: &DVector<f64>) -> DVector<f64> {
        &self.matrix * coefficients - &self.wanted
    }

    /// |y|.
    pub fn size(&self) -> f64 {
        self.wanted.norm()
    }

    /// R times the derivatives of a.
    pub fn jacobian(&self, derivatives: &DMatrix<f64>) -> DMatrix<f64> {
        &self.matrix * derivatives
    }
}

/// The triangle of the rows so far and a block of further ones.
fn reduced(triangle: &DMatrix<f64>, block: &[f64]) -> DMatrix<f64> {
    let width = triangle.ncols();
    let mut rows = DMatrix::zeros(triangle.nrows() + block.len() / width, width);
    rows.rows_mut(0, triangle.nrows()).copy_from(triangle);
    rows.rows_mut(triangle.nrows(), block.len() / width).copy_from(&DMatrix::from_row_slice(
        block.len() / width,
        width,
        block,
    ));
    rows.qr().unpack_r()
}
