//! The binary columns of a response, of first order and of second order in sixteen bits, and the data of its estimates.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::response::QuadraticForm;
use mechanics::response::coupling::PROBES;

/// The binary file of the columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ColumnsDocument {
    pub file: String,
    /// `f32 little-endian [column][node][xyz], mm`.
    pub layout: String,
    pub count: u64,
    pub bytes: u64,
    pub sha256: String,
}

/// Data of the case for the estimate of nonlinearity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LinearityDocument {
    /// The median distance from the skin to the nearest constrained node.
    pub thickness_mm: f64,
    /// Whether nodes are constrained that no segment of the response moves.
    pub something_stays: bool,
    /// For each segment the mean length on the skin of the second-order term for 1 mm along x, y, z and for 1 rad about
    /// x, y, z through its centre; grows with the square. Absent if it is unknown: of fibres that only pull and quadratic tetrahedra, and
    /// in responses of earlier programs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub second_order_mm: Vec<[f64; 6]>,
    /// What probes of the skin measure of the second-order term of each pair of these directions, of all segments one after the other,
    /// in the order (0,0), (0,1), ... (1,1), ...: a plan has the sum of its squares times `second_order_mm`, times the length of all
    /// of its products of these over the sum of its squares times the length of each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub second_order_coupling: Vec<[f32; PROBES]>,
    /// The estimate above which a result is outside the linear range.
    pub range_mm: f64,
}

/// The columns of second order. With a the twelve numbers of all segments, one after the other,
/// u2 = sum over k <= l of a_k a_l scale_mm[p] column p, p counting (0,0), (0,1), ... (0,n-1), (1,1), ...
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SecondOrderDocument {
    /// `GET` with `order=2` returns it.
    pub columns: ColumnsDocument,
    /// One for each column.
    pub scale_mm: Vec<f32>,
    /// For each segment the mean length on the skin of the third-order term for 1 mm along x, y, z and for 1 rad about
    /// x, y, z through its centre; grows with the cube.
    pub third_order_mm: Vec<[f64; 6]>,
    /// The same as `second_order_coupling` of every three directions, (0,0,0), (0,0,1), ... (0,1,1), ...
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub third_order_coupling: Vec<[f32; PROBES]>,
}

impl SecondOrderDocument {
    /// The form with its columns.
    pub fn to_form(&self, numbers: usize, values: Vec<i16>) -> QuadraticForm {
        let (scales, third) = (self.scale_mm.clone(), self.third_order_mm.clone());
        QuadraticForm {
            numbers,
            values,
            scales,
            third,
            coupling: self.third_order_coupling.clone(),
        }
    }
}
