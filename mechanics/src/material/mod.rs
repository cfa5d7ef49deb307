//! Constitutive laws and their constants at a material point. Knows no mesh.

pub mod elastic_tensor;
mod error;
pub mod hyperelastic;
mod isotropic;
pub mod law_series;
mod linear_elastic;
mod mixing_rule;
pub mod mixture;
pub mod plane_stress;
pub mod stress_series;
pub mod tension_field;
pub mod transversely_isotropic;
pub use elastic_tensor::ElasticTensor;
pub use error::MaterialError;
pub use isotropic::Isotropic;
pub use linear_elastic::LinearElastic;
pub use plane_stress::{PlaneStress, Sheet, SheetError};
pub use transversely_isotropic::{Fibre, FibreLaw, TransverselyIsotropic};
