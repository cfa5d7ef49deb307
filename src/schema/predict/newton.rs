//! Newton's method at finite strain: how tissue came to rest.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::pressing::StepContactDocument;
use crate::schema::Triple;

/// How tissue at finite strain came to rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NewtonDocument {
    pub energy_mn_mm: f64,
    /// The least det F of the points of all cells.
    pub least_det_f: f64,
    /// The share of movement and loads that was made before each step, and at rest; at most 200 of them.
    pub path: Vec<f64>,
    pub inner_iterations: u64,
    pub hierarchies: u64,
    /// Steps along which the tangent was not positive definite: tissue may then rest in another way too.
    pub indefinite_steps: u64,
    /// Whether the tangent at rest is positive definite, as far as iterations see, pressures answering to displacements. Absent where
    /// iterations ended before that was known, as with Poisson's ratios near 1/2, and where contact may hold what is not stable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub is_stable: Option<bool>,
    /// The bulk modulus that stays in cells while a pressure carries the rest, as a multiple of the shear modulus; 0
    /// without pressures.
    pub bulk_in_cells: f64,
    /// How many cells keep it: those that are pressed to less than a fifth of their volume, or, where that jams, all.
    #[serde(default)]
    pub cells_with_bulk: u64,
    /// Rest at the end of each part of a movement that found no rest at once, with more bulk modulus in the cells on the way.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<RestOnTheWayDocument>,
}

/// Tissue at rest with a share of its movement and loads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RestOnTheWayDocument {
    pub share: f64,
    pub energy_mn_mm: f64,
    /// The least det F of the points of all cells.
    pub least_det_f: f64,
    /// Steps since the rest before.
    pub steps: u64,
}

/// Tissue at rest at the end of a load step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadStepDocument {
    #[serde(flatten)]
    pub rest: RestOnTheWayDocument,
    pub relative_residual: f64,
    /// As that of `provenance.solver.newton`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub is_stable: Option<bool>,
    /// As that of the result.
    pub reaction_millinewton: BTreeMap<String, Triple>,
    /// Where anything presses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub contact: Option<StepContactDocument>,
}
