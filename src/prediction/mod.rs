//! The path of one prediction: scene in, nodal displacement and its measures out.

pub mod case;
pub mod progress;
pub mod scene;

use std::collections::BTreeMap;

pub use case::{
    Bone, Case, CaseSegment, ElementChoice, Load, Plan, Prescribed, RegionNames, Settings, Sliding,
    SlidingNormal,
};
pub use progress::{Phase, Progress, Unobserved};
pub use scene::{NodeClass, Scene, SceneError, SceneErrors, Skin};

use crate::mesh::{Vector, Warning};

/// The answer. Node and cell order are those of the volume mesh of the case.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// In mm, for each node.
    pub displacement: Vec<Vector>,
    /// The smallest determinant of F = I + grad u over the quadrature points of each cell.
    pub det_f: Vec<f64>,
    /// Principal small strains at the centre of each cell, largest first.
    pub principal_strain: Vec<[f64; 3]>,
    /// In mN: what each segment, `fixed`, `sliding` and `prescribed` nodes exert on the tissue.
    pub reactions: BTreeMap<String, Vector>,
    /// The displacement of each landmark in mm.
    pub landmarks: BTreeMap<String, Vector>,
    pub solver: SolverReport,
    /// Those of the scene and those of the solution.
    pub warnings: Vec<Warning>,
}

/// How the equations were solved.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverReport {
    /// `cholesky`, `conjugate_gradient`, or `none` where nothing moves.
    pub name: &'static str,
    pub preconditioner: &'static str,
    /// Why this solver was chosen.
    pub why: String,
    pub unknowns: usize,
    pub iterations: usize,
    /// |f - K u| / |f_D| of the free rows, recomputed at the end.
    pub relative_residual: f64,
    pub wanted_residual: f64,
    /// The elements used, e.g. `hex8 mean dilatation`.
    pub elements: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PredictionError {
    #[error("stopped on request")]
    Cancelled,
    #[error("residual {residual:.2e} after {iterations} iterations, wanted {wanted:.2e}")]
    NotConverged {
        iterations: usize,
        residual: f64,
        wanted: f64,
        history: Vec<f64>,
    },
    #[error("the matrix is singular at node {node}")]
    Singular { node: usize },
    #[error("the problem needs about {needed_mb:.0} MB and may take {allowed_mb:.0} MB")]
    OverBudget { needed_mb: f64, allowed_mb: f64 },
    #[error("the solution has values that are not finite")]
    NotFinite,
}

/// Solves a scene. The same scene gives the same bits on any number of threads.
pub fn predict(_scene: &Scene, _progress: &dyn Progress) -> Result<Prediction, PredictionError> {
    unimplemented!("the numerics land on main while you work; code against this signature")
}
