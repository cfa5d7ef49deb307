//! Slots, hosts and clocks.

pub mod clocks;
pub mod hosts;
pub mod slots;
