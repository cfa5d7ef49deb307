//! Faces of voxels between bone of two owners, at a cut or without one, and bone that cuts do not separate.

use std::collections::BTreeMap;

use super::bone_labels::{BoneLabels, Owner};
use super::cut::Side;
use super::grid::{Grid, Neighbour};
use super::rule::Osteotomy;
use crate::mesh::Vector;
use crate::mesh::disjoint_sets::DisjointSets;

/// Where bone of two owners touches.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    pub between: [Owner; 2],
    /// The cut that parts them; `None` where they touch without one, as teeth that meet do.
    pub cut: Option<usize>,
    pub faces: usize,
    /// At a cut the area of bone that is cut; without one that of the faces of voxels, which is up to 1.7 times as large.
    pub area_mm2: f64,
    /// The mean of the faces, in mm.
    pub centre: Vector,
}

/// Bone that goes around a bounded cut: what it should part is still whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Bridge {
    pub segment: usize,
    pub cut: usize,
    /// Faces of voxels beside the extent, on the plane of the cut, of a piece of a line where it goes on; 0 where bone goes another way
    /// around.
    pub faces: usize,
    pub area_mm2: f64,
    /// In mm; without faces the middle of what the cut reaches.
    pub centre: Vector,
}

#[derive(Clone, Copy, Default)]
struct Sum {
    faces: usize,
    area: f64,
    middles: Vector,
}

impl Sum {
    fn add(&mut self, area: f64, middle: Vector) {
        self.faces += 1;
        self.area += area;
        self.middles += middle;
    }

    fn centre(&self) -> Vector {
        self.middles / self.faces.max(1) as f64
    }
}

/// Where segments touch others, in the order of their owners, and for each cut whether it parts any of them.
pub(super) fn contacts(
    osteotomy: &Osteotomy,
    grid: &Grid<'_>,
    labels: &BoneLabels,
) -> (Vec<Contact>, Vec<bool>) {
    let mut parts = vec![false; osteotomy.cuts().len()];
    let mut sums: BTreeMap<(Owner, Owner, Option<usize>), Sum> = BTreeMap::new();
    for (voxel, neighbour) in pairs(grid) {
        let (Some(one), Some(other)) = (labels.owner(voxel), labels.owner(neighbour.voxel)) else {
            continue;
        };
        if one == other {
            continue;
        }
        let [here, there] = [voxel, neighbour.voxel].map(|voxel| grid.centre(voxel));
        let mut cuts = cuts_between(osteotomy, [one, other], [here, there]).peekable();
        let cut = cuts.peek().copied();
        cuts.for_each(|cut| parts[cut] = true);
        let face = grid.face(neighbour.axis);
        let area =
            cut.map_or(face.norm(), |cut| face.dot(&osteotomy.cuts()[cut].plane().normal()).abs());
        let key = (one.min(other), one.max(other), cut);
        sums.entry(key).or_default().add(area, (here + there) / 2.0);
    }
    let contact = |((one, other, cut), sum): (_, Sum)| Contact {
        between: [one, other],
        cut,
        faces: sum.faces,
        area_mm2: sum.area,
        centre: sum.centre(),
    };
    (sums.into_iter().map(contact).collect(), parts)
}

fn pairs<'a>(grid: &'a Grid<'_>) -> impl Iterator<Item = (usize, Neighbour)> + 'a {
    (0..grid.len())
        .flat_map(|voxel| grid.later_neighbours(voxel).map(move |neighbour| (voxel, neighbour)))
}

/// The cuts of either owner that pass between two voxels, or that one of them fell to.
fn cuts_between(
    osteotomy: &Osteotomy,
    owners: [Owner; 2],
    ends: [Vector; 2],
) -> impl Iterator<Item = usize> {
    let cuts_of = |owner: Owner| match owner {
        Owner::Segment(segment) => osteotomy.segments()[segment].sides.as_slice(),
        Owner::Rest | Owner::Sawn | Owner::Loose => &[],
    };
    let cuts = owners.into_iter().flat_map(cuts_of).map(|side| side.cut);
    cuts.filter(move |&cut| {
        let cut = &osteotomy.cuts()[cut];
        cut.parts(&ends[0], &ends[1]) || ends.iter().any(|end| cut.saws(end))
    })
}

