//! Learning from operated cases: regression and deformation models over cohorts, beside mechanics and validated without the
//! case that is predicted (docs/learning.md).

pub mod bands;
pub mod classes;
pub mod cohort;
pub mod curve;
pub mod deformation_model;
pub mod features;
mod golden_section;
pub mod hill_climb;
pub mod learner;
pub mod measures;
pub mod model;
mod pairs;
pub mod regression;
pub mod theta;
pub mod validation;
#[cfg(test)]
mod validation_tests;
pub mod virtual_cohort;

pub use cohort::{Cohort, CohortError, LearningCase};
pub use features::{Distance, Features};
pub use learner::{Learner, Method, Target};
pub use model::{Corrected, LearnedModel, PreoperativeCase, Refusal};
