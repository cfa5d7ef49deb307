//! Materials of cells from the values of an image.
//!
//! `mean`: a cell is the tissue whose window its mean lies in (Zachow et al. 2006, section 3.5).
//! `fraction`: a cell is the mixture C = sum_t f_t C_t of the tissues in whose windows its sample points lie
//! (docs/methods.md#tissue-from-images); points in no window count as the region of the cell, with its fibres.
//! A cell of which a sample point lies outside the image, or that is in no window, keeps the material of its
//! region. Shares are rounded to steps that leave no more mixtures than numbers for them.

use super::case::{Hounsfield, Mixing};
use super::check::Check;
use super::error_code::SceneErrorCode;
use super::imaged_tissue::{ImagedTissue, TissueShare};
use crate::image::{SampledCells, SamplingRule, Windows, sample_cells};
use crate::material::LinearElastic;
use crate::material::mixture::{MixingRule, mixture};
use crate::mesh::{VolumeMesh, Warning, place};
use crate::progress::StopQuery;
use std::collections::BTreeMap;

/// Cells name their material in 16 bits.
pub(super) const MOST_MATERIALS: usize = u16::MAX as usize;

/// Where windows and images are told to be wrong.
const PLACE: &str = "/case/hounsfield";

/// Sample points in all cells of a mesh, at which an image is interpolated: 512 in each of two million cells, or 250 in four million.
pub const MOST_SAMPLE_POINTS: u64 = 1_000_000_000;

/// The materials of a scene.
pub(super) struct TissueOfCells {
    pub materials: Vec<LinearElastic>,
    pub material_of_cell: Vec<u16>,
    pub pressure_of_cell: Vec<u16>,
    pub imaged: Option<ImagedTissue>,
}

/// The parts of a cell in steps: those of the tissues, then that of its region.
type TissueShares = Vec<u16>;

impl Check<'_> {
    /// The material of each cell: that of its region, or what an image shows.
    pub(super) fn tissue_of_cells(
        &mut self,
        region_of_cell: &[u16],
        materials: Vec<LinearElastic>,
    ) -> TissueOfCells {
        let regions = region_of_cell.iter().map(|&region| region as usize + 1).max().unwrap_or(0);
        if let Some(hounsfield) = &self.case.hounsfield
            && materials.len() >= regions
            && self.can_mix(hounsfield, &materials)
            && let Some(sampled) = self.sampled(hounsfield)
        {
            let own = (region_of_cell, materials);
            let tissue = imaged(&self.case.volume, hounsfield, &sampled, own, self.stop);
            self.warnings.extend(tissue.imaged.iter().flat_map(ImagedTissue::warnings));
            self.warnings.extend(tissue.replaced_fibres(region_of_cell));
            return tissue;
        }
        TissueOfCells {
            materials,
            material_of_cell: region_of_cell.to_vec(),
            pressure_of_cell: region_of_cell.to_vec(),
            imaged: None,
        }
    }

    /// Stiffnesses mix, of regions with fibres along these: laws of finite strain and fibres that only pull have more.
    fn can_mix(&mut self, hounsfield: &Hounsfield, materials: &[LinearElastic]) -> bool {
        let windows = hounsfield.tissues.iter().map(|window| &window.material);
        let is_more = |material: &&LinearElastic| {
            material.has_pulling_fibres() || material.stated_law().is_some()
        };
        let more = materials.iter().chain(windows).filter(is_more).count();
        if hounsfield.mixing == Mixing::Mean || more == 0 {
            return true;
        }
        let detail = format!(
            "`fraction` mixes linear tissue, and {more} tissues have a law of finite strain or fibres that only pull: `mean` \
             leaves them as they are"
        );
        self.problems.add(format!("{PLACE}/mixing"), SceneErrorCode::MethodNotAvailable, detail);
        false
    }

    fn sampled(&mut self, hounsfield: &Hounsfield) -> Option<SampledCells> {
        let ends: Vec<(f64, f64)> =
            hounsfield.tissues.iter().map(|tissue| (tissue.from_hu, tissue.to_hu)).collect();
        let Some(windows) = Windows::new(&ends).filter(|windows| !windows.is_empty()) else {
            let detail = "the windows are none, empty or overlap".to_owned();
            self.problems.add(format!("{PLACE}/tissues"), SceneErrorCode::WindowsOverlap, detail);
            return None;
        };
        let rule = SamplingRule::new(hounsfield.samples);
        if let Some(detail) = too_many_points(self.case.volume.cells.len(), rule.count) {
            self.problems.add(format!("{PLACE}/samples"), SceneErrorCode::TooMany, detail);
            return None;
        }
        let (mesh, image) = (&self.case.volume, &hounsfield.image);
        let sampled = sample_cells(mesh, image, &rule, &windows, self.stop);
        if sampled.mean.iter().any(Option::is_some) {
            return Some(sampled);
        }
        let (low, high) = hounsfield.image.bounds();
        let detail = format!(
            "no cell lies inside the image, which reaches from {} to {} mm: are both in the same frame?",
            place(&low, 1),
            place(&high, 1)
        );
        self.problems.add(format!("{PLACE}/image"), SceneErrorCode::OutsideImage, detail);
        None
    }
}

