//! Initial stress of undeformed tissue: growth that its surroundings do not allow, and active muscles.
//!
//! sigma = C : (eps(u) - eps_g 1) + S,  eps_g = g^(1/3) - 1 of a cell whose volume becomes g times what it was, and
//! S = T f (x) f of a muscle that pulls with T along its fibres f, so that
//!   a(u, v) = f(v) - int S0 : grad v dV,   S0 = S - C : eps_g 1
//! with S0 constant in each cell. What a cell exerts on its nodes sums to zero, and so does its moment, because S0 is symmetric.
//! A mean volume change (`cell_stiffness`) of v gives the same integral. Tetrahedra with pressures keep in S0 what the
//! pressure leaves of C, and their pressure is p = lambda (div u - 3 eps_g): the volume by which a cell grows stands in the
//! equations of the pressures (`displacement_pressure`), so that growth is exact as nu goes to 1/2.
//!
//! Sources: Eshelby, The determination of the elastic field of an ellipsoidal inclusion, Proceedings of the Royal Society A 241,
//! 1957 (eigenstrain); Rodriguez, Hoger, McCulloch, Stress-dependent finite growth in soft elastic tissues, Journal of
//! Biomechanics 27, 1994 (F = F_e F_g, whose linear form this is); Blemker, Pinsky, Delp, A 3D model of muscle, Journal of
//! Biomechanics 38, 2005 (active stress along fibres).

use nalgebra::Matrix3;

use super::assembly::Tissue;
use super::cell_stiffness::tetrahedron;
use super::displacement_pressure::{carries_pressure, without_pressure_part};
use super::edge_nodes::EdgeNodes;
use crate::element::tetrahedron10;
use crate::material::ElasticTensor;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;

/// Stress in a cell, in kPa, or for each kPa with which a muscle pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellStress {
    pub cell: u32,
    pub stress: Matrix3<f64>,
}

/// Growth and active stress of the cells of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InnerStress {
    /// eps_g of each cell; empty where nothing grows.
    pub growth: Vec<f64>,
    /// S of each cell in kPa; empty where no muscle pulls.
    pub active: Vec<Matrix3<f64>>,
}

/// The nodes on which inner stress acts, and what cells are.
#[derive(Clone, Copy)]
pub struct StressedTissue<'a> {
    pub tissue: &'a Tissue<'a>,
    /// Whether tetrahedra carry pressures.
    pub has_pressures: bool,
    /// Of quadratic tetrahedra.
    pub edges: Option<&'a EdgeNodes>,
}

impl InnerStress {
    pub fn is_empty(&self) -> bool {
        self.growth.is_empty() && self.active.is_empty()
    }

    /// A share of the strain with which it grows and of what pulls.
    pub fn share(&self, share: f64) -> InnerStress {
        InnerStress {
            growth: self.growth.iter().map(|strain| strain * share).collect(),
            active: self.active.iter().map(|stress| stress * share).collect(),
        }
    }

    /// Whether nothing grows and nothing pulls.
    pub fn is_zero(&self) -> bool {
        self.growth.iter().all(|strain| *strain == 0.0)
            && self.active.iter().all(|stress| *stress == Matrix3::zeros())
    }

    /// Adds the linear strain eps_g to each of some cells, of so many.
    pub fn grow(&mut self, count: usize, cells: impl Iterator<Item = usize>, strain: f64) {
        self.growth.resize(count, 0.0);
        cells.for_each(|cell| self.growth[cell] += strain);
    }

    /// Adds the pull of a muscle, in kPa, to its cells, of so many.
    pub fn pull(&mut self, count: usize, muscle: &[CellStress], pull: f64) {
        self.active.resize(count, Matrix3::zeros());
        for CellStress { cell, stress } in muscle {
            self.active[*cell as usize] += stress * pull;
        }
    }

    /// eps_g of a cell.
    pub(super) fn strain(&self, cell: usize) -> f64 {
        self.growth.get(cell).copied().unwrap_or_default()
    }

    /// By how much a cell is longer where nothing holds it, and by how much larger.
    pub(crate) fn grown(&self, cell: usize) -> Grown {
        let length = 1.0 + self.strain(cell);
        Grown { length, volume: length.powi(3) }
    }

    /// S of a cell in kPa; none where no muscle pulls.
    pub(super) fn pulls(&self, cell: usize) -> Option<&Matrix3<f64>> {
        self.active.get(cell).filter(|stress| **stress != Matrix3::zeros())
    }

