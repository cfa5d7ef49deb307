//! Orientation of a cell: determinants of its Jacobian at corners and Gauss points.
//!
//! J(ξ) = Σ x_a ⊗ ∇N_a(ξ)        positive det J where stiffness is integrated = a usable cell
//!
//! Gauss points are 2x2x2 for hexahedra, three of the triangle by two along the axis for wedges.
//! Whether det J is positive everywhere in between is asked in `jacobian`.
//!
//! Source: Hughes, The Finite Element Method, Dover 2000, sections 3.5 (shape functions) and 3.8 (Gauss rules).

use std::sync::LazyLock;

use super::{CellShape, Vector, VolumeMesh};

/// Gradients of all shape functions at one point of the reference cell.
type Gradients = Vec<Vector>;

/// Where the determinant of one shape is looked at.
struct SamplePoints {
    corners: Vec<Gradients>,
    gauss: Vec<Gradients>,
}

static HEXAHEDRON: LazyLock<SamplePoints> = LazyLock::new(|| {
    let at = 1.0 / 3.0_f64.sqrt();
    SamplePoints {
        corners: HEXAHEDRON_CORNERS.iter().map(hexahedron_gradients).collect(),
        gauss: HEXAHEDRON_CORNERS
            .iter()
            .map(|corner| hexahedron_gradients(&corner.map(|sign| sign * at)))
            .collect(),
    }
});

static WEDGE: LazyLock<SamplePoints> = LazyLock::new(|| {
    let at = 1.0 / 3.0_f64.sqrt();
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let inner = triangle.map(|point| point.map(|coordinate: f64| coordinate / 2.0 + 1.0 / 6.0));
    let both_ends = |points: [[f64; 2]; 3], end: f64| {
        let ends = [-end, end].into_iter();
        ends.flat_map(move |z| points.map(|[x, y]| wedge_gradients(x, y, z))).collect()
    };
    SamplePoints { corners: both_ends(triangle, 1.0), gauss: both_ends(inner, at) }
});

const HEXAHEDRON_CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// N_a = (1 + ξ ξ_a)(1 + η η_a)(1 + ζ ζ_a) / 8.
fn hexahedron_gradients(&[x, y, z]: &[f64; 3]) -> Gradients {
    let gradient = |&[a, b, c]: &[f64; 3]| {
        let (p, q, r) = (1.0 + x * a, 1.0 + y * b, 1.0 + z * c);
        Vector::new(a * q * r, p * b * r, p * q * c) / 8.0
    };
    HEXAHEDRON_CORNERS.iter().map(gradient).collect()
}

/// N_a = L_a(ξ, η) (1 ∓ ζ) / 2 with the area coordinates L of the triangle.
fn wedge_gradients(x: f64, y: f64, z: f64) -> Gradients {
    let areas = [(1.0 - x - y, -1.0, -1.0), (x, 1.0, 0.0), (y, 0.0, 1.0)];
    let ends = [-1.0, 1.0].into_iter();
    ends.flat_map(|end| {
        areas.map(|(area, by_x, by_y)| {
            let height = (1.0 + end * z) / 2.0;
            Vector::new(by_x * height, by_y * height, area * end / 2.0)
        })
    })
    .collect()
}

/// The extremes of det J over the corners and over the Gauss points of one cell, in mm³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellJacobian {
    pub corner_min: f64,
    pub corner_max: f64,
    pub gauss_min: f64,
    pub gauss_max: f64,
}

impl CellJacobian {
    /// Positive at every Gauss point, so that a stiffness matrix can be formed.
    pub fn is_valid(&self) -> bool {
        self.gauss_min > 0.0
    }

    /// The mirror image is valid: the file numbers the nodes of this cell the other way round.
    pub fn is_reversed(&self) -> bool {
        self.gauss_max < 0.0
    }
}

impl VolumeMesh {
    /// The Jacobian determinants of a cell.
    pub fn cell_jacobian(&self, cell: usize) -> CellJacobian {
        let mut corners = [Vector::zeros(); 8];
        for (slot, corner) in corners.iter_mut().zip(self.corners(cell)) {
            *slot = corner;
        }
        match self.cells.shape(cell) {
            CellShape::Tet4 => tetrahedron_jacobian(&corners),
            CellShape::Hex8 => sampled_jacobian(&HEXAHEDRON, &corners),
            CellShape::Wedge6 => sampled_jacobian(&WEDGE, &corners),
        }
    }

