//! Input of a study.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::verdict::Baseline;
use crate::schema::study::report::ReportDocument;
use crate::schema::study::truth::TruthMethodName;
use crate::schema::{CaseDocument, StudyDocument};

/// A study: its cases and its baseline in full beside the spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    /// By their ids in the spec.
    pub cases: BTreeMap<String, CaseDocument>,
    /// The report of the study that the spec names as baseline.
    pub baseline: Option<Box<ReportDocument>>,
    /// What the job of the spec's truth answered by, as far as strain goes; none where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth_method: Option<TruthMethodName>,
    /// The report of an earlier study that may have the same rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub earlier: Option<Box<ReportDocument>>,
    pub spec: StudyDocument,
}

impl StudyInput {
    /// The ids of all meshes that its cases read.
    pub fn mesh_ids(&self) -> Vec<String> {
        let mut ids: Vec<String> = self.cases.values().flat_map(CaseDocument::mesh_ids).collect();
        let mut spec = self.spec.clone();
        ids.extend(spec.truth_meshes_mut().into_iter().map(|(_, id)| id.clone()));
        for plan in spec.plan_documents_mut() {
            for (_, id) in plan.surface_references_mut() {
                let is_bone = |case: &CaseDocument| case.bones.iter().any(|bone| bone.name == *id);
                if !self.cases.values().any(is_bone) {
                    ids.push(id.clone());
                }
            }
        }
        ids.sort_unstable();
        ids.dedup();
        ids
    }

    /// The earlier report, if it has all rows of this key.
    pub fn rows_of(&self, rows_key: &str) -> Option<&ReportDocument> {
        let earlier = self.earlier.as_deref();
        earlier.filter(|earlier| earlier.rows_key == rows_key && earlier.is_complete())
    }

    /// The baseline of its outcome.
    pub fn to_baseline(&self) -> Baseline<'_> {
        match (&self.baseline, &self.spec.baseline) {
            (Some(report), _) => Baseline::Report(report),
            (None, Some(job)) => Baseline::Missing(format!("the baseline {job} has no report")),
            (None, None) => Baseline::NotAsked,
        }
    }
}
