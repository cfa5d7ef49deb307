//! What `GET /v1/methods` tells of `msm`.

use serde_json::json;

use super::document::{MethodDocument, ParameterDocument, words};
use super::name::{ElementName, MethodName};
use crate::schema::predict::mass_spring::{DIRECT_ITERATIONS, NEWTON_ITERATIONS};

pub(super) fn document() -> MethodDocument {
    MethodDocument {
        name: MethodName::Msm,
        title: "springs along the edges of tetrahedra, at rest".to_owned(),
        assumptions: words(&[
            "a spring has the stiffness E V / L^2, V the volume of the tetrahedra around it and L its length \
                (Van Gelder): only Young's modulus is read, and only its ratios matter where bone is moved",
            "a Poisson ratio of 1/4 on average, whatever the materials say: the bulk modulus is 2 E / 3 and \
                C1122 equals C1212 (Cauchy's symmetry) on every mesh; tissue, of 0.43 and above, loses volume \
                instead of moving the skin. The result has the warning `built-in-poisson-ratio`",
            "the mesh shows in the answer: its edges are the only directions in which forces run, and how \
                stiff it is in which direction depends on how it was cut",
            "springs know lengths and not volumes: rotations cost nothing, and under large pressure the network \
                gives way sideways and cells turn inside out, which is told by `cells-inverted`. There are then \
                several states of rest, and `newton` and `direct` may end in different ones",
        ]),
        elements: vec![ElementName::Auto],
        cells: words(&["tet4"]),
        reads: words(&[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.density_g_per_cm3",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "spec.contact",
            "spec.materials",
            "spec.msm",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ]),
        parameters: vec![
            ParameterDocument {
                name: "equilibrium".to_owned(),
                meaning: "how rest is looked for: Newton's method with a line search on the energy, or node by \
                    node, each to where its own springs would have it"
                    .to_owned(),
                default: json!("newton"),
                range: "newton | direct".to_owned(),
            },
            ParameterDocument {
                name: "max_iterations".to_owned(),
                meaning: format!(
                    "steps or sweeps after which it is told that rest was not found; default \
                     {NEWTON_ITERATIONS} with newton, {DIRECT_ITERATIONS} with direct"
                ),
                default: json!(NEWTON_ITERATIONS),
                range: "[1, 1000000]".to_owned(),
            },
        ],
    }
}
