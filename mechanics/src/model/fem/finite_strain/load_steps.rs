//! Load steps: what moves, acts, grows and pulls advanced in equal shares, each brought to rest before the next one.
//!
//! Each is found as the whole is (`parts`, `inner`), from the one before.

use super::newton_state::{Question, Rest, Start};
use super::problem::FiniteStrain;
use super::reactions;
use super::tissue::Tissue;
use crate::mesh::Vector;
use crate::model::problem::ModelError;
use crate::solver::LoadStep;

impl<'a> FiniteStrain<'a> {
    pub(super) fn rest_in_steps(
        &self,
        steps: u32,
        question: Question<'a>,
        start: Start<'a>,
    ) -> Result<(Tissue<'a>, Rest<'a>), ModelError> {
        let (mut reached, mut rests, mut parts) = (start, Vec::new(), Vec::new());
        let mut step = 1;
        loop {
            let begun = reached.history.len();
            let share = f64::from(step) / f64::from(steps);
            let most_steps = begun + question.most_steps;
            let own = Question { share, most_steps, ..question };
            let (tissue, mut rest) = self.rest_at_share(own, reached)?;
            rests.extend(load_step(own, &tissue, &rest, begun));
            if let Some(touching) = &mut rest.touching {
                let rows = own.constrained.dof_map.ordering.place.iter();
                let positions: Vec<Vector> =
                    rows.map(|&row| rest.positions[row as usize]).collect();
                touching.keep_load_step(&positions);
            }
            let newton = rest.report.newton.as_mut();
            parts.extend(newton.into_iter().flat_map(|newton| newton.parts.drain(..)));
            if step == steps {
                if let Some(newton) = &mut rest.report.newton {
                    (newton.load_steps, newton.parts) = (rests, parts);
                }
                return Ok((tissue, rest));
            }
            reached = rest.into_start();
            step += 1;
        }
    }
}

/// Report of rest at the end of a load step that began after so many residuals.
fn load_step(question: Question, tissue: &Tissue, rest: &Rest, begun: usize) -> Option<LoadStep> {
    let loads = question.case.forces.iter().map(|force| force * question.share);
    let mut acting: Vec<Vector> = loads.collect();
    if let Some(touching) = &rest.touching {
        let pressing = touching.forces(acting.len());
        acting.iter_mut().zip(&pressing).for_each(|(force, pressing)| *force += pressing);
    }
    let newton = rest.report.newton.as_ref()?;
    Some(LoadStep {
        rest: rest.on_the_way(begun)?,
        relative_residual: rest.report.relative_residual,
        is_stable: newton.is_stable,
        bulk_in_cells: newton.bulk_in_cells,
        cells_with_bulk: newton.cells_with_bulk,
        is_bulk_in_all: tissue.is_bulk_in_all(newton),
        reactions: reactions(question.constrained, &rest.forces, &acting),
    })
}
