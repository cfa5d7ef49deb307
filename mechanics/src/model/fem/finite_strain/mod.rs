//! Finite elements at finite strain: cells of any hyperelastic law, brought to rest by Newton's method.
//!
//! At rest the internal forces f_a = sum_cells V P(F) g_a balance those that act, F = sum_a x_a g_a^T, P = dW/dF. What is held
//! and what acts is advanced in the same steps that bring the tissue to rest (docs/methods.md#newton). Tetrahedra with pressures
//! and cells with mean dilatation do not lock (`elements`).

mod another_rest;
mod balance;
mod brick_at_rest;
mod bricks;
mod direction;
mod edge_block;
mod elements;
mod enriched;
mod enriched_brick;
mod enriched_simplex;
mod fibres;
mod inner;
mod load_steps;
mod mesh_error;
mod near;
mod newton;
mod newton_state;
mod parts;
mod pressures;
mod problem;
mod sheet;
mod simplices;
mod states;
mod step_length;
mod tissue;
mod touching;

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use crate::boundary::Constraint;
use crate::boundary::contact::FacingSurfaces;
use crate::mesh::Vector;
use crate::model::cell_state::CellStates;
use crate::model::dofs::{Constrained, nodes_of_cells, number};
use crate::model::fem::contact::Contact;
use crate::model::fem::displacement::check_finite;
use crate::model::fem::edge_nodes::WithEdges;
use crate::model::fem::strain::{determinant, determinants};
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::SolverError;
use crate::solver::element_connectivity::ElementConnectivity;
pub use another_rest::ANOTHER_EQUILIBRIUM;
use another_rest::{another_rest, is_doubtful};
use direction::Directions;
use elements::CellBulkModulus;
pub use elements::Elements;
pub use enriched_brick::COLLAPSED;
pub use fibres::FibreField;
pub use mesh_error::{FinerProblem, MeshError, NoMeshError};
use newton::Newton;
use newton_state::{Ending, NewtonExits, Question, Rest, Start};
pub use problem::{Advance, FiniteStrain};
use states::cell_states;
use tissue::Tissue;
use touching::Touching;

/// Displacements without contact, in mm by node, and what may touch on the way there.
#[derive(Clone, Copy)]
pub struct MayTouch<'a> {
    pub free: &'a [Vector],
    pub surfaces: &'a FacingSurfaces<'a>,
}

/// An answer with contact, and what its mesh leaves out where that was asked for.
pub struct InContact {
    pub equilibrium: Equilibrium,
    pub contact: Contact,
    pub mesh_error: Option<MeshError>,
}

/// Steps after which no rest of a movement that is made at once is expected any more, and the relative residual above which bones
/// wait until tissue that is not stable is nearer to rest.
pub const MOST_STEPS: usize = 150;
const OUT_OF_BALANCE: f64 = 0.3;

/// What moves goes by at most this part of its longest edges in a step where things touch.
const STEP: f64 = 0.5;

impl<'a> FiniteStrain<'a> {
    /// Solves a load case for rest.
    pub fn solve(
        &self,
        case: &LoadCase,
        progress: &dyn Progress,
    ) -> Result<Equilibrium, ModelError> {
        let (equilibrium, _) = self.solve_and(case, None, progress)?;
        Ok(equilibrium)
    }

    /// Solves a load case for rest, and estimates what its mesh leaves out where it is told what acts between the nodes.
    pub fn solve_and(
        &self,
        case: &LoadCase,
        finer: Option<&FinerProblem>,
        progress: &dyn Progress,
    ) -> Result<(Equilibrium, Option<MeshError>), ModelError> {
        progress.phase(Phase::Assemble);
        if self.elements.quadratic {
            return Ok((self.solve_with_edges(case, progress)?, None));
        }
        self.solve_on(&nodes_of_cells(self.mesh), case, finer, progress)
    }

