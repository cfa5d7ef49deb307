//! Symmetric matrices over pairs of cases: distances and scalar products.

use rayon::prelude::*;

/// A number for every two of some cases.
#[derive(Clone, Debug, PartialEq)]
pub struct Pairs {
    count: usize,
    values: Vec<f64>,
}

impl Pairs {
    /// The number of each two; `of` is symmetric, and asked once for both orders.
    pub fn of(count: usize, of: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        let half: Vec<Vec<f64>> = (0..count)
            .into_par_iter()
            .map(|row| (0..=row).map(|column| of(row, column)).collect())
            .collect();
        let at = |row: usize, column: usize| half[row.max(column)][row.min(column)];
        let values = (0..count * count).map(|place| at(place / count, place % count)).collect();
        Pairs { count, values }
    }

    /// Scalar products of vectors.
    pub fn products(vectors: &[&[f64]]) -> Self {
        Pairs::of(vectors.len(), |i, j| dot(vectors[i], vectors[j]))
    }

    /// Scalar products of what vectors differ by from their mean.
    pub fn centred_products(vectors: &[&[f64]]) -> Self {
        let mean = mean(vectors);
        let centred: Vec<Vec<f64>> = vectors
            .iter()
            .map(|own| own.iter().zip(&mean).map(|(value, mean)| value - mean).collect())
            .collect();
        Pairs::products(&centred.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    pub fn count(&self) -> usize {
        self.count
    }

    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.count + column]
    }

    /// Those of a case with others.
    pub fn row(&self, case: usize, others: &[usize]) -> Vec<f64> {
        others.iter().map(|&other| self.at(case, other)).collect()
    }

    /// |y - sum_j w_j y_j|^2 of a case y and others, of which these are the scalar products. Vectors may be taken from any point
    /// where the sum of weights is 1.
    pub fn squared_error(&self, case: usize, others: &[usize], weights: &[f64]) -> f64 {
        let mut sum = self.at(case, case);
        for (&one, &weight) in others.iter().zip(weights) {
            if weight != 0.0 {
                let row = others.iter().zip(weights).map(|(&other, own)| own * self.at(one, other));
                sum += weight * (row.sum::<f64>() - 2.0 * self.at(case, one));
            }
        }
        sum.max(0.0)
    }

    /// The same among some of the cases, in their order.
    pub fn among(&self, cases: &[usize]) -> Pairs {
        Pairs {
            count: cases.len(),
            values: cases.iter().flat_map(|&case| self.row(case, cases)).collect(),
        }
    }
}

/// The scalar product of two vectors of one length.
pub fn dot(first: &[f64], second: &[f64]) -> f64 {
    first.iter().zip(second).map(|(a, b)| a * b).sum()
}

/// The mean of vectors of one length; empty where there is none.
pub fn mean(vectors: &[&[f64]]) -> Vec<f64> {
    let mut sum = vec![0.0; vectors.first().map_or(0, |own| own.len())];
    for own in vectors {
        sum.iter_mut().zip(*own).for_each(|(sum, value)| *sum += value);
    }
    sum.iter().map(|sum| sum / vectors.len() as f64).collect()
}

/// Vectors weighted and added.
pub fn blended(weights: &[f64], vectors: &[&[f64]]) -> Vec<f64> {
    let mut sum = vec![0.0; vectors.first().map_or(0, |own| own.len())];
    for (&weight, own) in weights.iter().zip(vectors).filter(|(weight, _)| **weight != 0.0) {
        sum.iter_mut().zip(*own).for_each(|(sum, value)| *sum += weight * value);
    }
    sum
}
