//! Unconstrained rigid body motions: the null space of the constrained directions, in words.
//!
//! A held direction n at the place x forbids n . (t + w x (x - c)) / s of a small motion with the translation t and
//! the turn w about the centre c; s is a length that makes both alike. The sum of the squares of these rows is a 6 x 6
//! matrix, and its null vectors are what stays free.

use std::fmt;

use nalgebra::{DMatrix, Matrix3xX, Matrix6, Vector6};

use crate::mesh::Vector;

/// A rigid movement is held when its eigenvalue exceeds this share of the largest one: a part may be
/// ten thousand times as long as the patch that holds it.
const HELD: f64 = 1e-9;

/// A null vector that turns by less than this share of what it slides only slides.
const ONLY_SLIDES: f64 = 1e-3;

/// Components of printed directions are rounded to this.
const PRINTED: f64 = 1e-3;

/// How a body may still move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Freedom {
    /// Directions of length 1.
    pub slides: Vec<Vector>,
    pub turns: Vec<Axis>,
}

/// An axis to turn about: a point of it in mm, and its direction, of length 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub through: Vector,
    pub along: Vector,
}

impl Freedom {
    /// The null space of the rows of a Gram matrix; they are (n, (x - c) / s x n).
    pub fn of(gram: &Matrix6<f64>, centre: &Vector, scale: f64) -> Freedom {
        let free = null_space(gram);
        if free.is_empty() {
            return Freedom::default();
        }
        let turning = Matrix3xX::from_columns(
            &free.iter().map(|way| way.fixed_rows::<3>(3).into_owned()).collect::<Vec<_>>(),
        );
        let normal = turning.tr_mul(&turning).symmetric_eigen();
        let blend = |weights: nalgebra::DVectorView<f64>| {
            free.iter().zip(weights.iter()).map(|(way, weight)| way * *weight).sum::<Vector6<f64>>()
        };
        let (mut slides, mut turns) = (Vec::new(), Vec::new());
        for (square, weights) in normal.eigenvalues.iter().zip(normal.eigenvectors.column_iter()) {
            let way = blend(weights);
            match square.max(0.0).sqrt() < ONLY_SLIDES {
                true => slides.push(vec![way[0], way[1], way[2]]),
                false => turns.push(vec![way[3], way[4], way[5], way[0], way[1], way[2]]),
            }
        }
        readable(&mut slides);
        readable(&mut turns);
        let slides: Vec<Vector> =
            slides.iter().map(|way| upright(Vector::from_column_slice(way))).collect();
        let turns = turns.iter().map(|way| axis(way, &slides, centre, scale)).collect();
        Freedom { slides, turns }
    }

    /// How many of the six rigid movements are free.
    pub fn count(&self) -> usize {
        self.slides.len() + self.turns.len()
    }
}

/// The number of null vectors of a Gram matrix, without their directions.
pub fn free_movements(gram: &Matrix6<f64>) -> usize {
    let eigenvalues = gram.symmetric_eigenvalues();
    let least = HELD * eigenvalues.max();
    eigenvalues.iter().filter(|value| **value <= least).count()
}

fn null_space(gram: &Matrix6<f64>) -> Vec<Vector6<f64>> {
    let eigen = gram.symmetric_eigen();
    let least = HELD * eigen.eigenvalues.max();
    let ways = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    ways.filter(|(value, _)| **value <= least).map(|(_, way)| way.into_owned()).collect()
}

/// The same space spanned by rows of few entries: elimination with the largest of the first three entries of each as
/// its pivot.
fn readable(rows: &mut [Vec<f64>]) {
    for row in 0..rows.len() {
        let largest = |a: &usize, b: &usize| rows[row][*a].abs().total_cmp(&rows[row][*b].abs());
        let Some(pivot) = (0..3).max_by(largest) else { continue };
        let own: Vec<f64> = rows[row].iter().map(|entry| entry / rows[row][pivot]).collect();
        for (other, entries) in rows.iter_mut().enumerate() {
            let part = entries[pivot];
            match other == row {
                true => entries.copy_from_slice(&own),
                false => entries.iter_mut().zip(&own).for_each(|(entry, own)| *entry -= part * own),
            }
        }
    }
}

