//! Finite elements at finite strain: four-node tetrahedra of any hyperelastic law, brought to rest by Newton's method.
//!
//! At rest the internal forces f_a = sum_cells V P(F) g_a balance those that act, F = sum_a x_a g_a^T, P = dW/dF. What is held
//! and what acts is advanced in the same steps that bring the tissue to rest (NONLINEAR, section 1).

mod cells;
mod fibres;
mod holds;
mod newton;
mod step_length;

use nalgebra::Matrix3;

use crate::boundary::Hold;
use crate::material::hyperelastic::Law;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::dofs::{Constrained, nodes_of_cells, number};
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::fem::displacement::check_finite;
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::Tolerance;
use cells::Cells;
pub use fibres::FibreField;
use holds::along_holds;
use newton::{Newton, Rest};

/// Tetrahedra of hyperelastic tissue, and what holds them.
pub struct FiniteStrain<'a> {
    pub mesh: &'a VolumeMesh,
    pub laws: &'a [Law],
    /// For each cell its entry in `laws`.
    pub law_of_cell: &'a [u16],
    pub fibres: FibreField<'a>,
    pub holds: &'a [Hold],
    pub tolerance: Tolerance,
}

impl FiniteStrain<'_> {
    /// Solves a load case for rest.
    pub fn solve(
        &self,
        case: &LoadCase,
        progress: &dyn Progress,
    ) -> Result<Equilibrium, ModelError> {
        progress.phase(Phase::Assemble);
        self.check_held_cells(case)?;
        let numbering = number(&nodes_of_cells(self.mesh), &self.mesh.nodes, self.holds);
        let constrained = Constrained { holds: self.holds, numbering: &numbering };
        let cells =
            Cells::new(self.mesh, &numbering, self.laws, self.law_of_cell)?.fibred(self.fibres);
        progress.phase(Phase::Solve);
        let nodes = &self.mesh.nodes;
        let newton = Newton::new(&cells, &constrained, case, self.tolerance, progress);
        let Rest { positions, forces, report } = newton.solve()?;

        let places = numbering.layout.place.iter().zip(nodes);
        let reaction = |hold: &Hold| {
            let internal = forces[numbering.row(hold.node)];
            along_holds(hold, &(internal - case.forces[hold.node as usize]))
        };
        let equilibrium = Equilibrium {
            displacement: places.map(|(&row, rest)| positions[row as usize] - rest).collect(),
            reactions: self.holds.iter().map(reaction).collect(),
            solver: report,
            warnings: Vec::new(),
        };
        check_finite(std::slice::from_ref(&equilibrium))?;
        Ok(equilibrium)
    }

    /// No movement of bones may turn a cell inside out all of whose nodes they hold.
    fn check_held_cells(&self, case: &LoadCase) -> Result<(), ModelError> {
        let mut held: Vec<Option<Vector>> = vec![None; self.mesh.nodes.len()];
        for (hold, value) in self.holds.iter().zip(&case.held).filter(|(hold, _)| hold.count() == 3)
        {
            held[hold.node as usize] = Some(hold.axes() * value);
        }
        for (cell, (_, nodes)) in self.mesh.cells.iter().enumerate() {
            let moved: Option<Vec<Vector>> =
                nodes.iter().map(|&node| held[node as usize]).collect();
            let Some(moved) = moved else { continue };
            let (_, gradients) = tetrahedron(self.mesh, cell)?;
            let stretch: Matrix3<f64> =
                moved.iter().zip(&gradients).map(|(u, g)| u * g.transpose()).sum();
            let det_f = (Matrix3::identity() + stretch).determinant();
            if det_f <= 0.0 {
                return Err(ModelError::Folded { cell, det_f });
            }
        }
        Ok(())
    }
}
