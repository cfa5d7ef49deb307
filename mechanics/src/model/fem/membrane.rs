//! Skin as a membrane: a thin sheet on faces of the tissue that resists stretching in its plane and no bending.
//!
//! On a triangle of normal n and area A the strain is that of the displacement in its plane,
//! eps = P sym(grad u) P, P = I - n n^T, and with the plane stress C of `material::plane_stress`
//!   K_jk = t int P g_j.C.g_k P dA = t sum_q A_q { lambda g_j g_k^T + mu [ g_k g_j^T + (g_j.g_k) P ] + lines },
//! because gradients of shape functions and lines lie in the plane. On linear cells the triangles have constant
//! strain; quadrilaterals are cut along their shorter diagonal. Quadratic cells have six-node triangles, of the same
//! displacement as the face below them; four triangles of three nodes would have another one between nodes, and
//! lose an order. Three points in the middles of the sides integrate them exactly.
//!
//! A sheet that is under a stress s at rest, in balance with the tissue below, resists its own slopes too: t s int (g_j.g_k) I dA, the
//! stiffness of a stretched skin. Its energy t s |grad u|^2 / 2 is that of the second Piola-Kirchhoff stress s P whatever the
//! displacement, so that it adds nothing of a higher order. What balances it at rest is left out.
//!
//! At finite strain: `stretched_membrane`.
//!
//! Source: Zienkiewicz, Taylor, The Finite Element Method, 5th ed., vol. 1, chapter 4; skin as a membrane:
//! Zachow et al. 2006, section 4.2 (docs/methods.md#membrane). The sheet weighs nothing.

use nalgebra::Matrix3;

use super::edge_nodes::EdgeNodes;
use crate::material::tension_field::TensionOnly;
use crate::material::{ElasticTensor, PlaneStress};
use crate::mesh::{Vector, VolumeMesh};
use crate::model::dofs::{DofMap, add_cell};
use crate::solver::{Block, HalfMatrix};

/// A sheet on faces of the tissue.
#[derive(Clone, Debug, PartialEq)]
pub struct Membrane {
    pub sheet: PlaneStress,
    /// Nodes of the mesh.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the direction of the lines, of length 1 and in its plane; empty where there are none.
    pub lines: Vec<Vector>,
}

/// A triangle of the sheet, and how much it is pressed along itself.
#[derive(Clone, Debug, PartialEq)]
pub struct PressedTriangle {
    pub nodes: [u32; 3],
    /// At rest, in mm², mm and mm.
    pub area: f64,
    pub edge: f64,
    pub centre: Vector,
    /// Against the least principal stress, in mN/mm; 0 where it is pressed in no direction.
    pub force: f64,
}

/// What a triangle needs for its matrix.
#[derive(Clone)]
pub(super) struct Triangle {
    pub normal: Vector,
    /// Thickness times area, in mm³.
    pub volume: f64,
    /// Of the barycentric coordinates, in 1/mm.
    pub gradients: [Vector; 3],
    pub tensor: ElasticTensor,
    /// At rest, in kPa.
    pub tension: f64,
    /// Where it bears no compression.
    pub tension_only: Option<TensionOnly>,
}

