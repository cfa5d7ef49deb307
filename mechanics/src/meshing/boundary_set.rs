//! Sets of boundaries that a node lies on.

use crate::domain::Boundary;

/// Which boundaries a node lies on; none inside the tissue, several at a crease.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct BoundarySet(u8);

impl BoundarySet {
    pub const NONE: BoundarySet = BoundarySet(0);

    pub fn contains(self, boundary: Boundary) -> bool {
        self.0 & bit(boundary) != 0
    }

    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    #[must_use]
    pub fn and(self, other: BoundarySet) -> BoundarySet {
        BoundarySet(self.0 | other.0)
    }

    #[must_use]
    pub fn shared(self, other: BoundarySet) -> BoundarySet {
        BoundarySet(self.0 & other.0)
    }

    /// The boundaries in it, in their order.
    pub fn iter(self) -> impl Iterator<Item = Boundary> {
        ALL.into_iter().filter(move |&boundary| self.contains(boundary))
    }
}

impl From<Boundary> for BoundarySet {
    fn from(boundary: Boundary) -> BoundarySet {
        BoundarySet(bit(boundary))
    }
}

const ALL: [Boundary; 4] = [Boundary::Skin, Boundary::Airway, Boundary::Bone, Boundary::Cut];

fn bit(boundary: Boundary) -> u8 {
    match boundary {
        Boundary::Skin => 1,
        Boundary::Bone => 2,
        Boundary::Cut => 4,
        Boundary::Airway => 8,
    }
}
