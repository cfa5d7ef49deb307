//! The queue and its workers.

pub mod heartbeat;
pub mod worker;
