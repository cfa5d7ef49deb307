//! Mesh and image files: what is read, written, refused.

mod damage;
mod hostile;
mod nrrd;
mod read;
mod round_trip;
mod surface;