/// The refusal of more points than are taken, told before the first.
fn too_many_points(cells: usize, samples: usize) -> Option<String> {
    let (cells, samples) = (cells as u64, samples as u64);
    let all = cells * samples;
    let detail = || {
        format!(
            "{all} sample points would be taken, at most {MOST_SAMPLE_POINTS} are: {samples} in each of {cells} cells; state at most {} \
             `samples`, or fewer cells",
            MOST_SAMPLE_POINTS / cells
        )
    };
    (all > MOST_SAMPLE_POINTS).then(detail)
}

impl TissueOfCells {
    /// Cells of regions with fibres that an image makes another tissue, which has none.
    fn replaced_fibres(&self, region_of_cell: &[u16]) -> Option<Warning> {
        let has_fibre = |material: u16| {
            let material = &self.materials[usize::from(material)];
            material.has_fibre() || material.has_pulling_fibres()
        };
        let cells = region_of_cell.iter().zip(&self.material_of_cell);
        let of_regions = region_of_cell.iter().filter(|&&region| has_fibre(region)).count();
        let replaced =
            cells.filter(|&(&region, &material)| has_fibre(region) && !has_fibre(material)).count();
        let detail = format!(
            "{replaced} of {of_regions} cells of regions with fibres are another tissue in the image, and have none"
        );
        let warning = Warning::new("fibres-replaced", detail).with("cells", replaced as f64);
        (replaced > 0).then(|| warning.with("of", of_regions as f64))
    }
}

impl ImagedTissue {
    fn warnings(&self) -> Vec<Warning> {
        let cells = self.mean.len();
        let alone = self.tissue_of_cell.iter().zip(&self.mean);
        let in_none = alone.filter(|(tissue, mean)| tissue.is_none() && mean.is_some()).count();
        let outside = format!(
            "{} of {cells} cells reach beyond the image and keep the material of their region",
            self.outside
        );
        let unlabelled = format!(
            "{in_none} of {cells} cells are mostly in no window and keep the material of their region there"
        );
        let told =
            [("outside-image", outside, self.outside), ("outside-windows", unlabelled, in_none)];
        let told = told.into_iter().filter(|(_, _, count)| *count > 0);
        told.map(|(code, detail, count)| Warning::new(code, detail).with("cells", count as f64))
            .collect()
    }
}

