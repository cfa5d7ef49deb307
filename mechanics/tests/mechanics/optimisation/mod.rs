//! Inverse planning.

pub mod plans;
pub mod scenes;
