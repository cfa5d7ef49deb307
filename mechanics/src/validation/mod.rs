//! Prediction against a postoperative scan: distances, statistics, alignment.

pub mod alignment;
pub mod comparison;
mod correspondence;
pub mod distance;
mod error;
pub mod penetration;
pub mod statistics;

pub use alignment::{Alignment, AlignmentReport, LandmarkPair};
pub use comparison::{Comparison, ComparisonSettings, NodeWise, compare};
pub use distance::{DistanceStatistics, Distances};
pub use error::ComparisonError;
pub use statistics::{Statistics, StatisticsError};
