//! Tensors of a tetrahedron with the full Green strain: its force as a cubic polynomial of nodal displacements.
//!
//! With v_k the displacement of corner k = 1, 2, 3 from that of corner 0, g_k the gradients of their shape functions,
//! G_ab = g_a . g_b and s_ab = v_a . v_b, the energy of Saint Venant-Kirchhoff tissue, lambda/2 (tr E)^2 + mu tr E^2, is
//!   W = 1/2 sum_ab v_a . K_ab v_b + sum_abc s_ab v_c . C_abc + sum_abcd D_abcd s_ab s_cd,
//!   K_ab = V [ lambda g_a g_b^T + mu g_b g_a^T + mu G_ab I ],
//!   C_abc = V/2 [ lambda G_ab g_c + mu (G_ca g_b + G_cb g_a) ],
//!   D_abcd = V/8 [ lambda G_ab G_cd + mu (G_ac G_bd + G_ad G_bc) ]
//! (Kim et al. 2012, section 3.3; Picinbono, Delingette, Ayache 2003, with their indices on differences of displacement, which
//! leaves 3 corners of 4). Force and tangent are its derivatives.

use nalgebra::Matrix3;

use crate::mesh::Vector;
use crate::mesh::VolumeMesh;
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::problem::InvertedCell;
use crate::solver::Block;

/// Lame's constants in kPa.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants {
    pub lambda: f64,
    pub mu: f64,
}

/// The tensors of a cell: in mN/mm, mN/mm^2 and mN/mm^3.
pub(super) struct Tensors {
    linear: [[Matrix3<f64>; 3]; 3],
    quadratic: [[[Vector; 3]; 3]; 3],
    cubic: [[[[f64; 3]; 3]; 3]; 3],
}

/// Displacements of three corners from that of the first, in mm.
pub(super) type Differences = [Vector; 3];

/// The parts of force and tangent that belong to the lengths and angles between differences.
struct Lengths {
    /// v_a . v_b
    products: [[f64; 3]; 3],
    /// 2 sum_c v_c . C_abc + 4 sum_cd D_abcd s_cd
    along: [[f64; 3]; 3],
}

fn each<T>(make: impl Fn(usize) -> T) -> [T; 3] {
    std::array::from_fn(make)
}

impl Tensors {
    pub fn new(
        mesh: &VolumeMesh,
        cell: usize,
        Constants { lambda, mu }: Constants,
    ) -> Result<Self, InvertedCell> {
        let (volume, [_, g @ ..]) = tetrahedron(mesh, cell)?;
        let products = each(|a| each(|b| g[a].dot(&g[b])));
        let linear = |a: usize, b: usize| {
            let outer = g[a] * g[b].transpose() * lambda + g[b] * g[a].transpose() * mu;
            (outer + Matrix3::from_diagonal_element(mu * products[a][b])) * volume
        };
        let quadratic = |a: usize, b: usize, c: usize| {
            let across = g[b] * products[c][a] + g[a] * products[c][b];
            (g[c] * (lambda * products[a][b]) + across * mu) * (0.5 * volume)
        };
        let cubic = |a: usize, b: usize, c: usize, d: usize| {
            let across = products[a][c] * products[b][d] + products[a][d] * products[b][c];
            0.125 * volume * (lambda * products[a][b] * products[c][d] + mu * across)
        };
        Ok(Tensors {
            linear: each(|a| each(|b| linear(a, b))),
            quadratic: each(|a| each(|b| each(|c| quadratic(a, b, c)))),
            cubic: each(|a| each(|b| each(|c| each(|d| cubic(a, b, c, d))))),
        })
    }

    /// V (lambda + 2 mu) |g|^2, in mN/mm: what rounding is measured by.
    pub fn stiffness(&self) -> f64 {
        self.linear.iter().enumerate().map(|(k, row)| row[k].trace()).sum()
    }

    fn lengths(&self, v: &Differences) -> Lengths {
        let products = each(|a| each(|b| v[a].dot(&v[b])));
        let along = |a: usize, b: usize| {
            let quadratic: f64 = (0..3).map(|c| v[c].dot(&self.quadratic[a][b][c])).sum();
            2.0 * quadratic + 4.0 * self.contract(a, b, &products)
        };
        Lengths { along: each(|a| each(|b| along(a, b))), products }
    }

    /// sum_cd D_abcd s_cd
    fn contract(&self, a: usize, b: usize, products: &[[f64; 3]; 3]) -> f64 {
        let pairs = self.cubic[a][b].as_flattened().iter().zip(products.as_flattened());
        pairs.map(|(tensor, product)| tensor * product).sum()
    }

    /// In mN mm.
    pub fn energy(&self, v: &Differences) -> f64 {
        let products = each(|a| each(|b| v[a].dot(&v[b])));
        let mut energy = 0.0;
        for a in 0..3 {
            for b in 0..3 {
                energy += 0.5 * v[a].dot(&(self.linear[a][b] * v[b]));
                let quadratic: f64 = (0..3).map(|c| v[c].dot(&self.quadratic[a][b][c])).sum();
                energy += products[a][b] * (quadratic + self.contract(a, b, &products));
            }
        }
        energy
    }

    /// The internal forces of the four corners in mN.
    pub fn forces(&self, v: &Differences) -> [Vector; 4] {
        let Lengths { products, along } = self.lengths(v);
        let own = each(|p| {
            let mut force = Vector::zeros();
            for a in 0..3 {
                force += self.linear[p][a] * v[a] + v[a] * along[p][a];
                for (quadratic, product) in self.quadratic[a].iter().zip(&products[a]) {
                    force += quadratic[p] * *product;
                }
            }
            force
        });
        [-(own[0] + own[1] + own[2]), own[0], own[1], own[2]]
    }

    /// The derivatives of the forces by the displacements of the four corners, row by row, in mN/mm.
    pub fn tangent(&self, v: &Differences) -> [Block; 16] {
        let Lengths { along, .. } = self.lengths(v);
        let own =
            each(|p| each(|q| self.pair(p, q, v) + Matrix3::from_diagonal_element(along[p][q])));
        // Corner 0 moves all differences back.
        let of = |p: usize, q: usize| -> Matrix3<f64> {
            match (p.checked_sub(1), q.checked_sub(1)) {
                (Some(p), Some(q)) => own[p][q],
                (Some(p), None) => -own[p].iter().sum::<Matrix3<f64>>(),
                (None, Some(q)) => -own.iter().map(|row| row[q]).sum::<Matrix3<f64>>(),
                (None, None) => own.as_flattened().iter().sum(),
            }
        };
        std::array::from_fn(|entry| {
            let block = of(entry / 4, entry % 4);
            std::array::from_fn(|i| std::array::from_fn(|j| block[(i, j)]))
        })
    }

    /// K_pq + 2 sum_a (v_a C_paq^T + C_aqp v_a^T) + 8 sum_ab D_paqb v_a v_b^T.
    fn pair(&self, p: usize, q: usize, v: &Differences) -> Matrix3<f64> {
        let mut sum = self.linear[p][q];
        for a in 0..3 {
            let mut right = self.quadratic[p][a][q] * 2.0;
            for (v, cubic) in v.iter().zip(&self.cubic[p][a][q]) {
                right += v * (8.0 * cubic);
            }
            sum += v[a] * right.transpose();
            sum += self.quadratic[a][q][p] * v[a].transpose() * 2.0;
        }
        sum
    }
}
