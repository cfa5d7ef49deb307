//! Statistics of lengths.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::validation::Statistics;

/// Statistics of lengths in mm. A percentile is the smallest value whose cumulative weight reaches it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StatDocument {
    pub count: u64,
    pub mean: f64,
    pub sd: f64,
    pub rms: f64,
    #[serde(default)]
    pub min: f64,
    #[serde(default)]
    pub p25: f64,
    pub median: f64,
    #[serde(default)]
    pub p75: f64,
    pub p90: f64,
    pub p95: f64,
    pub p99: f64,
    pub max: f64,
}

impl From<&Statistics> for StatDocument {
    fn from(statistics: &Statistics) -> Self {
        let Statistics { count, mean, sd, rms, min, p25, median, p75, p90, p95, p99, max } =
            *statistics;
        let count = count as u64;
        StatDocument { count, mean, sd, rms, min, p25, median, p75, p90, p95, p99, max }
    }
}
