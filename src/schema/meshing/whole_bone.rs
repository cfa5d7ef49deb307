//! Bone of a scan made whole before it is cut and meshed.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::anatomy::WholeBone;

/// How bone of a scan is made whole: thin plates that voxels show with gaps, and hollows. The warning `bone-made-whole` tells how much
/// became bone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WholeBoneDocument {
    /// Gaps that no ball of this radius fits into are closed, jaws that nearly touch too. 0: none.
    #[serde(default)]
    #[schema(default = 0.0, minimum = 0.0, maximum = 10.0)]
    pub closing_mm: f64,
    /// Whether hollows that bone encloses, such as marrow, are bone.
    #[serde(default)]
    #[schema(default = false)]
    pub fill_holes: bool,
}

impl WholeBoneDocument {
    /// What is wrong is added to `faults`.
    pub(super) fn to_rules(self, at: &Pointer, faults: &mut Faults) -> WholeBone {
        let WholeBoneDocument { closing_mm, fill_holes } = self;
        faults.check_range(&at.key("closing_mm"), closing_mm, 0.0..=10.0, "mm");
        WholeBone { closing_mm, fill_holes }
    }
}
