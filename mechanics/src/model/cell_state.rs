//! Stress and strain of cells.

use nalgebra::Matrix3;

/// Stress and strain of the cells of a solution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellStates {
    /// In cell order; empty where it was not asked for or the model has none.
    pub cells: Vec<CellState>,
    /// Whether the strain is Green's (F^T F - 1) / 2 and not small strain.
    pub is_green: bool,
}

/// Mean stress and strain of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellState {
    /// Cauchy's stress in kPa, symmetric; tension is positive.
    pub stress: Matrix3<f64>,
    /// Tensor components, so that shear is half of an angle: small strain, at finite strain that of Green. Growth is part of it.
    pub strain: Matrix3<f64>,
}

impl CellState {
    /// xx, yy, zz, xy, yz, xz of the stress in kPa.
    pub fn stress_components(&self) -> [f64; 6] {
        components(&self.stress)
    }

    /// xx, yy, zz, xy, yz, xz of the strain.
    pub fn strain_components(&self) -> [f64; 6] {
        components(&self.strain)
    }

    /// -tr sigma / 3 in kPa, positive where tissue is pressed.
    pub fn pressure(&self) -> f64 {
        -self.stress.trace() / 3.0
    }

    /// Mises' stress sqrt(3/2 s : s) in kPa, s the deviator of the stress.
    pub fn von_mises(&self) -> f64 {
        let deviator = self.stress + Matrix3::from_diagonal_element(self.pressure());
        (1.5 * deviator.norm_squared()).sqrt()
    }
}

fn components(tensor: &Matrix3<f64>) -> [f64; 6] {
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|at| tensor[at])
}
