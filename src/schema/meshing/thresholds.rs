//! Thresholds between air, soft tissue and bone of a scan.

use serde::de::IntoDeserializer;
use serde::{Deserialize, Deserializer, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::text_or_object::TextOrObject;
use mechanics::domain::ImageOptions;
use mechanics::image::{Histogram, ImageVolume, Thresholds};

/// Thresholds of soft tissue in a scan: numbers, or `auto` for those of its histogram.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum ThresholdsReference {
    Histogram(HistogramName),
    Values(HounsfieldThresholdsDocument),
}

/// By the method of Otsu (1979), between the modes of air and soft tissue, and between soft tissue and bone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum HistogramName {
    Auto,
}

/// Thresholds of soft tissue in a scan, in Hounsfield units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct HounsfieldThresholdsDocument {
    /// Air below.
    #[serde(default = "default_skin_hu")]
    #[schema(default = -300.0)]
    pub skin: f64,
    /// Bone at and above.
    #[serde(default = "default_bone_hu")]
    #[schema(default = 250.0)]
    pub bone: f64,
}

fn default_skin_hu() -> f64 {
    ImageOptions::default().skin_threshold
}

fn default_bone_hu() -> f64 {
    ImageOptions::default().bone_threshold
}

impl Default for HounsfieldThresholdsDocument {
    fn default() -> Self {
        HounsfieldThresholdsDocument { skin: default_skin_hu(), bone: default_bone_hu() }
    }
}

impl Default for ThresholdsReference {
    fn default() -> Self {
        ThresholdsReference::Values(HounsfieldThresholdsDocument::default())
    }
}

impl<'de> Deserialize<'de> for ThresholdsReference {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match TextOrObject::deserialize(deserializer)? {
            TextOrObject::Text(name) => ThresholdsReference::Histogram(HistogramName::deserialize(
                name.into_deserializer(),
            )?),
            TextOrObject::Object(values) => ThresholdsReference::Values(values),
        })
    }
}

impl ThresholdsReference {
    /// The thresholds as stated, or those of the histogram of `scan`, which has to contain air and soft tissue.
    pub fn to_values(
        self,
        scan: Option<&ImageVolume>,
        at: &Pointer,
        faults: &mut Faults,
    ) -> HounsfieldThresholdsDocument {
        let values = match self {
            ThresholdsReference::Values(values) => values,
            ThresholdsReference::Histogram(HistogramName::Auto) => {
                let found = scan.and_then(|scan| Thresholds::of(&Histogram::of(scan)));
                let Some(found) = found else {
                    let detail = "the scan has no voxels of air (-1100 to -800 HU) or none of soft tissue (0 to 120 HU), or \
                                  what parts them lies above -150 HU, so that these are no Hounsfield units: state `skin` and `bone`";
                    faults.add(at, ErrorCode::NoThresholds, detail);
                    return HounsfieldThresholdsDocument::default();
                };
                HounsfieldThresholdsDocument { skin: found.skin, bone: found.bone }
            }
        };
        faults.check_range(&at.key("skin"), values.skin, -1e6..=1e6, "HU");
        faults.check_range(&at.key("bone"), values.bone, -1e6..=1e6, "HU");
        if values.skin >= values.bone {
            let HounsfieldThresholdsDocument { skin, bone } = values;
            let detail =
                format!("tissue is between {skin} HU and {bone} HU, which has to be larger");
            faults.add(at, ErrorCode::OutOfRange, detail);
        }
        values
    }
}
