//! A prediction corrected by a learned model: the corrected skin beside the mechanical one, with its band.

use super::fitted_model::FittedModel;
use super::input::{PredictInput, Prepared};
use crate::jobs::failure::JobError;
use crate::jobs::source::{MeshSource, SourceError};
use crate::schema::learn::correspondence::CorrespondenceDocument;
use crate::schema::learn::mechanics::MechanicsDocument;
use crate::schema::learn::model::ModelDocument;
use crate::schema::predict::correction::CorrectedDocument;
use crate::schema::{ErrorCode, Pointer, Problem};
use mechanics::format::vtk::vtp;
use mechanics::format::{ArrayValues, NamedValues, SurfaceOutput};
use mechanics::learning::validation::lengths;
use mechanics::learning::{Corrected, PreoperativeCase, Refusal, measures};
use mechanics::mesh::{Frame, Vector, Warning};
use mechanics::prediction::{Case, Plan, Prediction, Scene};
use mechanics::validation::operated::unlike_skins;

/// The file of the corrected skin.
pub const CORRECTED_FILE: &str = "corrected.vtp";

/// In mm: a plan that moves no node farther moves nothing.
const NOTHING_MM: f64 = 1e-9;

/// A prediction corrected by a model.
pub struct Correction {
    pub document: CorrectedDocument,
    /// None where the case is refused.
    pub skin: Option<Vec<u8>>,
    pub warnings: Vec<Warning>,
}

impl PredictInput {
    /// The model that the spec names, if it names one.
    pub(super) fn fetch_model(
        &self,
        sources: &dyn MeshSource,
    ) -> Result<Option<FittedModel>, JobError> {
        let Some(correction) = &self.spec.correction else { return Ok(None) };
        let at = Pointer::from_text("/spec/correction/model");
        let refused = |code, detail: String| JobError::from(Problem::at(&at, code, detail));
        let bytes = sources.model(&correction.model).map_err(|error| match error {
            SourceError::Unknown { id } => {
                refused(ErrorCode::UnknownJob, format!("there is no model {id:?}"))
            }
            other => JobError::Source(other),
        })?;
        let model: ModelDocument = serde_json::from_slice(&bytes)
            .map_err(|error| refused(ErrorCode::WrongType, format!("it is no model: {error}")))?;
        let method = self.spec.method.name();
        if method != model.predicted_by {
            let detail = format!(
                "the model corrects predictions by `{}`, and `method` is `{method}`: what they miss is not the same",
                model.predicted_by
            );
            return Err(refused(ErrorCode::MethodMismatch, detail));
        }
        let fitted = FittedModel::new(model)
            .map_err(|error| refused(ErrorCode::NotCorresponding, error.to_string()))?;
        Ok(Some(fitted))
    }

    /// Refuses a case in another frame, or with other nodes, than those that the model was learned from, and a prediction of
    /// another kind.
    pub(super) fn check_model(
        &self,
        model: &ModelDocument,
        case: &Case,
        plan: &Plan,
        scene: &Scene,
    ) -> Result<(), JobError> {
        let refused = |code, detail: String| {
            Err(Problem::at(&Pointer::from_text("/spec/correction/model"), code, detail).into())
        };
        if let Some(own) = model.frame.map(Frame::from).filter(|own| *own != case.frame) {
            let detail = format!(
                "the model was learned from cases in the frame {}, and the case is in {}: what it adds has other directions there",
                own.name(),
                case.frame.name()
            );
            return refused(ErrorCode::FrameConflict, detail);
        }
        let own = CorrespondenceDocument::new(scene);
        if let Some(part) = model.correspondence.as_ref().and_then(|known| known.difference(&own)) {
            let detail = format!(
                "the nodes of its {part} are not those of the cases that the model was learned from: nodes do not correspond"
            );
            return refused(ErrorCode::NotCorresponding, detail);
        }
        if self.spec.refine.is_some() {
            let detail = "the mesh is refined (`refine`), and the model corrects what predictions on the mesh of the case miss: leave one of them out";
            return refused(ErrorCode::MethodMismatch, detail.to_owned());
        }
        let learned = model.cases.first().and_then(|own| own.mechanics.as_ref());
        let conflict = learned.and_then(|own| self.mechanics(plan, scene).conflict(own));
        if let Some([what, own, learned]) = conflict {
            let detail = format!(
                "`{what}` is {own} here, and {learned} in the predictions that the model was learned from: what they miss is not the same"
            );
            return refused(ErrorCode::MethodMismatch, detail);
        }
        Ok(())
    }

    /// In what the case differs from all that the model was learned from.
    fn unlike_learned(&self, model: &ModelDocument, prepared: &Prepared) -> Vec<Warning> {
        let learned: Vec<&MechanicsDocument> =
            model.cases.iter().filter_map(|own| own.mechanics.as_ref()).collect();
        if learned.is_empty() {
            return Vec::new();
        }
        let Prepared { plan, scene, .. } = prepared;
        let mut warnings = self.mechanics(plan, scene).unlike(&learned);
        let skins: Vec<Vec<Vector>> = model.cases.iter().map(|own| vectors(&own.at_rest)).collect();
        let skins: Vec<&[Vector]> = skins.iter().map(Vec::as_slice).collect();
        warnings.extend(unlike_skins(&scene.skin.surface.points, &skins));
        warnings
    }
}

