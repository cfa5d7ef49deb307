//! Values at a few points as a map over a surface: the mean of all, weighted by the inverse square of the distance
//! (Shepard, A two-dimensional interpolation function for irregularly-spaced data, ACM National Conference, 1968;
//! Zhang et al. 2016 draw the errors of nodes so; docs/methods.md#distances-and-statistics).
//!
//! f(x) = sum f_i / |x - x_i|^2 / sum 1 / |x - x_i|^2, and f_i at x_i.

use crate::mesh::Vector;

/// The value at each of the places; `None` without any point. Of points at one place the first counts there.
pub fn inverse_distance_map(points: &[(Vector, f64)], at: &[Vector]) -> Option<Vec<f64>> {
    if points.is_empty() {
        return None;
    }
    let value = |x: &Vector| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (point, value) in points {
            let squared = (x - point).norm_squared();
            let weight = squared.recip();
            if !weight.is_finite() {
                return *value;
            }
            sum += value * weight;
            weights += weight;
        }
        sum / weights
    };
    Some(at.iter().map(value).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_values_give_the_number_of_v41_and_are_exact_where_they_are() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector::from);
        let points: Vec<(Vector, f64)> = corners.into_iter().zip([1.0, 3.0, 5.0]).collect();
        let at = [Vector::new(0.25, 0.25, 0.0), corners[0], corners[1], corners[2]];
        let found = inverse_distance_map(&points, &at).expect("three points");
        assert!((found[0] - 1.857_142_857_142_857).abs() < 1e-14, "{found:?}");
        assert_eq!(found[1..], [1.0, 3.0, 5.0]);
        assert_eq!(inverse_distance_map(&[], &at), None);
    }

    #[test]
    fn a_place_next_to_a_point_has_its_value_and_no_overflow() {
        let points = [(Vector::zeros(), 2.0), (Vector::x(), 4.0)];
        let found = inverse_distance_map(&points, &[Vector::x() * 1e-170]).expect("two points");
        assert_eq!(found, [2.0]);
    }
}
