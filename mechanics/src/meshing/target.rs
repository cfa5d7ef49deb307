//! The scale of a size field at which a body has about so many tetrahedra.
//!
//! The octree of a scale takes a small part of the time that its mesh takes, and its leaves tell how many tetrahedra come of
//! it. The scale is found by the secant rule on the logarithms of scale and number. Large parts of tissue that hang together with the
//! rest nowhere do not count, unless they are kept.

use super::error::MeshingError;
use super::grid::{Coordinates, Grid};
use super::octree::{Leaf, Leaves};
use super::refine::{PER_CUBE, Refinement};
use super::settings::MeshingSettings;
use super::size::SizeField;
use super::watch::Watch;
use crate::domain::{Coverage, Domain};
use crate::mesh::disjoint_sets::DisjointSets;

/// The finest cells of the first scale along the longest side of the body.
const FIRST: f64 = 32.0;
/// A number so near to the target, as a logarithm, is met.
const NEAR: f64 = 0.03;
const MOST_ROUNDS: usize = 10;
/// By which power of the scale the number falls: 3 for cells all through a body, 2 for cells along its boundary.
const SLOPES: [f64; 2] = [2.0, 3.2];
const FIRST_SLOPE: f64 = 2.7;
/// Tetrahedra for each square of the lattice's edge on the boundary, beyond those of the volume: 1.63 to 1.9 on balls.
const PER_SQUARE: f64 = 1.7;
/// A plane at any angle shows so much of its area along the three axes.
const SHOWN: f64 = 1.5;
/// Tetrahedra at a face against four smaller leaves, beyond the twelve that each leaf is worth.
const AT_FINER: f64 = 6.0;

/// Pieces of a smaller share of the volume count: they may hang together with the rest by what is thinner than a leaf.
const LEAST_APART: f64 = 0.02;

/// A scale of the size field, and how many tetrahedra it gives; both as logarithms, the number over the target.
#[derive(Clone, Copy)]
struct Trial {
    scale: f64,
    number: f64,
}

/// The size field of the settings, scaled to their target if there is one.
pub(super) fn size_field(
    domain: &dyn Domain,
    settings: &MeshingSettings,
    watch: &Watch,
) -> Result<SizeField, MeshingError> {
    let Some(target) = settings.target else { return Ok(settings.size.clone()) };
    let keep_pieces = settings.keep_pieces;
    let search = Search { domain, size: &settings.size, target, keep_pieces, watch };
    let found = search.scale()?;
    Ok(settings.size.scaled(found.exp()))
}

struct Search<'a> {
    domain: &'a dyn Domain,
    size: &'a SizeField,
    target: usize,
    keep_pieces: bool,
    watch: &'a Watch<'a>,
}