/// Asks the model of a prepared prediction, where there is one.
pub fn corrected(
    input: &PredictInput,
    prepared: &Prepared,
    prediction: &Prediction,
) -> Result<Option<Correction>, JobError> {
    let (Some(spec), Some(fitted)) = (&input.spec.correction, &prepared.model) else {
        return Ok(None);
    };
    let FittedModel { document: model, learned } = fitted;
    let (scene, displacement) = (&prepared.scene, &prediction.displacement);
    let features = measures::features(scene, displacement);
    let (bone, predicted) =
        (measures::bone(scene, displacement), measures::skin(scene, displacement));
    let asked = PreoperativeCase { features: &features, bone: &bone, predicted: &predicted };
    let mut document = CorrectedDocument {
        model: spec.model.clone(),
        helps: model.helps,
        model_error_mm: model.error_mm,
        mechanical_error_mm: model.mechanical_mm,
        refused: None,
        distance: None,
        farthest: learned.fitted.farthest,
        changed_mm: None,
        band_mm: None,
    };
    let mut warnings: Vec<Warning> = model.warning().into_iter().collect();
    warnings.extend(model.suspected(&spec.model));
    warnings.extend(input.unlike_learned(model, prepared));
    if displacement.iter().all(|moved| moved.norm() <= NOTHING_MM) {
        let detail = "the plan moves nothing: nothing is added to it";
        document.refused = Some(detail.to_owned());
        warnings.push(Warning::new("nothing-to-correct", detail));
        return Ok(Some(Correction { document, skin: None, warnings }));
    }
    let found = match learned.correct(asked) {
        Err(refusal @ Refusal::OutOfDistribution { .. }) => {
            document.refused = Some(refusal.to_string());
            warnings.push(Warning::new("out-of-distribution", refusal.to_string()));
            return Ok(Some(Correction { document, skin: None, warnings }));
        }
        found => known(found)?,
    };
    let changed = mean(&lengths(&found.displacement, &predicted));
    warnings.extend(above_movement(changed, &predicted));
    document.distance = Some(found.distance);
    document.changed_mm = Some(changed);
    document.band_mm = found
        .band
        .as_ref()
        .map(|band| mean(&band.iter().map(|[low, high]| high - low).collect::<Vec<_>>()));
    let skin = Some(file(prepared, &predicted, &found)?);
    Ok(Some(Correction { document, skin, warnings }))
}

/// What a model says, unless it is of another mesh or of the very prediction.
fn known(found: Result<Corrected, Refusal>) -> Result<Corrected, JobError> {
    let refused = |code, detail: String| {
        Err(Problem::at(&Pointer::from_text("/spec/correction/model"), code, detail).into())
    };
    match found {
        Err(refusal) => refused(ErrorCode::NotCorresponding, refusal.to_string()),
        Ok(found) if found.distance == 0.0 => {
            let detail = "the model was learned from this very prediction: its correction repeats what it was trained with";
            refused(ErrorCode::DuplicateName, detail.to_owned())
        }
        Ok(found) => Ok(found),
    }
}

/// A warning where more is added than mechanics moves the skin.
fn above_movement(changed: f64, predicted: &[f64]) -> Option<Warning> {
    let moved = mean(&lengths(predicted, &vec![0.0; predicted.len()]));
    let detail = format!(
        "the correction adds {changed:.3} mm to the skin in the mean, and mechanics moves it by {moved:.3} mm: what was learned from larger movements says little of this one"
    );
    let warning = Warning::new("correction-above-movement", detail);
    (changed > moved).then(|| warning.with("changed_mm", changed).with("moved_mm", moved))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn vectors(values: &[f64]) -> Vec<Vector> {
    values.chunks_exact(3).map(Vector::from_column_slice).collect()
}

/// The corrected skin; bands are displacements whose components are the ends of the band.
fn file(prepared: &Prepared, predicted: &[f64], found: &Corrected) -> Result<Vec<u8>, JobError> {
    let (corrected, mechanical) = (vectors(&found.displacement), vectors(predicted));
    let ends = found.band.as_ref().map(|band| {
        [0, 1].map(|end| vectors(&band.iter().map(|ends| ends[end]).collect::<Vec<_>>()))
    });
    let mut surface = prepared.scene.skin.surface.clone();
    surface.points.iter_mut().zip(&corrected).for_each(|(point, moved)| *point += moved);
    let named = |name, values| NamedValues { name, values: ArrayValues::Vectors(values) };
    let mut output = SurfaceOutput::plain(&surface, prepared.case.frame);
    output.point_arrays = vec![
        named("displacement_mm", &corrected),
        named("mechanical_displacement_mm", &mechanical),
    ];
    if let Some([low, high]) = &ends {
        output.point_arrays.extend([named("band_low_mm", low), named("band_high_mm", high)]);
    }
    Ok(vtp::write(&output)?)
}
