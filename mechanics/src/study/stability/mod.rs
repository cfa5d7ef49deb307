//! Map of failures: each axis increases one parameter until an answer can no longer be right, and each probe records
//! how the method reacted.
//!
//! A probe is judged by the 95th percentile of |u - u*| over the skin, by area, against a bound stated for its
//! axis. The one verdict that must never appear is `Wrong`: an answer beyond the bound without a word.

pub mod axes;
mod axis;
mod judge;
mod own_axes;
pub mod random;
mod scenes;

use super::{Stopwatch, Variant};
use crate::mesh::{Vector, Warning};
use crate::prediction::{Case, Laws, Plan, Settings};

pub use judge::map;

/// One thing that is turned up, value by value.
pub struct Axis {
    /// A stable word.
    pub name: &'static str,
    pub title: &'static str,
    /// Empty where the values are words.
    pub unit: &'static str,
    /// The scene and what its answers are held against, in words.
    pub scene: &'static str,
    pub reference: &'static str,
    /// What the 95th percentile of the error over the skin may be, in mm.
    pub bound_mm: f64,
    /// From harmless to hopeless, with the words for each.
    pub values: Vec<(f64, String)>,
    /// The scene at a value for a variant; none where the value means nothing to it.
    pub probe: fn(f64, &Variant) -> Result<Option<Probe>, Refusal>,
    /// The right answer at a value.
    pub truth: fn(f64) -> Truth,
    /// The right answer for methods of finite strain, of the law that they solve; none where the axis says nothing of them.
    pub finite_truth: Option<fn(f64, Laws) -> Truth>,
}

impl Axis {
    /// The right answer at a value for a method that knows such laws.
    fn truth_of(&self, value: f64, laws: Laws) -> Option<Truth> {
        match laws {
            Laws::AtRest => Some((self.truth)(value)),
            Laws::SaintVenantKirchhoff | Laws::Any => {
                self.finite_truth.map(|truth| truth(value, laws))
            }
        }
    }
}

/// Input of a method.
pub struct Probe {
    pub case: Case,
    pub plan: Plan,
    pub settings: Settings,
}

/// Reference of an answer.
pub enum Truth {
    /// Displacement in mm at a point.
    Formula(Box<dyn Fn(&Vector) -> Vector + Send + Sync>),
    /// The answer of a better method, on a mesh whose nodes include those of the skin of the probe.
    Solved(Box<Probe>),
    /// That of the first value of the axis, so many times: where scene or movement differ by a factor only.
    First { times: f64 },
    /// There is none: only a refusal is right.
    Impossible,
}

/// A refusal of documents: the place, the stable word and the sentence.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    pub pointer: String,
    pub code: String,
    pub detail: String,
}

/// Outcome of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// An answer within the bound, and no warning.
    Good,
    /// An answer within the bound that carries a warning all the same.
    Cautious,
    /// An answer beyond the bound, or where there is none, with a warning.
    Warned,
    /// Refused before anything is solved.
    Refused,
    /// Ended with an error.
    Failed,
    /// An answer beyond the bound, or where there is none, without a warning.
    Wrong,
}

impl Verdict {
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Good => "good",
            Verdict::Cautious => "cautious",
            Verdict::Warned => "warned",
            Verdict::Refused => "refused",
            Verdict::Failed => "failed",
            Verdict::Wrong => "wrong",
        }
    }
}

/// The verdict on one probe with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    pub verdict: Verdict,
    /// Of an answer.
    pub answer: Option<Answer>,
    /// Of a refusal or a failure: the place in the documents, empty for failures, the word and the sentence.
    pub refusal: Option<Refusal>,
}

/// Measured errors of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// 95th percentile over the skin by area, in mm; none where there is no truth.
    pub error_mm: Option<f64>,
    pub smallest_det_f: f64,
    pub inverted_share: f64,
    /// Of one cell, in radians.
    pub largest_rotation: f64,
    pub warnings: Vec<Warning>,
}

/// All axes with all variants.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The labels of the variants.
    pub variants: Vec<String>,
    pub axes: Vec<AxisMap>,
}

/// One axis with all variants.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisMap {
    pub name: &'static str,
    pub title: &'static str,
    pub unit: &'static str,
    pub scene: &'static str,
    pub reference: &'static str,
    pub bound_mm: f64,
    pub values: Vec<(f64, String)>,
    /// [variant][value]; none where the value means nothing to the variant.
    pub findings: Vec<Vec<Option<Finding>>>,
}

impl Map {
    /// How many probes have this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        let findings = self.axes.iter().flat_map(|axis| axis.findings.iter().flatten().flatten());
        findings.filter(|finding| finding.verdict == verdict).count()
    }
}

/// How long probes may take, and who takes the time.
pub struct Bounds<'a> {
    pub stopwatch: &'a dyn Stopwatch,
    /// For one probe, in s; what takes longer has failed with `budget-exceeded`.
    pub seconds: f64,
}
