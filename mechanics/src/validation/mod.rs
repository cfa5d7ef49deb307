//! Prediction against a postoperative scan: distances, statistics, alignment.

pub mod alignment;
pub mod both_ways;
pub mod comparison;
pub mod contact_map;
mod correspondence;
pub mod distance;
mod error;
pub mod histogram;
mod inverse_distance;
mod landmark_errors;
pub mod operated;
pub mod penetration;
mod region;
pub mod statistics;
mod suspicion;
mod warped;

pub use alignment::{Aligned, Alignment, AlignmentReport, BoneSurfaces, LandmarkPair, aligned};
pub use both_ways::{BothDirections, Coverage};
pub use comparison::{Comparison, ComparisonSettings, NodeWise, compare};
pub use correspondence::corresponding_points;
pub use distance::{DistanceStatistics, Distances};
pub use error::ComparisonError;
pub use histogram::{Histogram, Histograms};
pub use landmark_errors::LandmarkError;
pub use region::Region;
pub use statistics::{Statistics, StatisticsError};
pub use warped::{WarpedStatistics, warped_distances};
