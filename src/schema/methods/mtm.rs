//! What `GET /v1/methods` tells of `mtm`.

use serde_json::json;

use super::document::{MethodDocument, ParameterDocument, words};
use super::name::{ElementName, MethodName};
use crate::schema::predict::mass_tensor::USUAL_ITERATIONS;

pub(super) fn document() -> MethodDocument {
    MethodDocument {
        name: MethodName::Mtm,
        title: "mass-tensor model: one stiffness tensor for each node and edge".to_owned(),
        assumptions: words(&[
            "its tensors are the blocks of the stiffness matrix of plain linear tetrahedra, so that its answer is \
                that of `fem_linear` with the element `plain`, with all that this assumes",
            "it locks above a Poisson ratio of 0.45 and says so: skin moves too little",
            "what is its own are its iterations. They converge to the same answer, in a number of sweeps that \
                grows with the fineness of the mesh and as 1 / (1 - 2 nu); plain Jacobi diverges wherever the \
                largest eigenvalue of D^-1 K is above 2, as on nearly all meshes of tetrahedra",
        ]),
        elements: vec![ElementName::Auto, ElementName::Plain],
        cells: words(&["tet4"]),
        reads: words(&[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "spec.contact",
            "spec.materials",
            "spec.mtm",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ]),
        parameters: parameters(),
    }
}

fn parameters() -> Vec<ParameterDocument> {
    vec![
        ParameterDocument {
            name: "iterations".to_owned(),
            meaning: "what brings the tensors to rest: the solver of fem_linear, block Gauss-Seidel, block Jacobi \
                with omega at 0.95 of its limit, or block Jacobi with omega 1, which diverges"
                .to_owned(),
            default: json!("fast"),
            range: "fast | gauss_seidel | damped_jacobi | jacobi".to_owned(),
        },
        ParameterDocument {
            name: "relative_change".to_owned(),
            meaning: "the change of u in one iteration, as a share of u, at which the iterations may end, beside \
                tolerance.relative_residual; not with fast"
                .to_owned(),
            default: json!(null),
            range: "[1e-14, 1e-2]".to_owned(),
        },
        ParameterDocument {
            name: "max_iterations".to_owned(),
            meaning: "iterations after which it is told that rest was not found; not with fast".to_owned(),
            default: json!(USUAL_ITERATIONS),
            range: "[1, 1000000]".to_owned(),
        },
    ]
}
