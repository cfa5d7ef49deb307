//! Nonlinear mass-tensor model: description.

use super::document::Description;

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "mass-tensor with the full Green strain",
        assumptions: &[
            "the force of a node is a cubic polynomial of displacements, with tensors of each undeformed tetrahedron: \
                Saint Venant-Kirchhoff tissue, W = lambda/2 (tr E)^2 + mu tr E^2; rotation causes no strain",
            "tissue compressed to less than 0.577 of its length collapses, and cells may invert, with a warning: \
                fem_nonlinear with its default law does neither",
            "plain tetrahedra lock above a Poisson ratio of 0.45, with a warning",
            "a wall that tissue slides on stays flat, and rotates with its segment; loads keep their direction",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "case.materials.law",
            "case.hounsfield",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "spec.contact",
            "spec.materials",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ],
        parameters: Vec::new(),
    }
}
