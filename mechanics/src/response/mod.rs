//! Plan response: skin displacement as a linear function of how segments are moved.
//!
//! A segment moves by u(x) = (R - I) x + t, x from its centre: linear in the twelve numbers of R - I and t.
//! The tissue is linear too, so the skin is u = sum_k a_k c_k with one solved column c_k for each of
//! the twelve numbers of each segment: exact for every finite movement (Cotin, Delingette, Ayache
//! 1999, "pre-calculus"; docs/verification.md#v43). What linearity leaves out is, to second order, a quadratic form in the same
//! numbers, which is built on request. Growth of a region and the pull of a muscle act linearly too: one column each.

pub mod build;
mod combined;
pub mod coupling;
mod inner_loads;
pub mod linearity;
mod probes;
pub mod quadratic_form;
mod response_error;
mod rigid_numbers;
mod second_order;
mod superposition;
pub use build::{
    ColumnRequest, Columns, ResponseOrder, build, build_of, build_to, check_order, chosen,
};
pub use combined::solved_skin;
pub use inner_loads::inner_loads;
pub use linearity::{Linearity, Nonlinearity, SampledSecond, by_rule_of_thumb};
pub use quadratic_form::{BeyondLinear, QuadraticForm};
pub use response_error::ResponseError;
pub use superposition::{
    Amounts, COLUMNS_PER_SEGMENT, InnerLoad, Response, ResponseSegment, coefficients,
};
