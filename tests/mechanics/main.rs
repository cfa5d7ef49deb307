//! Mechanics, formats and statistics: no server, no database.

#![allow(clippy::unwrap_used)]

#[path = "../shared/mod.rs"]
mod shared;

mod closed_form;
mod conditions;
mod convergence;
mod documents;
mod patch;
mod scenes;
mod solvers;
