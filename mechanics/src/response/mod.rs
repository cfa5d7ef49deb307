//! Plan response: skin displacement as a linear function of how segments are moved.
//!
//! A segment moves by u(x) = (R - I) x + t, x from its centre: linear in the twelve numbers of R - I and t.
//! The tissue is linear too, so the skin is u = sum_k a_k c_k with one solved column c_k for each of
//! the twelve numbers of each segment: exact for every finite movement (Cotin, Delingette, Ayache
//! 1999, "pre-calculus"; VERIFICATION V.43). What linearity leaves out is, to second order, a quadratic form in the same
//! numbers, which is built on request.

pub mod build;
pub mod linearity;
pub mod quadratic_form;
mod rigid_numbers;
mod second_order;
mod superposition;
pub use build::{Columns, ResponseError, ResponseOrder, build, build_to, check_order, chosen};
pub use linearity::{Linearity, Nonlinearity, SampledSecond, by_rule_of_thumb};
pub use quadratic_form::{BeyondLinear, QuadraticForm};
pub use superposition::{COLUMNS_PER_SEGMENT, Response, ResponseSegment, coefficients};
