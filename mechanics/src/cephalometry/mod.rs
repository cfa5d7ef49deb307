//! A head in numbers: measures by landmarks, their norms, and its symmetry.

mod landmarks;
mod measures;
mod norm;
mod symmetry;

pub use landmarks::{HeadAxes, Landmarks, SwappedSides};
pub use measures::{MEASURES, Measure, Tissue, Unit};
pub use norm::{NORMS, Norm, z_score};
pub use symmetry::{Asymmetry, MidSagittal, Symmetric};
