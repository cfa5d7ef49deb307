//! Report of Newton's method at finite strain.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::pressing::StepContactDocument;
use crate::schema::Triple;

/// Report of Newton's method at finite strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NewtonDocument {
    pub energy_mn_mm: f64,
    /// The least det F over the points of all cells.
    pub least_det_f: f64,
    /// The share of movement and loads applied before each step, and at equilibrium; at most 200 of them.
    pub path: Vec<f64>,
    pub inner_iterations: u64,
    pub hierarchies: u64,
    /// Steps with an indefinite tangent: tissue may then have another equilibrium too.
    pub indefinite_steps: u64,
    /// Whether the tangent at equilibrium is positive definite, as far as iterations see, pressures condensed out. Absent if
    /// iterations ended before that was known, as with Poisson's ratios near 1/2, and if contact may stabilise the tissue.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub is_stable: Option<bool>,
    /// The bulk modulus kept in cells beside a pressure unknown for the remainder, as a multiple of the shear modulus; 0
    /// without pressures.
    pub bulk_in_cells: f64,
    /// Number of these cells: those compressed to less than a fifth of their volume, or, if that fails to converge, all.
    #[serde(default)]
    pub cells_with_bulk: u64,
    /// Equilibrium after each part of a movement that did not converge in one, with more bulk modulus in cells until then.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<RestOnTheWayDocument>,
}

/// Equilibrium under a share of movement and loads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RestOnTheWayDocument {
    pub share: f64,
    pub energy_mn_mm: f64,
    /// The least det F over the points of all cells.
    pub least_det_f: f64,
    /// Steps since the previous equilibrium.
    pub steps: u64,
}

/// Equilibrium at the end of a load step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadStepDocument {
    #[serde(flatten)]
    pub rest: RestOnTheWayDocument,
    pub relative_residual: f64,
    /// As that of `provenance.solver.newton`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub is_stable: Option<bool>,
    /// As that of `provenance.solver.newton`.
    #[serde(default)]
    pub bulk_in_cells: f64,
    /// As that of `provenance.solver.newton`.
    #[serde(default)]
    pub cells_with_bulk: u64,
    /// Codes of warnings about this equilibrium; absent if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// As that of the result.
    pub reaction_millinewton: BTreeMap<String, Triple>,
    /// Where anything presses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub contact: Option<StepContactDocument>,
}
