//! Comparison of methods on the same scenes: time and error of each.

mod answer;
pub mod cell_sizes;
pub mod constant_map;
pub mod convergence;
mod deadline;
mod error;
mod estimated;
mod failure;
mod held_against;
mod levels;
pub mod methods;
pub mod paired;
pub mod pairwise;
pub mod pareto;
pub mod report;
mod run;
mod scan;
mod scan_points;
pub mod scenes;
pub mod stability;
pub mod sweep;
mod truth;
mod truth_cost;
mod truth_error;
mod truth_words;
pub mod variant;

pub use answer::LONG_S;
pub use failure::StudyError;
pub use held_against::{LINEAR_TRUTH, TRUTH_WITHOUT_CONTACT, WITHIN_TRUTH_ERROR};
pub use levels::{MOST_CELLS, cells_at};
pub use report::{Errors, Outcome, Report, Row, SceneReport, Skipped, Solved};
pub use run::{NOT_RUN, run};
pub use truth_cost::{TruthCost, TruthMesh, truth_cost};
pub use variant::{
    ClosedForm, Materials, Scan, ScanMetric, Strain, Study, StudyScene, Truth, Variant,
};

/// Time and memory, measured by the caller: numerics know neither.
pub trait Stopwatch: Sync {
    /// Seconds since some moment.
    fn seconds(&self) -> f64;
    /// Resets the peak of the memory in use.
    fn reset_peak(&self);
    /// The most memory in use since then in MB, where the system tells.
    fn peak_mb(&self) -> Option<f64>;
}
