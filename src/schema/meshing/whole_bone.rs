//! Repair of the bone of a scan before it is cut and meshed.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::anatomy::WholeBone;

/// Repair of the bone of a scan: gaps in thin plates, and hollows. The warning `bone-made-whole` reports how much
/// became bone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WholeBoneDocument {
    /// Morphological closing with a ball of this radius, also of jaws that nearly touch. 0: none.
    #[serde(default)]
    #[schema(default = 0.0, minimum = 0.0, maximum = 10.0)]
    pub closing_mm: f64,
    /// Whether enclosed hollows, such as marrow, become bone.
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
