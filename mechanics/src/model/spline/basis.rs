//! B-splines over clamped uniform knots, by the recursion of Cox and de Boor.
//!
//! N_i,0(u) = 1 on [t_i, t_i+1), else 0
//! N_i,p(u) = (u - t_i) / (t_i+p - t_i) N_i,p-1(u) + (t_i+p+1 - u) / (t_i+p+1 - t_i+1) N_i+1,p-1(u)
//! N'_i,p(u) = p [ N_i,p-1(u) / (t_i+p - t_i) - N_i+1,p-1(u) / (t_i+p+1 - t_i+1) ]
//!
//! with 0/0 = 0. The first and the last knot stand p + 1 times, so that the domain is covered by
//! sum_i N_i = 1. With control values at the Greville points (t_i+1 + ... + t_i+p) / p the spline is the
//! identity: sum_i N_i(u) xi_i = u.
//!
//! Source: de Boor, A Practical Guide to Splines, revised ed., 2001, chapters IX and X; the basis N of
//! Ulusoy et al. 2010, eq. 1.

/// The highest degree.
pub const MOST_DEGREE: usize = 3;

/// One value for each function that is not zero in a span; entries above the degree are zero.
pub type Local = [f64; MOST_DEGREE + 1];

/// A clamped basis with spans of equal length.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    degree: usize,
    knots: Vec<f64>,
}

impl Basis {
    /// Over [low, high] in mm; degree 1 to 3, at least one span.
    pub fn clamped(degree: usize, spans: usize, [low, high]: [f64; 2]) -> Self {
        let degree = degree.clamp(1, MOST_DEGREE);
        let spans = spans.max(1);
        let inner = (1..spans).map(|k| low + (high - low) * k as f64 / spans as f64);
        let mut knots = vec![low; degree + 1];
        knots.extend(inner);
        knots.extend(vec![high; degree + 1]);
        Basis { degree, knots }
    }

    pub fn degree(&self) -> usize {
        self.degree
    }

    pub fn spans(&self) -> usize {
        self.knots.len() - 1 - 2 * self.degree
    }

    /// How many functions, and so control points, there are.
    pub fn count(&self) -> usize {
        self.spans() + self.degree
    }

    /// The length of a span in mm.
    pub fn spacing(&self) -> f64 {
        (self.knots[self.knots.len() - 1] - self.knots[0]) / self.spans() as f64
    }

    /// The span that holds u: functions `span` to `span + degree` are not zero there. Outside of the
    /// domain the span at its end.
    pub fn span(&self, u: f64) -> usize {
        let inner = &self.knots[self.degree + 1..self.knots.len() - self.degree - 1];
        inner.partition_point(|knot| *knot <= u)
    }

    /// The functions of a span at u.
    pub fn values(&self, span: usize, u: f64) -> Local {
        self.recursion(span, u, self.degree)
    }

    /// Their derivatives in 1/mm.
    pub fn gradients(&self, span: usize, u: f64) -> Local {
        let p = self.degree;
        let lower = self.recursion(span, u, p - 1);
        let mut gradients = [0.0; MOST_DEGREE + 1];
        for (j, gradient) in gradients.iter_mut().enumerate().take(p + 1) {
            let i = span + j;
            if j > 0 {
                *gradient += p as f64 * lower[j - 1] / (self.knots[i + p] - self.knots[i]);
            }
            if j < p {
                *gradient -= p as f64 * lower[j] / (self.knots[i + p + 1] - self.knots[i + 1]);
            }
        }
        gradients
    }

    /// Their derivatives of the order of the degree, constant in a span, in 1/mm^degree.
    pub fn highest_derivatives(&self, span: usize) -> Local {
        let p = self.degree;
        std::array::from_fn(|j| {
            if j > p {
                return 0.0;
            }
            // The control values of the k-th derivative are scaled differences of those before.
            let mut values = [0.0; MOST_DEGREE + 1];
            values[j] = 1.0;
            for order in 1..=p {
                for at in 0..=p - order {
                    let i = span + at + order;
                    let width = self.knots[i + p + 1 - order] - self.knots[i];
                    values[at] = (p + 1 - order) as f64 * (values[at + 1] - values[at]) / width;
                }
            }
            values[0]
        })
    }

