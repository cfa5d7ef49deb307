//! Linear finite elements: description.

use super::document::Description;

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "linear elasticity at small strain, finite elements",
        assumptions: &[
            "strain is the symmetric part of the displacement gradient: a rotation by theta \
                stretches the tissue beside it by 1 - cos theta, and cells may invert, with a warning",
            "stress is linear in strain",
            "displacement is prescribed on bone, so that only ratios of moduli matter",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "case.hounsfield",
            "case.materials.fibre",
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
