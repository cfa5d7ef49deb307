//! Ten-node tetrahedron with straight edges: N_a = L_a (2 L_a - 1) at corners, N_ab = 4 L_a L_b on edges,
//! L the barycentric coordinates. Edges in the order of VTK: 01, 12, 20, 03, 13, 23.
//!
//! Quadrature: four points with barycentric coordinates (alpha, beta, beta, beta), exact for the products of
//! linear gradients that the stiffness is made of (Zienkiewicz, Taylor, The Finite Element Method,
//! 5th ed., vol. 1, table 9.2).

use super::reference_cell::Vector;

/// The corners of each edge.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

const ALPHA: f64 = 0.585_410_196_624_968_5;
const BETA: f64 = 0.138_196_601_125_010_5;

/// The quadrature points, each a quarter of the volume.
pub fn points() -> [[f64; 4]; 4] {
    std::array::from_fn(|q| std::array::from_fn(|a| if a == q { ALPHA } else { BETA }))
}

/// Values of the shape functions at a point.
pub fn values(l: &[f64; 4]) -> [f64; 10] {
    std::array::from_fn(|k| match k {
        0..4 => l[k] * (2.0 * l[k] - 1.0),
        _ => EDGES[k - 4].iter().map(|&a| l[a]).product::<f64>() * 4.0,
    })
}

/// Gradients of the shape functions at a point, from those of the barycentric coordinates.
pub fn gradients(l: &[f64; 4], of_barycentric: &[Vector; 4]) -> [Vector; 10] {
    std::array::from_fn(|k| match k {
        0..4 => of_barycentric[k] * (4.0 * l[k] - 1.0),
        _ => {
            let [a, b] = EDGES[k - 4];
            (of_barycentric[b] * l[a] + of_barycentric[a] * l[b]) * 4.0
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_are_one_at_their_own_node_and_zero_at_the_others() {
        for node in 0..10 {
            let mut l = [0.0; 4];
            match node {
                0..4 => l[node] = 1.0,
                _ => EDGES[node - 4].iter().for_each(|&a| l[a] = 0.5),
            }
            for (k, value) in values(&l).into_iter().enumerate() {
                assert_eq!(value, if k == node { 1.0 } else { 0.0 });
            }
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_values() {
        // On the unit tetrahedron L = (1 - x - y - z, x, y, z); central differences err by step² alone.
        let unit = [-Vector::new(1.0, 1.0, 1.0), Vector::x(), Vector::y(), Vector::z()];
        let barycentric = |x: &Vector| [1.0 - x.sum(), x.x, x.y, x.z];
        let (at, step) = (Vector::new(0.2, 0.3, 0.1), 1e-5);
        let found = gradients(&barycentric(&at), &unit);
        for axis in 0..3 {
            let mut shift = Vector::zeros();
            shift[axis] = step;
            let (up, down) =
                (values(&barycentric(&(at + shift))), values(&barycentric(&(at - shift))));
            for k in 0..10 {
                assert!((found[k][axis] - (up[k] - down[k]) / (2.0 * step)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_quadrature_is_exact_for_products_of_two_coordinates() {
        // int L_a L_b = V (1 + delta_ab) / 20.
        for a in 0..4 {
            for b in 0..4 {
                let sum: f64 = points().iter().map(|l| l[a] * l[b] / 4.0).sum();
                let exact = if a == b { 0.1 } else { 0.05 };
                assert!((sum - exact).abs() < 1e-15);
            }
        }
    }
}
