//! Nonlinear finite elements: what is told of them.

use super::document::Description;

/// Its words in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "hyperelastic tissue at finite strain, finite elements",
        assumptions: &[
            "each region follows its law; without one it is neo-Hookean, W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J \
                with the Lame constants of Young's modulus and Poisson's ratio: no cell turns inside out, and turning is \
                no stretching",
            "elements of first order that do not lock: tetrahedra share pressures at their nodes, hexahedra and wedges one in \
                each cell; plain ones lock above a Poisson ratio of 0.45, which is told",
            "a wall that tissue slides on stays flat, and turns with the segment that carries it; loads keep their direction",
            "where tissue may rest in several ways, as pressed and creased tissue may, one of them is found",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "case.materials.law",
            "case.materials.fibre",
            "case.hounsfield",
            "case.muscles",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "plan.growth",
            "plan.activations",
            "spec.contact",
            "spec.element",
            "spec.materials",
            "spec.membrane",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ],
        parameters: Vec::new(),
    }
}
