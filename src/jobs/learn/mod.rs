//! Learning from operated cases: their predictions and what came of them, or virtual patients.

mod chart;
mod corresponding;
mod gather;
mod input;
mod job;
mod maps;
mod table;
mod thetas;

pub use input::{LearnInput, LearnedCase};
pub use job::learn_job;
