//! The time that a computation is expected to take.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// From mesh in memory to displacement in memory on one thread of a machine like the one that measured the table of
/// methods: an order of magnitude, not a promise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TimeBandDocument {
    /// As fast as the best row, time growing with the unknowns.
    pub low: f64,
    /// As slow as the worst row, time growing with their power 4/3.
    pub high: f64,
}
