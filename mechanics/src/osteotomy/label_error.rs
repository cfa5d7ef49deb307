//! Why the bone of a scan holds no such segments.

/// Why a scan cannot be parted as asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LabelError {
    #[error("no bone lies on the sides of segment `{segment}`")]
    NoBone { segment: String },
    #[error("seed {seed} of segment `{segment}` has no bone of its sides within 10 mm")]
    SeedOffBone { segment: String, seed: usize },
    #[error("seed {seed} of segment `{segment}` is on the other side of cut `{cut}`")]
    SeedAcross { segment: String, seed: usize, cut: String },
    #[error("segments `{one}` and `{other}` have a seed at the same place")]
    SeedsMeet { one: String, other: String },
    #[error(
        "the largest piece on the sides of segment `{segment}` is that of `{other}` too: give it a seed"
    )]
    NeedsSeed { segment: String, other: String },
}
