//! Bones under a plan, before any prediction: movements for navigation, collisions, cephalometric measures.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::{Matrix4x4, Triple};
use mechanics::cephalometry::Asymmetry;
use mechanics::mesh::Frame;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::validation::contact_map::ContactRegion;
use mechanics::validation::penetration::Overlap;

/// The most listed contact regions.
const MOST_REGIONS: usize = 50;

/// A segment that moves. Its texts are read back bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MovementReportDocument {
    pub segment: String,
    /// Movement of bone, in the frame of the case: row-major, x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    pub rotation_deg: f64,
    /// The same as four lines of text.
    pub matrix_text: String,
    /// An ITK transform file, `.tfm`: in LPS, and by ITK's convention the inverse, which resamples. Absent if
    /// the case states no frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub itk_transform: Option<String>,
}

/// Two bones that the plan moves relative to each other, and that overlap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CollisionDocument {
    pub bones: [String; 2],
    /// Depth after and before the plan; below 0.1 mm more than before there is no warning.
    pub depth_mm: f64,
    pub depth_before_mm: f64,
    /// Of the overlap after the plan, if both are closed; some per cent of error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub overlap: Option<OverlapDocument>,
}

/// The overlap of two bones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OverlapDocument {
    pub volume_mm3: f64,
    /// Its centre, with the second bone as planned.
    pub middle_mm: Triple,
    pub radius_mm: f64,
}

/// Contact or overlap of two bones, such as jaws with their teeth: before the plan, and as
/// planned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BoneContactDocument {
    /// Areas are of the first.
    pub bones: [String; 2],
    /// The distance below which bones are in contact.
    pub within_mm: f64,
    pub before: ContactMapDocument,
    pub planned: ContactMapDocument,
}

/// The part of a bone in contact with another.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContactMapDocument {
    pub area_mm2: f64,
    /// The part of it inside the other bone.
    pub overlap_area_mm2: f64,
    /// Depth; 0 if nothing is inside.
    pub depth_mm: f64,
    /// The number of contact regions.
    pub count: u64,
    /// The largest of them, the largest first, at most 50.
    pub regions: Vec<ContactRegionDocument>,
}

/// A contact region.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContactRegionDocument {
    pub area_mm2: f64,
    pub overlap_area_mm2: f64,
    pub depth_mm: f64,
    /// The smallest distance; negative inside.
    pub least_gap_mm: f64,
    /// Its centre, with the bones at that stage.
    pub middle_mm: Triple,
}

/// `bone` or `skin`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum TissueName {
    #[default]
    Bone,
    Skin,
}

/// A cephalometric measure; one with missing landmarks is omitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeasureDocument {
    pub name: String,
    /// `deg`, `mm` or `1`.
    pub unit: String,
    /// Whether it is of landmarks of bone or of skin.
    pub tissue: TissueName,
    /// Who defined it.
    pub source: String,
    /// Its norm, if built in or stated by the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub norm: Option<NormOfMeasureDocument>,
    pub before: f64,
    /// Of bone, as planned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub planned: Option<f64>,
    /// Of skin, as predicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub predicted: Option<f64>,
    /// Of bone after the operation, in a reproduction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub performed: Option<f64>,
}

/// The norm of a measure, and the standard score of each value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NormOfMeasureDocument {
    pub mean: f64,
    pub sd: f64,
    /// Source of the norm.
    pub source: String,
    pub before_z: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub planned_z: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub predicted_z: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub performed_z: Option<f64>,
}

/// The asymmetry of a midline landmark, or a pair, about the mid-sagittal plane of the head before the operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SymmetryDocument {
    /// The landmark, or the pair without its suffix of the side.
    pub landmark: String,
    pub tissue: TissueName,
    /// The landmarks of the plane: those of the skin if `Po_L`, `Po_R`, `Or_L`, `Or_R`, `N` or `Me` of bone are missing.
    #[serde(default)]
    #[schema(required)]
    pub plane: TissueName,
    pub before: AsymmetryDocument,
    /// Of bone, as planned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub planned: Option<AsymmetryDocument>,
    /// Of skin, as predicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub predicted: Option<AsymmetryDocument>,
    /// Of bone after the operation, in a reproduction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub performed: Option<AsymmetryDocument>,
}

/// Of a midline landmark: its offset from the plane. Of a pair: the difference of the mirrored left one and the right one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AsymmetryDocument {
    /// To the patient's left; of a pair twice the offset of its midpoint from the plane.
    pub left_mm: f64,
    /// Height of the left one above the right one; 0 for a midline landmark.
    pub up_mm: f64,
    /// Distance of the left one in front of the right one; 0 for a midline landmark.
    pub forwards_mm: f64,
    /// The length of the vector of all three.
    pub length_mm: f64,
}

impl From<Asymmetry> for AsymmetryDocument {
    fn from(found: Asymmetry) -> Self {
        let Asymmetry { left, up, forwards } = found;
        let length_mm = found.length();
        AsymmetryDocument { left_mm: left, up_mm: up, forwards_mm: forwards, length_mm }
    }
}

impl MovementReportDocument {
    /// `None` for a segment that stays.
    pub fn new(segment: &PlannedSegment, frame: Frame) -> Option<Self> {
        let movement = &segment.movement;
        if *movement == RigidMovement::default() {
            return None;
        }
        let comment = format!("segment {}", segment.name);
        Some(MovementReportDocument {
            segment: segment.name.clone(),
            matrix4x4: Matrix4x4(movement.matrix4()),
            rotation_deg: movement.angle().to_degrees(),
            matrix_text: movement.to_matrix_text(&format!("{comment}, frame {frame}")),
            itk_transform: match frame {
                Frame::Lps => Some(movement.to_itk_text(&comment)),
                Frame::Ras => Some(movement.between_lps_and_ras().to_itk_text(&comment)),
                Frame::Unspecified => None,
            },
        })
    }
}

impl From<&[ContactRegion]> for ContactMapDocument {
    fn from(regions: &[ContactRegion]) -> Self {
        // The sum of nothing is -0.
        let sum =
            |of: fn(&ContactRegion) -> f64| regions.iter().map(of).fold(0.0, |sum, own| sum + own);
        ContactMapDocument {
            area_mm2: sum(|region| region.area),
            overlap_area_mm2: sum(|region| region.overlap_area),
            depth_mm: regions.iter().map(|region| region.depth).fold(0.0, f64::max),
            count: regions.len() as u64,
            regions: regions.iter().take(MOST_REGIONS).map(Into::into).collect(),
        }
    }
}

impl From<&ContactRegion> for ContactRegionDocument {
    fn from(region: &ContactRegion) -> Self {
        ContactRegionDocument {
            area_mm2: region.area,
            overlap_area_mm2: region.overlap_area,
            depth_mm: region.depth,
            least_gap_mm: region.least_gap,
            middle_mm: region.middle.into(),
        }
    }
}

impl From<&Overlap> for OverlapDocument {
    fn from(overlap: &Overlap) -> Self {
        OverlapDocument {
            volume_mm3: overlap.volume,
            middle_mm: overlap.middle.into(),
            radius_mm: overlap.radius,
        }
    }
}
