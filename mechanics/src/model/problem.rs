//! Input and output of every model: load cases in, equilibria out.

use super::cell_state::CellStates;
use crate::mesh::{Vector, Warning};
use crate::solver::{SolveReport, SolverError};

/// One of several things that happen to the same tissue.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadCase {
    /// For each hold its displacement in mm along its held axes, in its frame.
    pub held: Vec<Vector>,
    /// For each node, in mN.
    pub forces: Vec<Vector>,
    /// For each cell the volume in mm³ that it grows by, of which pressures take no notice; empty where nothing grows.
    pub grown: Vec<f64>,
}

/// Nodal displacement in mm, and for each hold the force in mN that it exerts on the tissue.
#[derive(Clone)]
pub struct Equilibrium {
    pub displacement: Vec<Vector>,
    pub reactions: Vec<Vector>,
    pub solver: SolveReport,
    pub states: CellStates,
    /// Warnings about this model and this solution.
    pub warnings: Vec<Warning>,
}

/// Why there is no equilibrium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    #[error(transparent)]
    Inverted(#[from] InvertedCell),
    #[error(transparent)]
    Solver(#[from] SolverError),
    #[error(
        "a step of {step_s:.3e} s grows without bound: explicit steps may take up to {limit_s:.3e} s"
    )]
    StepAboveLimit { step_s: f64, limit_s: f64 },
    #[error("no face of the tissue lies on bone: a warp has nothing to follow")]
    NoBone,
    /// Of tissue at finite strain.
    #[error(
        "no rest was found in which every cell keeps its orientation: after {steps} steps {:.1} % of the movement is made, \
         and the most pressed cell has {:.2} % of its volume", 100.0 * made, 100.0 * least_det_f
    )]
    Standstill { made: f64, steps: usize, least_det_f: f64 },
    #[error(
        "contact does not settle: after {passes} passes what presses still changes with every solution, and the answer moves \
         by {moved_mm:.2} mm where closest points are looked for again"
    )]
    ContactUnsettled { passes: usize, moved_mm: f64 },
    /// Of tissue at finite strain whose forces balance; with a place at rest in mm.
    #[error(
        "contact does not settle: forces balance to a residual of {residual:.1e}, but after {steps} steps of Newton's method what presses \
         still changes with every step{}; points looked for again lie up to {depth_mm:.3} mm in what they face",
        as_at(place)
    )]
    ContactAlternates { steps: usize, residual: f64, depth_mm: f64, place: Option<[f64; 3]> },
    /// Before anything is solved.
    #[error(
        "cell {cell} is inverted by the movements prescribed at its nodes, det F {det_f:.3}: these movements fold the tissue between bones"
    )]
    Folded { cell: usize, det_f: f64 },
    /// Of tissue at finite strain whose bones pass through each other (`boundary::tearing::turned_edges`), which is told.
    #[error("{cause}; {told}")]
    BonesPass { cause: Box<ModelError>, edges: usize, cells: usize, told: String },
}

impl ModelError {
    /// The stable word of the error catalogue.
    pub fn code(&self) -> &'static str {
        match self {
            ModelError::Inverted(_) => "element-inverted",
            ModelError::Solver(error) => error.code(),
            ModelError::StepAboveLimit { .. } => "step-above-limit",
            ModelError::NoBone => "no-bone",
            ModelError::Standstill { .. } => "no-equilibrium",
            ModelError::ContactUnsettled { .. } | ModelError::ContactAlternates { .. } => {
                "contact-unsettled"
            }
            ModelError::Folded { .. } => "tissue-folded",
            ModelError::BonesPass { cause, .. } => cause.code(),
        }
    }
}

fn as_at(place: &Option<[f64; 3]>) -> String {
    place.map_or_else(String::new, |[x, y, z]| format!(", as at ({x:.1}, {y:.1}, {z:.1}) mm"))
}

/// A cell whose Jacobian is not positive at a quadrature point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("cell {cell} is inverted or flat")]
pub struct InvertedCell {
    pub cell: usize,
}
