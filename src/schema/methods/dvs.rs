//! What `GET /v1/methods` tells of `dvs`.

use serde_json::json;

use super::document::{MethodDocument, ParameterDocument, parameter, words};
use super::name::MethodName;

pub(super) fn document() -> MethodDocument {
    MethodDocument {
        name: MethodName::Dvs,
        title: "dynamic volume spline: B-splines over a lattice of control points".to_owned(),
        assumptions: words(&[
            "displacement is smooth, with continuous second derivatives for degree 3: steep changes beside the \
                edge of a bone are smeared over about two control spacings",
            "bone lies between control points: held nodes are pulled to where they have to be, and what is \
                left is told as `held-nodes-missed`",
            "galerkin: small strain and linear elastic regions, without means against locking above a Poisson \
                ratio of 0.49; gaps narrower than a control spacing, such as between the lips, are bridged",
            "lattice: control points are tied by equal links, component by component: tissue has no Poisson \
                ratio and no regions, and resists rotation, told as `rotation-resisted`",
            "rest does not depend on mass and damping: stepping in time arrives where `static` is at once",
        ]),
        elements: Vec::new(),
        cells: words(&["tet4", "hex8", "wedge6"]),
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
            "spec.dvs",
            "spec.materials",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ]),
        parameters: parameters(),
    }
}

fn parameters() -> Vec<ParameterDocument> {
    let chosen = "the finest of at least 1.5 mean edges that leaves at most 4000 control points";
    vec![
        parameter("stiffness", "what ties control points", json!("galerkin"), "galerkin | lattice"),
        parameter("degree", "of the B-splines", json!(3), "2 | 3"),
        parameter("control_spacing_mm", "between control points", json!(chosen), "[0.1, 1000]"),
        parameter(
            "hold_weight",
            "stiffness of what holds held nodes over that of the tissue around a control point",
            json!(5.0),
            "[1, 1e6]",
        ),
        parameter(
            "stepping",
            "how rest is found; explicit steps above 4 / (c + sqrt(c^2 + 4 omega^2)) are refused, c the \
                damping and omega the frequency of the fastest mode",
            json!("static"),
            "static | backward_euler | newmark | explicit",
        ),
        parameter("step_s", "length of a step in time", json!(0.01), "[1e-9, 10]"),
        parameter("duration_s", "when everything has to rest", json!(10.0), "[1e-6, 1000]"),
        parameter("stiffness_n_per_m", "of a link, lattice only", json!(80.0), "[1e-3, 1e6]"),
        parameter("damping_n_s_per_m", "of a link, lattice only", json!(1.0), "[0, 1e6]"),
        parameter("mass_damping_per_s", "D = d_M M + d_K K, galerkin only", json!(0.0), "[0, 1e6]"),
        parameter("stiffness_damping_s", "the same", json!(0.0125), "[0, 1000]"),
    ]
}
