//! Outcome of a study, its reasons, and the rows that prevent a pass.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The outcome of a study.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OutcomeName {
    /// All rows ran, and none is worse.
    Pass,
    /// A row is above a threshold, worse than in the baseline, or failed.
    Worse,
    /// Rows did not run, or none was solved, or the baseline has rows that this study lacks.
    #[default]
    Incomplete,
    /// A baseline was requested, and is missing.
    NoBaseline,
}

impl OutcomeName {
    pub fn name(self) -> &'static str {
        match self {
            OutcomeName::Pass => "pass",
            OutcomeName::Worse => "worse",
            OutcomeName::Incomplete => "incomplete",
            OutcomeName::NoBaseline => "no-baseline",
        }
    }

    /// The exit code of the command line.
    pub fn exit_code(self) -> u8 {
        match self {
            OutcomeName::Pass => 0,
            OutcomeName::Worse => 1,
            OutcomeName::Incomplete => 4,
            OutcomeName::NoBaseline => 5,
        }
    }
}

/// The outcome and its reasons.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct VerdictDocument {
    pub outcome: OutcomeName,
    /// Sentences with the numbers.
    pub reasons: Vec<String>,
    pub rows: u64,
    pub solved: u64,
    pub failed: u64,
    pub worse: u64,
    pub not_run: u64,
    /// Number of rows if every variant supported every scene and none were the reference itself.
    #[serde(default)]
    #[schema(required = false)]
    pub skipped: u64,
    /// The job of the baseline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub baseline: Option<String>,
    /// The rows that are worse than allowed or failed, with each exceeded limit: one entry for each measure.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub failing: Vec<FailingRowDocument>,
}

/// A row that prevents a pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FailingRowDocument {
    pub scene: String,
    pub plan: String,
    pub label: String,
    pub material: String,
    pub level: u32,
    /// `mean_mm`, `p95_mm`, `wall_s` or `iterations`; absent if the row has no numbers, or its plan moves nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub measure: Option<String>,
    /// The value of the row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub value: Option<f64>,
    /// The largest allowed value, by a threshold or by the baseline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub limit: Option<f64>,
    /// The same in a sentence.
    pub reason: String,
}

impl FailingRowDocument {
    /// In one line.
    pub fn sentence(&self) -> String {
        let FailingRowDocument { scene, plan, label, material, level, reason, .. } = self;
        format!("{scene}, {plan}, {label}, {material}, level {level}: {reason}")
    }
}
