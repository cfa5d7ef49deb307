//! Workers on many hosts, their clocks and their traces.

pub mod clocks;
pub mod hosts;
pub mod traces;
