//! Process of a slot, which computes one job after the other: an allocation that fails, a full stack or a signal ends
//! one attempt and nothing else. The worker keeps claim, lease and publication; the process gets documents and meshes
//! from it, and has neither database nor credentials.

mod answers;
pub mod attempt;
pub mod child;
pub mod memory;
pub mod protocol;
mod reports;
mod restarts;
pub mod serve;
mod source;
mod spent;
pub mod supervisor;

pub use child::Program;
pub use memory::slot_bytes;
pub use serve::{SlotError, serve};
pub use supervisor::{SlotSettings, SlotWork};
