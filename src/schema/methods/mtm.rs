//! Mass-tensor model: parameters and description.

use serde::{Deserialize, Serialize};
use serde_json::json;
use utoipa::ToSchema;

use super::document::{Description, ParameterDocument};
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::solver::stationary::{Iteration, Stationary};

/// The default number of sweeps over all nodes.
pub const USUAL_ITERATIONS: u32 = 50_000;
/// The most iterations.
const MOST_ITERATIONS: u32 = 1_000_000;

/// The iterations to equilibrium; with the methods `mtm` and `mtm_ti`, in the field of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MassTensorDocument {
    #[serde(default)]
    pub iterations: IterationsName,
    /// |u - u_old| / |u| required to end the iterations, beside `tolerance.relative_residual`; default: any.
    /// Not with `fast`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-14, maximum = 1e-2)]
    pub relative_change: Option<f64>,
    /// Default: 50 000. Not with `fast`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 1000000)]
    pub max_iterations: Option<u32>,
}

/// The iterations to equilibrium: all that converge give the same result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum IterationsName {
    /// The solver of `fem_linear`.
    #[default]
    Fast,
    /// Node by node, each with the newest displacements of the others.
    GaussSeidel,
    /// All nodes at once, with a step just below the convergence limit.
    DampedJacobi,
    /// All nodes at once with a step of 1, as printed in papers. On nearly all meshes it diverges, which
    /// is then the error: `solver-diverged` with the residuals and their growth.
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

    /// `fast` ends at the residual of the spec, and has no other settings.
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

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "mass-tensor model: one stiffness tensor for each node and edge",
        assumptions: &[
            "its tensors are the blocks of the stiffness matrix of plain linear tetrahedra, so that its result is \
                that of `fem_linear` with the element `plain`, with the same assumptions",
            "it locks above a Poisson ratio of 0.45, with a warning: skin moves too little",
            "only its iterations differ. They converge to the same result, in a number of sweeps that \
                grows with the fineness of the mesh and as 1 / (1 - 2 nu); plain Jacobi diverges wherever the \
                largest eigenvalue of D^-1 K is above 2, as on nearly all meshes of tetrahedra",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "case.muscles",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "plan.growth",
            "plan.activations",
            "spec.contact",
            "spec.materials",
            "spec.mtm",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ],
        parameters: parameters(),
    }
}

pub(super) fn parameters() -> Vec<ParameterDocument> {
    vec![
        ParameterDocument {
            name: "iterations".to_owned(),
            meaning: "the iterations to equilibrium: the solver of fem_linear, block Gauss-Seidel, block Jacobi \
                with omega at 0.95 of its limit, or block Jacobi with omega 1, which diverges"
                .to_owned(),
            default: json!("fast"),
            range: "fast | gauss_seidel | damped_jacobi | jacobi".to_owned(),
        },
        ParameterDocument {
            name: "relative_change".to_owned(),
            meaning: "the change of u in one iteration, as a share of u, required to end them, beside \
                tolerance.relative_residual; not with fast"
                .to_owned(),
            default: json!(null),
            range: "[1e-14, 1e-2]".to_owned(),
        },
        ParameterDocument {
            name: "max_iterations".to_owned(),
            meaning: "iterations after which the solution ends without an equilibrium; not with fast".to_owned(),
            default: json!(USUAL_ITERATIONS),
            range: "[1, 1000000]".to_owned(),
        },
    ]
}
