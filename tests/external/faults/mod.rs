//! Disks and databases that fail.

pub mod broken_disk;
pub mod slow_database;
pub mod small_disk;
