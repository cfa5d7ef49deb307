//! Choice of the cheapest adequate model: models of rising cost until the estimated error of the skin is accepted.
//!
//! The rungs are linear finite elements; their answer to second order (`nonlinearity`); and the same elements at finite strain;
//! each as it is and with what its mesh leaves out added (`numerical_error`). With e_m of the mesh, e_l of what linearity
//! leaves out and e_3 of what the second order does, all means over the skin that moves or a part of it, an answer is expected to be off by
//! e_m + e_l, e_m + e_3 or e_m, a corrected one by .8 e_m in place of e_m (docs/estimates.md: what adding an estimate left). A
//! rung is tried while none below is adequate, if its own expected error is accepted or clearly smaller, and if the time for it
//! is there. The cheapest one within what is accepted is taken, unless its warnings speak against it (`objection`); where there is
//! none, the cheapest that is nearly as good as the best, which is then said not to be adequate.

mod accepted;
mod climb;
mod duration;
mod finite_strain;
mod objection;
mod rung;

pub use accepted::{Accepted, MeanErrors, TimedProgress, USUALLY_ACCEPTED_MM};
pub use climb::{Adequate, predict_adequately};
pub use duration::{NEWTON_MAY_TAKE, SECOND_ORDER_TAKES};
pub(super) use objection::CandidateAnswer;
pub use objection::Objection;
pub(super) use rung::error_over_estimate;
pub use rung::{Considered, Errors, Rung};
