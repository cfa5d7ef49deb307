//! The skin as a membrane on tissue at finite strain (`model::fem::membrane`).

use super::elements::rounded;
use super::problem::FiniteStrain;
use crate::mesh::Vector;
use crate::model::dofs::{DofMap, add_cell};
use crate::model::fem::membrane::Triangle;
use crate::model::fem::stretched_membrane::Stretched;
use crate::solver::Block;
use crate::solver::half_matrix::HalfMatrix;

/// A triangle of the skin, and the rows of its corners.
struct Part {
    triangle: Triangle,
    rows: [u32; 3],
}

/// The triangles of the skin; none where it is no membrane.
pub(super) struct Sheet {
    parts: Vec<Part>,
}

impl Sheet {
    pub fn new(problem: &FiniteStrain, dof_map: &DofMap) -> Self {
        let triangles = problem.membrane.iter().flat_map(|skin| skin.in_space(problem.mesh));
        let parts = triangles.map(|(triangle, nodes)| {
            let rows = nodes.map(|node| dof_map.row(node) as u32);
            Part { triangle, rows }
        });
        Sheet { parts: parts.collect() }
    }

    /// As of cells: what rounding of a force and of an energy is relative to.
    pub fn moduli(&self, farthest: f64) -> impl Iterator<Item = (f64, f64)> {
        let triangles = self.parts.iter().map(|part| &part.triangle);
        triangles.map(move |own| rounded(own.modulus(), &own.gradients, farthest))
    }

    /// At positions, one for each row.
    pub fn at(&self, x: &[Vector]) -> DeformedSheet<'_> {
        let parts = self.parts.iter();
        let parts = parts.map(|part| {
            let corners = part.rows.map(|row| x[row as usize]);
            (part, part.triangle.at(&corners))
        });
        DeformedSheet { parts: parts.collect() }
    }
}

/// The triangles of the skin at positions.
pub(super) struct DeformedSheet<'a> {
    parts: Vec<(&'a Part, Stretched<'a>)>,
}

impl DeformedSheet<'_> {
    /// Adds internal forces in mN, by row.
    pub fn add_forces(&self, forces: &mut [Vector]) {
        for (part, stretched) in &self.parts {
            for (&row, g) in part.rows.iter().zip(&part.triangle.gradients) {
                forces[row as usize] += stretched.force(g);
            }
        }
    }

    /// Adds the derivatives of the internal forces by the positions, in kPa mm.
    pub fn add_tangent(&self, matrix: &mut HalfMatrix<f64, 3>) {
        for (part, stretched) in &self.parts {
            let g = &part.triangle.gradients;
            let block = |entry: usize| -> Block {
                let block = stretched.pair(&g[entry / 3], &g[entry % 3]);
                std::array::from_fn(|i| std::array::from_fn(|j| block[(i, j)]))
            };
            let blocks: [Block; 9] = std::array::from_fn(block);
            add_cell(matrix, &part.rows, &blocks);
        }
    }

    /// In mN mm.
    pub fn energy(&self) -> f64 {
        self.parts.iter().map(|(_, stretched)| stretched.energy()).sum()
    }
}
