//! Studies, their statistics, and the map of failures.

pub mod paired;
pub mod stability;
pub mod studies;
