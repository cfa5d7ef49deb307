//! A head in numbers: measures by landmarks, their norms, and its symmetry.

mod measures;
mod norm;
mod symmetry;

pub use measures::{HeadAxes, Landmarks, MEASURES, Measure, SwappedSides, Tissue, Unit};
pub use norm::{NORMS, Norm, z_score};
pub use symmetry::{Asymmetry, MidSagittal, Symmetric};
