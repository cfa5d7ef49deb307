//! Segments in the bone of a scan: voxels above a threshold, parted by cuts and by where bones touch.

use super::bone_image::BoneImage;
use super::bone_labels::{BoneLabels, Owner};
use super::contact::{Bridge, Contact, bridges, contacts, reversed_line};
use super::flood::flood;
use super::grid::Grid;
use super::label_error::LabelError;
use super::markers::markers;
use super::pieces::{PieceSummary, Pieces};
use super::rule::Osteotomy;
use crate::mesh::Vector;

/// Bone of no segment in pieces smaller than this, in mm³, is loose: a hyoid has about 2 cm³, a ramus 5 and more.
const LEAST_STANDING: f64 = 2500.0;

/// A segment that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundSegment {
    pub name: String,
    pub voxels: usize,
    pub volume_mm3: f64,
    /// The mean of its voxels, in mm.
    pub centre: Vector,
    /// What lies on its sides of the cuts, and is of no segment.
    pub left: PieceSummary,
}

/// The bone of a scan, parted.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelled {
    pub labels: BoneLabels,
    pub segments: Vec<FoundSegment>,
    /// Where segments touch each other or the rest of the bone.
    pub contacts: Vec<Contact>,
    /// For each cut whether it parts segments from each other or from the rest of the bone.
    pub parts: Vec<bool>,
    /// Pieces of bone too small to hold tissue.
    pub loose: PieceSummary,
    /// Bounded cuts around which a segment is still whole.
    pub bridges: Vec<Bridge>,
}

/// Finds the segments of an osteotomy in the bone of a scan. The same scan and osteotomy give the same labels.
pub fn label(bone: &BoneImage<'_>, osteotomy: &Osteotomy) -> Result<Labelled, LabelError> {
    let grid = Grid::new(bone.image);
    let is_bone = |voxel: usize| bone.value(voxel) > bone.threshold;
    let mut labels = BoneLabels::new(bone.image.size(), *bone.image.placement(), is_bone);
    let markers = markers(osteotomy, bone, &grid, &labels)?;
    flood(osteotomy, &grid, |voxel| bone.value(voxel), &markers, &mut labels);
    saw(osteotomy, &grid, &mut labels);
    if let Some((cut, segment)) = reversed_line(osteotomy, &grid, &labels) {
        let [cut, segment] =
            [&osteotomy.cuts()[cut].name, &osteotomy.segments()[segment].name].map(String::clone);
        return Err(LabelError::LineTurned { segment, cut });
    }
    let found = Labelled::segments_of(osteotomy, bone, &grid, &labels);
    let loose = separate_loose(osteotomy, bone, &grid, &mut labels);
    Ok(Labelled { loose, ..Labelled::new(osteotomy, &grid, labels, found) })
}

/// Takes bone as it is: `segment_of` gives for each voxel of bone the number of its segment, all of it one piece or not; none
/// for bone that stays.
pub fn label_given(
    bone: &BoneImage<'_>,
    osteotomy: &Osteotomy,
    segment_of: impl Fn(usize) -> Option<usize>,
) -> Result<Labelled, LabelError> {
    let grid = Grid::new(bone.image);
    let is_bone = |voxel: usize| bone.value(voxel) > bone.threshold;
    let mut labels = BoneLabels::new(bone.image.size(), *bone.image.placement(), is_bone);
    for voxel in (0..grid.len()).filter(|&voxel| is_bone(voxel)) {
        labels.set(voxel, segment_of(voxel).map_or(Owner::Rest, Owner::Segment));
    }
    let found = Labelled::segments_of(osteotomy, bone, &grid, &labels);
    let labelled = Labelled::new(osteotomy, &grid, labels, found);
    match labelled.segments.iter().find(|segment| segment.voxels == 0) {
        Some(missing) => Err(LabelError::NoBone { segment: missing.name.clone() }),
        None => Ok(labelled),
    }
}