impl Membrane {
    /// Of its elements, whose triangles may have a node in the middle of each side.
    pub fn name(&self, is_quadratic: bool) -> &'static str {
        match (is_quadratic, self.sheet.bears_compression()) {
            (true, _) => "tri6 membrane",
            (false, true) => "tri3 membrane",
            (false, false) => "tri3 membrane, tension only",
        }
    }

    /// Adds the sheet to the matrix of a mesh whose triangles have three nodes.
    pub(super) fn add_linear(
        &self,
        matrix: &mut HalfMatrix<f64, 3>,
        dof_map: &DofMap,
        mesh: &VolumeMesh,
    ) {
        for (triangle, nodes) in self.in_space(mesh) {
            let rows = nodes.map(|node| dof_map.row(node) as u32);
            add_cell(matrix, &rows, &triangle.linear());
        }
    }

    /// Adds the sheet to the matrix of a mesh whose triangles have a node in the middle of each side too.
    pub(super) fn add_quadratic(
        &self,
        matrix: &mut HalfMatrix<f64, 3>,
        dof_map: &DofMap,
        mesh: &VolumeMesh,
        edges: &EdgeNodes,
    ) {
        for (triangle, [a, b, c]) in self.in_space(mesh) {
            let middles = [edges.between(a, b), edges.between(b, c), edges.between(c, a)];
            let nodes = [a, b, c, middles[0], middles[1], middles[2]];
            let rows = nodes.map(|node| dof_map.row(node) as u32);
            add_cell(matrix, &rows, &triangle.quadratic());
        }
    }

    /// Forces in mN with which the sheet of three-node triangles resists a displacement of the nodes.
    pub fn internal_forces(&self, mesh: &VolumeMesh, displacement: &[Vector]) -> Vec<Vector> {
        let mut forces = vec![Vector::zeros(); mesh.nodes.len()];
        for (triangle, nodes) in self.in_space(mesh) {
            for (entry, block) in triangle.linear().iter().enumerate() {
                let moved = displacement[nodes[entry % 3] as usize];
                let force = &mut forces[nodes[entry / 3] as usize];
                for (component, row) in force.iter_mut().zip(block) {
                    *component += row.iter().zip(&moved).map(|(k, u)| k * u).sum::<f64>();
                }
            }
        }
        forces
    }

    /// Adds a factor times the second order of the forces of three-node triangles, bilinear in two displacements: F S,
    /// S = C:E, E = P (F^T F - I) P / 2, so that turning the sheet strains nothing.
    pub(super) fn add_second_order(
        &self,
        mesh: &VolumeMesh,
        [u, v]: [&[Vector]; 2],
        factor: f64,
        forces: &mut [Vector],
    ) {
        for (triangle, nodes) in self.in_space(mesh) {
            let [g, h] = [u, v].map(|moved| triangle.gradient(nodes, moved));
            let product = g.transpose() * h;
            let stretching = triangle.tensor.stress(&((product + product.transpose()) * 0.25));
            let turning = (g * triangle.stress(&h) + h * triangle.stress(&g)) * 0.5;
            triangle.add_forces(nodes, &((turning + stretching) * factor), forces);
        }
    }

    /// Adds the third order of the same forces along one displacement.
    pub(super) fn add_third_order(&self, mesh: &VolumeMesh, u: &[Vector], forces: &mut [Vector]) {
        for (triangle, nodes) in self.in_space(mesh) {
            let h = triangle.gradient(nodes, u);
            let stress = h * triangle.tensor.stress(&(h.transpose() * h * 0.5));
            triangle.add_forces(nodes, &stress, forces);
        }
    }

    /// How much each triangle of three nodes is pressed along itself after a displacement of the nodes.
    pub fn pressed<'a>(
        &'a self,
        mesh: &'a VolumeMesh,
        displacement: &'a [Vector],
    ) -> impl Iterator<Item = PressedTriangle> + 'a {
        self.in_space(mesh).map(|(triangle, nodes)| {
            let at_rest = nodes.map(|node| mesh.nodes[node as usize]);
            let corners = nodes.map(|node| mesh.nodes[node as usize] + displacement[node as usize]);
            let stretched = triangle.at(&corners);
            // The normal has the eigenvalue 0.
            let in_plane = stretched.plane * stretched.stress * stretched.plane;
            let least = in_plane.symmetric_eigenvalues().min();
            let area = triangle.volume / self.sheet.thickness();
            let [a, b, c] = at_rest;
            PressedTriangle {
                nodes,
                area,
                edge: ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0,
                centre: (a + b + c) / 3.0,
                force: -self.sheet.thickness() * least,
            }
        })
    }

    /// Triangles with an area, and their nodes.
    pub(super) fn in_space<'a>(
        &'a self,
        mesh: &'a VolumeMesh,
    ) -> impl Iterator<Item = (Triangle, [u32; 3])> + 'a {
        self.triangles.iter().enumerate().filter_map(|(number, &nodes)| {
            let [a, b, c] = nodes.map(|node| mesh.nodes[node as usize]);
            let area_vector = (b - a).cross(&(c - a)) * 0.5;
            let area = area_vector.norm();
            if area == 0.0 {
                return None;
            }
            let normal = area_vector / area;
            let across = |side: Vector| normal.cross(&side) / (2.0 * area);
            let lines = self.lines.get(number).copied().unwrap_or_default();
            let (tensor, tension) = (self.sheet.tensor(&lines), self.sheet.tension());
            let tension_only = (!self.sheet.bears_compression())
                .then(|| TensionOnly::new(&tensor, tension, (b - a).normalize(), normal));
            let triangle = Triangle {
                normal,
                volume: self.sheet.thickness() * area,
                gradients: [across(c - b), across(a - c), across(b - a)],
                tensor,
                tension,
                tension_only,
            };
            Some((triangle, nodes))
        })
    }
}

impl Triangle {
    /// Its stiffness times its volume, in mN mm.
    pub fn modulus(&self) -> f64 {
        self.volume * (self.tensor.lambda + 2.0 * self.tensor.mu + self.tension)
    }

    /// The gradient of a displacement in the plane.
    fn gradient(&self, nodes: [u32; 3], moved: &[Vector]) -> Matrix3<f64> {
        let nodes = nodes.iter().zip(&self.gradients);
        nodes.map(|(&node, g)| moved[node as usize] * g.transpose()).sum()
    }