    /// The Greville points, ascending, in mm.
    pub fn greville(&self) -> Vec<f64> {
        let p = self.degree;
        let mean = |i: usize| self.knots[i + 1..=i + p].iter().sum::<f64>() / p as f64;
        (0..self.count()).map(mean).collect()
    }

    /// The functions of the given degree that are not zero in a span, in place: each pass of the recursion
    /// shares a function out to the two above it.
    fn recursion(&self, span: usize, u: f64, degree: usize) -> Local {
        let here = span + self.degree;
        let mut values = [0.0; MOST_DEGREE + 1];
        values[0] = 1.0;
        for p in 1..=degree {
            let mut from_left = 0.0;
            for (r, value) in values[..p].iter_mut().enumerate() {
                let (left, right) = (self.knots[here + 1 + r - p], self.knots[here + 1 + r]);
                let share = *value / (right - left);
                *value = from_left + (right - u) * share;
                from_left = (u - left) * share;
            }
            values[p] = from_left;
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// docs/verification.md#v20: clamped cubic with 5 functions and the inner knot 0.5, clamped quadratic with 4, at 0.3.
    #[test]
    fn the_functions_are_those_of_the_recursion() {
        let cubic = Basis::clamped(3, 2, [0.0, 1.0]);
        assert_eq!((cubic.count(), cubic.span(0.3)), (5, 0));
        for (found, exact) in cubic.values(0, 0.3).into_iter().zip([0.064, 0.558, 0.324, 0.054]) {
            assert!((found - exact).abs() < 1e-15);
        }
        let quadratic = Basis::clamped(2, 2, [0.0, 1.0]);
        assert_eq!(quadratic.count(), 4);
        for (found, exact) in quadratic.values(0, 0.3).into_iter().zip([0.16, 0.66, 0.18, 0.0]) {
            assert!((found - exact).abs() < 1e-15);
        }
    }

    #[test]
    fn control_values_at_the_greville_points_are_the_identity() {
        for degree in 1..=3 {
            for spans in 1..6 {
                let basis = Basis::clamped(degree, spans, [-2.0, 3.0]);
                let greville = basis.greville();
                for step in 0..=40 {
                    let u = -2.0 + step as f64 / 8.0;
                    let span = basis.span(u);
                    let values = basis.values(span, u);
                    let sum: f64 = (0..=degree).map(|j| values[j] * greville[span + j]).sum();
                    assert!((sum - u).abs() < 1e-14, "{degree} {spans} {u}: {sum}");
                    assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                }
            }
        }
        let five = Basis::clamped(3, 2, [0.0, 1.0]).greville();
        for (found, exact) in five.into_iter().zip([0.0, 1.0 / 6.0, 0.5, 5.0 / 6.0, 1.0]) {
            assert!((found - exact).abs() < 1e-15);
        }
    }

    /// Central differences err by the square of the step times a third derivative of at most 200.
    #[test]
    fn gradients_are_the_derivatives_of_the_values() {
        for degree in 1..=3 {
            let basis = Basis::clamped(degree, 4, [0.0, 2.0]);
            for u in [0.1, 0.6, 1.3, 1.9] {
                let span = basis.span(u);
                let found = basis.gradients(span, u);
                let (up, down) = (basis.values(span, u + 1e-5), basis.values(span, u - 1e-5));
                for j in 0..=degree {
                    assert!((found[j] - (up[j] - down[j]) / 2e-5).abs() < 1e-7, "{degree} {u} {j}");
                }
            }
        }
    }

    #[test]
    fn the_highest_derivative_of_a_power_is_its_factorial_and_of_a_lower_one_zero() {
        // Control values of u^3 and of u: the blossoms of the knots around each function.
        let basis = Basis::clamped(3, 3, [0.0, 3.0]);
        for span in 0..3 {
            let derivatives = basis.highest_derivatives(span);
            let over = |blossom: &dyn Fn(&[f64]) -> f64| -> f64 {
                (0..4)
                    .map(|j| derivatives[j] * blossom(&basis.knots[span + j + 1..span + j + 4]))
                    .sum()
            };
            assert!((over(&|t| t[0] * t[1] * t[2]) - 6.0).abs() < 1e-12);
            assert!(over(&|t| (t[0] + t[1] + t[2]) / 3.0).abs() < 1e-12);
        }
    }
}
