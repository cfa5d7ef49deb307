//! Norms of measures: mean and standard deviation of a group of people, with who measured them.

/// Of adults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Norm {
    /// The measure.
    pub measure: &'static str,
    /// In the unit of the measure.
    pub mean: f64,
    pub sd: f64,
    pub source: &'static str,
}

/// Norms that are built in: of angles of the profile, which lengths and enlargement do not change. Others are the client's to state,
/// because those of bone differ between peoples, sexes and ages by more than operations change.
pub const NORMS: [Norm; 2] = [
    Norm {
        measure: "facial_convexity",
        mean: 12.0,
        sd: 4.0,
        source: "Legan, Burstone 1980: adults of European descent with good occlusion",
    },
    Norm {
        measure: "nasolabial_angle",
        mean: 102.0,
        sd: 8.0,
        source: "Legan, Burstone 1980: adults of European descent with good occlusion",
    },
];

/// How many standard deviations a value is above a mean.
pub fn z_score(value: f64, mean: f64, sd: f64) -> f64 {
    (value - mean) / sd
}