    /// The same on nodes in the middle of edges too, whose part of the answer is left out at the end.
    fn solve_with_edges(
        &self,
        case: &LoadCase,
        progress: &dyn Progress,
    ) -> Result<Equilibrium, ModelError> {
        let with = WithEdges::new(self.mesh, self.constraints);
        let problem =
            FiniteStrain { constraints: &with.constraints, nodes: &with.positions, ..self.clone() };
        let (mut equilibrium, _) =
            problem.solve_on(&with.cells, &with.case(case), None, progress)?;
        with.gather_reactions(&mut equilibrium);
        equilibrium.warnings.extend(with.inverted_cells(self.mesh, &equilibrium.displacement));
        equilibrium.displacement.truncate(self.mesh.nodes.len());
        Ok(equilibrium)
    }

    fn solve_on(
        &self,
        cells: &ElementConnectivity,
        case: &LoadCase,
        finer: Option<&FinerProblem>,
        progress: &dyn Progress,
    ) -> Result<(Equilibrium, Option<MeshError>), ModelError> {
        self.check_held_cells(case)?;
        let dof_map = number(cells, self.nodes, self.constraints);
        let constrained = Constrained { constraints: self.constraints, dof_map: &dof_map };
        let question = self.whole(&constrained, case, progress);
        let (tissue, mut rest) = self.rest(question, None)?;
        let error = self.mesh_error(finer, &tissue, &mut rest, &question)?;
        Ok((self.equilibrium(&tissue, &question, rest, &case.forces)?, error))
    }

    /// What the mesh leaves out of an answer of the same tissue that another model found, without pressures.
    pub fn mesh_error_at(
        &self,
        displacement: &[Vector],
        case: &LoadCase,
        finer: &FinerProblem,
        progress: &dyn Progress,
    ) -> Result<MeshError, ModelError> {
        if determinants(self.mesh, displacement).iter().any(|det_f| *det_f <= 0.0) {
            return Ok(Err(NoMeshError::Inverted));
        }
        let dof_map = number(&nodes_of_cells(self.mesh), self.nodes, self.constraints);
        let constrained = Constrained { constraints: self.constraints, dof_map: &dof_map };
        let question = self.whole(&constrained, case, progress);
        let pairs = self.nodes.iter().zip(displacement);
        let moved: Vec<Vector> = pairs.map(|(rest, u)| rest + u).collect();
        let start = Start::at(dof_map.by_row(&moved), 1.0, None);
        let (tissue, mut rest) = self.rest_from(question, start)?;
        finer.of(&tissue, &mut rest, &constrained, progress)
    }

    fn mesh_error(
        &self,
        finer: Option<&FinerProblem>,
        tissue: &Tissue,
        rest: &mut Rest,
        question: &Question,
    ) -> Result<Option<MeshError>, ModelError> {
        let Question { constrained, progress, .. } = *question;
        finer.map(|finer| finer.of(tissue, rest, constrained, progress)).transpose()
    }

    /// The answer in which nothing passes through what it faces; none where nothing touches on the way to where tissue goes without
    /// contact, or nothing presses in the end. With what its mesh leaves out, as `solve_and`.
    pub fn solve_in_contact(
        &self,
        case: &LoadCase,
        MayTouch { free, surfaces }: MayTouch,
        finer: Option<&FinerProblem>,
        progress: &dyn Progress,
    ) -> Result<Option<InContact>, ModelError> {
        let steps = surfaces.steps(free, STEP);
        if !touches(surfaces, free, steps, progress)? {
            return Ok(None);
        }
        let dof_map = number(&nodes_of_cells(self.mesh), &self.mesh.nodes, self.constraints);
        let constrained = Constrained { constraints: self.constraints, dof_map: &dof_map };
        let question = self.whole(&constrained, case, progress);
        let touching = Touching::new(surfaces, self.constraints, &dof_map, 1.0 / steps as f64);
        let (tissue, mut rest) = self.rest(question, Some(touching))?;
        let mesh_error = self.mesh_error(finer, &tissue, &mut rest, &question)?;
        let Some(touching) = rest.touching.take() else { return Ok(None) };
        let residual = rest.report.relative_residual;
        let pressing = touching.forces(self.mesh.nodes.len());
        let acting: Vec<Vector> =
            case.forces.iter().zip(&pressing).map(|(force, pressing)| force + pressing).collect();
        let equilibrium = self.equilibrium(&tissue, &question, rest, &acting)?;
        let contact = touching.answer(&equilibrium.displacement, residual)?;
        Ok(contact.map(|contact| InContact { equilibrium, contact, mesh_error }))
    }