/// Materials of regions first, then those of tissues, then mixtures.
fn imaged(
    mesh: &VolumeMesh,
    hounsfield: &Hounsfield,
    sampled: &SampledCells,
    (region_of_cell, mut materials): (&[u16], Vec<LinearElastic>),
    stop: &StopQuery,
) -> TissueOfCells {
    let first_tissue = materials.len();
    materials.extend(hounsfield.tissues.iter().map(|tissue| tissue.material));
    let parts = match hounsfield.mixing {
        Mixing::Mean => labels(hounsfield, sampled),
        Mixing::Fraction => shares(hounsfield, sampled, (region_of_cell, materials.len()), stop),
    };
    let largest: Vec<Option<u16>> = parts.iter().map(largest_tissue).collect();
    let own = |cell: usize, tissue: Option<u16>| {
        tissue.map_or(region_of_cell[cell], |tissue| first_tissue as u16 + tissue)
    };
    let pressure_of_cell: Vec<u16> =
        largest.iter().enumerate().map(|(cell, &tissue)| own(cell, tissue)).collect();
    let mut mixtures: BTreeMap<(u16, &TissueShares), u16> = BTreeMap::new();
    let material_of_cell = parts
        .iter()
        .enumerate()
        .map(|(cell, parts)| {
            let region = region_of_cell[cell];
            if parts.iter().filter(|part| **part > 0).count() == 1 {
                return pressure_of_cell[cell];
            }
            *mixtures.entry((region, parts)).or_insert_with(|| {
                let entries = (first_tissue..).take(parts.len() - 1).chain([region as usize]);
                let steps: f64 = parts.iter().map(|&part| f64::from(part)).sum();
                let shares = parts.iter().map(|&part| f64::from(part) / steps);
                let mixed: Vec<(f64, LinearElastic)> =
                    shares.zip(entries.map(|entry| materials[entry])).collect();
                materials.push(mixture(&mixed, MixingRule::Voigt));
                (materials.len() - 1) as u16
            })
        })
        .collect();
    let imaged = describe(mesh, hounsfield, sampled, (&parts, largest));
    TissueOfCells { materials, material_of_cell, pressure_of_cell, imaged: Some(imaged) }
}

/// The whole cell is the tissue of its mean.
fn labels(hounsfield: &Hounsfield, sampled: &SampledCells) -> Vec<TissueShares> {
    let tissues = &hounsfield.tissues;
    let label = |mean: &Option<f64>| {
        let inside = |mean: f64| {
            tissues.iter().position(|tissue| (tissue.from_hu..tissue.to_hu).contains(&mean))
        };
        let mut parts = vec![0; tissues.len() + 1];
        parts[mean.and_then(inside).unwrap_or(tissues.len())] = 1;
        parts
    };
    sampled.mean.iter().map(label).collect()
}

/// The share of points in each window, in steps of one point or as much coarser as it takes for all materials
/// to be numbered. After a stop they are the coarsest.
fn shares(
    hounsfield: &Hounsfield,
    sampled: &SampledCells,
    (region_of_cell, pure): (&[u16], usize),
    stop: &StopQuery,
) -> Vec<TissueShares> {
    let samples = sampled.samples as u16;
    let counted = |cell: usize| -> TissueShares {
        let counts = sampled.counts(cell);
        let rest = samples - counts.iter().sum::<u16>();
        counts.iter().copied().chain([rest]).collect()
    };
    let counted: Vec<TissueShares> = (0..sampled.mean.len()).map(counted).collect();
    let mut steps = samples;
    loop {
        let rounded: Vec<TissueShares> =
            counted.iter().map(|parts| in_steps(parts, samples, steps)).collect();
        let mut mixtures: Vec<(u16, &TissueShares)> =
            region_of_cell.iter().copied().zip(&rounded).collect();
        mixtures.sort_unstable();
        mixtures.dedup();
        // With one step every cell is pure: regions and tissues are all there is.
        if pure + mixtures.len() <= MOST_MATERIALS || steps == 1 || hounsfield.tissues.is_empty() {
            return rounded;
        }
        steps = if stop.is_asked() { 1 } else { steps / 2 };
    }
}

/// Parts that sum to `samples` as parts that sum to `steps`: rounded down, and what is then missing given to
/// those that lost most, the first where they lost the same.
fn in_steps(parts: &TissueShares, samples: u16, steps: u16) -> TissueShares {
    let scaled = |part: u16| u32::from(part) * u32::from(steps);
    let mut rounded: TissueShares =
        parts.iter().map(|&part| (scaled(part) / u32::from(samples)) as u16).collect();
    let missing = steps - rounded.iter().sum::<u16>();
    let mut by_loss: Vec<usize> = (0..parts.len()).collect();
    by_loss.sort_by_key(|&at| std::cmp::Reverse(scaled(parts[at]) % u32::from(samples)));
    by_loss.iter().take(missing as usize).for_each(|&at| rounded[at] += 1);
    rounded
}

/// The tissue with the largest part, the first of equals; `None` where it is the region.
fn largest_tissue(parts: &TissueShares) -> Option<u16> {
    let most = parts.iter().max()?;
    let first = parts.iter().position(|part| part == most)?;
    (first + 1 < parts.len()).then_some(first as u16)
}

