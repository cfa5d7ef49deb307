//! The nonlinear mass-tensor model: tetrahedra of Saint Venant-Kirchhoff tissue whose force is a cubic polynomial of
//! displacements (Kim et al. 2012, section 3.3; docs/methods.md#nonlinear-mass-tensor; [`tensors`]).

mod rest;
mod tensors;
mod tissue;

use crate::boundary::Constraint;
use crate::material::LinearElastic;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::dofs::{Constrained, nodes_of_cells, number};
use crate::model::fem::displacement::check_finite;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::Tolerance;
use rest::Search;
use tissue::Tetrahedra;

/// Tetrahedra with their materials, and what holds them.
pub struct MassTensors<'a> {
    pub mesh: &'a VolumeMesh,
    pub materials: &'a [LinearElastic],
    /// For each cell its entry in `materials`.
    pub material_of_cell: &'a [u16],
    pub constraints: &'a [Constraint],
    pub tolerance: Tolerance,
}

impl MassTensors<'_> {
    /// Solves a load case for rest.
    pub fn solve(
        &self,
        case: &LoadCase,
        progress: &dyn Progress,
    ) -> Result<Equilibrium, ModelError> {
        progress.phase(Phase::Assemble);
        let tetrahedra = Tetrahedra::new(self.mesh, self.materials, self.material_of_cell)?;
        let dof_map = number(&nodes_of_cells(self.mesh), &self.mesh.nodes, self.constraints);
        let constrained = Constrained { constraints: self.constraints, dof_map: &dof_map };
        progress.phase(Phase::Solve);
        let search = Search { tetrahedra: &tetrahedra, constrained: &constrained, case, progress };
        let equilibrium = search.solve(self.tolerance)?;
        check_finite(std::slice::from_ref(&equilibrium))?;
        Ok(equilibrium)
    }

    /// The internal forces of displacements in mN, for each node.
    pub fn forces(&self, displacement: &[Vector]) -> Result<Vec<Vector>, ModelError> {
        let tetrahedra = Tetrahedra::new(self.mesh, self.materials, self.material_of_cell)?;
        Ok(tetrahedra.forces(displacement))
    }
}