    /// Renumbers the nodes of a cell so that it is its own mirror image: the same cell with the
    /// other sign of det J.
    pub fn reverse_cell(&mut self, cell: usize) {
        let shape = self.cells.shape(cell);
        let nodes = self.cells.nodes_mut(cell);
        match shape {
            CellShape::Tet4 => nodes.swap(1, 2),
            CellShape::Hex8 => {
                let (bottom, top) = nodes.split_at_mut(4);
                bottom.swap_with_slice(top);
            }
            // The way in which the two conventions for wedges in VTK files differ.
            CellShape::Wedge6 => {
                nodes.swap(1, 2);
                nodes.swap(4, 5);
            }
        }
    }
}

fn tetrahedron_jacobian(corners: &[Vector; 8]) -> CellJacobian {
    let [a, b, c, d, ..] = corners;
    let determinant = (b - a).cross(&(c - a)).dot(&(d - a));
    CellJacobian {
        corner_min: determinant,
        corner_max: determinant,
        gauss_min: determinant,
        gauss_max: determinant,
    }
}

fn sampled_jacobian(points: &SamplePoints, corners: &[Vector; 8]) -> CellJacobian {
    let mut jacobian = CellJacobian {
        corner_min: f64::INFINITY,
        corner_max: f64::NEG_INFINITY,
        gauss_min: f64::INFINITY,
        gauss_max: f64::NEG_INFINITY,
    };
    for gradients in &points.corners {
        let determinant = determinant_at(gradients, corners);
        jacobian.corner_min = jacobian.corner_min.min(determinant);
        jacobian.corner_max = jacobian.corner_max.max(determinant);
    }
    for gradients in &points.gauss {
        let determinant = determinant_at(gradients, corners);
        jacobian.gauss_min = jacobian.gauss_min.min(determinant);
        jacobian.gauss_max = jacobian.gauss_max.max(determinant);
    }
    jacobian
}

fn determinant_at(gradients: &Gradients, corners: &[Vector; 8]) -> f64 {
    let mut columns = [Vector::zeros(); 3];
    for (gradient, corner) in gradients.iter().zip(corners) {
        for (column, component) in columns.iter_mut().zip(gradient.iter()) {
            *column += corner * *component;
        }
    }
    columns[0].cross(&columns[1]).dot(&columns[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_cell(shape: CellShape, corners: &[[f64; 3]]) -> VolumeMesh {
        let mut mesh = VolumeMesh {
            nodes: corners.iter().map(|&corner| corner.into()).collect(),
            ..VolumeMesh::default()
        };
        let nodes: Vec<u32> = (0..corners.len() as u32).collect();
        mesh.cells.push(shape, &nodes);
        mesh
    }

    fn box_2_by_3_by_4() -> Vec<[f64; 3]> {
        let half = |[x, y, z]: [f64; 3]| [x, y * 1.5, z * 2.0];
        HEXAHEDRON_CORNERS.map(half).to_vec()
    }

    #[test]
    fn the_determinant_of_a_box_is_its_volume_over_that_of_the_reference_cell() {
        let corners = box_2_by_3_by_4();
        let hexahedron = one_cell(CellShape::Hex8, &corners).cell_jacobian(0);
        let half = [0, 1, 2, 4, 5, 6].map(|corner| corners[corner]);
        let wedge = one_cell(CellShape::Wedge6, &half).cell_jacobian(0);
        // 24 mm³ over 8, and 12 mm³ over 1.
        for (jacobian, expected) in [(hexahedron, 3.0), (wedge, 12.0)] {
            let CellJacobian { corner_min, corner_max, gauss_min, gauss_max } = jacobian;
            for determinant in [corner_min, corner_max, gauss_min, gauss_max] {
                // Rounding of eight products.
                assert!((determinant - expected).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn reversing_a_cell_changes_the_sign_of_its_jacobian() {
        let corners = box_2_by_3_by_4();
        let tetrahedron = [0, 1, 2, 4].map(|corner| corners[corner]);
        let wedge = [0, 1, 2, 4, 5, 6].map(|corner| corners[corner]);
        for mut mesh in [
            one_cell(CellShape::Tet4, &tetrahedron),
            one_cell(CellShape::Hex8, &corners),
            one_cell(CellShape::Wedge6, &wedge),
        ] {
            let before = mesh.cell_jacobian(0);
            mesh.reverse_cell(0);
            let after = mesh.cell_jacobian(0);
            assert!((before.gauss_min + after.gauss_max).abs() < 1e-13);
            assert!(before.is_valid() && after.is_reversed());
        }
    }
}
