//! The expected time of a computation.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// From mesh in memory to displacement in memory on one thread of a machine like that of the table of
/// methods: an order of magnitude, not a promise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TimeBandDocument {
    /// From the best row, in proportion to the unknowns.
    pub low: f64,
    /// From the worst row, in proportion to their power 4/3.
    pub high: f64,
}
