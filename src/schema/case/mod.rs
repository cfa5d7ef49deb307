//! The case document, its parts, and its conversion to the numerics.

pub mod acquisition;
pub mod bone_landmark;
pub mod conversion;
pub mod document;
pub mod fibre;
pub mod hounsfield;
pub mod law;
mod law_conversion;
pub mod material;
pub mod membrane;
pub mod merged;
pub mod meshed;
pub mod meshes;
pub mod muscle;
pub mod muscle_box;
pub mod muscle_mixing;
pub mod norm;
mod normal;
pub mod preset;
pub mod preset_name;
mod preset_source;
pub mod region;
pub mod selection;
pub mod size;