impl Search<'_> {
    fn longest(&self) -> f64 {
        let (low, high) = self.domain.bounds();
        (high - low).max()
    }

    fn scale(&self) -> Result<f64, MeshingError> {
        let coarsest = (self.longest() / self.size.finest).ln();
        let mut last = self.first(coarsest)?;
        let (mut best, mut slope) = (last, FIRST_SLOPE);
        for _ in 0..MOST_ROUNDS {
            let scale = (last.scale + last.number / slope).min(coarsest);
            if last.number.abs() < NEAR || scale == last.scale {
                break;
            }
            let next = self.trial(scale, false)?;
            // A sheet that lies between the middles of such cells: what was found before is all there is.
            if next.number == f64::NEG_INFINITY {
                break;
            }
            let found = (last.number - next.number) / (next.scale - last.scale);
            slope = found.clamp(SLOPES[0], SLOPES[1]);
            last = next;
            best = if next.number.abs() < best.number.abs() { next } else { best };
        }
        // Once more with thin tissue kept, which takes longer: by what that adds, cells are coarser.
        let kept = self.trial(best.scale, true)?;
        if kept.number == f64::NEG_INFINITY {
            return Ok(best.scale);
        }
        Ok((best.scale + (kept.number - best.number) / slope).min(coarsest))
    }

    /// The coarsest scale, from some cells along the longest side on, at which the body has tissue.
    fn first(&self, coarsest: f64) -> Result<Trial, MeshingError> {
        let mut scale = coarsest - FIRST.ln();
        for _ in 0..4 {
            let trial = self.trial(scale, false)?;
            if trial.number > f64::NEG_INFINITY {
                return Ok(trial);
            }
            scale -= std::f64::consts::LN_2;
        }
        let (low, high) = self.domain.bounds();
        Err(MeshingError::Empty { low, high, size: self.size.finest * scale.exp() })
    }

    fn trial(&self, scale: f64, keeps_thin: bool) -> Result<Trial, MeshingError> {
        let (low, high) = self.domain.bounds();
        let size = self.size.scaled(scale.exp()).bounded(self.longest());
        // Far more than the target would be a scale gone wrong; it is not followed to its end.
        let most = self.target.saturating_mul(100).max(10_000_000);
        let refinement = Refinement { domain: self.domain, size: &size, most, keeps_thin };
        let leaves = refinement.leaves(Grid::new(&low, &high, &size)?, self.watch)?;
        let number = (self.tetrahedra(&leaves)? / self.target as f64).ln();
        Ok(Trial { scale, number })
    }

    /// About how many tetrahedra come of an octree.
    fn tetrahedra(&self, leaves: &Leaves) -> Result<f64, MeshingError> {
        let mut inside = self.watch.map(&leaves.list, |leaf| self.is_inside(leaves, leaf))?;
        if !self.keep_pieces {
            leave_out_pieces(leaves, &mut inside);
        }
        let numbers: Vec<u32> = (0..leaves.list.len() as u32).collect();
        let of_leaves = self.watch.map(&numbers, |&leaf| of_leaf(leaves, &inside, leaf))?;
        Ok(of_leaves.into_iter().sum())
    }

    /// The middle of a leaf lies in tissue.
    fn is_inside(&self, leaves: &Leaves, leaf: &Leaf) -> bool {
        match leaf.held {
            Coverage::Inside => true,
            Coverage::Outside => false,
            Coverage::Mixed => {
                let middle = leaf.corner.map(|coordinate| coordinate + leaf.size / 2);
                self.domain.value(&leaves.tree.grid.position(middle)) > 0.0
            }
        }
    }
}

/// Leaves out large pieces of leaves other than the largest.
fn leave_out_pieces(leaves: &Leaves, inside: &mut [bool]) {
    let numbers = || (0..leaves.list.len()).filter(|&number| inside[number]);
    let mut joined = DisjointSets::new(leaves.list.len());
    for number in numbers() {
        let leaf = &leaves.list[number];
        for (axis, high) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, false), (axis, true)]) {
            let other = leaves.at(beyond(leaf, axis, high)).filter(|&other| inside[other as usize]);
            other.into_iter().for_each(|other| joined.join(number as u32, other));
        }
    }
    let mut volumes = vec![0.0; leaves.list.len()];
    for number in numbers() {
        let root = joined.root(number as u32) as usize;
        volumes[root] += f64::from(leaves.list[number].size).powi(3);
    }
    let all: f64 = volumes.iter().sum();
    let largest = volumes.iter().copied().fold(0.0, f64::max);
    let is_apart = |volume: f64| volume < largest && volume > LEAST_APART * all;
    let apart: Vec<usize> =
        numbers().filter(|&n| is_apart(volumes[joined.root(n as u32) as usize])).collect();
    apart.into_iter().for_each(|number| inside[number] = false);
}

/// A place in the leaf beside a face of another.
fn beyond(leaf: &Leaf, axis: usize, high: bool) -> Coordinates {
    let mut beyond = leaf.corner;
    beyond[axis] = if high { beyond[axis] + leaf.size } else { beyond[axis].wrapping_sub(1) };
    beyond
}

fn of_leaf(leaves: &Leaves, inside: &[bool], number: u32) -> f64 {
    if !inside[number as usize] {
        return 0.0;
    }
    let leaf = &leaves.list[number as usize];
    let mut tetrahedra = PER_CUBE;
    for axis in 0..3 {
        for high in [false, true] {
            let other = leaves.at(beyond(leaf, axis, high));
            let finer = other.is_some_and(|other| leaves.list[other as usize].level > leaf.level);
            let bare = !other.is_some_and(|other| inside[other as usize]);
            tetrahedra += if finer { AT_FINER } else { 0.0 };
            tetrahedra += if bare { PER_SQUARE / SHOWN } else { 0.0 };
        }
    }
    tetrahedra
}
