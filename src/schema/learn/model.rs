//! `model.json`, a learned model as a file: the cases that it learned from in numbers, and where they come from.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::document::LearnDocument;
use crate::schema::case::document::FrameName;
use crate::schema::cohort::stored::CohortVersionDocument;
use crate::schema::engine::EngineDocument;
use crate::schema::learn::correspondence::CorrespondenceDocument;
use crate::schema::learn::mechanics::MechanicsDocument;
use crate::schema::wire::warning::WarningDocument;
use mechanics::learning::{Cohort, CohortError, Features, LearnedModel, LearningCase};
use mechanics::mesh::Warning;

/// The name of the file.
pub const MODEL_FILE: &str = "model.json";

/// A model; displacements in mm, three numbers for each point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelDocument {
    pub engine: EngineDocument,
    pub spec: LearnDocument,
    /// The stored cohort that the cases are the members of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cohort: Option<CohortVersionDocument>,
    pub cases: Vec<ModelCaseDocument>,
    pub regions: BTreeMap<String, Vec<u32>>,
    /// That of the cases; models of earlier versions do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameName>,
    /// That of the cases' meshes; models of earlier versions do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correspondence: Option<CorrespondenceDocument>,
    /// The method of the predictions that it corrects.
    pub predicted_by: String,
    /// Whether the validation found it nearer to the truth than the mechanical prediction alone.
    pub helps: bool,
    /// Mean errors of validation in mm: of this model, nested, and of mechanics alone.
    pub error_mm: f64,
    pub mechanical_mm: f64,
    /// What speaks against the cases; models of earlier versions do not say it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub suspicions: Vec<WarningDocument>,
}

/// A case with its provenance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelCaseDocument {
    pub name: String,
    /// Of the case in the service.
    pub case: Option<String>,
    /// The job that predicted it, and the hash of its spec.
    pub prediction: Option<String>,
    pub spec_hash: Option<String>,
    /// Of the mesh after the operation.
    pub actual_sha256: Option<String>,
    /// What it was predicted by; models of earlier versions do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mechanics: Option<MechanicsDocument>,
    /// The skin at rest in mm, as the displacements; models without `mechanics` do not have it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at_rest: Vec<f64>,
    pub features: Vec<Vec<f64>>,
    pub bone: Vec<f64>,
    pub predicted: Vec<f64>,
    pub actual: Vec<f64>,
}

impl ModelDocument {
    /// A model that is worse than what it corrects says so.
    pub fn warning(&self) -> Option<Warning> {
        let (learned, mechanical) = (self.error_mm, self.mechanical_mm);
        let detail = format!(
            "what was learned misses {learned:.3} mm in the mean where mechanics alone misses {mechanical:.3}: it is not to be used"
        );
        let warning = Warning::new("learning-does-not-help", detail)
            .with("learned_mm", learned)
            .with("mechanical_mm", mechanical);
        (!self.helps).then_some(warning)
    }

    /// What speaks against the cases that it was learned from, with the name that a prediction has for the model.
    pub fn suspected(&self, model: &str) -> Option<Warning> {
        let first = self.suspicions.first()?;
        let mut codes: Vec<&str> = self.suspicions.iter().map(|own| own.code.as_str()).collect();
        codes.sort_unstable();
        codes.dedup();
        let detail = format!(
            "the model {model:?} was learned from cases that are doubtful ({}): {}; what it adds to the prediction is, too",
            codes.join(", "),
            first.detail
        );
        let warning = Warning::new("model-suspect", detail);
        Some(warning.with("suspicions", self.suspicions.len() as f64))
    }

    /// The model, fitted to its cases.
    pub fn to_model(&self) -> Result<LearnedModel, CohortError> {
        let case = |own: &ModelCaseDocument| LearningCase {
            name: own.name.clone(),
            class: String::new(),
            features: Features { blocks: own.features.clone() },
            bone: own.bone.clone(),
            predicted: own.predicted.clone(),
            actual: own.actual.clone(),
        };
        let cohort = Cohort::new(
            self.cases.iter().map(case).collect(),
            self.regions.clone(),
            &self.predicted_by,
        )?;
        Ok(LearnedModel::new(&cohort, self.spec.method(), self.spec.distance.into()))
    }
}
