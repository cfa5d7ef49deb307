//! Inverse planning.

mod plans;
mod scenes;