impl Labelled {
    /// Report on labelled bone of which nothing is loose.
    fn new(
        osteotomy: &Osteotomy,
        grid: &Grid<'_>,
        labels: BoneLabels,
        segments: Vec<FoundSegment>,
    ) -> Labelled {
        let (contacts, parts) = contacts(osteotomy, grid, &labels);
        let bridges = bridges(osteotomy, grid, &labels);
        Labelled { labels, segments, contacts, parts, loose: PieceSummary::default(), bridges }
    }

    /// Whether a cut parts bone of a segment; a line of pieces does where one of them does.
    pub fn is_parted_by(&self, osteotomy: &Osteotomy, cut: usize) -> bool {
        let cuts = osteotomy.cuts();
        let line = cuts[cut].chain();
        let of_line = |other: usize| line.is_some() && cuts[other].chain() == line;
        (0..cuts.len()).any(|other| self.parts[other] && (other == cut || of_line(other)))
    }

    fn segments_of(
        osteotomy: &Osteotomy,
        bone: &BoneImage<'_>,
        grid: &Grid<'_>,
        labels: &BoneLabels,
    ) -> Vec<FoundSegment> {
        let segments = 0..osteotomy.segments().len();
        segments.map(|segment| found(osteotomy, bone, grid, labels, segment)).collect()
    }
}

/// What lies within the width of a cut of a segment, and hangs together with it there, is sawdust.
fn saw(osteotomy: &Osteotomy, grid: &Grid<'_>, labels: &mut BoneLabels) {
    for (number, cut) in osteotomy.cuts().iter().enumerate() {
        let lies_at = |segment: usize| {
            osteotomy.segments()[segment].sides.iter().any(|side| side.cut == number)
        };
        let mut waiting: Vec<usize> = (0..grid.len())
            .filter(|&voxel| match labels.owner(voxel) {
                Some(Owner::Segment(segment)) => cut.kerf() > 0.0 && lies_at(segment),
                Some(Owner::Rest | Owner::Sawn | Owner::Loose) | None => false,
            })
            .collect();
        while let Some(voxel) = waiting.pop() {
            for next in grid.neighbours(voxel).map(|neighbour| neighbour.voxel) {
                if labels.owner(next) == Some(Owner::Rest) && cut.saws(&grid.centre(next)) {
                    labels.set(next, Owner::Sawn);
                    waiting.push(next);
                }
            }
        }
    }
}

/// Separates loose pieces of bone, too small to hold tissue, from the skull.
fn separate_loose(
    osteotomy: &Osteotomy,
    bone: &BoneImage<'_>,
    grid: &Grid<'_>,
    labels: &mut BoneLabels,
) -> PieceSummary {
    let is_rest = |voxel: usize| labels.owner(voxel) == Some(Owner::Rest);
    let least = (LEAST_STANDING / bone.image.voxel_volume()).ceil() as usize;
    let small = Pieces::new(osteotomy, grid, is_rest).smaller_than(least);
    for voxel in small.voxels() {
        labels.set(voxel, Owner::Loose);
    }
    small.summary(grid)
}

fn found(
    osteotomy: &Osteotomy,
    bone: &BoneImage<'_>,
    grid: &Grid<'_>,
    labels: &BoneLabels,
    segment: usize,
) -> FoundSegment {
    let own = |voxel: &usize| labels.owner(*voxel) == Some(Owner::Segment(segment));
    let (mut voxels, mut sum) = (0, Vector::zeros());
    for voxel in (0..grid.len()).filter(own) {
        voxels += 1;
        sum += grid.centre(voxel);
    }
    let left = Pieces::new(osteotomy, grid, |voxel| {
        let centre = grid.centre(voxel);
        labels.owner(voxel) == Some(Owner::Rest)
            && osteotomy.admits(segment, &centre)
            && !osteotomy.is_across(segment, &centre)
    });
    FoundSegment {
        name: osteotomy.segments()[segment].name.clone(),
        voxels,
        volume_mm3: voxels as f64 * bone.image.voxel_volume(),
        centre: sum / voxels.max(1) as f64,
        left: left.summary(grid),
    }
}
