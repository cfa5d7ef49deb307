//! Mass-tensor model of transversely isotropic tissue: description.

use super::document::Description;
use super::mtm;

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "mass-tensor of tetrahedra with fibres",
        assumptions: &[
            "the force of a node is a sum over its neighbours of a tensor times their displacement, V g_j.C.g_k: \
                the plain finite element, node by node; both give the same numbers",
            "tissue is stiffer along the fibre of a cell than across it, by the law of its material; \
                Kim et al. 2012 print this tensor with another factor and without one of its terms, which is not \
                solved here",
            "its iterations are those of mtm: with others than fast, unilateral contact is not available, \
                and each load case is solved separately",
            "strain is small, as with fem_linear; plain tetrahedra lock above a Poisson ratio of 0.45, with a \
                warning",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "case.materials.fibre",
            "case.muscles",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "plan.growth",
            "plan.activations",
            "spec.contact",
            "spec.materials",
            "spec.membrane",
            "spec.mtm_ti",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ],
        parameters: mtm::parameters(),
    }
}
