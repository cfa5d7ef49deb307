//! Report of a solution: the method, why it was chosen, and what it took. Made where equations are solved, and
//! carried as it is to whoever tells of it.

use nalgebra::Vector3;

/// How equations were solved.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveReport {
    /// `cholesky`, `conjugate_gradient`, `conjugate_residual` with pressures, what the method's own iterations are
    /// called, or `none` where nothing moves.
    pub method: &'static str,
    pub preconditioner: &'static str,
    /// Why this method was chosen, with the numbers; empty where nothing chose.
    pub why: String,
    /// Those that are not held: displacements and, with stabilised tetrahedra, pressures.
    pub unknowns: usize,
    pub iterations: usize,
    /// |f - K u| / |f_D| of the free rows, recomputed at the end; with pressures as `solver::mixed` says.
    pub relative_residual: f64,
    pub wanted_residual: f64,
    /// The relative residual after each iteration, of methods that have their own iterations to show.
    pub history: Vec<f64>,
    /// Steps of load or time; one where a system is solved at once.
    pub steps: u32,
    /// Of tissue at finite strain.
    pub newton: Option<NewtonReport>,
}

/// How tissue at finite strain came to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonReport {
    /// In mN mm.
    pub energy: f64,
    /// The least det F of the points of all cells at rest; at every step before it was positive too.
    pub least_det_f: f64,
    /// The share of movement and loads that was made before each step, and at rest.
    pub path: Vec<f64>,
    /// Iterations of all linear systems, and hierarchies made for them.
    pub inner_iterations: usize,
    pub hierarchies: usize,
    /// Steps along which the tangent was not positive definite: tissue may then rest in another way too.
    pub indefinite_steps: usize,
    /// Whether no direction without positive curvature was found in the tangent at rest, pressures answering to displacements;
    /// nothing where iterations ended before that was known, or where what presses may hold what is not stable.
    pub is_stable: Option<bool>,
    /// The bulk modulus that stays in cells while a pressure carries the rest, as a multiple of mu, and how many keep it.
    pub bulk_in_cells: f64,
    pub cells_with_bulk: usize,
    /// Rest at the end of each part of a movement that found none at once; empty where it did.
    pub parts: Vec<RestOnTheWay>,
    /// Rest at the end of each load step; empty where none were asked for.
    pub load_steps: Vec<LoadStep>,
}

/// Tissue at rest at the end of a load step.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadStep {
    pub rest: RestOnTheWay,
    pub relative_residual: f64,
    /// As those of a [`NewtonReport`].
    pub is_stable: Option<bool>,
    pub bulk_in_cells: f64,
    pub cells_with_bulk: usize,
    /// Whether all cells keep bulk modulus, because strained tissue jams where only pressed ones do.
    pub is_bulk_in_all: bool,
    /// What each hold exerts on the tissue, in mN.
    pub reactions: Vec<Vector3<f64>>,
}

/// Tissue at rest with a share of its movement and loads.
#[derive(Clone, Debug, PartialEq)]
pub struct RestOnTheWay {
    pub share: f64,
    /// In mN mm.
    pub energy: f64,
    /// The least det F of the points of all cells.
    pub least_det_f: f64,
    /// Steps since the rest before.
    pub steps: usize,
}

impl SolveReport {
    /// That of an answer for which no equation had to be solved.
    pub fn without_equations(why: &str, unknowns: usize, wanted_residual: f64) -> Self {
        SolveReport {
            method: "none",
            preconditioner: "none",
            why: why.to_owned(),
            unknowns,
            iterations: 0,
            relative_residual: 0.0,
            wanted_residual,
            history: Vec::new(),
            steps: 1,
            newton: None,
        }
    }

    /// That of a system in which nothing is held away from its place and nothing acts.
    pub fn at_rest(unknowns: usize, wanted_residual: f64) -> Self {
        Self::without_equations("nothing moves and nothing acts", unknowns, wanted_residual)
    }
}
