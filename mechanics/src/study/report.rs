//! Report of a study: one row for each method, mesh level, material, plan and scene.

use std::collections::BTreeMap;

use crate::mesh::Warning;

/// All rows in the order of the study: scene, plan, material, level, variant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    pub scenes: Vec<SceneReport>,
    pub rows: Vec<Row>,
    pub skipped: Vec<Skipped>,
}

/// A variant that does not serve a scene: it has no rows there.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    pub scene: String,
    pub method: String,
    /// The variant.
    pub label: String,
    /// A sentence.
    pub reason: String,
    /// Combinations with plans, materials and levels that have no row for this reason.
    pub rows: usize,
}

/// A scene at level 0 and what is held for true in it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneReport {
    pub name: String,
    pub nodes: usize,
    pub cells: usize,
    /// Of [`super::cell_sizes`], in mm.
    pub cell_size: f64,
    pub skin_nodes: usize,
    /// In words, e.g. `tet10 quadratic, every edge halved once, 69 301 unknowns`.
    pub truth: String,
    /// What the truth itself is off by, mean and p95 over the skin in mm, by extrapolation; none for a
    /// closed form. Of the plan and the material for which it is largest.
    pub truth_error_mm: Option<[f64; 2]>,
    /// The distance of the skin at rest from a scan, over what rows are measured on; none without a scan.
    pub unmoved_mm: Option<f64>,
    /// Root of the mean squared distance that the registration of a scan left; none without a scan, or where it is not known.
    pub noise_mm: Option<f64>,
    /// Doubts about a scan.
    pub warnings: Vec<Warning>,
    /// Making the truth, in s; not part of any row.
    pub truth_s: f64,
}

/// One method on one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub scene: String,
    pub plan: String,
    pub method: String,
    /// The variant.
    pub label: String,
    /// The elements in use, e.g. `tet4 stabilised`; empty where there are none.
    pub element: String,
    pub material: String,
    pub level: u32,
    pub outcome: Outcome,
}

/// Outcome of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Solved(Box<Solved>),
    /// Refused or failed: the stable word, and the sentence with its numbers.
    Failed {
        code: String,
        detail: String,
    },
}

/// A row with numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    pub unknowns: usize,
    pub iterations: usize,
    /// Median over the repeats of mesh in memory to displacement in memory, on one thread.
    pub wall_s: f64,
    /// The solves that the time is the median of: as many as the study asks for, or fewer once they took
    /// [`super::LONG_S`] together.
    pub repeats: usize,
    /// The most that the process had in use during the first of them.
    pub peak_mb: Option<f64>,
    /// Mean of |u| over the skin nodes of level 0 in mm, by area.
    pub skin_mean_mm: f64,
    /// |u - u_truth| at the skin nodes of level 0, by area; of a scan the distance between both surfaces where the skin
    /// moves ([`super::variant::Scan`]).
    pub error: Errors,
    /// From the predicted skin of level 0 to the closest point of the true one, by area.
    pub closest_point: Errors,
    /// The error of each named part of the skin.
    pub regions: BTreeMap<String, Errors>,
    /// What the mesh leaves out of the answer, as estimated without the truth; none where it is not.
    pub numerical_error: Option<Errors>,
    /// What linearity leaves out, the same.
    pub linearity_error: Option<Errors>,
    /// The mean error that is expected of the answer, over the true one: of mesh, and of linearity where the truth is one of
    /// finite strain; none without both.
    pub effectivity: Option<f64>,
    /// Of a model that was chosen by its error: which, as documents call it.
    pub chosen: Option<String>,
    pub smallest_det_f: f64,
    /// What the truth of this plan and these materials is off by itself, mean and p95 in mm, as far as that is known.
    pub truth_error: Option<[f64; 2]>,
    /// Whether that truth was solved with contact.
    pub truth_contact: bool,
    /// Share of the moving skin's area that has a scan opposite; none without a scan.
    pub covered_share: Option<f64>,
    /// Codes of the warnings.
    pub warnings: Vec<String>,
}

/// In mm, by area; p95 is the smallest value whose cumulative weight reaches 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    pub mean: f64,
    pub p95: f64,
    pub max: f64,
}
