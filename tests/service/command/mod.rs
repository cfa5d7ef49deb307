//! The program as a process: the demo, settings, start and end.

pub mod demo;
pub mod settings;
