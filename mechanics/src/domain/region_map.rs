//! Regions of soft tissue on a grid: which of them a place is in, and where two meet.
//!
//! Each voxel that a place sees votes for its region with the weight of a cubic B-spline, so that regions have smooth
//! boundaries, and one that is a voxel thick stays.

use nalgebra::Matrix3;

use crate::image::spline::spline_weights;
use crate::mesh::Vector;

/// Steps to where two regions meet.
const STEPS: usize = 12;
/// The longest step, in voxels.
const LONGEST: f64 = 0.5;
/// Votes that differ by less are equal.
const EQUAL: f64 = 1e-3;

/// The region of each voxel.
#[derive(Clone, Debug)]
pub(super) struct RegionMap {
    size: [usize; 3],
    /// One more than the region; 0 where there is no tissue.
    of_voxels: Vec<u8>,
    count: usize,
}

/// The votes for a region, and how they change by the index along each axis.
#[derive(Clone, Copy, Default)]
struct Votes {
    sum: f64,
    slope: Vector,
}

impl RegionMap {
    /// `region` is that of a voxel of tissue; there are so many.
    pub(super) fn new(
        size: [usize; 3],
        count: usize,
        region: impl Fn(usize) -> Option<u8>,
    ) -> RegionMap {
        let voxels = 0..size.iter().product();
        let of_voxels = voxels.map(|voxel| region(voxel).map_or(0, |region| region + 1)).collect();
        RegionMap { size, of_voxels, count }
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The region with most votes at a place in voxels; the first where no tissue is seen.
    pub(super) fn at(&self, place: [f64; 3]) -> u8 {
        let mut votes = [0.0; 256];
        spline_weights(self.size, place, |seen| {
            votes[usize::from(self.of_voxels[seen.voxel])] += seen.weight;
        });
        let of_tissue = votes.iter().enumerate().skip(1);
        let most = of_tissue.fold((1, 0.0), |most, (region, &sum)| match sum > most.1 {
            true => (region, sum),
            false => most,
        });
        (most.0 - 1) as u8
    }

    /// By how much the votes for the first region are more than those for the second at a place in voxels; -1 where there are none
    /// for the first.
    pub(super) fn lead(&self, place: [f64; 3], [one, other]: [u8; 2]) -> f64 {
        let [one, other] = self.votes(place, [one, other]);
        if one.sum == 0.0 { -1.0 } else { one.sum - other.sum }
    }

    /// The place near a point where two regions have as many votes, or the point where none is found. `place` leads to voxels,
    /// `to_index` is its derivative.
    pub(super) fn interface(
        &self,
        point: &Vector,
        between: [u8; 2],
        place: &dyn Fn(&Vector) -> [f64; 3],
        to_index: &Matrix3<f64>,
    ) -> Vector {
        let mut at = *point;
        for _ in 0..STEPS {
            let [one, other] = self.votes(place(&at), between);
            let lead = one.sum - other.sum;
            if lead.abs() < EQUAL {
                return at;
            }
            let slope = to_index.tr_mul(&(one.slope - other.slope));
            let step = slope * (lead / slope.norm_squared());
            at -= step * (LONGEST / (to_index * step).norm()).min(1.0);
            if !at.iter().all(|x| x.is_finite()) {
                return *point;
            }
        }
        let [one, other] = self.votes(place(&at), between);
        if (one.sum - other.sum).abs() < 10.0 * EQUAL { at } else { *point }
    }

    fn votes(&self, place: [f64; 3], between: [u8; 2]) -> [Votes; 2] {
        let mut votes = [Votes::default(); 2];
        spline_weights(self.size, place, |seen| {
            for (votes, region) in votes.iter_mut().zip(between) {
                if self.of_voxels[seen.voxel] == region + 1 {
                    votes.sum += seen.weight;
                    votes.slope += Vector::from(seen.slope);
                }
            }
        });
        votes
    }
}