    /// Displacements and reactions of tissue at rest under forces in mN, by node.
    fn equilibrium(
        &self,
        tissue: &Tissue,
        question: &Question,
        rest: Rest,
        acting: &[Vector],
    ) -> Result<Equilibrium, ModelError> {
        let dof_map = question.constrained.dof_map;
        let Rest { positions, pressures, forces, report, directions, .. } = rest;
        let places = dof_map.ordering.place.iter().zip(self.nodes);
        let displacement: Vec<Vector> =
            places.map(|(&row, rest)| positions[row as usize] - rest).collect();
        let pressed = report.newton.as_ref().and_then(|newton| tissue.bulk_warning(newton));
        let doubtful = report.newton.as_ref().filter(|newton| is_doubtful(newton));
        let (mut doubt, mut states) = (None, CellStates::default());
        if self.with_states || doubtful.is_some() {
            let deformed = tissue.at(&positions, &pressures, directions.pressures.as_ref());
            let of_cells = cell_states(self.mesh, &self.inner, &deformed);
            if let Some(newton) = doubtful {
                doubt = another_rest(self, &deformed, &of_cells, newton);
            }
            states = if self.with_states { of_cells } else { states };
        }
        let equilibrium = Equilibrium {
            displacement,
            reactions: reactions(question.constrained, &forces, acting),
            warnings: doubt.into_iter().chain(pressed).collect(),
            solver: report,
            states,
        };
        check_finite(std::slice::from_ref(&equilibrium))?;
        Ok(equilibrium)
    }

