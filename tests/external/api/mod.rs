//! Audited actions, downloads and erasures over HTTP.

pub mod audit;
pub mod downloads;
pub mod erasures;
