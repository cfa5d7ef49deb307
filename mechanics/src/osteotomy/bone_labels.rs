//! Labels of voxels: the segment of each, or the skull.

use nalgebra::Matrix3;

use super::cut::Cut;
use crate::image::Placement;
use crate::mesh::{Vector, bounds_of};

const NO_BONE: u8 = 0;
const REST: u8 = 1;
const SAWN: u8 = 2;
const LOOSE: u8 = 3;
const FIRST_SEGMENT: u8 = 4;

/// Owner of a piece of bone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// Of no segment: the skull and whatever else does not move.
    Rest,
    /// Sawdust.
    Sawn,
    /// Of no segment and of nothing that could hold tissue: the hyoid, tubes, splinters.
    Loose,
    /// Of a segment, by its number.
    Segment(usize),
}

/// For each voxel of an image the owner of its bone, if any; the first axis fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneLabels {
    size: [usize; 3],
    placement: Placement,
    to_index: Matrix3<f64>,
    labels: Vec<u8>,
}

/// The bone that lies nearest to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestBone {
    pub owner: Owner,
    /// From the place to the centre of the voxel, in mm.
    pub distance: f64,
}

impl BoneLabels {
    /// All bone is of no segment yet. The placement is one that an image has.
    pub(super) fn new(
        size: [usize; 3],
        placement: Placement,
        is_bone: impl Fn(usize) -> bool,
    ) -> BoneLabels {
        let steps = Matrix3::from_columns(&placement.steps);
        let to_index = steps.try_inverse().expect("the directions of an image span space");
        let count = size.iter().product();
        let labels = (0..count).map(|voxel| if is_bone(voxel) { REST } else { NO_BONE }).collect();
        BoneLabels { size, placement, to_index, labels }
    }

    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// 0 no bone, 1 bone of no segment, 2 sawdust, 3 loose bone, 4 and on the segments.
    pub fn bytes(&self) -> &[u8] {
        &self.labels
    }

    /// Owner of the bone of a voxel; `None` where there is no bone.
    pub fn owner(&self, voxel: usize) -> Option<Owner> {
        match self.labels[voxel] {
            NO_BONE => None,
            REST => Some(Owner::Rest),
            SAWN => Some(Owner::Sawn),
            LOOSE => Some(Owner::Loose),
            segment => Some(Owner::Segment(usize::from(segment - FIRST_SEGMENT))),
        }
    }

    pub(super) fn set(&mut self, voxel: usize, owner: Owner) {
        self.labels[voxel] = match owner {
            Owner::Rest => REST,
            Owner::Sawn => SAWN,
            Owner::Loose => LOOSE,
            Owner::Segment(segment) => FIRST_SEGMENT + segment as u8,
        };
    }

    /// The bone whose voxel is nearest to `place`, of those with their centre at most `reach` mm away from it and not
    /// behind it, seen along `ahead`. Of voxels as near as each other the first.
    pub fn nearest(&self, place: &Vector, ahead: &Vector, reach: f64) -> Option<NearestBone> {
        self.nearest_within(place, ahead, reach, f64::INFINITY)
    }

    /// The same of voxels whose box is at most so many `voxels` away: differences along the axes in their edges, as one length.
    pub fn nearest_within(
        &self,
        place: &Vector,
        ahead: &Vector,
        reach: f64,
        voxels: f64,
    ) -> Option<NearestBone> {
        let middle = self.to_index * (place - self.placement.origin);
        let half = [0, 1, 2].map(|axis| reach * self.to_index.row(axis).norm());
        let range = |axis: usize| {
            let lowest = (middle[axis] - half[axis]).ceil().max(0.0) as usize;
            let highest = (middle[axis] + half[axis]).floor().min((self.size[axis] - 1) as f64);
            lowest..(highest + 1.0).max(0.0) as usize
        };
        let mut best: Option<NearestBone> = None;
        for (k, j, i) in
            range(2).flat_map(|k| range(1).flat_map(move |j| range(0).map(move |i| (k, j, i))))
        {
            let voxel = i + self.size[0] * (j + self.size[1] * k);
            let Some(owner) = self.owner(voxel) else { continue };
            let way = self.centre([i, j, k]) - place;
            let distance = way.norm();
            let beside = Vector::from([i, j, k].map(|n| n as f64)) - middle;
            let gap = beside.map(|steps| (steps.abs() - 0.5).max(0.0)).norm();
            let nearer = best.is_none_or(|best| distance < best.distance);
            if distance <= reach && gap <= voxels && way.dot(ahead) >= 0.0 && nearer {
                best = Some(NearestBone { owner, distance });
            }
        }
        best
    }

    /// A place in voxels from the centre of the first one, along the axes.
    pub(super) fn index_of(&self, place: &Vector) -> Vector {
        self.to_index * (place - self.placement.origin)
    }

    /// Whether a voxel is of bone that holds tissue or moves it.
    pub(super) fn holds(&self, voxel: usize) -> bool {
        let label = self.labels[voxel];
        label == REST || label >= FIRST_SEGMENT
    }

    /// Of a voxel, in mm³.
    pub fn voxel_volume(&self) -> f64 {
        Matrix3::from_columns(&self.placement.steps).determinant().abs()
    }

    /// Of all bone, in mm³.
    pub fn volume(&self) -> f64 {
        let voxels = self.labels.iter().filter(|&&label| label != NO_BONE).count();
        voxels as f64 * self.voxel_volume()
    }

    /// The lowest and the highest centres of voxels of bone, in mm.
    pub fn bone_box(&self) -> Option<(Vector, Vector)> {
        let bone = (0..self.labels.len()).filter(|&voxel| self.labels[voxel] != NO_BONE);
        bounds_of(bone.map(|voxel| self.centre_of(voxel))).map(Into::into)
    }

    /// Whether a cut comes into the image, be it where there is no bone.
    pub fn is_met_by(&self, cut: &Cut) -> bool {
        let steps = &self.placement.steps;
        let half = steps.iter().map(Vector::norm).sum::<f64>() / 2.0;
        let rises = Vector::from(steps.map(|step| cut.plane().normal().dot(&step)));
        // Of a row along the axis that rises most only the voxels about the plane are near it.
        let across = rises.iamax();
        let [one, other] = [(across + 1) % 3, (across + 2) % 3];
        let mut rows = (0..self.size[one]).flat_map(|i| (0..self.size[other]).map(move |j| [i, j]));
        rows.any(|place| {
            let mut index = [0; 3];
            [index[one], index[other]] = place;
            let crossing = -cut.plane().height(&self.centre(index)) / rises[across];
            let reach = half / rises[across].abs() + 1.0;
            let first = (crossing - reach).max(0.0) as usize;
            let end = (crossing + reach + 1.0).clamp(0.0, self.size[across] as f64) as usize;
            (first..end).any(|number| {
                index[across] = number;
                let centre = self.centre(index);
                cut.plane().height(&centre).abs() <= half && cut.reaches(&centre)
            })
        })
    }

    /// The centre of a voxel by its number, in mm.
    pub fn centre_of(&self, voxel: usize) -> Vector {
        let [nx, ny, _] = self.size;
        self.centre([voxel % nx, voxel / nx % ny, voxel / (nx * ny)])
    }

    fn centre(&self, index: [usize; 3]) -> Vector {
        let steps = self.placement.steps.iter().zip(index);
        steps.fold(self.placement.origin, |sum, (step, count)| sum + step * count as f64)
    }
}

#[cfg(test)]
#[path = "bone_labels_tests.rs"]
mod tests;
