//! `report.json`, the report of a study: rows, fronts, comparisons of variants, convergence, and the outcome.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::cell_sizes::CellSizesDocument;
use super::constants::ConstantMapDocument;
use super::document::{ThresholdsDocument, TolerancesDocument};
pub use super::scene::{StudySceneDocument, TruthErrorDocument};
pub use super::verdict::{FailingRowDocument, OutcomeName, VerdictDocument};
use crate::schema::engine::EngineDocument;

/// The report of a study. Errors are distances at the skin nodes of level 0 from the reference solution, by area; of a
/// scan they are distances between it and the predicted skin, both ways, where the skin moves and both exist.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReportDocument {
    /// The version of this document: 1.
    pub schema: u32,
    /// The id of the job; absent in reports of the command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    pub spec_hash: String,
    /// Equal if all but the rules of the outcome is: thresholds, baseline, tolerances, expected failures.
    /// A study with the key of an earlier one takes its rows and judges them again.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    #[schema(required = false)]
    pub rows_key: String,
    /// The study of these rows; absent if they were solved for this report.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rows_of: Option<RowsOfDocument>,
    pub engine: EngineDocument,
    /// RFC 3339, UTC.
    pub created: String,
    pub verdict: VerdictDocument,
    pub rules: RulesDocument,
    pub scenes: Vec<StudySceneDocument>,
    pub rows: Vec<RowDocument>,
    /// Of a study with a scan as reference and swept constants.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub constant_maps: Vec<ConstantMapDocument>,
    /// Combinations without rows: variants that do not support a scene, and levels at which a variant is the reference itself or
    /// finer.
    #[serde(default)]
    #[schema(required = false)]
    pub skipped: Vec<SkippedDocument>,
    /// Every two variants on the scenes that both solved.
    pub comparisons: Vec<VariantComparisonDocument>,
    /// A note on multiple comparisons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub comparisons_note: Option<String>,
    pub convergence: Vec<ConvergenceDocument>,
    /// Of a study with scenes of one `series`: the convergence of the skin over the cell sizes of their meshes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub cell_sizes: Vec<CellSizesDocument>,
    /// The disclaimer of these numbers.
    pub statement: String,
}

/// An earlier study whose rows were reused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct RowsOfDocument {
    /// Absent in reports of the command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    /// When it was solved: RFC 3339, UTC.
    pub created: String,
}

/// A variant that does not support a scene, or is the reference itself at a level.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct SkippedDocument {
    pub scene: String,
    pub method: String,
    /// The variant.
    pub label: String,
    /// A sentence.
    pub reason: String,
    /// Rows that it would have.
    pub rows: u64,
}

/// The rules of the outcome.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RulesDocument {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub thresholds: Option<ThresholdsDocument>,
    pub tolerances: TolerancesDocument,
    pub expected_failures: Vec<String>,
}

/// The status of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RowStatus {
    Solved,
    /// Refused or failed; `error` says why.
    Failed,
    /// The time of the study had run out.
    NotRun,
}

impl RowStatus {
    pub fn name(self) -> &'static str {
        match self {
            RowStatus::Solved => "solved",
            RowStatus::Failed => "failed",
            RowStatus::NotRun => "not-run",
        }
    }
}

/// The verdict on a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RowVerdict {
    Pass,
    /// Above a threshold or worse than in the baseline.
    Worse,
    /// Failed unexpectedly.
    Failed,
    /// Failed as expected, or as in the baseline.
    KnownFailure,
    #[default]
    NotRun,
}

impl RowVerdict {
    pub fn name(self) -> &'static str {
        match self {
            RowVerdict::Pass => "pass",
            RowVerdict::Worse => "worse",
            RowVerdict::Failed => "failed",
            RowVerdict::KnownFailure => "known-failure",
            RowVerdict::NotRun => "not-run",
        }
    }
}

/// One variant on one scene, plan, material and mesh level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RowDocument {
    pub scene: String,
    pub plan: String,
    pub method: String,
    /// The variant.
    pub label: String,
    /// The elements in use; empty without any.
    pub element: String,
    pub material: String,
    pub level: u32,
    pub status: RowStatus,
    #[serde(flatten)]
    pub numbers: Option<NumbersDocument>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error: Option<RowErrorDocument>,
    /// Codes.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Whether no other row of the same scene, plan and material is both faster and more accurate.
    pub on_front: bool,
    pub verdict: RowVerdict,
    /// Why it does not pass, in sentences with the numbers.
    #[serde(default)]
    pub reasons: Vec<String>,
}

