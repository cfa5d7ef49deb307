//! Reasons why the bone of a scan cannot be divided into the stated segments.

use crate::mesh::{Vector, place};

/// Why a scan cannot be parted as asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LabelError {
    #[error("no bone lies on the sides of segment `{segment}`")]
    NoBone { segment: String },
    #[error(
        "seed {seed} of segment `{segment}` has no bone of its sides within 10 mm of {}: {}{}",
        place(at, 0), extent(bone.as_ref()), hint(at, bone.as_ref())
    )]
    SeedOffBone { segment: String, seed: usize, at: Vector, bone: Option<(Vector, Vector)> },
    #[error("seed {seed} of segment `{segment}` is on the other side of cut `{cut}`")]
    SeedAcross { segment: String, seed: usize, cut: String },
    #[error(
        "segment `{segment}` lies on the other side of `{cut}` than it says: `below` and `above` change places where a line is \
         walked the other way"
    )]
    LineTurned { segment: String, cut: String },
    #[error("segments `{one}` and `{other}` have a seed at the same place")]
    SeedsMeet { one: String, other: String },
    #[error(
        "the largest piece on the sides of segment `{segment}` is that of `{other}` too: give it a seed"
    )]
    NeedsSeed { segment: String, other: String },
}

/// Where bone lies.
pub(crate) fn extent(bone: Option<&(Vector, Vector)>) -> String {
    bone.map_or("there is no bone".to_owned(), |(low, high)| {
        format!("bone reaches from {} to {} mm", place(low, 0), place(high, 0))
    })
}

/// A place beyond all bone is mostly one of another frame.
fn hint(at: &Vector, bone: Option<&(Vector, Vector)>) -> &'static str {
    match bone.is_none_or(|(low, high)| at.sup(low).inf(high) == *at) {
        true => "",
        false => "; is the osteotomy in the frame of the bone?",
    }
}
