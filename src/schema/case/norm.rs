//! Norms of cephalometric measures in documents.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::cephalometry::MEASURES;

/// The norm of a measure, in its unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NormDocument {
    #[schema(minimum = -1e4, maximum = 1e4)]
    pub mean: f64,
    /// Standard deviation.
    #[schema(minimum = 1e-6, maximum = 1e4)]
    pub sd: f64,
    /// Source: authors, year, population.
    pub source: String,
}

/// Norms by the names of measures.
pub type NormDocuments = BTreeMap<String, NormDocument>;

/// Adds the faults of norms at a place.
pub fn check_norms(norms: &NormDocuments, at: &Pointer, limits: &Limits, faults: &mut Faults) {
    for (name, norm) in norms {
        let at = at.key(name);
        if !MEASURES.iter().any(|measure| measure.name == name) {
            let known = MEASURES.iter().map(|measure| measure.name).collect::<Vec<_>>().join(", ");
            let detail = format!("there is no measure {name:?}; there are {known}");
            faults.add(&at, ErrorCode::OneOf, detail);
        }
        faults.check_range(&at.key("mean"), norm.mean, -1e4..=1e4, "");
        faults.check_range(&at.key("sd"), norm.sd, 1e-6..=1e4, "");
        faults.check_name(&at.key("source"), &norm.source, limits.name_characters as usize);
    }
}
