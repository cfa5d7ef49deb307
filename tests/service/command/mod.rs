//! The program as a process: the demo, settings, start and end.

mod demo;
mod settings;
