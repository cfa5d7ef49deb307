//! Label map to be meshed, with the meanings of its labels.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::domain::{LabelBody, LabelClass};
use mechanics::image::labels::Region;
use mechanics::image::{ImageVolume, LabelMap};

/// The region of unnamed tissue.
const TISSUE: &str = "tissue";
/// The label that stands for all unlisted ones.
const REST: &str = "*";
/// The most labels named in a message.
const MOST_TOLD: usize = 20;
/// The most regions of tissue.
const MOST_REGIONS: usize = 255;

/// A label map, as written by segmentation programs, with the meanings of its labels. 0 is air unless it is listed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LabelsDocument {
    /// The label map: the id of an uploaded image of whole numbers from 0 to 65535.
    pub image: String,
    /// The meanings of its labels. All labels with voxels have to be listed.
    pub classes: Vec<LabelClassDocument>,
}

/// The meaning of a label.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LabelClassDocument {
    /// Its name in the file, or its number, or `*` for all unlisted ones.
    pub label: String,
    pub is: SubstanceName,
    /// Of tissue the region, `tissue` by default: several labels may be one region. Of bone and teeth their segment;
    /// without a name they are fixed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
}

/// The substance of a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum SubstanceName {
    Air,
    Tissue,
    Bone,
    /// Bone that tissue slides on, if it belongs to a segment.
    Teeth,
}

impl LabelClassDocument {
    fn name(&self) -> Option<&str> {
        self.name.as_deref().map(str::trim)
    }

    /// The region of tissue.
    fn region(&self) -> Option<&str> {
        match self.is {
            SubstanceName::Tissue => Some(self.name().unwrap_or(TISSUE)),
            SubstanceName::Air | SubstanceName::Bone | SubstanceName::Teeth => None,
        }
    }

    /// The segment of bone.
    fn segment(&self) -> Option<&str> {
        match self.is {
            SubstanceName::Bone | SubstanceName::Teeth => self.name(),
            SubstanceName::Air | SubstanceName::Tissue => None,
        }
    }
}

impl LabelsDocument {
    /// The regions of tissue, each once, in their order.
    pub fn regions(&self) -> Vec<&str> {
        distinct_in_order(self.classes.iter().filter_map(LabelClassDocument::region))
    }

    /// The segments of bone, each once, in their order.
    pub fn segments(&self) -> Vec<&str> {
        distinct_in_order(self.classes.iter().filter_map(LabelClassDocument::segment))
    }

    /// Checks that need no image.
    pub(super) fn check(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        let classes = at.key("classes");
        faults.check_length(&classes, self.classes.len(), limits.map_entries as usize);
        for (number, class) in self.classes.iter().enumerate() {
            let at = classes.index(number);
            if let Some(name) = class.name() {
                faults.check_name(&at.key("name"), name, limits.name_characters as usize);
                if class.is == SubstanceName::Air {
                    let detail = "air has no region and no segment, and takes no name";
                    faults.add(&at.key("name"), ErrorCode::UnknownSegment, detail);
                }
            }
            let same = |other: &LabelClassDocument| other.label.trim() == class.label.trim();
            if self.classes[..number].iter().any(same) {
                let detail = format!("label `{}` is listed twice", class.label);
                faults.add(&at.key("label"), ErrorCode::DuplicateName, detail);
            }
        }
        let regions = self.regions().len();
        if regions == 0 {
            let detail = "no label is tissue, so that there is nothing to mesh";
            faults.add(&classes, ErrorCode::MissingField, detail);
        }
        faults.check_length(&classes, regions, MOST_REGIONS);
    }

    /// The body of a label map. Errors are added to `faults`.
    pub fn to_body(
        &self,
        image: &Arc<ImageVolume>,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<LabelBody> {
        let map = match LabelMap::of(image) {
            Ok(map) => map,
            Err(error) => {
                let detail = format!("this image is not a label map: {error}");
                faults.add(&at.key("image"), ErrorCode::WrongMesh, detail);
                return None;
            }
        };
        let there = map.regions();
        let classes = at.key("classes");
        let mut table: BTreeMap<u16, LabelClass> = BTreeMap::new();
        let mut rest = None;
        for (number, class) in self.classes.iter().enumerate() {
            let at = classes.index(number).key("label");
            let text = class.label.trim();
            if text == REST {
                rest = Some(self.class(class));
                continue;
            }
            let Some(label) = known(text, &map, &there) else {
                let detail =
                    format!("the label map has no label `{text}`; it has {}", told(&there));
                faults.add(&at, ErrorCode::UnknownLabel, detail);
                continue;
            };
            if table.insert(label, self.class(class)).is_some() {
                let detail = format!("label {label} is listed twice, as `{text}` and otherwise");
                faults.add(&at, ErrorCode::DuplicateName, detail);
            }
        }
        let unlisted: Vec<Region> =
            there.into_iter().filter(|region| !table.contains_key(&region.label)).collect();
        if rest.is_none() && !unlisted.is_empty() {
            let detail = format!(
                "these labels have no meaning: {}; list them, or `*` for all others",
                told(&unlisted)
            );
            faults.add(&classes, ErrorCode::UnknownLabel, detail);
        }
        let rest = rest.unwrap_or(LabelClass::Air);
        let class = |label: u16| {
            let otherwise = if label == 0 { LabelClass::Air } else { rest };
            table.get(&label).copied().unwrap_or(otherwise)
        };
        let regions = self.regions().len();
        faults.is_empty().then(|| LabelBody::new((**image).clone(), map, regions, class))
    }

    fn class(&self, class: &LabelClassDocument) -> LabelClass {
        let place = |names: Vec<&str>, name: Option<&str>| {
            name.and_then(|name| names.into_iter().position(|other| other == name))
        };
        let segment = place(self.segments(), class.segment());
        match class.is {
            SubstanceName::Air => LabelClass::Air,
            SubstanceName::Tissue => {
                let region = place(self.regions(), class.region()).unwrap_or_default();
                LabelClass::Tissue(region.min(MOST_REGIONS - 1) as u8)
            }
            SubstanceName::Bone => LabelClass::Bone { segment, is_tooth: false },
            SubstanceName::Teeth => LabelClass::Bone { segment, is_tooth: true },
        }
    }
}

/// The label of a name or a number that is in the file or has voxels.
fn known(text: &str, map: &LabelMap, there: &[Region]) -> Option<u16> {
    let number = text.parse::<u16>().ok();
    let number = number.filter(|number| *number == 0 || there.iter().any(|r| r.label == *number));
    map.label(text).or(number)
}

fn told(regions: &[Region]) -> String {
    let one = |region: &Region| match region.name.is_empty() {
        true => format!("{} ({} voxels)", region.label, region.size),
        false => format!("{} `{}` ({} voxels)", region.label, region.name, region.size),
    };
    let mut all: Vec<String> = regions.iter().take(MOST_TOLD).map(one).collect();
    if regions.len() > MOST_TOLD {
        all.push(format!("{} more", regions.len() - MOST_TOLD));
    }
    if all.is_empty() { "none".to_owned() } else { all.join(", ") }
}

fn distinct_in_order<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}
