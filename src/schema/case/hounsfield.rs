//! Materials by Hounsfield unit: the image, the windows of the tissues, and the tissues found in the cells.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::material::{MaterialDocument, MaterialDocuments};
use super::preset::expanded;
use super::preset_name::doubt;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::names::check_distinct;
use mechanics::image::{ImageVolume, MOST_SAMPLES, Windows};
use mechanics::mesh::Warning;
use mechanics::prediction::{Hounsfield, ImagedTissue, Mixing, TissueShare, TissueWindow};

/// Valid ends of windows.
const FARTHEST_HU: f64 = 1e6;

/// Materials by the image values in each cell. A cell that extends beyond the image, or is in no window,
/// keeps the material of its region.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct HounsfieldDocument {
    /// The image: the id of an uploaded scan (NRRD, NIfTI, MetaImage, DICOM). It is in mm, and is converted to the
    /// frame of the case if both are stated.
    pub image: String,
    /// Sample points in each cell, the same in all cells of a shape.
    #[serde(default = "default_samples")]
    #[schema(default = 512, minimum = 1, maximum = 512)]
    pub samples: u32,
    /// Windows of values, without overlap.
    #[schema(min_items = 1)]
    pub tissues: Vec<TissueDocument>,
    #[serde(default)]
    pub mixing: MixingName,
}

fn default_samples() -> u32 {
    MOST_SAMPLES as u32
}

/// A tissue: `from_hu` <= value < `to_hu`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TissueDocument {
    pub name: String,
    pub from_hu: f64,
    pub to_hu: f64,
    pub material: MaterialDocument,
}

/// The material of a cell with several tissues.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MixingName {
    /// The tissue of its mean value.
    #[default]
    Mean,
    /// Bulk and shear modulus are those of its tissues, weighted by the share of points in each window; points in
    /// no window count as its region.
    Fraction,
}

/// Tissues of the mesh by an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ImagedTissueDocument {
    pub tissues: BTreeMap<String, TissueShareDocument>,
    /// The part that kept the material of its region.
    pub region: TissueShareDocument,
    /// Cells that extend beyond the image.
    pub outside_cells: u64,
}

/// The share of a tissue in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TissueShareDocument {
    /// Cells of it, with `fraction` also in part.
    pub cells: u64,
    /// Of the volume of the mesh.
    pub volume_share: f64,
}

impl From<&TissueShare> for TissueShareDocument {
    fn from(share: &TissueShare) -> Self {
        TissueShareDocument { cells: share.cells as u64, volume_share: share.volume_share }
    }
}

impl From<&ImagedTissue> for ImagedTissueDocument {
    fn from(imaged: &ImagedTissue) -> Self {
        let tissues = imaged.tissues.iter();
        ImagedTissueDocument {
            tissues: tissues.map(|(name, share)| (name.clone(), share.into())).collect(),
            region: (&imaged.region).into(),
            outside_cells: imaged.outside as u64,
        }
    }
}

impl HounsfieldDocument {
    /// Objections to the presets of its tissues.
    pub(super) fn doubts(&self) -> impl Iterator<Item = Warning> + '_ {
        self.tissues.iter().filter_map(|tissue| doubt(&tissue.name, tissue.material.preset))
    }

    /// The materials of its tissues by name, with presets in full.
    pub fn expanded(&self) -> MaterialDocuments {
        let tissues = self.tissues.iter();
        tissues.map(|tissue| (tissue.name.clone(), expanded(&tissue.material))).collect()
    }

    /// The image with these windows; a missing image was refused earlier.
    pub(super) fn to_hounsfield(
        &self,
        image: Arc<ImageVolume>,
        tissues: Vec<TissueWindow>,
    ) -> Hounsfield {
        let mixing = match self.mixing {
            MixingName::Mean => Mixing::Mean,
            MixingName::Fraction => Mixing::Fraction,
        };
        Hounsfield { image, samples: self.samples as usize, tissues, mixing }
    }

    /// The windows of its tissues; adds their faults and those of the samples.
    pub(super) fn to_tissues(
        &self,
        at: &Pointer,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Vec<TissueWindow> {
        let range = 1.0..=MOST_SAMPLES as f64;
        faults.check_range(&at.key("samples"), f64::from(self.samples), range, "");
        let at = &at.key("tissues");
        faults.check_length(at, self.tissues.len(), limits.list_entries as usize);
        if self.tissues.is_empty() {
            faults.add(at, ErrorCode::OutOfRange, "one tissue or more is expected");
        }
        check_distinct(self.tissues.iter().map(|tissue| tissue.name.as_str()), at, faults);
        let mut tissues = Vec::new();
        for (index, tissue) in self.tissues.iter().enumerate() {
            let at = at.index(index);
            faults.check_name(&at.key("name"), &tissue.name, limits.name_characters as usize);
            let TissueDocument { from_hu, to_hu, .. } = *tissue;
            for (end, value) in [("from_hu", from_hu), ("to_hu", to_hu)] {
                faults.check_range(&at.key(end), value, -FARTHEST_HU..=FARTHEST_HU, "HU");
            }
            if from_hu >= to_hu {
                let detail = format!("a window from {from_hu} to {to_hu} HU is empty");
                faults.add(&at, ErrorCode::OutOfRange, detail);
            }
            let name = tissue.name.trim().to_owned();
            let place = at.key("material");
            let material = expanded(&tissue.material);
            if material.fibre.is_some() {
                let detail = "an image does not show fibre directions: give fibres to a region";
                faults.add(&place.key("fibre"), ErrorCode::MethodNotAvailable, detail);
            }
            let material = material.to_isotropic(&place, faults);
            tissues.extend(material.map(|material| TissueWindow {
                name,
                from_hu,
                to_hu,
                material,
            }));
        }
        let ends: Vec<(f64, f64)> =
            self.tissues.iter().map(|tissue| (tissue.from_hu, tissue.to_hu)).collect();
        if ends.iter().all(|(from, to)| from < to) && Windows::new(&ends).is_none() {
            faults.add(
                at,
                ErrorCode::WindowsOverlap,
                "two windows overlap: a value belongs to one tissue",
            );
        }
        tissues
    }
}
