//! Markers from which segments grow: the bone at their seeds, or the brightest voxel of the largest piece on their sides.

use super::bone_image::BoneImage;
use super::bone_labels::BoneLabels;
use super::flood::Marker;
use super::grid::Grid;
use super::label_error::LabelError;
use super::pieces::Pieces;
use super::rule::Osteotomy;
use crate::mesh::Vector;

/// Bone this far from a seed, in mm, is still meant by it.
const SEED_REACH: f64 = 10.0;

/// One marker for each seed, and one for each segment without.
pub(super) fn markers(
    osteotomy: &Osteotomy,
    bone: &BoneImage<'_>,
    grid: &Grid<'_>,
    labels: &BoneLabels,
) -> Result<Vec<Marker>, LabelError> {
    let mut markers: Vec<Marker> = Vec::new();
    let mut largest_pieces = Vec::new();
    for (segment, rule) in osteotomy.segments().iter().enumerate() {
        let counts = |voxel: usize| {
            labels.owner(voxel).is_some() && osteotomy.admits(segment, &grid.centre(voxel))
        };
        for (number, seed) in rule.seeds.iter().enumerate() {
            let place = Seed { segment, number, at: *seed };
            let voxel = place.voxel(osteotomy, grid, counts)?;
            let voxel = voxel.ok_or_else(|| LabelError::SeedOffBone {
                segment: rule.name.clone(),
                seed: number,
                at: *seed,
                bone: labels.bone_box(),
            });
            markers.push(Marker { segment, voxel: voxel? });
        }
        if rule.seeds.is_empty() {
            let largest = Pieces::new(osteotomy, grid, counts).largest();
            let brightest = largest.iter().copied().reduce(|best, voxel| {
                if bone.value(voxel) > bone.value(best) { voxel } else { best }
            });
            let name = || rule.name.clone();
            let voxel = brightest.ok_or_else(|| LabelError::NoBone { segment: name() })?;
            markers.push(Marker { segment, voxel });
            largest_pieces.push((segment, largest));
        }
    }
    refuse_ambiguous_seeds(osteotomy, &markers, &largest_pieces)?;
    Ok(markers)
}

/// Refuses two segments that begin at one voxel, and one without a seed that is not alone in its piece.
fn refuse_ambiguous_seeds(
    osteotomy: &Osteotomy,
    markers: &[Marker],
    largest_pieces: &[(usize, Vec<usize>)],
) -> Result<(), LabelError> {
    let name = |segment: usize| osteotomy.segments()[segment].name.clone();
    for (segment, piece) in largest_pieces {
        let other = markers.iter().find(|marker| {
            marker.segment != *segment && piece.binary_search(&marker.voxel).is_ok()
        });
        if let Some(other) = other {
            return Err(LabelError::NeedsSeed {
                segment: name(*segment),
                other: name(other.segment),
            });
        }
    }
    for (number, marker) in markers.iter().enumerate() {
        let earlier = markers[..number]
            .iter()
            .find(|earlier| earlier.voxel == marker.voxel && earlier.segment != marker.segment);
        if let Some(earlier) = earlier {
            return Err(LabelError::SeedsMeet {
                one: name(earlier.segment),
                other: name(marker.segment),
            });
        }
    }
    Ok(())
}

struct Seed {
    segment: usize,
    number: usize,
    at: Vector,
}

impl Seed {
    /// The nearest voxel that counts.
    fn voxel(
        &self,
        osteotomy: &Osteotomy,
        grid: &Grid<'_>,
        counts: impl Fn(usize) -> bool,
    ) -> Result<Option<usize>, LabelError> {
        let rule = &osteotomy.segments()[self.segment];
        for side in &rule.sides {
            let cut = &osteotomy.cuts()[side.cut];
            if cut.chain().is_none() && !cut.leaves(&self.at, side.side) {
                let (segment, seed) = (rule.name.clone(), self.number);
                let cut = cut.name.clone();
                return Err(LabelError::SeedAcross { segment, seed, cut });
            }
        }
        let mut best: Option<(f64, usize)> = None;
        for voxel in 0..grid.len() {
            let distance = (grid.centre(voxel) - self.at).norm();
            if distance < best.map_or(SEED_REACH, |(nearest, _)| nearest) && counts(voxel) {
                best = Some((distance, voxel));
            }
        }
        Ok(best.map(|(_, voxel)| voxel))
    }
}
