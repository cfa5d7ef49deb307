//! Stress and strain of the cells of an answer, where they are asked for.

use super::scene::Scene;
use crate::mesh::{Vector, Warning};
use crate::model::cell_state::{CellState, CellStates};
use crate::model::fem::law_states::at_second_order;
use crate::model::fem::linear_states::{Displaced, at_small_strain};
use crate::model::fem::linear_system::{LinearSystem, Solved};
use crate::model::fem::quadratic;
use crate::model::problem::{Equilibrium, InvertedCell, ModelError};
use crate::progress::Progress;

impl Scene {
    /// The answer of linear finite elements of any order.
    pub(super) fn solve_linear(&self, progress: &dyn Progress) -> Result<Equilibrium, ModelError> {
        if let Some(system) = self.assemble(progress)? {
            let solved = system.solve(&[self.load_case()], progress)?.remove(0);
            return Ok(self.stated(&system, solved)?);
        }
        let cases = [self.load_case()];
        let mut answer = quadratic::solve_with_edges(&self.problem(), &cases, progress)?.remove(0);
        answer.states = self.states(&answer.displacement, &[])?;
        answer.displacement.truncate(self.mesh.nodes.len());
        Ok(answer)
    }

    /// The answer of a linear system, with the states of its cells.
    pub(super) fn stated(
        &self,
        system: &LinearSystem,
        solved: Solved,
    ) -> Result<Equilibrium, InvertedCell> {
        let states = self.states_of(system, &solved)?;
        Ok(Equilibrium { states, ..solved.equilibrium })
    }

    /// Those of the answer of a linear system; none where they are not asked for.
    pub(super) fn states_of(
        &self,
        system: &LinearSystem,
        solved: &Solved,
    ) -> Result<CellStates, InvertedCell> {
        let pressures = match self.settings.states {
            true => self.mean_pressures(system, &solved.pressures),
            false => Vec::new(),
        };
        self.states(&solved.equilibrium.displacement, &pressures)
    }

    /// The state of each cell at second order, asked for or not; none of cells that are turned inside out.
    pub(super) fn cell_states_at_second_order(
        &self,
        system: &LinearSystem,
        displacement: &[Vector],
        pressures: &[f64],
    ) -> Vec<Option<CellState>> {
        let pressures = self.mean_pressures(system, pressures);
        at_second_order(&self.tissue(), &self.distributed.inner, displacement, &pressures)
    }

    /// The answer of elements without pressures, with the states of its cells.
    pub(super) fn with_states(&self, answer: Equilibrium) -> Result<Equilibrium, ModelError> {
        let states = self.states(&answer.displacement, &[])?;
        Ok(Equilibrium { states, ..answer })
    }

    /// Those of an answer to second order, and the warning of cells that have none.
    pub(super) fn states_at_second_order(
        &self,
        system: &LinearSystem,
        displacement: &[Vector],
        pressures: &[f64],
    ) -> (CellStates, Option<Warning>) {
        if !self.settings.states {
            return (CellStates::default(), None);
        }
        let states = self.cell_states_at_second_order(system, displacement, pressures);
        let unknown = states.iter().filter(|state| state.is_none()).count();
        let detail = format!(
            "{unknown} cells are turned inside out, where no law has a stress: stress and strain of these are written as zero"
        );
        let warning = Warning::new("stress-unknown", detail).with("cells", unknown as f64);
        let cells = states.into_iter().map(Option::unwrap_or_default).collect();
        (CellStates { cells, is_green: true }, (unknown > 0).then_some(warning))
    }

    fn states(
        &self,
        displacement: &[Vector],
        pressures: &[Option<f64>],
    ) -> Result<CellStates, InvertedCell> {
        if !self.settings.states {
            return Ok(CellStates::default());
        }
        let edges = self.edge_nodes();
        let displaced = Displaced { displacement, edges: edges.as_ref(), pressures };
        let cells = at_small_strain(&self.tissue(), &self.distributed.inner, &displaced)?;
        Ok(CellStates { cells, is_green: false })
    }

    fn mean_pressures(&self, system: &LinearSystem, pressures: &[f64]) -> Vec<Option<f64>> {
        match &system.pressures {
            Some(own) => own.cells.means(pressures, self.mesh.cells.len()),
            None => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use crate::boundary::NodeSelection;
    use crate::material::LinearElastic;
    use crate::mesh::sample::block;
    use crate::mesh::{CellShape, Vector};
    use crate::prediction::answer::{self, Answer, Linear};
    use crate::prediction::{Case, Plan, Prescribed, Scene, Settings};
    use crate::progress::Unobserved;

    /// A block of 72 cells of which all outer nodes go along x by so many times their x: F = diag(1 + share, 1, 1), to every order.
    fn stretched(share: f64) -> Answer {
        let mut mesh = block(Vector::new(6.0, 4.0, 2.0), [6, 4, 3], CellShape::Hex8);
        let mut boundary: Vec<u32> =
            mesh.boundary_faces().iter().flat_map(|face| face.nodes().to_vec()).collect();
        boundary.sort_unstable();
        boundary.dedup();
        mesh.node_sets.insert("boundary".to_owned(), boundary);
        let field = mesh.nodes.iter().map(|x| Vector::x() * (share * x.x)).collect();
        mesh.node_vectors.insert("field".to_owned(), field);
        let tissue = LinearElastic::new(15.0, 0.3, 1.0).unwrap();
        let materials = BTreeMap::from([("*".to_owned(), tissue)]);
        let case = Case { volume: Arc::new(mesh), materials, ..Case::default() };
        let nodes = NodeSelection::NodeSet("boundary".to_owned());
        let prescribed = vec![Prescribed::FromArray { nodes, array: "field".to_owned() }];
        let plan = Plan { prescribed, ..Plan::default() };
        let settings = Settings { states: true, relative_residual: 1e-12, ..Settings::default() };
        let scene = Scene::new(&case, &plan, &settings).unwrap();
        let Linear::Solved(known) = answer::linear(&scene, &Unobserved).unwrap() else {
            panic!("a linear answer has its matrix")
        };
        known.to_second_order(&scene, &Unobserved).unwrap()
    }

    #[test]
    fn cells_that_the_second_order_turns_inside_out_are_told_to_have_no_stress() {
        let is_told = |own: &&crate::mesh::Warning| own.code == "stress-unknown";
        let found = stretched(-1.5).equilibrium;
        let told = found.warnings.iter().find(is_told).unwrap();
        assert_eq!(told.numbers, [("cells", 72.0)]);
        assert!(found.states.cells.iter().all(|state| state.stress.amax() == 0.0));
        let found = stretched(-0.1).equilibrium;
        assert!(found.warnings.iter().find(is_told).is_none());
        assert!(found.states.is_green && found.states.cells.len() == 72);
        assert!(found.states.cells.iter().all(|state| state.stress[(0, 0)] < -1.0));
    }
}
