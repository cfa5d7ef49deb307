//! Inverse planning.

mod assimilation;
mod plans;
pub mod scenes;
