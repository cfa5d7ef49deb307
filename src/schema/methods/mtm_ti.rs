//! What `GET /v1/methods` tells of `mtm_ti`.

use super::document::{MethodDocument, words};
use super::name::{ElementName, MethodName};

pub(super) fn document() -> MethodDocument {
    MethodDocument {
        name: MethodName::MtmTi,
        title: "mass-tensor of tetrahedra with fibres".to_owned(),
        assumptions: words(&[
            "the force of a node is a sum over its neighbours of a tensor times their displacement, V g_j.C.g_k: \
                the plain finite element, node by node; both give the same numbers",
            "tissue is stiffer along the fibre of a cell than across it, by the law that its material names; \
                paper 002 prints this tensor with another factor and without one of its terms, which is not \
                what is solved",
            "strain is small, as with fem_linear; plain tetrahedra lock above a Poisson ratio of 0.45, with a \
                warning",
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
            "case.materials.fibre",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "spec.contact",
            "spec.materials",
            "spec.membrane",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ]),
        parameters: Vec::new(),
    }
}
