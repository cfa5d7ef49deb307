//! A triangle of a membrane whose corners are moved however far.
//!
//! At finite strain the same stiffness acts on Green's strain in the plane, F = sum x_a g_a^T, E = (F^T F - P) / 2, S = C:E: the energy of
//! the sheet is t int E:S / 2 + s |F - P|^2 / 2 dA, its forces are t int (F S + s (F - P)) g_a dA, and their derivatives
//! t int F C(g_a, g_b) F^T + (g_a.S.g_b + s g_a.g_b) I dA. Turning it strains nothing; pressed in its plane it may wrinkle, and a sheet alone
//! has no energy against that. A sheet that bears no compression has the least energy that wrinkles leave of that of S + s P instead
//! (`material::tension_field`), and with that a limit on finer meshes.

use nalgebra::{Matrix3, Matrix3x2};

use super::membrane::Triangle;
use crate::mesh::Vector;
use crate::solver::Block;

/// A triangle whose corners are moved however far.
pub(super) struct Stretched<'a> {
    triangle: &'a Triangle,
    /// F, whose null vector is the normal at rest.
    gradient: Matrix3<f64>,
    /// P.
    pub plane: Matrix3<f64>,
    /// S with what is there at rest, in kPa.
    pub stress: Matrix3<f64>,
    /// Without that of what balances the tension at rest, which does not follow; in kPa.
    energy: f64,
    /// The tangent in the plane where the sheet bears no compression.
    relaxed: Option<(Matrix3x2<f64>, Matrix3<f64>)>,
}

impl Stretched<'_> {
    /// In mN mm.
    pub fn energy(&self) -> f64 {
        self.triangle.volume * self.energy
    }

    /// In mN, at a node of this gradient.
    pub fn force(&self, g: &Vector) -> Vector {
        let stress = self.gradient * self.stress - self.plane * self.triangle.tension;
        stress * g * self.triangle.volume
    }

    /// The derivative of the force at a node by the position of another one, in kPa mm.
    pub fn pair(&self, gj: &Vector, gk: &Vector) -> Matrix3<f64> {
        let Triangle { volume, tensor, .. } = self.triangle;
        let own = match &self.relaxed {
            Some((axes, tangent)) => {
                let turned = self.gradient * axes;
                let strain = |g: &Vector| {
                    let ([a, b], f) = ([axes.column(0).dot(g), axes.column(1).dot(g)], turned);
                    Matrix3::from_columns(&[
                        f.column(0) * a,
                        f.column(1) * b,
                        f.column(0) * b + f.column(1) * a,
                    ])
                };
                strain(gj) * tangent * strain(gk).transpose() * *volume
            }
            None => {
                let mut block: Block = [[0.0; 3]; 3];
                tensor.add_pair(&mut block, [gj, gk], *volume);
                let own = Matrix3::from_fn(|i, j| block[i][j]);
                self.gradient * own * self.gradient.transpose()
            }
        };
        own + Matrix3::from_diagonal_element(volume * gj.dot(&(self.stress * gk)))
    }
}

impl Triangle {
    /// With its corners at these positions.
    pub fn at(&self, corners: &[Vector; 3]) -> Stretched<'_> {
        let plane = Matrix3::identity() - self.normal * self.normal.transpose();
        let moved = corners.iter().zip(&self.gradients);
        let gradient: Matrix3<f64> = moved.map(|(x, g)| x * g.transpose()).sum();
        let strain = (gradient.transpose() * gradient - plane) * 0.5;
        let (slope, of_strain) = (gradient - plane, self.tensor.stress(&strain));
        let carried = Stretched {
            triangle: self,
            gradient,
            plane,
            stress: of_strain + plane * self.tension,
            energy: 0.5 * (strain.dot(&of_strain) + self.tension * slope.norm_squared()),
            relaxed: None,
        };
        match &self.tension_only {
            None => carried,
            Some(own) => {
                let found = own.at(&strain);
                let energy = found.energy - own.energy_at_rest() - self.tension * slope.dot(&plane);
                let relaxed = Some((*own.axes(), found.tangent));
                Stretched { stress: own.in_space(&found.stress), energy, relaxed, ..carried }
            }
        }
    }
}
