//! Label maps: images whose values are the numbers of regions, as segmentation programs write them.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::mask::{Grid, Mask};
use super::volume::{ImageVolume, Placement, Voxels};

/// A region of a label map.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    pub label: u16,
    /// Empty where the file has none.
    pub name: String,
    /// In voxels.
    pub size: u64,
}

/// Why an image is no label map.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("voxel {voxel} holds {value}: labels are whole numbers from 0 to 65535")]
pub struct NoLabel {
    pub voxel: usize,
    pub value: f64,
}

/// The region of every voxel; 0 is none.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelMap {
    pub grid: Grid,
    pub placement: Placement,
    pub labels: Vec<u16>,
    names: BTreeMap<u16, String>,
}

impl LabelMap {
    pub fn of(image: &ImageVolume) -> Result<LabelMap, NoLabel> {
        let labels = match image.voxels() {
            Voxels::I16(values) => labels(values),
            Voxels::F32(values) => labels(values),
        }?;
        let (grid, placement) = (Grid::of(image), *image.placement());
        Ok(LabelMap { grid, placement, labels, names: image.label_names().clone() })
    }

    /// The regions that have voxels, by their labels.
    pub fn regions(&self) -> Vec<Region> {
        let mut sizes: BTreeMap<u16, u64> = BTreeMap::new();
        for run in self.labels.chunk_by(|one, other| one == other) {
            *sizes.entry(run[0]).or_default() += run.len() as u64;
        }
        sizes.remove(&0);
        let name = |label: &u16| self.names.get(label).cloned().unwrap_or_default();
        let region = |(label, size)| Region { label, name: name(&label), size };
        sizes.into_iter().map(region).collect()
    }

    /// The label of a name, whatever its case.
    pub fn label(&self, name: &str) -> Option<u16> {
        let mut named = self.names.iter();
        named.find(|(_, known)| known.eq_ignore_ascii_case(name.trim())).map(|(label, _)| *label)
    }

    /// The voxels of some regions.
    pub fn mask(&self, wanted: &[u16]) -> Mask {
        let inside = self.labels.par_iter().map(|label| wanted.contains(label)).collect();
        Mask { grid: self.grid, inside }
    }
}

fn labels<T: Copy + Into<f64> + Sync>(values: &[T]) -> Result<Vec<u16>, NoLabel> {
    let label = |(voxel, &value): (usize, &T)| {
        let value: f64 = value.into();
        let label = value as u16;
        if f64::from(label) == value { Ok(label) } else { Err(NoLabel { voxel, value }) }
    };
    values.iter().enumerate().map(label).collect()
}
