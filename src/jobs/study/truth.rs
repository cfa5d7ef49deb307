//! Reference solution of a study, as its documents state it.

use super::documents::{Documents, spec_at};
use crate::jobs::failure::JobError;
use crate::jobs::predict::Prepared;
use crate::jobs::source::StoredMesh;
use crate::schema::methods::ElementName;
use crate::schema::study::document::TruthDocument;
use crate::schema::{ErrorCode, Faults, Pointer, Problem};
use mechanics::mesh::Vector;
use mechanics::prediction::ElementChoice;
use mechanics::study::scenes::usual_truth_element;
use mechanics::study::{MOST_CELLS, StudyScene, Truth, cells_at};

impl Documents<'_> {
    /// What the spec holds for true, if it says so.
    pub(super) fn truth(&self, scene: &mut StudyScene, faults: &mut Faults) {
        let at = spec_at().key("truth");
        match &self.spec.truth {
            Some(TruthDocument { refine: Some(times), element, .. }) => {
                let usual = usual_truth_element(&scene.case);
                let element = element.map_or(usual, ElementName::choice);
                check_element(element, scene, &at.key("element"), faults);
                check_cells(*times, scene, &at.key("refine"), faults);
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

/// A truth that cannot be solved would be found out after all rows.
fn check_element(element: ElementChoice, scene: &StudyScene, at: &Pointer, faults: &mut Faults) {
    let mut cells = scene.case.volume.cells.iter();
    let shapes = element.shapes();
    if let Some((shape, _)) = cells.find(|(shape, _)| !shapes.contains(shape)) {
        let detail = format!(
            "scene {} has {} cells, which cannot be {}: `auto` serves every cell",
            scene.name,
            shape.name(),
            element.name()
        );
        faults.add(at, ErrorCode::MethodNotAvailable, detail);
    }
}

fn check_cells(times: u32, scene: &StudyScene, at: &Pointer, faults: &mut Faults) {
    let cells = cells_at(scene.case.volume.cells.len(), times);
    if cells > MOST_CELLS {
        let detail = format!(
            "the truth of scene {} has {cells:.2e} cells, at most {MOST_CELLS:.0e} are allowed",
            scene.name
        );
        faults.add(at, ErrorCode::OutOfRange, detail);
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