    /// The whole of a movement and load, at once.
    fn whole<'b>(
        &self,
        constrained: &'b Constrained<'b>,
        case: &'b LoadCase,
        progress: &'b dyn Progress,
    ) -> Question<'b> {
        Question {
            constrained,
            case,
            share: 1.0,
            kept: CellBulkModulus::USUAL,
            out_of_balance: OUT_OF_BALANCE,
            by_energy: false,
            most_steps: MOST_STEPS,
            tolerance: self.tolerance,
            progress,
        }
    }

    /// Brings the tissue to rest, on the way that is asked for.
    fn rest(
        &self,
        question: Question<'a>,
        touching: Option<Touching<'a>>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        let rest = question.constrained.dof_map.by_row(self.nodes);
        let start = Start::at(rest, 0.0, touching);
        match self.advance {
            Advance::AtOnce | Advance::AtOnceOrInParts => match self.rest_near(question, &start)? {
                Some(found) => Ok(found),
                None => self.rest_at_share(question, start),
            },
            Advance::InSteps(steps) => self.rest_in_steps(steps.get(), question, start),
        }
    }

    /// Near rest with a share of the bulk modulus in all cells, then with that in pressed ones only, where the tissue bears it.
    fn rest_from(
        &self,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        let kept = question.kept;
        let (share, near, pressed) = match self.with_bulk_in_cells(kept, question, start, true)? {
            (tissue, Ending::Rest(rest)) => return Ok((tissue, *rest)),
            (tissue, Ending::Near(near, pressed)) => (tissue.bulk_in_cells, near, pressed),
            (_, Ending::Jam(_)) => unreachable!("with more bulk modulus nothing is a jam"),
        };
        let until = NewtonExits { jammed: true, near: false };
        match self.newton(
            &CellBulkModulus::in_pressed(share, pressed),
            question,
            near.clone(),
            until,
        ) {
            Ok((tissue, Ending::Rest(rest))) => return Ok((tissue, *rest)),
            Ok((_, Ending::Jam(_) | Ending::Near(..))) | Err(ModelError::Standstill { .. }) => {}
            Err(ModelError::ContactAlternates { .. }) => {}
            Err(ModelError::Solver(SolverError::NotConverged { .. })) => {}
            Err(error) => return Err(error),
        }
        match self.with_bulk_in_cells(kept, question, near, false)? {
            (tissue, Ending::Rest(rest)) => Ok((tissue, *rest)),
            (_, Ending::Jam(_) | Ending::Near(..)) => unreachable!("only rest ends it"),
        }
    }

    /// With the first share in the cells, and with the next where that jams.
    fn with_bulk_in_cells(
        &self,
        kept: &[CellBulkModulus],
        question: Question<'a>,
        start: Start<'a>,
        near: bool,
    ) -> Result<(Tissue<'a>, Ending<'a>), ModelError> {
        let [first, more @ ..] = kept else { unreachable!("a share is kept first") };
        match self.newton(first, question, start, NewtonExits { jammed: !more.is_empty(), near })? {
            (_, Ending::Jam(reached)) => self.with_bulk_in_cells(more, question, reached, near),
            ended => Ok(ended),
        }
    }

    fn newton(
        &self,
        kept: &CellBulkModulus,
        question: Question<'a>,
        start: Start<'a>,
        until: NewtonExits,
    ) -> Result<(Tissue<'a>, Ending<'a>), ModelError> {
        let tissue = Tissue::new(self, question.constrained.dof_map, kept)?;
        let pressures = tissue.pressures(self, kept, self.axes_by_row(question));
        let memory_mb = self.tolerance.memory_mb - tissue.megabytes();
        question.progress.phase(Phase::Solve);
        let directions = Directions::new(pressures, start.tally, memory_mb);
        let until = NewtonExits { near: until.near && tissue.bulk_in_cells > 0.0, ..until };
        let ending = Newton::new(&tissue, directions, question, start).solve(until)?;
        Ok((tissue, ending))
    }

    /// The axes of rows that have their own.
    fn axes_by_row(&self, question: Question) -> BTreeMap<u32, Matrix3<f64>> {
        let turned = self.constraints.iter().filter(|constraint| !constraint.is_aligned());
        let row = |node: u32| question.constrained.dof_map.row(node) as u32;
        turned.map(|constraint| (row(constraint.node), *constraint.axes())).collect()
    }

    /// No movement of bones may turn a cell inside out, in one of its quadrature points, all of whose nodes they hold.
    fn check_held_cells(&self, case: &LoadCase) -> Result<(), ModelError> {
        let mut displacement = vec![Vector::zeros(); self.nodes.len()];
        let mut is_held = vec![false; self.nodes.len()];
        for (constraint, value) in self.constraints.iter().zip(&case.held) {
            if constraint.count() == 3 {
                displacement[constraint.node as usize] = constraint.axes() * value;
                is_held[constraint.node as usize] = true;
            }
        }
        for (cell, (_, nodes)) in self.mesh.cells.iter().enumerate() {
            if !nodes.iter().all(|&node| is_held[node as usize]) {
                continue;
            }
            let det_f = determinant(self.mesh, &displacement, cell);
            if det_f <= 0.0 {
                return Err(ModelError::Folded { cell, det_f });
            }
        }
        Ok(())
    }
}

/// What each hold exerts on tissue with internal forces by row, under forces by node, in mN.
fn reactions(constrained: &Constrained, internal: &[Vector], acting: &[Vector]) -> Vec<Vector> {
    let reaction = |constraint: &Constraint| {
        let internal = internal[constrained.dof_map.row(constraint.node)];
        constraint.part_along(&(internal - acting[constraint.node as usize]))
    };
    constrained.constraints.iter().map(reaction).collect()
}

/// Whether a gap closes along a displacement, in so many steps.
fn touches(
    surfaces: &FacingSurfaces,
    displacement: &[Vector],
    steps: usize,
    progress: &dyn Progress,
) -> Result<bool, SolverError> {
    let share = |step: usize| (step as f64 / steps as f64).min(1.0);
    for step in 1..=steps + 1 {
        if progress.is_cancelled() {
            return Err(SolverError::Stopped);
        }
        if surfaces.closes(displacement, [share(step - 1), share(step)]) {
            return Ok(true);
        }
    }
    Ok(false)
}
