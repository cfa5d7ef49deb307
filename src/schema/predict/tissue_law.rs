//! Law of a tissue at finite strain, in the provenance of a result.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::case::law::LawDocument;
use mechanics::material::hyperelastic::{Fibres, Hyperelastic};

/// The law of a tissue at finite strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TissueLawDocument {
    pub law: LawDocument,
    /// Of tension-only fibres, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fibres: Option<PullingFibresDocument>,
}

/// W = k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1) if fibres are stretched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PullingFibresDocument {
    pub k1_kpa: f64,
    pub k2: f64,
}

impl From<&Hyperelastic> for TissueLawDocument {
    fn from(tissue: &Hyperelastic) -> Self {
        let fibres = tissue.fibres;
        TissueLawDocument {
            law: (&tissue.law).into(),
            fibres: fibres.map(|Fibres { k1, k2 }| PullingFibresDocument { k1_kpa: k1, k2 }),
        }
    }
}
