//! Common parts of all documents: strict reading, faults with their place, limits, canonical JSON.

pub mod canonical;
pub mod date;
pub mod fault;
pub mod letters;
pub mod limits;
pub mod names;
pub mod numbers;
pub mod pointer;
pub mod problem;
pub mod reading;
pub mod strict;
pub mod text_or_object;
pub mod vector;
pub mod warning;
