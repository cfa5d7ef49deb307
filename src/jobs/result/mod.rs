//! The files of a result.

pub mod folder;
pub mod muscles;
pub mod pictures;
pub mod provenance;
mod record;
pub mod skin;
pub mod stress;
pub mod tissue;
pub mod warnings;
