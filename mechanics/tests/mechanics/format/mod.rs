//! Mesh and image files: what is read, written, refused.

mod damage;
mod dicom;
mod hostile;
mod metaimage;
mod nifti;
mod nrrd;
mod read;
mod round_trip;
mod scans;
mod surface;
mod zip;
