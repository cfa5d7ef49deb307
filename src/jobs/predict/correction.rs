//! A prediction corrected by a learned model: the corrected skin beside the mechanical one, with its band.

use super::fitted_model::FittedModel;
use super::input::{PredictInput, Prepared};
use crate::jobs::failure::JobError;
use crate::jobs::source::{MeshSource, SourceError};
use crate::schema::learn::correspondence::CorrespondenceDocument;
use crate::schema::learn::model::ModelDocument;
use crate::schema::predict::correction::CorrectedDocument;
use crate::schema::{ErrorCode, Pointer, Problem};
use mechanics::format::vtk::vtp;
use mechanics::format::{ArrayValues, NamedValues, SurfaceOutput};
use mechanics::learning::validation::lengths;
use mechanics::learning::{Corrected, PreoperativeCase, Refusal, measures};
use mechanics::mesh::{Frame, Vector, Warning};
use mechanics::prediction::Prediction;

/// The file of the corrected skin.
pub const CORRECTED_FILE: &str = "corrected.vtp";

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
    let at = Pointer::from_text("/spec/correction/model");
    check_alike(model, prepared, &at)?;
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
    let skin = match learned.correct(asked) {
        Err(refusal @ Refusal::OtherMesh { .. }) => {
            let problem = Problem::at(&at, ErrorCode::NotCorresponding, refusal.to_string());
            return Err(problem.into());
        }
        Err(refusal @ Refusal::OutOfDistribution { .. }) => {
            document.refused = Some(refusal.to_string());
            warnings.push(Warning::new("out-of-distribution", refusal.to_string()));
            None
        }
        Ok(found) if found.distance == 0.0 => {
            let detail = "the model was learned from this very prediction: its correction repeats what it was trained with";
            return Err(Problem::at(&at, ErrorCode::DuplicateName, detail).into());
        }
        Ok(found) => {
            document.distance = Some(found.distance);
            document.changed_mm = Some(mean(&lengths(&found.displacement, &predicted)));
            document.band_mm = found
                .band
                .as_ref()
                .map(|band| mean(&band.iter().map(|[low, high]| high - low).collect::<Vec<_>>()));
            Some(file(prepared, &predicted, &found)?)
        }
    };
    Ok(Some(Correction { document, skin, warnings }))
}

/// Refuses a case in another frame, or with other nodes, than those that the model was learned from.
fn check_alike(model: &ModelDocument, prepared: &Prepared, at: &Pointer) -> Result<(), JobError> {
    let frame = prepared.case.frame;
    if let Some(own) = model.frame.map(Frame::from).filter(|own| *own != frame) {
        let detail = format!(
            "the model was learned from cases in the frame {}, and the case is in {}: what it adds has other directions there",
            own.name(),
            frame.name()
        );
        return Err(Problem::at(at, ErrorCode::FrameConflict, detail).into());
    }
    let own = CorrespondenceDocument::new(&prepared.scene);
    if let Some(part) = model.correspondence.as_ref().and_then(|known| known.difference(&own)) {
        let detail = format!(
            "the nodes of its {part} are not those of the cases that the model was learned from: nodes do not correspond"
        );
        return Err(Problem::at(at, ErrorCode::NotCorresponding, detail).into());
    }
    Ok(())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The corrected skin; bands are displacements whose components are the ends of the band.
fn file(prepared: &Prepared, predicted: &[f64], found: &Corrected) -> Result<Vec<u8>, JobError> {
    let vectors = |values: &[f64]| -> Vec<Vector> {
        values.chunks_exact(3).map(Vector::from_column_slice).collect()
    };
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
