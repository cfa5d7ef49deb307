//! What speaks against the answer on a refined mesh though the estimate of that mesh is accepted.
//!
//! `auto` accepts the error of an answer, so that its expected error is that of the search for an adequate model (`adequate`): mesh and
//! linearity together. Whoever names linear elements has them refined for the error of their mesh, and linearity by itself must be
//! known and within what is accepted. Objections are the same for both (`adequate::objection`).

use super::adequate::{Accepted, CandidateAnswer};
use super::answer::Answer;
use super::at_points::points_refined;
use super::muscle_field::MuscleField;
use super::nonlinearity::Nonlinearity;
use super::refined_scene::NotRefined;
use super::refinement_goal::{Limit, RefinementGoal};
use super::scene::Scene;
use crate::mesh::Warning;
use crate::mesh::ignored::listed;

/// The warnings by which an answer is not what was wanted, or not all of it estimated; scenes on the first mesh and on that of the answer.
pub(super) fn left_out(
    wanted: &RefinementGoal,
    limits: &[Limit],
    [first, finest]: [&Scene; 2],
    answer: &Answer,
) -> Result<Vec<Warning>, NotRefined> {
    let accepted = Accepted {
        skin_mm: wanted.skin_mm,
        regions_mm: wanted.regions_mm.clone(),
        ..Accepted::default()
    };
    // What the mesh leaves out has been added already where that is asked for.
    let objections = CandidateAnswer::of(finest, answer).objections(false, &accepted);
    let mut told: Vec<Warning> = objections.iter().map(|own| own.not_met(&accepted)).collect();
    match &answer.nonlinearity {
        Ok(left) => told.extend(linearity(wanted, limits, [first, finest], answer, left)),
        Err(reason) => {
            let detail = format!(
                "the error of linearity is not known, and refinement leaves it as it is: {reason}"
            );
            let warning = Warning::new("tolerance-not-met", detail);
            told.push(warning.with("accepted_mm", wanted.skin_mm));
        }
    }
    if finest.mesh.cells.len() > first.mesh.cells.len() {
        told.extend(muscles_stay(first));
        told.extend(points_refined(first)?);
    }
    Ok(told)
}

/// The warning where what linearity leaves out is above what is accepted, by itself or with the mesh.
fn linearity(
    wanted: &RefinementGoal,
    limits: &[Limit],
    scenes: [&Scene; 2],
    answer: &Answer,
    left: &Nonlinearity,
) -> Option<Warning> {
    let mesh = answer.numerical_error.as_ref().ok()?;
    let (limit, of_linearity, expected) = limits.iter().find_map(|limit| {
        let of_linearity = limit.error(scenes, &left.left_out);
        let of_mesh = limit.expected_of_mesh(scenes, &mesh.missing);
        let of_mesh = if wanted.is_of_answer { of_mesh } else { 0.0 };
        // A mesh that is not fine enough is told by the bound that it met.
        let is_of_mesh = of_mesh > limit.accepted_mm;
        let expected = of_linearity + of_mesh;
        (expected > limit.accepted_mm && !is_of_mesh).then_some((limit, of_linearity, expected))
    })?;
    let (accepted, place) = (limit.accepted_mm, limit.part.words());
    let detail = match wanted.is_of_answer && of_linearity <= accepted {
        true => format!(
            "{accepted:.3} mm are accepted {place}, and {expected:.3} mm are expected there, {of_linearity:.3} mm of them by linearity, \
             which a finer mesh does not reduce"
        ),
        false => format!(
            "{accepted:.3} mm are accepted {place}, and the linearisation error alone is {of_linearity:.3} mm there: a finer mesh does not \
             reduce it"
        ),
    };
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", accepted);
    Some(warning.with("expected_mm", expected))
}

/// The warning where muscles around lines or in surfaces count on a mesh that is refined.
fn muscles_stay(scene: &Scene) -> Option<Warning> {
    let counts = |own: &&MuscleField| {
        let is_drawn = own.has_lines || own.body.is_some();
        let is_tissue = own.body.is_some() && scene.muscle_tissue.is_some();
        is_drawn && (is_tissue || own.is_active(&scene.distributed.inner))
    };
    let counting: Vec<&String> =
        scene.muscles.iter().filter(counts).map(|muscle| &muscle.name).collect();
    let detail = format!(
        "finer cells have the muscles of the first mesh, from which they are cut: no estimate includes the error of muscles around lines \
         and in surfaces ({}) on coarse cells; use a finer mesh of the case",
        listed(&counting)
    );
    (!counting.is_empty()).then(|| Warning::new("muscles-not-refined", detail))
}