    /// The stress in kPa of a small displacement gradient.
    fn stress(&self, h: &Matrix3<f64>) -> Matrix3<f64> {
        let plane = Matrix3::identity() - self.normal * self.normal.transpose();
        self.tensor.stress(&(plane * (h + h.transpose()) * plane * 0.5))
    }

    fn add_forces(&self, nodes: [u32; 3], stress: &Matrix3<f64>, forces: &mut [Vector]) {
        for (&node, g) in nodes.iter().zip(&self.gradients) {
            forces[node as usize] += stress * g * self.volume;
        }
    }

    /// The block between two gradients in the plane.
    pub fn pair(&self, gj: &Vector, gk: &Vector) -> Matrix3<f64> {
        let mut block: Block = [[0.0; 3]; 3];
        self.tensor.add_pair(&mut block, [gj, gk], self.volume);
        let off_plane = self.tensor.mu * self.volume * gj.dot(gk);
        let n = &self.normal;
        let taut = Matrix3::from_diagonal_element(self.tension * self.volume * gj.dot(gk));
        taut + Matrix3::from_fn(|i, j| block[i][j] - off_plane * n[i] * n[j])
    }

    fn linear(&self) -> [Block; 9] {
        let mut blocks = [[[0.0; 3]; 3]; 9];
        self.add_point(&mut blocks, &self.gradients, self.volume);
        blocks
    }

    fn quadratic(&self) -> [Block; 36] {
        let mut blocks = [[[0.0; 3]; 3]; 36];
        let [ga, gb, gc] = &self.gradients;
        for [a, b, c] in [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]] {
            let gradients = [
                ga * (4.0 * a - 1.0),
                gb * (4.0 * b - 1.0),
                gc * (4.0 * c - 1.0),
                (gb * a + ga * b) * 4.0,
                (gc * b + gb * c) * 4.0,
                (ga * c + gc * a) * 4.0,
            ];
            self.add_point(&mut blocks, &gradients, self.volume / 3.0);
        }
        blocks
    }

    /// The part of one quadrature point: C between gradients in the plane, with P for the identity.
    fn add_point(&self, blocks: &mut [Block], gradients: &[Vector], volume: f64) {
        let (n, count) = (&self.normal, gradients.len());
        for (entry, block) in blocks.iter_mut().enumerate() {
            let (gj, gk) = (&gradients[entry / count], &gradients[entry % count]);
            self.tensor.add_pair(block, [gj, gk], volume);
            let off_plane = self.tensor.mu * volume * gj.dot(gk);
            let taut = self.tension * volume * gj.dot(gk);
            for (r, row) in block.iter_mut().enumerate() {
                for (c, value) in row.iter_mut().enumerate() {
                    *value -= off_plane * n[r] * n[c];
                }
                row[r] += taut;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Sheet;

    #[test]
    fn a_quadratic_displacement_stores_the_energy_of_its_linear_strain() {
        // u = (x², x y) on the triangle (0,0), (2,0), (0,1): eps = (2x, x, y/2), and the energy is the integral
        // of t/2 [C11 4x² + 2 C12 2x² + C22 x² + C66 y²], where x² has the integral 2/3 and y² 1/6.
        let (e, nu, t) = (200.0, 0.3, 1.5);
        let sheet = Sheet { thickness: t, young_modulus: e, poisson_ratio: nu, along_lines: None };
        let nodes = [[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]].map(|[x, y]| Vector::new(x, y, 0.0));
        let membrane = Membrane {
            sheet: PlaneStress::new(&sheet).unwrap(),
            triangles: vec![[0, 1, 2]],
            lines: Vec::new(),
        };
        let mesh = VolumeMesh { nodes: nodes.to_vec(), ..VolumeMesh::default() };
        let (triangle, _) = membrane.in_space(&mesh).next().unwrap();
        let middle = |a: usize, b: usize| (nodes[a] + nodes[b]) * 0.5;
        let places = [nodes[0], nodes[1], nodes[2], middle(0, 1), middle(1, 2), middle(2, 0)];
        let moved = places.map(|p| Vector::new(p.x * p.x, p.x * p.y, 3.0));
        let blocks = triangle.quadratic();
        let mut twice_energy = 0.0;
        for (entry, block) in blocks.iter().enumerate() {
            let block = nalgebra::Matrix3::from_fn(|i, j| block[i][j]);
            twice_energy += moved[entry / 6].dot(&(block * moved[entry % 6]));
        }
        let (c11, c66) = (e / (1.0 - nu * nu), e / (2.0 * (1.0 + nu)));
        let exact = t * ((c11 * (4.0 + 4.0 * nu + 1.0)) * 2.0 / 3.0 + c66 / 6.0);
        assert!((twice_energy / exact - 1.0).abs() < 1e-13, "{twice_energy} {exact}");
    }
}
