//! Mechanics, formats and statistics: no server, no database.

#![allow(clippy::unwrap_used)]

mod format;
mod material;
mod mesh;
mod model;
mod optimisation;
mod prediction;
#[path = "../support/data.rs"]
mod shared;
mod solver;
mod study;
mod validation;

mod golden;
mod image;
mod registration;
mod response;
#[path = "../support/samples.rs"]
mod samples;
mod scenes;
mod surfaces;
