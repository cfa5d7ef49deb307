//! Acquisition of a scan, as comparisons need it; nothing that identifies the patient.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;

/// A century.
const MOST_DAYS: u32 = 36_525;

/// How a scan was taken, all members optional; results repeat it. No dates, no patient names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AcquisitionDocument {
    /// The device, such as its model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub scanner: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.01, maximum = 20.0)]
    pub slice_thickness_mm: Option<f64>,
    /// Within a slice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.01, maximum = 20.0)]
    pub pixel_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub posture: Option<PostureName>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub lips: Option<ApartName>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub teeth: Option<ApartName>,
    /// From the operation to the scan; absent before it. Swelling takes half a year to subside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, maximum = 36525)]
    pub days_after_operation: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum PostureName {
    Supine,
    Prone,
    Upright,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ApartName {
    Apart,
    Together,
}

impl AcquisitionDocument {
    /// Adds its faults.
    pub fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        if let Some(scanner) = &self.scanner {
            faults.check_name(&at.key("scanner"), scanner, limits.name_characters as usize);
        }
        let lengths =
            [("slice_thickness_mm", self.slice_thickness_mm), ("pixel_mm", self.pixel_mm)];
        for (name, length) in lengths.into_iter().filter_map(|(name, of)| Some((name, of?))) {
            faults.check_range(&at.key(name), length, 0.01..=20.0, "mm");
        }
        if let Some(days) = self.days_after_operation.filter(|days| *days > MOST_DAYS) {
            let detail = format!("{days} days are more than a century");
            faults.add(&at.key("days_after_operation"), ErrorCode::OutOfRange, detail);
        }
    }
}
