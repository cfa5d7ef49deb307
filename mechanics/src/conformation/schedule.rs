//! The schedule of a free-form deformation: lattices from coarse to fine, what bends, and what counts.
//!
//! Chosen on the pair of faces of the shared data, docs/conformation.md says with what effect.

use super::matching::MatchWeights;

/// Between the control points of the coarsest and the finest lattice, in mm.
const COARSEST: f64 = 64.0;
pub const LATTICES: i32 = 5;

/// λ of the finest lattice in mm; λ of each coarser one is larger by this factor.
const BENDING: f64 = 3e-6;
const STIFFER: f64 = 10.0;

/// Of a landmark beside the 1 of a whole skin: it is left some hundredths of a mm away.
pub(super) const LANDMARK: f64 = 0.01;

/// Of a whole bone beside the 1 of a whole skin.
pub(super) const BONE: f64 = 0.5;

/// A lattice, and the rounds of matching and fitting on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Level {
    pub rounds: usize,
    pub bending: f64,
    pub weights: MatchWeights,
    pub with_bone: bool,
    /// In mm.
    pub spacing: f64,
}

/// Skin first and, where there is bone, all but the coarsest lattice again with both; the finest one first left out where there are to
/// be fewer than [`LATTICES`].
pub(super) fn levels(has_bone: bool, lattices: i32) -> Vec<Level> {
    let skin = (0..lattices).map(|lattice| level(lattice, false));
    let both = (1..lattices).map(|lattice| level(lattice, true));
    skin.chain(both.filter(|_| has_bone)).collect()
}

/// Between the control points of the finest of so many lattices, in mm.
pub fn finest_spacing(lattices: i32) -> f64 {
    COARSEST * 0.5f64.powi(lattices - 1)
}

/// The skin alone, on the two coarsest lattices.
pub(super) fn coarse_levels() -> Vec<Level> {
    (0..2).map(|lattice| level(lattice, false)).collect()
}

fn level(lattice: i32, with_bone: bool) -> Level {
    let coarser = LATTICES - 1 - lattice;
    let (rounds, across) =
        [(5, 0.1), (6, 0.05), (8, 0.03), (8, 0.02), (6, 0.01)][lattice.clamp(0, 4) as usize];
    let always = 2.0 * STIFFER.powf(0.5 * f64::from(coarser));
    Level {
        rounds,
        bending: BENDING * STIFFER.powi(coarser),
        weights: MatchWeights { along: 1.0, across, always, back: 0.5 },
        with_bone,
        spacing: finest_spacing(lattice + 1),
    }
}
