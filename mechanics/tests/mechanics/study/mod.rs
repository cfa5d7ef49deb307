//! Studies, their statistics, and the map of failures.

mod paired;
mod random;
mod stability;
mod studies;
