//! A plan applied to a response: request and result.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{Triple, WarningDocument};
use crate::schema::plan::document::PlanDocument;
use mechanics::mesh::Vector;
use mechanics::response::linearity::LINEAR_RANGE_MM;
use mechanics::response::{BeyondLinear, Nonlinearity};

/// The body of `POST /v1/cases/{id}/response/apply`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ApplyDocument {
    pub plan: PlanDocument,
}

/// The displacement of the skin for a plan, with its error estimate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AppliedDocument {
    /// The job that built the response.
    pub job: String,
    /// Nodes of the volume mesh, ascending.
    pub node_ids: Vec<u32>,
    /// For each of them.
    #[schema(value_type = Vec<Triple>)]
    pub displacement_mm: Vec<[f32; 3]>,
    #[serde(flatten)]
    pub summary: AppliedSummary,
    pub warnings: Vec<WarningDocument>,
    /// Codes of warnings that were not checked: those that need the mesh inside the skin, the surfaces of bones or landmarks
    /// (`numerical-error-large`, `cells-inverted`, `bones-overlap`, `bone-in-tissue`, `bone-through-skin`, `large-rotation`, `large-strain`,
    /// `skin-outruns-plan`, `sliding-off-wall`, `landmark-far`, `landmarks-crowded`, `landmarks-swapped`), `skin-overlaps` without
    /// `check_skin`, and `tearing` of a response of an earlier program.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_measured: Vec<String>,
}

/// Estimates and warnings beside the displacement; headers of a binary body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AppliedSummary {
    /// The largest displacement of a skin node.
    pub max_mm: f64,
    /// The largest rotation of a segment.
    pub largest_rotation_deg: f64,
    /// That of the response: 2 if the displacement includes the second-order term.
    #[serde(default = "first_order")]
    pub order: u8,
    /// Of order 2: the mean length of the second-order term over the moving skin, the error of order 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub second_order_mm: Option<f64>,
    /// The linearisation error, mean over the moving skin (by more than a tenth of the largest displacement): of order 1 the
    /// second-order term, of order 2 the third-order term, both estimated from samples. Null if the plan grows tissue, activates muscles
    /// or turns a wall with its segment (`sliding-normal-turned`), and of fibres that only pull or quadratic tetrahedra: then it is not
    /// known, which the warning `nonlinearity-unknown` says.
    #[schema(required)]
    pub nonlinearity_estimate_mm: Option<f64>,
    /// Whether the estimate is at most 0.5 mm, and of order 2 at most half of the second-order term if it is above
    /// 0.1 mm. Null without an estimate: then nobody knows.
    #[schema(required)]
    pub within_linear_range: Option<bool>,
}

/// Estimated linearisation error of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearPart {
    /// Of its movements.
    pub nonlinearity: Nonlinearity,
    /// Whether tissue grows, muscles pull or a wall turns with its segment, or the response has no samples: these have no estimate.
    pub is_unknown: bool,
}

/// Third-order terms above this many mm have to be smaller than this share of the second-order term, else the series is not
/// trusted.
const SERIES_MM: f64 = 0.1;
const SERIES: f64 = 0.5;

fn first_order() -> u8 {
    1
}

impl AppliedSummary {
    /// `beyond` of a response of second order; `nonlinearity` of the movements, reported if nothing else acts.
    pub fn new(displacement: &[Vector], beyond: Option<BeyondLinear>, linear: &LinearPart) -> Self {
        let LinearPart { nonlinearity, is_unknown } = *linear;
        let squared = displacement.iter().map(Vector::norm_squared).fold(0.0, f64::max);
        AppliedSummary {
            max_mm: squared.sqrt(),
            largest_rotation_deg: nonlinearity.largest_rotation.to_degrees(),
            order: if beyond.is_some() { 2 } else { 1 },
            second_order_mm: beyond.map(|beyond| beyond.second),
            nonlinearity_estimate_mm: (!is_unknown)
                .then(|| beyond.map_or(nonlinearity.estimate, |beyond| beyond.third)),
            within_linear_range: (!is_unknown).then(|| match beyond {
                None => nonlinearity.is_within_linear_range(),
                Some(beyond) => outside_second_order(&beyond).is_none(),
            }),
        }
    }

    /// The warning code of a result outside the linear range.
    pub const OUTSIDE: &'static str = "outside-linear-range";

    /// The same for a response of second order.
    pub const OUTSIDE_SECOND: &'static str = "outside-second-order-range";

    /// The same without an estimate.
    pub const UNKNOWN: &'static str = "nonlinearity-unknown";

    pub fn warnings(&self) -> Vec<WarningDocument> {
        if self.within_linear_range == Some(true) {
            return Vec::new();
        }
        let Some(estimate) = self.nonlinearity_estimate_mm else {
            let detail =
                "the linearisation error is unknown where tissue grows, muscles pull, a wall turns with its segment, fibres only pull, or \
                 tetrahedra are quadratic"
                    .to_owned();
            return vec![WarningDocument {
                code: Self::UNKNOWN.to_owned(),
                detail,
                numbers: serde_json::Map::new(),
            }];
        };
        let (code, detail) = match self.second_order_mm {
            None => {
                let detail = format!(
                    "the estimated linearisation error is {estimate:.1} mm, more than {LINEAR_RANGE_MM} mm"
                );
                (Self::OUTSIDE, detail)
            }
            Some(second) => {
                let beyond = BeyondLinear { second, third: estimate };
                (Self::OUTSIDE_SECOND, outside_second_order(&beyond).unwrap_or_default())
            }
        };
        vec![WarningDocument { code: code.to_owned(), detail, numbers: serde_json::Map::new() }]
    }
}

/// Why the second order of a plan is not to be trusted, where it is not.
pub fn outside_second_order(beyond: &BeyondLinear) -> Option<String> {
    let BeyondLinear { second, third } = *beyond;
    let is_near = third <= LINEAR_RANGE_MM && (third <= SERIES_MM || third <= SERIES * second);
    (!is_near).then(|| {
        format!(
            "the second-order term is {second:.2} mm and its error about {third:.2} mm: more than {LINEAR_RANGE_MM} mm, or more than \
             {SERIES_MM} mm and half of it"
        )
    })
}