/// The measurements of a solved row; absent in rows without numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NumbersDocument {
    #[schema(required = false)]
    pub unknowns: u64,
    #[schema(required = false)]
    pub iterations: u64,
    /// Median over `repeats` of mesh in memory to displacement in memory, on one thread.
    #[schema(required = false)]
    pub wall_s: f64,
    #[schema(required = false)]
    pub repeats: u64,
    /// The peak memory of the process during the row; absent if the system does not report it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub peak_mb: Option<f64>,
    #[schema(required = false)]
    pub mean_mm: f64,
    #[schema(required = false)]
    pub p95_mm: f64,
    #[schema(required = false)]
    pub max_mm: f64,
    /// From the predicted skin to the closest point of the reference.
    #[schema(required = false)]
    pub closest_point_mm: ErrorsDocument,
    /// By the names of the parts of the skin.
    #[schema(required = false)]
    pub regions_mm: BTreeMap<String, ErrorsDocument>,
    /// Mean displacement of the skin, by area.
    #[schema(required = false)]
    pub skin_mean_mm: f64,
    /// The discretisation error, estimated without the reference; absent without an estimate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub numerical_error_mm: Option<ErrorsDocument>,
    /// The linearisation error, estimated without the reference; absent without an estimate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub linearity_error_mm: Option<ErrorsDocument>,
    /// The expected mean error of the result, over the true one: of its mesh, and also of linearity if the reference is
    /// one of finite strain; of `auto` over the moving skin. Absent if one of the two is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub effectivity: Option<f64>,
    /// Of `auto`: the chosen model, as in `adequacy` of a prediction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub chosen: Option<String>,
    /// Absent without cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub smallest_det_f: Option<f64>,
    /// Error of the reference solution of this plan and these materials; absent if it is a formula or a scan, or
    /// unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub truth_error_mm: Option<TruthErrorDocument>,
    /// Whether the reference was solved with contact; absent if not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub truth_contact: bool,
    /// Share of the moving skin's area covered by the scan; absent without a scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub covered_share: Option<f64>,
}

/// By area; p95 is the smallest value whose cumulative weight reaches 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ErrorsDocument {
    pub mean: f64,
    pub p95: f64,
    pub max: f64,
}

/// Why a row has no numbers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct RowErrorDocument {
    /// A stable word.
    #[serde(rename = "type")]
    pub kind: String,
    pub detail: String,
}

/// Two variants by Wilcoxon's signed rank test; the trials are scenes, each with the mean over its rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct VariantComparisonDocument {
    pub first: String,
    pub second: String,
    /// `mean_mm` or `p95_mm`.
    pub measure: String,
    pub scenes: u64,
    /// Pairs of rows behind them.
    pub rows: u64,
    /// Pairs of rows omitted because one failed.
    pub unsolved: u64,
    /// Pairs of rows omitted because the truth of one has contact and that of the other has none.
    #[serde(default)]
    #[schema(required = false)]
    pub other_truths: u64,
    /// Of first minus second.
    pub median_difference_mm: f64,
    /// Absent if there is nothing to rank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub test: Option<SignedRankDocument>,
    /// The conclusion from the numbers.
    pub sentence: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SignedRankDocument {
    /// Scenes with a difference: the n of the test.
    pub differing: u64,
    pub w_positive: f64,
    pub w_negative: f64,
    /// Scenes without a difference omitted before the ranking (Wilcoxon).
    pub p_two_sided: f64,
    /// The same omitted after the ranking (Pratt).
    pub p_two_sided_pratt: f64,
    /// Exact, not approximated.
    pub exact: bool,
    /// The smallest p possible with this number of scenes.
    pub smallest_p: f64,
    /// Matched-pairs rank biserial correlation, -1 to 1.
    pub rank_biserial: f64,
}

/// The movement of the skin on successively refined meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConvergenceDocument {
    pub scene: String,
    pub plan: String,
    pub material: String,
    pub label: String,
    pub levels: Vec<u32>,
    /// Mean over the skin on each.
    pub skin_mean_mm: Vec<f64>,
    /// Relative change on the last step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub last_change: Option<f64>,
    /// Observed order; absent with fewer than three meshes, or if steps do not decrease.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub order: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub limit_mm: Option<f64>,
}

/// A study in the manifest of its job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StudySummaryDocument {
    pub verdict: VerdictDocument,
    /// Labels of the variants on a front, each once.
    pub on_front: Vec<String>,
}

impl ReportDocument {
    /// The study that solved its rows.
    pub fn source(&self) -> RowsOfDocument {
        let own = RowsOfDocument { job: self.job.clone(), created: self.created.clone() };
        self.rows_of.clone().unwrap_or(own)
    }

    /// Whether no row was left out for lack of time.
    pub fn is_complete(&self) -> bool {
        self.rows.iter().all(|row| row.status != RowStatus::NotRun)
    }

    pub fn summary(&self) -> StudySummaryDocument {
        let mut on_front: Vec<String> = Vec::new();
        for row in self.rows.iter().filter(|row| row.on_front) {
            if !on_front.contains(&row.label) {
                on_front.push(row.label.clone());
            }
        }
        StudySummaryDocument { verdict: self.verdict.clone(), on_front }
    }
}
