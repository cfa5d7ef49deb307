//! Sampling points of cells: the same in every cell of a shape, in coordinates of the cell.
//!
//! Generators are the R sequence u_k = frac(1/2 + k (1/g, 1/g², 1/g³)), g the positive root of x⁴ = x + 1,
//! which fills the cube with low discrepancy (Roberts, The Unreasonable Effectiveness of Quasirandom
//! Sequences, 2018). Sorted, the three numbers of u_k are the cuts of [0, 1] into four barycentric
//! coordinates, uniform over the tetrahedron. Each generator stands with its images under the cyclic
//! changes of the corners of a tetrahedron, the even changes of sign in a hexahedron, and the cyclic
//! changes of the triangle with the change of sign along a wedge; what is then missing to the count is made of
//! the centre and of pairs about it. So the mean of all points is the centre of the cell at every count, and
//! the mean of a linear field is its value there.

use crate::mesh::{CellShape, Vector};

/// As many points as the finest sampling of Zachow et al. 2006, section 3.5.
pub const MOST_SAMPLES: usize = 512;

/// 1/g, 1/g², 1/g³.
const STEPS: [f64; 3] = [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3];

/// The weights of the corners of a cell at each of its sample points.
#[derive(Clone, Debug)]
pub struct SamplingRule {
    pub count: usize,
    tetrahedron: Vec<[f64; 4]>,
    hexahedron: Vec<[f64; 8]>,
    wedge: Vec<[f64; 6]>,
}

/// The k-th point of the sequence, from 1.
fn generator(k: usize) -> [f64; 3] {
    STEPS.map(|step| (0.5 + k as f64 * step).fract())
}

impl SamplingRule {
    /// `count` points in each cell, from 1 to [`MOST_SAMPLES`]; a count outside is taken to the nearest end.
    pub fn new(count: usize) -> Self {
        let count = count.clamp(1, MOST_SAMPLES);
        SamplingRule {
            count,
            tetrahedron: tetrahedron(count),
            hexahedron: hexahedron(count).into_iter().map(of_hexahedron).collect(),
            wedge: wedge(count).into_iter().map(of_wedge).collect(),
        }
    }

    /// Calls `each` with every sample point of a cell with these corners.
    pub fn for_each(&self, shape: CellShape, corners: &[Vector], each: impl FnMut(Vector)) {
        match shape {
            CellShape::Tet4 => at_weights(&self.tetrahedron, corners, each),
            CellShape::Hex8 => at_weights(&self.hexahedron, corners, each),
            CellShape::Wedge6 => at_weights(&self.wedge, corners, each),
        }
    }
}

fn at_weights<const N: usize>(rule: &[[f64; N]], corners: &[Vector], mut each: impl FnMut(Vector)) {
    for weights in rule {
        let terms = weights.iter().zip(corners);
        each(terms.fold(Vector::zeros(), |sum, (&weight, corner)| sum + corner * weight));
    }
}

/// Barycentric coordinates.
fn tetrahedron(count: usize) -> Vec<[f64; 4]> {
    let point = |k: usize| {
        let mut cuts = generator(k);
        cuts.sort_by(f64::total_cmp);
        let [a, b, c] = cuts;
        [a, b - a, c - b, 1.0 - c]
    };
    let full = count / 4;
    let mut points = Vec::with_capacity(count);
    for k in 1..=full {
        let [a, b, c, d] = point(k);
        points.extend([[a, b, c, d], [d, a, b, c], [c, d, a, b], [b, c, d, a]]);
    }
    if count % 4 >= 2 {
        let [a, b, ..] = point(full + 1);
        let half = (a + b) / 2.0;
        points.extend([[half, half, 0.5 - half, 0.5 - half], [0.5 - half, 0.5 - half, half, half]]);
    }
    if count % 2 == 1 {
        points.push([0.25; 4]);
    }
    points
}

