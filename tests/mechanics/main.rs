//! Mechanics, formats and statistics: no server, no database.

#![allow(clippy::unwrap_used)]

#[path = "../shared/mod.rs"]
mod shared;

mod closed_form;
mod comparison;
mod conditions;
mod convergence;
mod distances;
mod documents;
mod documents_plan;
mod documents_syntax;
mod elements;
mod formats_check;
mod formats_damage;
mod formats_hostile;
mod formats_interop;
mod formats_nrrd;
mod formats_read;
mod formats_round_trip;
mod formats_samples;
mod formats_shared_data;
mod formats_surface;
mod hard_systems;
mod image;
mod image_jobs;
mod jobs;
mod optimisation;
mod optimisation_scenes;
mod optimise_jobs;
mod patch;
mod quality;
mod registration;
mod response;
mod scenes;
mod solvers;
mod surfaces;