/// The direction of a row, its largest component positive.
fn upright(direction: Vector) -> Vector {
    let largest = direction[direction.iamax()];
    direction.normalize() * largest.signum()
}

/// Where t + w x (x - c) / s vanishes, as far as slides do not move it.
fn axis(way: &[f64], slides: &[Vector], centre: &Vector, scale: f64) -> Axis {
    let turn = Vector::from_column_slice(&way[..3]);
    let mut shift = Vector::from_column_slice(&way[3..]);
    let free = DMatrix::from_fn(3, slides.len(), |row, column| slides[column][row]);
    if !slides.is_empty()
        && let Ok(inverse) = free.clone().pseudo_inverse(1e-9)
    {
        shift -= Vector::from_column_slice((&free * inverse * shift).as_slice());
    }
    let arm = turn.cross(&shift) / turn.norm_squared();
    Axis { through: centre + arm * scale, along: upright(turn) }
}

/// Rounded, without a sign at zero.
fn rounded(vector: &Vector) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| (vector[axis] / PRINTED).round() * PRINTED + 0.0);
    let plain = |value: f64| {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    format!("({}, {}, {})", plain(x), plain(y), plain(z))
}

impl fmt::Display for Freedom {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.count() == 6 {
            return formatter.write_str("slide and turn in every way");
        }
        let mut ways = Vec::new();
        match self.slides.len() {
            0 => {}
            3 => ways.push("slide in every direction".to_owned()),
            _ => ways.push(format!(
                "slide along {}",
                self.slides.iter().map(rounded).collect::<Vec<_>>().join(" and ")
            )),
        }
        for Axis { through, along } in &self.turns {
            let (through, along) = (rounded(through), rounded(along));
            ways.push(format!("turn about the axis through {through} mm along {along}"));
        }
        formatter.write_str(&ways.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Gram matrix of directions held at places, about the origin.
    fn gram(rows: &[([f64; 3], [f64; 3])]) -> Matrix6<f64> {
        let mut gram = Matrix6::zeros();
        for (place, direction) in rows {
            let (place, n) = (Vector::from(*place), Vector::from(*direction));
            let turn = place.cross(&n);
            let row = Vector6::new(n.x, n.y, n.z, turn.x, turn.y, turn.z);
            gram += row * row.transpose();
        }
        gram
    }

    const ALL: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn a_flat_wall_leaves_two_slides_and_one_turn() {
        let n = [0.0, 1.0, 0.0];
        let wall = gram(&[([1.0, 3.0, 0.0], n), ([0.0, 3.0, 1.0], n), ([-1.0, 3.0, -1.0], n)]);
        let freedom = Freedom::of(&wall, &Vector::zeros(), 1.0);
        let text = freedom.to_string();
        assert_eq!(freedom.count(), 3);
        assert!(text.starts_with("slide along (1, 0, 0) and (0, 0, 1), turn about"), "{text}");
        assert!(text.ends_with("along (0, 1, 0)"), "{text}");
    }

    #[test]
    fn nodes_on_a_line_leave_the_turn_about_it() {
        let places = [[2.0, 5.0, 0.0], [2.0, 5.0, 4.0]];
        let rows: Vec<_> = places.iter().flat_map(|at| ALL.map(|n| (*at, n))).collect();
        let freedom = Freedom::of(&gram(&rows), &Vector::zeros(), 1.0);
        let text = "turn about the axis through (2, 5, 0) mm along (0, 0, 1)";
        assert_eq!(freedom.to_string(), text);
    }

    #[test]
    fn nothing_leaves_everything_and_three_nodes_leave_nothing() {
        let free = Freedom::of(&Matrix6::zeros(), &Vector::zeros(), 1.0);
        assert_eq!((free.count(), free.to_string().as_str()), (6, "slide and turn in every way"));
        let places = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let rows: Vec<_> = places.iter().flat_map(|at| ALL.map(|n| (*at, n))).collect();
        assert_eq!(Freedom::of(&gram(&rows), &Vector::zeros(), 1.0).count(), 0);
        assert_eq!(free_movements(&gram(&rows)), 0);
    }
}
