//! Mechanics, formats and statistics: no server, no database.

#![allow(clippy::unwrap_used)]

#[path = "../shared/mod.rs"]
mod shared;

mod anisotropy;
mod closed_form;
mod comparison;
mod conditions;
mod convergence;
mod distances;
mod documents;
mod documents_fibres;
mod documents_plan;
mod documents_syntax;
mod elements;
mod fibres;
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
mod fuzz;
mod hard_systems;
mod image;
mod image_jobs;
mod jobs;
mod jump;
mod mass_spring;
mod mass_tensor;
mod membrane;
mod optimisation;
mod optimisation_scenes;
mod optimise_jobs;
mod paired;
mod patch;
mod quality;
mod registration;
mod response;
mod scenes;
mod slab_table;
mod sliding;
mod solvers;
mod spline_stepping;
mod spline_volume;
mod stability;
mod study;
mod study_report;
mod surfaces;
mod thickness_warp;
