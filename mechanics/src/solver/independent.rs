//! Symmetric positive semidefinite systems of a few hundred, possibly dependent, unknowns.

/// A pivot below this part of its diagonal is decided by those before it.
const DECIDED: f64 = 1e-6;

/// The Cholesky factor of the rows that stand for themselves, the largest pivot first (Higham, Accuracy and Stability of
/// Numerical Algorithms, 2nd ed., section 10.3).
pub(super) struct Independent {
    /// Rows in the order of elimination.
    order: Vec<usize>,
    /// Row i of the factor has i + 1 entries.
    factor: Vec<Vec<f64>>,
    size: usize,
}

impl Independent {
    /// Of a matrix by rows, of which the symmetric part counts.
    pub fn new(matrix: &[Vec<f64>]) -> Self {
        let size = matrix.len();
        let mut left: Vec<f64> = (0..size).map(|i| matrix[i][i]).collect();
        // Columns of the factor so far, each for all rows.
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut order: Vec<usize> = Vec::new();
        let mut is_open = vec![true; size];
        let share = |left: &[f64], i: usize| left[i] / matrix[i][i];
        loop {
            let open = (0..size).filter(|&i| is_open[i] && matrix[i][i] > 0.0);
            let pivot = open.max_by(|&a, &b| share(&left, a).total_cmp(&share(&left, b)));
            let Some(pivot) = pivot.filter(|&pivot| share(&left, pivot) > DECIDED) else { break };
            let root = left[pivot].sqrt();
            // For all rows at once, column by column as they lie in memory.
            let mut earlier = vec![0.0; size];
            for column in &columns {
                let by = column[pivot];
                earlier.iter_mut().zip(column).for_each(|(sum, c)| *sum += c * by);
            }
            let own = |i: usize| 0.5 * (matrix[i][pivot] + matrix[pivot][i]);
            let column: Vec<f64> =
                earlier.iter().enumerate().map(|(i, sum)| (own(i) - sum) / root).collect();
            left.iter_mut().zip(&column).for_each(|(left, c)| *left -= c * c);
            is_open[pivot] = false;
            order.push(pivot);
            columns.push(column);
        }
        let row = |(place, &i): (usize, &usize)| columns[..=place].iter().map(|c| c[i]).collect();
        let factor = order.iter().enumerate().map(row).collect();
        Independent { order, factor, size }
    }

    /// The rows that others decide, ascending.
    pub fn dependent(&self) -> Vec<usize> {
        let mut is_own = vec![false; self.size];
        self.order.iter().for_each(|&row| is_own[row] = true);
        (0..self.size).filter(|&row| !is_own[row]).collect()
    }

    /// The solution, zero for rows that others decide.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut values: Vec<f64> = self.order.iter().map(|&row| right[row]).collect();
        for i in 0..values.len() {
            let sum: f64 = self.factor[i][..i].iter().zip(&values).map(|(l, v)| l * v).sum();
            values[i] = (values[i] - sum) / self.factor[i][i];
        }
        for i in (0..values.len()).rev() {
            values[i] /= self.factor[i][i];
            let value = values[i];
            let row = &self.factor[i][..i];
            values[..i].iter_mut().zip(row).for_each(|(v, l)| *v -= l * value);
        }
        let mut solution = vec![0.0; self.size];
        self.order.iter().zip(values).for_each(|(&row, value)| solution[row] = value);
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_repeats_another_is_left_out_and_the_rest_is_solved() {
        let matrix = [[4.0, 1.0, 4.0], [1.0, 3.0, 1.0], [4.0, 1.0, 4.0]].map(|row| row.to_vec());
        let independent = Independent::new(&matrix);
        let dependent = independent.dependent();
        assert_eq!(dependent.len(), 1, "{dependent:?}");
        let x = independent.solve(&[6.0, 7.0, 6.0]);
        let product: Vec<f64> =
            matrix.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        for (value, wanted) in product.iter().zip([6.0, 7.0, 6.0]) {
            assert!((value - wanted).abs() < 1e-14, "{product:?}");
        }
        assert_eq!(x[dependent[0]], 0.0);
    }
}