/// Coordinates in [-1, 1]³.
fn hexahedron(count: usize) -> Vec<[f64; 3]> {
    let point = |k: usize| generator(k).map(|u| 2.0 * u - 1.0);
    let full = count / 4;
    let mut points = Vec::with_capacity(count);
    for k in 1..=full {
        let [x, y, z] = point(k);
        points.extend([[x, y, z], [x, -y, -z], [-x, y, -z], [-x, -y, z]]);
    }
    if count % 4 >= 2 {
        let [x, y, z] = point(full + 1);
        points.extend([[x, y, z], [-x, -y, -z]]);
    }
    if count % 2 == 1 {
        points.push([0.0; 3]);
    }
    points
}

/// N_i = (1 + a_i x)(1 + b_i y)(1 + c_i z) / 8.
fn of_hexahedron([x, y, z]: [f64; 3]) -> [f64; 8] {
    let signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)];
    std::array::from_fn(|node| {
        let (a, b) = signs[node % 4];
        let c = if node < 4 { -1.0 } else { 1.0 };
        (1.0 + f64::from(a) * x) * (1.0 + f64::from(b) * y) * (1.0 + c * z) / 8.0
    })
}

/// Barycentric coordinates in the triangle, and the coordinate in [-1, 1] along the wedge.
fn wedge(count: usize) -> Vec<([f64; 3], f64)> {
    let point = |k: usize| {
        let [u, v, w] = generator(k);
        let (low, high) = (u.min(v), u.max(v));
        ([low, high - low, 1.0 - high], 2.0 * w - 1.0)
    };
    let full = count / 6;
    let mut points = Vec::with_capacity(count);
    for k in 1..=full {
        let ([a, b, c], z) = point(k);
        for triangle in [[a, b, c], [c, a, b], [b, c, a]] {
            points.extend([(triangle, z), (triangle, -z)]);
        }
    }
    let (third, rest) = ([1.0 / 3.0; 3], count % 6);
    let ([a, b, c], z) = point(full + 1);
    if rest >= 3 {
        points.extend([([a, b, c], 0.0), ([c, a, b], 0.0), ([b, c, a], 0.0)]);
    }
    if rest % 3 == 2 {
        points.extend([(third, z), (third, -z)]);
    }
    if rest % 3 == 1 {
        points.push((third, 0.0));
    }
    points
}

fn of_wedge((triangle, z): ([f64; 3], f64)) -> [f64; 6] {
    std::array::from_fn(|node| {
        let along = if node < 3 { 1.0 - z } else { 1.0 + z };
        triangle[node % 3] * along / 2.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> impl Iterator<Item = (usize, SamplingRule)> {
        (1..=MOST_SAMPLES).map(|count| (count, SamplingRule::new(count)))
    }

    /// The largest distance of the mean of the weights from equal ones, and the smallest weight.
    fn balance<const N: usize>(rule: &[[f64; N]]) -> (f64, f64) {
        let mean = |corner: usize| rule.iter().map(|w| w[corner]).sum::<f64>() / rule.len() as f64;
        let off = (0..N).map(|corner| (mean(corner) - 1.0 / N as f64).abs()).fold(0.0, f64::max);
        (off, rule.iter().flatten().copied().fold(1.0, f64::min))
    }

    #[test]
    fn points_are_as_many_as_asked_for_inside_the_cell_and_in_a_tetrahedron_balanced() {
        for (count, rule) in rows() {
            let counts = [rule.tetrahedron.len(), rule.hexahedron.len(), rule.wedge.len()];
            assert_eq!(counts, [count; 3]);
            // Rounding of 512 sums. The weights of a hexahedron are products: their means say nothing.
            let (off, smallest) = balance(&rule.tetrahedron);
            assert!(off < 1e-14 && smallest >= 0.0, "{count}: {off} {smallest}");
            for (_, smallest) in [balance(&rule.hexahedron), balance(&rule.wedge)] {
                assert!(smallest >= 0.0, "{count}: {smallest}");
            }
        }
    }

    #[test]
    fn the_steps_are_powers_of_the_root_of_the_sequence() {
        let g = 1.0 / STEPS[0];
        assert!((g.powi(4) - g - 1.0).abs() < 1e-14);
        assert!(
            (STEPS[1] * g * g - 1.0).abs() < 1e-14 && (STEPS[2] * g.powi(3) - 1.0).abs() < 1e-14
        );
    }
}
