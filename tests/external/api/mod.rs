//! Deeds and erasures over HTTP.

pub mod audit;
pub mod erasures;
