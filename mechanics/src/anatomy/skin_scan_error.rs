//! Reasons why a surface scan is not the skin of a CT.

use crate::mesh::{Vector, place};
use crate::osteotomy::RuleError;
use crate::registration::AlignmentError;

/// Farther from the skin of the CT than this, in mm, is an outlier.
pub(super) const OUTLIER_MM: f64 = 3.0;
/// Half of the scan lies no farther away, in mm.
pub(super) const MOST_MEDIAN: f64 = 1.5;

/// Why a surface scan is not the skin of a CT.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SkinScanError {
    #[error("the surface scan cannot be brought onto the skin of the CT: {0}; give `landmarks`")]
    Alignment(#[from] AlignmentError),
    #[error("the skin of the CT is no surface: {0}")]
    Skin(#[from] RuleError),
    #[error(
        "the surface scan does not lie on the skin of the CT: half of it is more than {median:.1} mm away (at most \
         {MOST_MEDIAN} is possible), {percent:.0} % more than {OUTLIER_MM} mm (at most 25 %). Is it of somebody else, or did the \
         registration go astray, as without `landmarks` where both stand in frames of their own?"
    )]
    Misfit { median: f64, percent: f64 },
    #[error(
        "the surface scan is mirrored: its mirror image fits the skin of the CT to {mirrored:.2} mm, itself only to {plain:.2} mm"
    )]
    Mirrored { plain: f64, mirrored: f64 },
    #[error(
        "{covered_cm2:.2} cm² of the surface scan, of {whole_cm2:.2}, can lie on the skin that the CT shows; at least 40 cm² are needed. Is its unit right?"
    )]
    Small { covered_cm2: f64, whole_cm2: f64 },
    #[error(
        "{covered_cm2:.2} cm² of the surface scan, of {whole_cm2:.2}, can lie on the skin that the CT shows within the mask; at least 40 cm² are needed: is the \
         mask too small, or not where the skin is?"
    )]
    SmallMask { covered_cm2: f64, whole_cm2: f64 },
    #[error(
        "the mask holds no skin of the CT, which reaches from {} to {} mm",
        place(low, 0),
        place(high, 0)
    )]
    EmptyMask { low: Vector, high: Vector },
}
