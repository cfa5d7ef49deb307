//! Contact in a result: pairs, forces, and the report of the solution.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::prediction::{ContactPair, StepTouch, Touch};

/// Contact of tissue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContactDocument {
    /// In mm², of all pairs.
    pub area_mm2: f64,
    pub largest_pressure_kpa: f64,
    /// Remaining penetration of the boundary, beyond that at rest: 0 except for rounding, or more at edges.
    pub largest_penetration_mm: f64,
    pub pairs: Vec<ContactPairDocument>,
    /// Solutions for an active set, changes of the set, and searches of closest points.
    pub passes: u64,
    pub set_changes: u64,
    pub rounds: u64,
    /// Change of the solution in the last round.
    pub last_moved_mm: f64,
    pub iterations: u64,
}

/// Two parts of the boundary in contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContactPairDocument {
    /// Two names, of segments, of bones and of `skin_regions`; `fixed`, `skin` and `inner` for other parts.
    pub between: Vec<String>,
    /// Nodes under pressure, on both sides.
    pub nodes: u64,
    pub area_mm2: f64,
    pub largest_pressure_kpa: f64,
    /// The sum of what presses at nodes, each in its own direction, so above the resultant; absent in results of before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub force_millinewton: Option<f64>,
    /// Former name of `force_millinewton`, until the next version of this document.
    #[schema(deprecated)]
    pub force_mn: f64,
}

/// What presses at the end of a load step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StepContactDocument {
    /// Nodes that are held against what they face.
    pub points: u64,
    /// In mm², of all pairs.
    pub area_mm2: f64,
    pub largest_pressure_kpa: f64,
}

impl From<&StepTouch> for StepContactDocument {
    fn from(touch: &StepTouch) -> Self {
        StepContactDocument {
            points: touch.points as u64,
            area_mm2: touch.area,
            largest_pressure_kpa: touch.largest_pressure,
        }
    }
}

impl From<&Touch> for ContactDocument {
    fn from(touch: &Touch) -> Self {
        let contact = &touch.contact;
        ContactDocument {
            area_mm2: touch.area(),
            largest_pressure_kpa: touch.largest_pressure(),
            largest_penetration_mm: touch.largest_penetration(),
            pairs: touch.pairs.iter().map(Into::into).collect(),
            passes: contact.effort.passes as u64,
            set_changes: contact.effort.changes as u64,
            rounds: contact.effort.rounds as u64,
            last_moved_mm: contact.last_moved_mm,
            iterations: contact.effort.iterations as u64,
        }
    }
}

impl From<&ContactPair> for ContactPairDocument {
    fn from(pair: &ContactPair) -> Self {
        ContactPairDocument {
            between: pair.between.to_vec(),
            nodes: pair.nodes as u64,
            area_mm2: pair.area,
            largest_pressure_kpa: pair.largest_pressure,
            force_millinewton: Some(pair.force),
            force_mn: pair.force,
        }
    }
}
