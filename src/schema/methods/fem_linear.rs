//! What `GET /v1/methods` tells of `fem_linear`.

use super::document::{MethodDocument, words};
use super::name::{ElementName, MethodName};

pub(super) fn document() -> MethodDocument {
    MethodDocument {
        name: MethodName::FemLinear,
        title: "linear elasticity at small strain, finite elements".to_owned(),
        assumptions: words(&[
            "strain is the symmetric part of the displacement gradient: a segment that turns by theta \
                stretches the tissue beside it by 1 - cos theta, and cells may turn inside out, which is told",
            "stress is linear in strain",
            "displacement is prescribed on bone, so that only ratios of moduli matter",
        ]),
        elements: vec![
            ElementName::Auto,
            ElementName::Plain,
            ElementName::MeanDilatation,
            ElementName::Stabilised,
            ElementName::Quadratic,
        ],
        cells: words(&["tet4", "hex8", "wedge6"]),
        reads: words(&[
            "case.segments",
            "case.fixed",
            "case.sliding",
            "case.materials.young_modulus_kpa",
            "case.materials.poisson_ratio",
            "case.materials.density_g_per_cm3",
            "case.hounsfield",
            "case.materials.fibre",
            "plan.segments",
            "plan.prescribed",
            "plan.loads",
            "spec.contact",
            "spec.element",
            "spec.materials",
            "spec.membrane",
            "spec.tolerance.relative_residual",
            "spec.budget",
        ]),
        parameters: Vec::new(),
    }
}
