//! Repair of the bone of a scan or of surfaces before it is cut and meshed.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::anatomy::WholeBone;

/// Repair of bone: gaps in thin plates of a scan, and hollows of a scan or of surfaces. The warnings `bone-made-whole` and
/// `bone-hollow` report how much became bone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WholeBoneDocument {
    /// Of a scan: morphological closing with a ball of this radius, also of jaws that nearly touch. 0: none.
    #[serde(default)]
    #[schema(default = 0.0, minimum = 0.0, maximum = 10.0)]
    pub closing_mm: f64,
    /// Whether enclosed hollows, such as marrow, become bone of their segment. No tissue is meshed in them either way.
    #[serde(default)]
    #[schema(default = false)]
    pub fill_holes: bool,
}

impl WholeBoneDocument {
    /// Errors are added to `faults`.
    pub(super) fn to_rules(self, at: &Pointer, faults: &mut Faults) -> WholeBone {
        let WholeBoneDocument { closing_mm, fill_holes } = self;
        faults.check_range(&at.key("closing_mm"), closing_mm, 0.0..=10.0, "mm");
        WholeBone { closing_mm, fill_holes }
    }
}