/// The first piece of a line, and the segment that lies on its other side at most of the faces of voxels that the line parts: such a
/// line is walked the other way than its segment says.
pub(super) fn reversed_line(
    osteotomy: &Osteotomy,
    grid: &Grid<'_>,
    labels: &BoneLabels,
) -> Option<(usize, usize)> {
    // Planes have no chains: the voxels of a scan are not walked for them.
    osteotomy.cuts().iter().find(|cut| cut.chain().is_some())?;
    let mut faces: BTreeMap<(usize, usize), [usize; 2]> = BTreeMap::new();
    for (voxel, neighbour) in pairs(grid) {
        let owners = [labels.owner(voxel), labels.owner(neighbour.voxel)];
        let [here, there] = [voxel, neighbour.voxel].map(|voxel| grid.centre(voxel));
        for (own, place, other) in [(0, here, there), (1, there, here)] {
            let Some(Owner::Segment(segment)) = owners[own] else { continue };
            if owners[1 - own].is_none() || owners[1 - own] == owners[own] {
                continue;
            }
            for side in &osteotomy.segments()[segment].sides {
                let cut = &osteotomy.cuts()[side.cut];
                let Some(chain) = cut.chain() else { continue };
                if cut.parts(&place, &other) || cut.saws(&other) {
                    let counts = faces.entry((chain, segment)).or_default();
                    counts[usize::from(cut.is_above(&place) != (side.side == Side::Above))] += 1;
                }
            }
        }
    }
    let ((chain, segment), _) = faces.into_iter().find(|(_, [right, wrong])| wrong > right)?;
    let first = osteotomy.cuts().iter().position(|cut| cut.chain() == Some(chain))?;
    Some((first, segment))
}

/// Of the bone of a segment in front of and behind the extent of a cut, the share on the side that is not the segment's from which on
/// the segment has come around the cut.
const FAR_SHARE: f64 = 0.1;

/// Bounded cuts with bone of one segment on both of their sides, be it that the saw goes through it there, or that the segment lies
/// beyond the extent too, although nothing of it does next to it.
pub(super) fn bridges(osteotomy: &Osteotomy, grid: &Grid<'_>, labels: &BoneLabels) -> Vec<Bridge> {
    let bounded = (0..osteotomy.cuts().len()).filter(|&cut| osteotomy.cuts()[cut].is_bounded());
    bounded.flat_map(|cut| VoxelPairs::new(osteotomy, grid, labels, cut).bridges(grid)).collect()
}

/// Pairs of voxels of one segment on both sides of the plane of a cut: those that it parts, and those beside it.
struct VoxelPairs<'a> {
    osteotomy: &'a Osteotomy,
    cut: usize,
    parted: BTreeMap<usize, Sum>,
    /// Of segments that are to lie on one side: the voxels in front of the extent or behind it, on their side and on the other.
    sides: BTreeMap<usize, [Sum; 2]>,
    beside: BTreeMap<usize, Vec<(usize, Neighbour)>>,
}