fn describe(
    mesh: &VolumeMesh,
    hounsfield: &Hounsfield,
    sampled: &SampledCells,
    (parts, tissue_of_cell): (&[TissueShares], Vec<Option<u16>>),
) -> ImagedTissue {
    let mut found = vec![TissueShare::default(); hounsfield.tissues.len() + 1];
    let mut whole = 0.0;
    for (cell, parts) in parts.iter().enumerate() {
        let volume = mesh.cell_volume(cell).abs();
        let steps: f64 = parts.iter().map(|&part| f64::from(part)).sum();
        whole += volume;
        for (tissue, &part) in found.iter_mut().zip(parts).filter(|(_, part)| **part > 0) {
            tissue.cells += 1;
            tissue.volume_share += volume * f64::from(part) / steps;
        }
    }
    if whole > 0.0 {
        found.iter_mut().for_each(|tissue| tissue.volume_share /= whole);
    }
    let region = found.pop().unwrap_or_default();
    let names = hounsfield.tissues.iter().map(|tissue| tissue.name.clone());
    let tissues = names.zip(found).collect();
    let outside = sampled.mean.iter().filter(|mean| mean.is_none()).count();
    ImagedTissue { mean: sampled.mean.clone(), tissue_of_cell, tissues, region, outside }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{ImageVolume, Placement, Voxels};
    use crate::mesh::sample::block;
    use crate::mesh::{CellShape, Vector};
    use crate::prediction::case::{Case, TissueWindow};

    #[test]
    fn more_sample_points_than_are_taken_are_refused_before_the_first() {
        let one = block(Vector::repeat(1.0), [1; 3], CellShape::Hex8);
        let nodes = one.cells.nodes(0).to_vec();
        let mut volume = one;
        // As many cells at one place, so that the mesh is made in no time.
        (0..1_999_999).for_each(|_| volume.cells.push(CellShape::Hex8, &nodes));
        let steps = [Vector::x(), Vector::y(), Vector::z()];
        let placement = Placement { origin: Vector::zeros(), steps };
        let image = ImageVolume::new([2; 3], placement, Voxels::I16(vec![-100; 8])).unwrap();
        let material = LinearElastic::new(1.0, 0.3, 1.0).unwrap();
        let tissue = TissueWindow { name: "fat".to_owned(), from_hu: -200.0, to_hu: 0.0, material };
        let hounsfield = Hounsfield {
            image: image.into(),
            samples: 501,
            tissues: vec![tissue],
            mixing: Mixing::Mean,
        };
        let case = Case { volume: volume.into(), ..Case::default() };
        let stop = StopQuery::never();
        let mut check = Check::new(&case, &[], &stop);
        assert!(check.sampled(&hounsfield).is_none());
        let refused = check.problems.fail_on_problems().unwrap_err().0.remove(0);
        assert_eq!(refused.code, SceneErrorCode::TooMany);
        assert_eq!(refused.pointer, "/case/hounsfield/samples");
        for number in ["1002000000", "1000000000", "501", "2000000", "at most 500 `samples`"] {
            assert!(refused.detail.contains(number), "{number} is in {}", refused.detail);
        }
        assert_eq!(too_many_points(2_000_000, 500), None);
    }

    #[test]
    fn coarser_steps_keep_the_sum_and_the_largest_parts() {
        assert_eq!(in_steps(&vec![300, 100, 112], 512, 512), [300, 100, 112]);
        assert_eq!(in_steps(&vec![300, 100, 112], 512, 8), [5, 1, 2]);
        assert_eq!(in_steps(&vec![171, 171, 170], 512, 1), [1, 0, 0]);
        assert_eq!(in_steps(&vec![0, 5, 0], 5, 2), [0, 2, 0]);
    }

    #[test]
    fn the_first_of_equal_parts_is_the_largest_and_the_region_the_last() {
        assert_eq!(largest_tissue(&vec![3, 3, 1]), Some(0));
        assert_eq!(largest_tissue(&vec![1, 3, 3]), Some(1));
        assert_eq!(largest_tissue(&vec![1, 2, 3]), None);
    }
}
