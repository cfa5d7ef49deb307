//! Inverse planning.

mod plans;
pub mod scenes;