    /// S0 of a cell in kPa, for a stiffness that resists its strain; none where it is zero.
    fn of_cell(&self, cell: usize, tensor: &ElasticTensor) -> Option<Matrix3<f64>> {
        let active = self.active.get(cell).copied().unwrap_or_default();
        let stress = active - tensor.stress(&Matrix3::from_diagonal_element(self.strain(cell)));
        (stress != Matrix3::zeros()).then_some(stress)
    }

    /// S0 of a cell in kPa, in which a pressure may carry a part of its strain.
    pub(super) fn stress(
        &self,
        tissue: &Tissue,
        cell: usize,
        has_pressure: bool,
    ) -> Option<Matrix3<f64>> {
        let tensor = tissue.tensor(cell);
        let tensor = if has_pressure { without_pressure_part(tensor) } else { tensor };
        self.of_cell(cell, &tensor)
    }

    /// Adds -int S0 grad N_a dV to the forces on nodes, in mN.
    pub fn add_forces(
        &self,
        acted: &StressedTissue,
        forces: &mut [Vector],
    ) -> Result<(), InvertedCell> {
        if self.is_empty() {
            return Ok(());
        }
        let StressedTissue { tissue, has_pressures, edges } = *acted;
        for cell in 0..tissue.mesh.cells.len() {
            let shape = tissue.mesh.cells.shape(cell);
            let carries = has_pressures && carries_pressure(shape, &tissue.tensor(cell));
            let Some(stress) = self.stress(tissue, cell, carries) else { continue };
            for Slope { node, integral } in slopes(tissue.mesh, cell, edges)? {
                forces[node as usize] -= stress * integral;
            }
        }
        Ok(())
    }

    /// For each cell the volume in mm³ that it grows by; empty where nothing grows.
    pub fn grown_volumes(&self, mesh: &VolumeMesh) -> Result<Vec<f64>, InvertedCell> {
        let grown = self.growth.iter().enumerate().map(|(cell, strain)| match *strain {
            0.0 => Ok(0.0),
            strain => Ok(3.0 * strain * volume(mesh, cell)?),
        });
        grown.collect()
    }
}

/// Factors of a grown cell; 1 where nothing grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grown {
    pub length: f64,
    pub volume: f64,
}

impl Grown {
    /// The gradient of a shape function of the grown cell.
    pub fn gradient(&self, gradient: &Vector) -> Vector {
        gradient / self.length
    }

    /// Green's strain of a deformation F with growth by that of F_e.
    pub fn green_strain(&self, elastic: &Matrix3<f64>) -> Matrix3<f64> {
        let square = self.length * self.length;
        elastic * square + Matrix3::from_diagonal_element(0.5 * (square - 1.0))
    }
}

/// The integral of the gradient of the shape function of a node over a cell, in mm².
pub(super) struct Slope {
    pub node: u32,
    pub integral: Vector,
}

pub(super) fn slopes(
    mesh: &VolumeMesh,
    cell: usize,
    edges: Option<&EdgeNodes>,
) -> Result<Vec<Slope>, InvertedCell> {
    if let Some(edges) = edges {
        return quadratic_slopes(mesh, cell, edges);
    }
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let nodes = mesh.cells.nodes(cell).iter();
    let mut slopes: Vec<Slope> =
        nodes.map(|&node| Slope { node, integral: Vector::zeros() }).collect();
    for point in &reference_cell(mesh.cells.shape(cell)).points {
        let point = point.at(&corners).ok_or(InvertedCell { cell })?;
        for (slope, gradient) in slopes.iter_mut().zip(&point.gradients) {
            slope.integral += gradient * point.volume;
        }
    }
    Ok(slopes)
}

fn quadratic_slopes(
    mesh: &VolumeMesh,
    cell: usize,
    edges: &EdgeNodes,
) -> Result<Vec<Slope>, InvertedCell> {
    let (volume, of_barycentric) = tetrahedron(mesh, cell)?;
    let mut integrals = [Vector::zeros(); 10];
    for point in tetrahedron10::points() {
        let gradients = tetrahedron10::gradients(&point, &of_barycentric);
        integrals.iter_mut().zip(gradients).for_each(|(sum, g)| *sum += g * (volume / 4.0));
    }
    let nodes = edges.of_cell(mesh, cell).into_iter().zip(integrals);
    Ok(nodes.map(|(node, integral)| Slope { node, integral }).collect())
}

/// In mm³.
pub(super) fn volume(mesh: &VolumeMesh, cell: usize) -> Result<f64, InvertedCell> {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    let points = reference_cell(mesh.cells.shape(cell)).points.iter();
    let volumes = points.map(|point| Some(point.at(&corners)?.volume));
    volumes.sum::<Option<f64>>().ok_or(InvertedCell { cell })
}
