//! Settings of a meshing: the size of cells, limits and what is left out.

use super::error::MeshingError;
use super::size::SizeField;

/// How a body is meshed.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshingSettings {
    pub size: SizeField,
    /// About so many tetrahedra: all lengths of `size` are scaled together until the estimate is so many.
    pub target: Option<usize>,
    /// More tetrahedra than these are refused before they are made.
    pub most_tetrahedra: usize,
    /// Keeps pieces of tissue that hang together with nothing else. Otherwise the largest alone stays.
    pub keep_pieces: bool,
    /// Moves apart the copies of nodes where tissue touches itself, so that no two nodes share a place.
    pub part_copies: bool,
    /// Looks for gaps and sheets that are thinner than a cell, to report them.
    pub find_gaps: bool,
    /// Sweeps of the hill climbing over the nodes of bad cells.
    pub sweeps: usize,
}

impl Default for MeshingSettings {
    fn default() -> Self {
        MeshingSettings {
            size: SizeField::uniform(4.0),
            target: None,
            most_tetrahedra: 4_000_000,
            keep_pieces: false,
            part_copies: false,
            find_gaps: true,
            sweeps: 8,
        }
    }
}

impl MeshingSettings {
    pub(super) fn check(&self) -> Result<(), MeshingError> {
        let refuse = |setting, wanted| MeshingError::Setting { setting, value: 0.0, wanted };
        if self.target == Some(0) {
            return Err(refuse("target", "at least 1"));
        }
        if self.most_tetrahedra == 0 {
            return Err(refuse("most_tetrahedra", "at least 1"));
        }
        self.size.check()
    }
}
