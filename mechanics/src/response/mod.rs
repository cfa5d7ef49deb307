//! Plan response: skin displacement as a linear function of how segments are moved.
//!
//! A segment moves by u(x) = (R - I) x + t, x from its centre: linear in the twelve numbers of R - I and t.
//! The tissue is linear too, so the skin is u = sum_k a_k c_k with one solved column c_k for each of
//! the twelve numbers of each segment: exact for every finite movement (Cotin, Delingette, Ayache
//! 1999, "pre-calculus"; VERIFICATION V.43).

pub mod build;
pub mod linearity;
mod superposition;
pub use build::{Columns, ResponseError, build, chosen};
pub use linearity::{Linearity, Nonlinearity};
pub use superposition::{COLUMNS_PER_SEGMENT, Response, ResponseSegment, coefficients};
