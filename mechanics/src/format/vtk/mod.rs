//! VTK files: XML unstructured grids and poly data, and the legacy format.

pub mod array;
pub mod cells;
pub mod document;
pub mod legacy;
pub mod legacy_arrays;
pub mod source;
pub mod vtp;
pub mod vtu;
pub mod writer;
