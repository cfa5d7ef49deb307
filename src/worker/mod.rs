//! Workers: slots that claim jobs, the processes that compute them, and the heartbeat that renews leases.

pub mod fail_point;
pub mod heartbeat;
pub mod niceness;
pub mod process;
mod publication;
mod publisher;
pub mod slots;
mod storage;
pub mod work;
