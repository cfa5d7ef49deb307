//! Mechanics, formats and statistics: no server, no database, nothing that is not part of the project.

#![allow(clippy::unwrap_used)]

mod airway_walls;
mod anatomy;
mod cephalometry;
mod conformation;
mod conformed_fibres;
mod domain;
mod format;
mod golden;
mod hollow_bone;
mod image;
mod landmarks;
mod material;
mod mesh;
mod meshing;
mod model;
mod muscle;
mod optimisation;
mod osteotomy;
mod prediction;
mod registration;
mod repair;
mod response;
mod segmentation;
mod simplification;
mod skin_scan;
mod solver;
mod study;
#[path = "../support/mod.rs"]
mod support;
mod thin_bone;
mod transform_text;
mod validation;

use support::{domains, samples, scenes, surfaces};
