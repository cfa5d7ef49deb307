//! Studies, their statistics, and the map of failures.

mod paired;
mod stability;
mod studies;
