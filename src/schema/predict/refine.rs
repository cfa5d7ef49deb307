//! Adaptive refinement of the mesh of a prediction: settings and report.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::prediction::{AdaptivePrediction, Level, RefinementGoal, Stop};

/// Valid accepted errors, in mm.
pub const ACCEPTED_MM: std::ops::RangeInclusive<f64> = 1e-3..=1e2;

/// Refinement until the estimated error of the skin is accepted, or a bound is met. Linear tetrahedra only.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RefineDocument {
    /// The accepted mean error in mm over the skin nodes of the case that move (by more than a tenth of the largest
    /// displacement).
    #[schema(minimum = 0.001, maximum = 100.0)]
    pub accept_mm: f64,
    /// The same for parts of `skin_regions`, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub regions: BTreeMap<String, f64>,
    /// The accepted error at `landmarks` of the case on its skin, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks: BTreeMap<String, f64>,
    /// The most cells of a mesh.
    #[serde(default = "default_cells")]
    #[schema(default = 400_000, minimum = 1)]
    pub cells: u64,
}

fn default_cells() -> u64 {
    400_000
}

/// Report of `check` on a mesh to be refined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RefineBoundDocument {
    /// The most cells of a mesh: those of the spec, or fewer if limited by the memory of a job.
    pub cells: u64,
    /// Expected memory of the process with this number.
    pub memory_mb: f64,
}

/// The refinement of the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RefinementDocument {
    pub accepted_mm: f64,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub accepted_regions_mm: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub accepted_landmarks_mm: BTreeMap<String, f64>,
    /// Whether the estimates on the last mesh are accepted, leave nothing out that a warning names, and nothing speaks against the
    /// answer. With `auto` they are of mesh and linearity together, with `fem_linear` of each alone; an unknown one is not accepted.
    pub met: bool,
    /// Why refinement stopped: `met`; `incomplete` if the estimate of the mesh is accepted, and warnings name what it leaves out
    /// (`muscles-not-refined`, `points-refined`) or what speaks against the answer (`tolerance-not-met`: linearity unknown or above
    /// what is accepted, or one of the objections of `auto`); or the bound `cells`, `time` or `memory`.
    pub stopped: String,
    /// The meshes, beginning with that of the case.
    pub levels: Vec<RefinementLevelDocument>,
}

/// A mesh of the refinement, with the estimated error at the skin nodes of the case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RefinementLevelDocument {
    pub cells: u64,
    pub nodes: u64,
    pub unknowns: u64,
    pub mean_mm: f64,
    pub p95_mm: f64,
    /// The mean over each part of the skin with its own limit.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub regions_mm: BTreeMap<String, f64>,
    /// That at each landmark with its own limit.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub landmarks_mm: BTreeMap<String, f64>,
    /// Of solving, estimating and marking, in s.
    pub spent_s: f64,
}

impl RefineDocument {
    pub fn new(accept_mm: f64) -> Self {
        let (regions, landmarks) = (BTreeMap::new(), BTreeMap::new());
        RefineDocument { accept_mm, regions, landmarks, cells: default_cells() }
    }

    pub fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        faults.check_range(&at.key("accept_mm"), self.accept_mm, ACCEPTED_MM, "mm");
        for (of, limits_mm) in [("regions", &self.regions), ("landmarks", &self.landmarks)] {
            for (name, &accepted) in limits_mm {
                faults.check_range(&at.key(of).key(name), accepted, ACCEPTED_MM, "mm");
            }
        }
        if !(1..=limits.mesh_cells).contains(&self.cells) {
            let detail = format!("{} is outside of 1 to {}", self.cells, limits.mesh_cells);
            faults.add(&at.key("cells"), ErrorCode::OutOfRange, detail);
        }
    }

    /// The settings of the numerics, with the effective bounds.
    pub fn wanted(&self, cells: usize, time_s: f64, is_of_answer: bool) -> RefinementGoal {
        RefinementGoal {
            skin_mm: self.accept_mm,
            regions_mm: self.regions.clone(),
            landmarks_mm: self.landmarks.clone(),
            is_of_answer,
            cells,
            time_s,
        }
    }
}

impl RefinementDocument {
    pub fn new(wanted: &RefinementGoal, adapted: &AdaptivePrediction) -> Self {
        RefinementDocument {
            accepted_mm: wanted.skin_mm,
            accepted_regions_mm: wanted.regions_mm.clone(),
            accepted_landmarks_mm: wanted.landmarks_mm.clone(),
            met: adapted.stop == Stop::Met,
            stopped: adapted.stop.name().to_owned(),
            levels: adapted.levels.iter().map(RefinementLevelDocument::from).collect(),
        }
    }

    /// In words.
    pub fn summary(&self) -> String {
        let Some(last) = self.levels.last() else { return "no mesh was solved".to_owned() };
        let verdict = match self.stopped.as_str() {
            _ if self.met => "within".to_owned(),
            "incomplete" => {
                "with more that it leaves out or that speaks against it (see the warnings), within"
                    .to_owned()
            }
            bound => format!("short of (bound: {bound})"),
        };
        format!(
            "{} meshes, the last of {} cells: an estimated {:.3} mm in the mean over the skin that moves, {verdict} {} mm",
            self.levels.len(),
            last.cells,
            last.mean_mm,
            self.accepted_mm
        )
    }
}

impl From<&Level> for RefinementLevelDocument {
    fn from(level: &Level) -> Self {
        RefinementLevelDocument {
            cells: level.cells as u64,
            nodes: level.nodes as u64,
            unknowns: level.unknowns as u64,
            mean_mm: level.mean_mm,
            p95_mm: level.p95_mm,
            regions_mm: level.regions_mm.clone(),
            landmarks_mm: level.landmarks_mm.clone(),
            spent_s: level.spent_s,
        }
    }
}
