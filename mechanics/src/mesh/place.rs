//! Places in messages.

use super::Vector;

/// A place as `(1.5, 0.0, -2.0)`, with so many decimals.
pub fn place(at: &Vector, decimals: usize) -> String {
    format!("({:.decimals$}, {:.decimals$}, {:.decimals$})", at.x, at.y, at.z)
}
