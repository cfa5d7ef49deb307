//! What a study holds for true, as its documents say it.

use super::documents::{Documents, spec_at};
use crate::jobs::failure::JobError;
use crate::jobs::predict::Prepared;
use crate::jobs::source::StoredMesh;
use crate::schema::methods::ElementName;
use crate::schema::study::document::TruthDocument;
use crate::schema::{ErrorCode, Faults, Pointer, Problem};
use mechanics::mesh::Vector;
use mechanics::study::{StudyScene, Truth};

impl Documents<'_> {
    /// What the spec holds for true, if it says so.
    pub(super) fn truth(&self, scene: &mut StudyScene, faults: &mut Faults) {
        let at = spec_at().key("truth");
        match &self.spec.truth {
            Some(TruthDocument { refine: Some(times), element, .. }) => {
                let element = element.unwrap_or(ElementName::Quadratic).choice();
                scene.truth = Truth::Refined { times: *times, element };
            }
            Some(TruthDocument { closed_form: true, .. })
                if !matches!(scene.truth, Truth::ClosedForm(_)) =>
            {
                let detail = format!("scene {} has no closed form", scene.name);
                faults.add(&at.key("closed_form"), ErrorCode::NoClosedForm, detail);
            }
            _ => {}
        }
    }
}

/// The displacement of each skin node to where a predicted skin has it.
pub(super) fn known_displacement(
    skin: &StoredMesh,
    prepared: &Prepared,
    at: &Pointer,
) -> Result<Vec<Vector>, JobError> {
    let Some(predicted) = skin.surface_in_mm() else {
        return Err(
            Problem::at(at, ErrorCode::WrongMesh, "the result of that job is no surface").into()
        );
    };
    let rest = &prepared.scene.skin;
    let numbers = predicted.node_ids.as_deref().unwrap_or_default();
    if numbers != rest.nodes() || predicted.points.len() != rest.surface.points.len() {
        let detail = format!(
            "the skin of that job has {} nodes, that of the case {}, and their numbers have to be the same",
            predicted.points.len(),
            rest.nodes().len()
        );
        return Err(Problem::at(at, ErrorCode::NotCorresponding, detail).into());
    }
    let pairs = predicted.points.iter().zip(&rest.surface.points);
    Ok(pairs.map(|(moved, rest)| moved - rest).collect())
}
