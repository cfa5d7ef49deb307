//! Points spread evenly over the area of a surface, always the same ones.
//!
//! Inside a triangle they follow the triangular van der Corput sequence: the digits of i in base 4
//! choose one of the four half-size triangles again and again (0 the middle one), and the point is
//! the centroid of the last. The first point is the centroid, the first four are those of the four
//! halves, and so on.
//! Source: Basu, Owen, Low discrepancy constructions in the triangle, SIAM Journal on Numerical
//! Analysis 53 (2015) 743-761, section 3.

use super::{TriangleSurface, Vector};

/// A point that stands for a piece of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaSample {
    pub point: Vector,
    pub triangle: u32,
    /// Of the piece, in mm².
    pub area: f64,
}

/// Points all over a triangle, so many rows of them along each side, its corners among them.
pub fn spread_over([a, b, c]: &[Vector; 3], rows: usize) -> impl Iterator<Item = Vector> {
    let places = (0..=rows).flat_map(move |i| (0..=rows - i).map(move |j| [i, j]));
    places.map(move |steps| {
        let [u, v] = steps.map(|step| step as f64 / rows as f64);
        a + (b - a) * u + (c - a) * v
    })
}

/// How many samples [`every_triangle`] gives.
pub fn count_of_every_triangle(surface: &TriangleSurface, samples_per_mm2: f64) -> f64 {
    (0..surface.triangles.len())
        .map(|triangle| surface.area_vector(triangle).norm())
        .filter(|&area| area > 0.0)
        .map(|area| (area * samples_per_mm2).round().max(1.0))
        .sum()
}

/// At least one sample on every triangle that has an area, more by its area; the areas add up to
/// that of the surface.
pub fn every_triangle(surface: &TriangleSurface, samples_per_mm2: f64) -> Vec<AreaSample> {
    let mut samples = Vec::new();
    for triangle in 0..surface.triangles.len() {
        let area = surface.area_vector(triangle).norm();
        if area > 0.0 {
            let count = (area * samples_per_mm2).round().max(1.0);
            samples.extend((0..count as u64).map(|number| AreaSample {
                point: point_in_triangle(surface, triangle, number),
                triangle: triangle as u32,
                area: area / count,
            }));
        }
    }
    samples
}

/// So many samples, at equal steps of the area counted along the triangles.
pub fn equal_areas(surface: &TriangleSurface, count: usize) -> Vec<AreaSample> {
    let total = surface.area();
    let step = total / count as f64;
    let mut samples = Vec::with_capacity(count);
    let mut covered = 0.0;
    for triangle in 0..surface.triangles.len() {
        covered += surface.area_vector(triangle).norm();
        let mut number = 0;
        while samples.len() < count && (samples.len() as f64 + 0.5) * step < covered {
            let point = point_in_triangle(surface, triangle, number);
            samples.push(AreaSample { point, triangle: triangle as u32, area: step });
            number += 1;
        }
    }
    samples
}

fn point_in_triangle(surface: &TriangleSurface, triangle: usize, number: u64) -> Vector {
    let [a, b, c] = surface.corners(triangle);
    // Few samples lean towards the first corner; which one that is goes round from triangle to triangle.
    let (a, b, c) = match triangle % 3 {
        0 => (a, b, c),
        1 => (b, c, a),
        _ => (c, a, b),
    };
    let [u, v] = van_der_corput(number);
    a + (b - a) * u + (c - a) * v
}

/// The weights of the second and third corner of a point of the sequence.
fn van_der_corput(mut number: u64) -> [f64; 2] {
    let mut corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    while number > 0 {
        let middle =
            |i: usize, j: usize| [0, 1].map(|axis| 0.5 * (corners[i][axis] + corners[j][axis]));
        let halves = [middle(1, 2), middle(2, 0), middle(0, 1)];
        corners = match number & 3 {
            0 => halves,
            1 => [corners[0], halves[2], halves[1]],
            2 => [halves[2], corners[1], halves[0]],
            _ => [halves[1], halves[0], corners[2]],
        };
        number >>= 2;
    }
    [0, 1].map(|axis| (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3.0)
}
