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

/// The report of a study. Errors are distances at the skin nodes of level 0 from where the truth has them, by area; of a
/// scan they are distances between it and the predicted skin, both ways, where the skin moves and both are there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReportDocument {
    /// The version of this document: 1.
    pub schema: u32,
    /// The id of the job; absent from reports of the command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    pub spec_hash: String,
    /// The same where everything but the rules of the outcome is: thresholds, baseline, tolerances, expected failures.
    /// A study with the key of an earlier one takes its rows and judges them again.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    #[schema(required = false)]
    pub rows_key: String,
    /// The study whose rows these are; absent where they were solved for this report.
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
    /// Of a study with a scan for its truth and swept constants.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub constant_maps: Vec<ConstantMapDocument>,
    /// What has no rows and judges nothing: variants that do not serve a scene, and levels at which a variant is the truth itself or
    /// finer.
    #[serde(default)]
    #[schema(required = false)]
    pub skipped: Vec<SkippedDocument>,
    /// Every two variants on the scenes that both solved.
    pub comparisons: Vec<VariantComparisonDocument>,
    /// What a reader of many comparisons has to know.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub comparisons_note: Option<String>,
    pub convergence: Vec<ConvergenceDocument>,
    /// Of a study with scenes of one `series`: how the skin converges over the cell sizes of their meshes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub cell_sizes: Vec<CellSizesDocument>,
    /// What the program answers for these numbers.
    pub statement: String,
}

/// An earlier study whose rows were taken.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct RowsOfDocument {
    /// Absent from reports of the command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    /// When it was solved: RFC 3339, UTC.
    pub created: String,
}

/// A variant that does not serve a scene, or is the truth itself at a level.
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

/// By which rules rows were judged.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RulesDocument {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub thresholds: Option<ThresholdsDocument>,
    pub tolerances: TolerancesDocument,
    pub expected_failures: Vec<String>,
}

/// What came of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RowStatus {
    Solved,
    /// Refused or failed; `error` says why.
    Failed,
    /// The time of the study ran out before.
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

/// How a row is judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RowVerdict {
    Pass,
    /// Above a threshold or worse than in the baseline.
    Worse,
    /// Failed, and nothing says that it may.
    Failed,
    /// Failed as it may: expected, or as in the baseline.
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
    /// The elements in use; empty where there are none.
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
    /// Whether no other row of the same scene, plan and material is both faster and nearer to the truth.
    pub on_front: bool,
    pub verdict: RowVerdict,
    /// Why it is no pass, in sentences with the numbers.
    #[serde(default)]
    pub reasons: Vec<String>,
}

/// What a solved row measured; absent from rows without numbers.
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
    /// The most memory of the process during the row; absent where the system does not report it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub peak_mb: Option<f64>,
    #[schema(required = false)]
    pub mean_mm: f64,
    #[schema(required = false)]
    pub p95_mm: f64,
    #[schema(required = false)]
    pub max_mm: f64,
    /// From the predicted skin to the closest point of the true one.
    #[schema(required = false)]
    pub closest_point_mm: ErrorsDocument,
    /// By the names of the parts of the skin.
    #[schema(required = false)]
    pub regions_mm: BTreeMap<String, ErrorsDocument>,
    /// How far the skin moves, mean by area.
    #[schema(required = false)]
    pub skin_mean_mm: f64,
    /// What the mesh leaves out of the answer, as estimated without the truth; absent where that is not estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub numerical_error_mm: Option<ErrorsDocument>,
    /// What linearity leaves out of the answer, as estimated without the truth; absent where that is not estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub linearity_error_mm: Option<ErrorsDocument>,
    /// The mean error that is expected of the answer, over the true one: of its mesh, and of linearity too where the truth is
    /// one of finite strain; of `auto` over the skin that moves. Absent where one of the two is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub effectivity: Option<f64>,
    /// Of `auto`: the model that it took, as in `adequacy` of a prediction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub chosen: Option<String>,
    /// Absent where there are no cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub smallest_det_f: Option<f64>,
    /// Error of the reference solution of this plan and these materials; absent where it is a formula or a scan, or
    /// that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub truth_error_mm: Option<TruthErrorDocument>,
    /// Whether that truth was solved with contact: absent where it was not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub truth_contact: bool,
    /// Share of the moving skin's area that has a scan opposite; absent without a scan.
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
    /// Pairs of rows left out because one failed.
    pub unsolved: u64,
    /// Pairs of rows left out because the truth of one has contact and that of the other has none.
    #[serde(default)]
    #[schema(required = false)]
    pub other_truths: u64,
    /// Of first minus second.
    pub median_difference_mm: f64,
    /// Absent where there is nothing to rank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub test: Option<SignedRankDocument>,
    /// What the numbers allow to say.
    pub sentence: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SignedRankDocument {
    /// Scenes with a difference: the n of the test.
    pub differing: u64,
    pub w_positive: f64,
    pub w_negative: f64,
    /// Scenes without a difference left out before the ranking (Wilcoxon).
    pub p_two_sided: f64,
    /// The same left out after the ranking (Pratt).
    pub p_two_sided_pratt: f64,
    /// Counted out and not approximated.
    pub exact: bool,
    /// The smallest p that so many scenes can give.
    pub smallest_p: f64,
    /// Matched-pairs rank biserial correlation, -1 to 1.
    pub rank_biserial: f64,
}

/// The movement of the skin on meshes that follow each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConvergenceDocument {
    pub scene: String,
    pub plan: String,
    pub material: String,
    pub label: String,
    pub levels: Vec<u32>,
    /// Mean over the skin on each.
    pub skin_mean_mm: Vec<f64>,
    /// Share of the last by which it changed on the last step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub last_change: Option<f64>,
    /// Observed; absent with fewer than three meshes, or where steps do not shrink.
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
    /// Where its rows were solved.
    pub fn source(&self) -> RowsOfDocument {
        let own = RowsOfDocument { job: self.job.clone(), created: self.created.clone() };
        self.rows_of.clone().unwrap_or(own)
    }

    /// Whether every row had its time.
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
