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
mod elements;
mod formats_check;
mod formats_damage;
mod formats_hostile;
mod formats_interop;
mod formats_read;
mod formats_round_trip;
mod formats_samples;
mod formats_shared_data;
mod formats_surface;
mod hard_systems;
mod jobs;
mod optimisation;
mod optimise_jobs;
mod patch;
mod quality;
mod registration;
mod response;
mod scenes;
mod solvers;
mod spline_stepping;
mod spline_volume;
mod surfaces;
mod thickness_warp;
