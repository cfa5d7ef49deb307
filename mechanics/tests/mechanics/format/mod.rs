//! Mesh and image files: what is read, written, refused.

pub mod damage;
pub mod hostile;
pub mod interop;
pub mod nrrd;
pub mod read;
pub mod round_trip;
pub mod shared_data;
pub mod surface;