impl<'a> VoxelPairs<'a> {
    fn new(
        osteotomy: &'a Osteotomy,
        grid: &Grid<'_>,
        labels: &BoneLabels,
        cut: usize,
    ) -> VoxelPairs<'a> {
        let bounded = &osteotomy.cuts()[cut];
        let sides = sides(osteotomy, grid, labels, cut);
        let (parted, beside) = (BTreeMap::new(), BTreeMap::new());
        let mut across = VoxelPairs { osteotomy, cut, parted, sides, beside };
        for (voxel, neighbour) in pairs(grid) {
            let (one, other) = (labels.owner(voxel), labels.owner(neighbour.voxel));
            let (Some(Owner::Segment(segment)), true) = (one, one == other) else { continue };
            let [here, there] = [voxel, neighbour.voxel].map(|voxel| grid.centre(voxel));
            if bounded.parts(&here, &there) {
                let area = across.area(grid, neighbour.axis);
                across.parted.entry(segment).or_default().add(area, (here + there) / 2.0);
            } else if bounded.is_beside(&here, &there) {
                across.beside.entry(segment).or_default().push((voxel, neighbour));
            }
        }
        across
    }

    fn area(&self, grid: &Grid<'_>, axis: usize) -> f64 {
        grid.face(axis).dot(&self.osteotomy.cuts()[self.cut].plane().normal()).abs()
    }

    fn bridges(&self, grid: &Grid<'_>) -> Vec<Bridge> {
        let far = self.sides.iter().filter(|(segment, [own, other])| {
            let is_parted = self.parted.contains_key(segment);
            !is_parted && other.faces as f64 > FAR_SHARE * own.faces as f64
        });
        let far = far.map(|(segment, [_, other])| (segment, other));
        let bridge = |(&segment, parted): (&usize, &Sum)| {
            let sum = self.nearest_patch(grid, segment, &parted.centre());
            Bridge {
                segment,
                cut: self.cut,
                faces: sum.faces,
                area_mm2: sum.area,
                centre: if sum.faces > 0 { sum.centre() } else { parted.centre() },
            }
        };
        self.parted.iter().chain(far).map(bridge).collect()
    }

    /// Of the patches of bone beside the extent the one that comes nearest to its middle.
    fn nearest_patch(&self, grid: &Grid<'_>, segment: usize, middle: &Vector) -> Sum {
        let faces = self.beside.get(&segment).map_or(&[][..], Vec::as_slice);
        let mut sets = patches(grid, faces);
        let distance = |face: usize| (grid.centre(faces[face].0) - middle).norm();
        let nearest = (0..faces.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        let mut sum = Sum::default();
        let Some(nearest) = nearest else { return sum };
        let root = sets.root(nearest as u32);
        for (number, (voxel, neighbour)) in faces.iter().enumerate() {
            if sets.root(number as u32) == root {
                let middle = (grid.centre(*voxel) + grid.centre(neighbour.voxel)) / 2.0;
                sum.add(self.area(grid, neighbour.axis), middle);
            }
        }
        sum
    }
}

/// The voxels of each segment that a bounded cut leaves on one side, in front of its extent or behind it: on that side, and on the other.
/// A piece of a line has no sides far from itself.
fn sides(
    osteotomy: &Osteotomy,
    grid: &Grid<'_>,
    labels: &BoneLabels,
    cut: usize,
) -> BTreeMap<usize, [Sum; 2]> {
    let mut sums: BTreeMap<usize, [Sum; 2]> = BTreeMap::new();
    let bounded = &osteotomy.cuts()[cut];
    if bounded.chain().is_some() {
        return sums;
    }
    for voxel in 0..grid.len() {
        let Some(Owner::Segment(segment)) = labels.owner(voxel) else { continue };
        let own = osteotomy.segments()[segment].sides.iter().find(|side| side.cut == cut);
        let (Some(own), centre) = (own, grid.centre(voxel)) else { continue };
        if bounded.reaches(&centre) {
            let is_other = bounded.is_above(&centre) != (own.side == Side::Above);
            sums.entry(segment).or_default()[usize::from(is_other)].add(0.0, centre);
        }
    }
    sums
}

/// Faces whose voxels touch, be it at a corner.
fn patches(grid: &Grid<'_>, faces: &[(usize, Neighbour)]) -> DisjointSets {
    let mut sets = DisjointSets::new(faces.len());
    let mut at: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    for (number, (voxel, _)) in faces.iter().enumerate() {
        let first = *at.entry(grid.place(*voxel)).or_insert(number as u32);
        sets.join(first, number as u32);
    }
    for (&[i, j, k], &face) in &at {
        let around = |middle: usize| middle.saturating_sub(1)..=middle + 1;
        for x in around(i) {
            for y in around(j) {
                for other in around(k).filter_map(|z| at.get(&[x, y, z])) {
                    sets.join(face, *other);
                }
            }
        }
    }
    sets
}
