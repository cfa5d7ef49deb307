//! Meshes, scenes, surfaces and needs that the tests of several targets share.

#![allow(dead_code, unused_macros, reason = "each target uses a part")]

pub mod chords;
pub mod damage;
pub mod damaged;
pub mod domains;
pub mod external;
pub mod responses;
pub mod samples;
pub mod scenes;
pub mod surfaces;
pub mod transforms;
