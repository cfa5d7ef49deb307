//! Disks, databases and descriptors that fail.

pub mod broken_disk;
pub mod outages;
pub mod storage;
