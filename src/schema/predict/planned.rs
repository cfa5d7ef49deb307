//! Bones under a plan, before anything is predicted: movements for navigation, collisions, measures of the head.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::{Matrix4x4, Triple};
use mechanics::cephalometry::Asymmetry;
use mechanics::mesh::Frame;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::validation::contact_map::ContactRegion;
use mechanics::validation::penetration::Overlap;

/// Most contact regions that are listed.
const MOST_REGIONS: usize = 50;

/// A segment that moves. Every text gives the same bits when it is read again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MovementReportDocument {
    pub segment: String,
    /// Moves bone, in the frame of the case: row-major, x' = R x + t in mm.
    pub matrix4x4: Matrix4x4,
    pub rotation_deg: f64,
    /// The same as four lines of text.
    pub matrix_text: String,
    /// An ITK transform file, `.tfm`: in LPS, and as files of ITK do it with the inverse, which resamples. Absent where
    /// the case states no frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub itk_transform: Option<String>,
}

/// Two bones of which the plan moves one against the other, and that reach into each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CollisionDocument {
    pub bones: [String; 2],
    /// How deep, after the plan and before it; below 0.1 mm more than before there is no warning.
    pub depth_mm: f64,
    pub depth_before_mm: f64,
    /// Of what both have in common after the plan, where both are closed; some percent of error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub overlap: Option<OverlapDocument>,
}

/// What two bones have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OverlapDocument {
    pub volume_mm3: f64,
    /// Its middle, with the second bone where the plan takes it.
    pub middle_mm: Triple,
    pub radius_mm: f64,
}

/// Where two bones, such as jaws with their teeth, are near to each other or in each other: before the plan, and as
/// planned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BoneContactDocument {
    /// Areas are of the first.
    pub bones: [String; 2],
    /// Nearer than this is contact.
    pub within_mm: f64,
    pub before: ContactMapDocument,
    pub planned: ContactMapDocument,
}

/// What of a bone touches another.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContactMapDocument {
    pub area_mm2: f64,
    /// What of it lies inside the other bone.
    pub overlap_area_mm2: f64,
    /// How deep; 0 where nothing does.
    pub depth_mm: f64,
    /// How many stretches of contact there are.
    pub count: u64,
    /// The largest of them, the largest first, at most 50.
    pub regions: Vec<ContactRegionDocument>,
}

/// A stretch of contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ContactRegionDocument {
    pub area_mm2: f64,
    pub overlap_area_mm2: f64,
    pub depth_mm: f64,
    /// The smallest distance; negative inside.
    pub least_gap_mm: f64,
    /// Its middle, where the bones are then.
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

/// A cephalometric measure; one whose landmarks are not all there is left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeasureDocument {
    pub name: String,
    /// `deg`, `mm` or `1`.
    pub unit: String,
    /// Whether landmarks of bone or of skin make it.
    pub tissue: TissueName,
    /// Who defined it.
    pub source: String,
    /// What is usual, where it is built in or the case states it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub norm: Option<NormOfMeasureDocument>,
    pub before: f64,
    /// Of bone, where the plan takes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub planned: Option<f64>,
    /// Of skin, where it is predicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub predicted: Option<f64>,
    /// Of bone, where an operation took it, of a reproduction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub performed: Option<f64>,
}

/// The norm of a measure, and how many standard deviations each value is above its mean.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NormOfMeasureDocument {
    pub mean: f64,
    pub sd: f64,
    /// Whose norm it is.
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

/// How a landmark of the middle, or a pair, lies to the mid-sagittal plane of the head before the operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SymmetryDocument {
    /// The landmark, or the pair without what says left or right.
    pub landmark: String,
    pub tissue: TissueName,
    /// Whose landmarks make the plane: those of the skin where `Po_L`, `Po_R`, `Or_L`, `Or_R`, `N` or `Me` of bone are missing.
    #[serde(default)]
    #[schema(required)]
    pub plane: TissueName,
    pub before: AsymmetryDocument,
    /// Of bone, where the plan takes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub planned: Option<AsymmetryDocument>,
    /// Of skin, where it is predicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub predicted: Option<AsymmetryDocument>,
    /// Of bone, where an operation took it, of a reproduction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub performed: Option<AsymmetryDocument>,
}

/// Of a landmark of the middle: how far it is beside the plane. Of a pair: what lies between the left one, mirrored, and the right one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AsymmetryDocument {
    /// To the patient's left; of a pair twice what its middle is beside the plane.
    pub left_mm: f64,
    /// How much higher the left one is; 0 of a landmark of the middle.
    pub up_mm: f64,
    /// How much farther in front the left one is; 0 of a landmark of the middle.
    pub forwards_mm: f64,
    /// The length of all three.
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
    /// `None` of a segment that stays.
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
        let sum = |of: fn(&ContactRegion) -> f64| regions.iter().map(of).sum::<f64>();
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
