//! `GET /v1/methods`: the ways of modelling, by the names a spec may give.

mod document;
mod dvs;
mod fem_linear;
mod list;
mod measured;
mod msm;
mod mtm;
mod mtm_ti;
mod name;
mod thickness_warp;

pub use document::{MethodDocument, ParameterDocument};
pub use list::{
    MeasuredMethod, MethodList, OptimiseMethod, ResponseMethod, available_methods, check_linear,
    check_method, check_own,
};
pub use measured::{MeasuredDocument, time_band};
pub use name::{ElementName, MethodName, WHY_ASKED, WHY_LINEAR};
