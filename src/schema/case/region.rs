//! Regions of a mesh: the names of their values, and what materials may name.

use std::collections::{BTreeMap, BTreeSet};

use super::document::RegionsDocument;
use super::hounsfield::HounsfieldDocument;
use super::merged::PlacedMaterials;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::mesh::VolumeMesh;
use mechanics::mesh::ignored::listed;
use mechanics::prediction::RegionNames;

impl RegionsDocument {
    pub(super) fn to_names(
        &self,
        at: &Pointer,
        volume: &VolumeMesh,
        faults: &mut Faults,
    ) -> RegionNames {
        let at = at.key("names");
        let (mut names, mut places) = (BTreeMap::new(), BTreeMap::new());
        for (value, name) in &self.names {
            let place = at.key(value);
            faults.check_name(&place, name, 128);
            match value.parse::<i64>() {
                Ok(label) => {
                    if names.insert(label, name.trim().to_owned()).is_some() {
                        let detail = format!("the value {label} is named more than once");
                        faults.add(&place, ErrorCode::DuplicateName, detail);
                    }
                    places.insert(label, place);
                }
                Err(_) => {
                    let detail = format!("`{value}` is not a value of an integer array");
                    faults.add(&place, ErrorCode::WrongType, detail);
                }
            }
        }
        let labels = volume.cell_labels.get(&self.array);
        let unnamed: BTreeSet<String> = (labels.into_iter().flatten())
            .filter(|label| !names.contains_key(label))
            .map(i64::to_string)
            .collect();
        for (label, name) in names.iter().filter(|(_, name)| unnamed.contains(*name)) {
            let detail = format!(
                "the value {label} is named {name:?}, and the value {name}, which has no name, is called so by its number: name both"
            );
            faults.add(&places[label], ErrorCode::DuplicateName, detail);
        }
        RegionNames { array: self.array.clone(), names }
    }
}

/// The regions of a mesh by name. None if their array is missing: that is refused, with the existing arrays, when the scene
/// is built.
pub fn region_names(
    regions: &Option<RegionNames>,
    volume: &VolumeMesh,
) -> Option<BTreeSet<String>> {
    let Some(regions) = regions else { return Some(BTreeSet::from(["tissue".to_owned()])) };
    let labels = volume.cell_labels.get(&regions.array)?;
    let values: BTreeSet<i64> = labels.iter().copied().collect();
    let name = |value: &i64| regions.names.get(value).cloned();
    Some(values.iter().map(|value| name(value).unwrap_or_else(|| value.to_string())).collect())
}

/// Refuses materials for regions that the mesh does not have.
pub(super) fn check_regions(
    materials: &[PlacedMaterials],
    known: &BTreeSet<String>,
    faults: &mut Faults,
) {
    for placed in materials {
        for region in placed.materials.into_iter().flat_map(BTreeMap::keys) {
            if region != "*" && !known.contains(region) {
                let names = listed(known);
                let detail = format!("the mesh has no region `{region}`; it has {names}");
                faults.add(&placed.at.key(region), ErrorCode::UnknownRegion, detail);
            }
        }
    }
}

/// Refuses materials of a spec for a region whose name a tissue of the image has too.
pub(super) fn check_tissues(
    spec: &PlacedMaterials,
    image: Option<&HounsfieldDocument>,
    known: &BTreeSet<String>,
    faults: &mut Faults,
) {
    let tissues = image.into_iter().flat_map(|image| &image.tissues);
    for name in tissues.map(|tissue| tissue.name.trim()).filter(|name| known.contains(*name)) {
        if spec.names(name) {
            let detail = format!(
                "{name:?} is a region of the tissue and a tissue of the image: only one of them can be meant; a spec changes regions"
            );
            faults.add(&spec.at.key(name), ErrorCode::DuplicateName, detail);
        }
    }
}
