//! Mechanics, formats and statistics: no server, no database, nothing that is not part of the project.

#![allow(clippy::unwrap_used)]

mod format;
mod golden;
mod image;
mod landmarks;
mod material;
mod mesh;
mod model;
mod optimisation;
mod osteotomy;
mod prediction;
mod registration;
mod response;
mod solver;
mod study;
#[path = "../support/mod.rs"]
mod support;
mod validation;

use support::{samples, scenes, surfaces};
