//! Numerics and formats, without a database.

#[path = "../shared/mod.rs"]
mod shared;

mod formats_check;
mod formats_damage;
mod formats_hostile;
mod formats_interop;
mod formats_read;
mod formats_round_trip;
mod formats_samples;
mod formats_shared_data;
mod formats_surface;
