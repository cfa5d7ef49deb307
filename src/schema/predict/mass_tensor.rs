//! What only the mass-tensor models have to be told.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::solver::stationary::{Iteration, Stationary};

/// Sweeps over all nodes, where the spec does not say.
pub const USUAL_ITERATIONS: u32 = 50_000;
/// Iterations allowed at most.
const MOST_ITERATIONS: u32 = 1_000_000;

/// How the tensors are brought to rest; only with the method `mtm`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MassTensorDocument {
    #[serde(default)]
    pub iterations: IterationsName,
    /// |u - u_old| / |u| at which the iterations may end, beside `tolerance.relative_residual`; default: any.
    /// Not with `fast`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-14, maximum = 1e-2)]
    pub relative_change: Option<f64>,
    /// Default: 50 000. Not with `fast`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 1000000)]
    pub max_iterations: Option<u32>,
}

/// What brings the tensors to rest: all that converge give the same answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum IterationsName {
    /// The solver of `fem_linear`.
    #[default]
    Fast,
    /// Node by node, each with the newest displacements of the others.
    GaussSeidel,
    /// All nodes at once, with a step just below the largest that converges.
    DampedJacobi,
    /// All nodes at once with a step of 1, as printed in papers. On nearly all meshes it diverges, which
    /// is then the answer: `solver-diverged` with the residuals and their growth.
    Jacobi,
}

impl MassTensorDocument {
    pub fn to_settings(&self, at: &Pointer, faults: &mut Faults) -> MassTensorSettings {
        let iteration = match self.iterations {
            IterationsName::Fast => {
                self.refuse_unread(at, faults);
                return MassTensorSettings { iterations: Iterations::Fast };
            }
            IterationsName::GaussSeidel => Iteration::GaussSeidel,
            IterationsName::DampedJacobi => Iteration::DampedJacobi,
            IterationsName::Jacobi => Iteration::Jacobi,
        };
        let most = self.max_iterations.unwrap_or(USUAL_ITERATIONS);
        let range = 1.0..=f64::from(MOST_ITERATIONS);
        faults.check_range(&at.key("max_iterations"), f64::from(most), range, "");
        if let Some(change) = self.relative_change {
            faults.check_range(&at.key("relative_change"), change, 1e-14..=1e-2, "");
        }
        MassTensorSettings {
            iterations: Iterations::Stationary(Stationary {
                iteration,
                relative_change: self.relative_change,
                most_iterations: most as usize,
            }),
        }
    }

    /// `fast` ends at the residual of the spec, and reads nothing else.
    fn refuse_unread(&self, at: &Pointer, faults: &mut Faults) {
        let given = [
            ("relative_change", self.relative_change.is_some()),
            ("max_iterations", self.max_iterations.is_some()),
        ];
        for (name, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
            let detail =
                "`fast` ends at `tolerance.relative_residual`; this is for the other iterations";
            faults.add(&at.key(name), ErrorCode::MethodMismatch, detail);
        }
    }
}
