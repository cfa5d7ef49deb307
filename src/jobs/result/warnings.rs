//! Warnings of a result, the most serious first.

use crate::schema::WarningDocument;
use mechanics::mesh::Warning;

/// Codes that precede all others, in this order: those of doubtful input or measurements, those of a result that
/// has larger errors than reported elsewhere, and those of an impossible one.
const GRAVE: [&str; 70] = [
    "nothing-moves",
    "nothing-performed",
    "units-suspect",
    "plan-units-suspect",
    "constant-suspect",
    "moduli-far-apart",
    "frame-suspect",
    "image-place-doubtful",
    "landmarks-swapped",
    "landmark-doubtful",
    "mirrored?",
    "another-person-suspect",
    "registration-undetermined",
    "before-operation-suspect",
    "unregistered-suspect",
    "model-suspect",
    "skin-unlike-learned",
    "segment-misfit",
    "template-apart",
    "surfaces-apart",
    "surfaces-opposed",
    "no-bone",
    "segment-without-nodes",
    "segment-far-from-bone",
    "cells-inverted",
    "cells-do-not-match",
    "duplicate-cells",
    "mesh-inverted-elements",
    "tearing",
    "tolerance-not-met",
    "solved-loosely",
    "other-response",
    "numerical-error-large",
    "thin-stiff-layer",
    "pressure-turned",
    "pressure-unsettled",
    "muscle-few-cells",
    "muscles-not-refined",
    "points-refined",
    "point-force",
    "muscle-outside",
    "sliding-normal-turned",
    "walls-nearly-parallel",
    "volume-not-kept",
    "locking",
    "large-strain",
    "large-rotation",
    "outside-linear-range",
    "outside-second-order-range",
    "nonlinearity-unknown",
    "another-equilibrium",
    "tissue-may-buckle",
    "another-minimum",
    "membrane-wrinkles",
    "bulk-in-all-cells",
    "skin-outruns-plan",
    "skin-overlaps",
    "bone-in-tissue",
    "bone-through-skin",
    "bones-overlap",
    "contact-overlap",
    "contact-chatter",
    "contact-points-move",
    "out-of-distribution",
    "learned-otherwise",
    "correction-above-movement",
    "nothing-to-correct",
    "learning-does-not-help",
    "not-corrected",
    "cut-near-risk",
];

/// The place of a code among those of [`GRAVE`], and after them that of all others.
pub fn rank(code: &str) -> usize {
    GRAVE.iter().position(|grave| *grave == code).unwrap_or(GRAVE.len())
}

/// Warnings as documents, without duplicates, the most serious first.
pub fn warning_documents<'a>(warnings: impl Iterator<Item = &'a Warning>) -> Vec<WarningDocument> {
    warnings_after(&[], warnings)
}

/// The same after those of the meshing of a volume.
pub fn warnings_after<'a>(
    told: &[WarningDocument],
    warnings: impl Iterator<Item = &'a Warning>,
) -> Vec<WarningDocument> {
    let mut documents: Vec<WarningDocument> = Vec::new();
    for warning in told.iter().cloned().chain(warnings.map(WarningDocument::from)) {
        if !documents.contains(&warning) {
            documents.push(warning);
        }
    }
    documents.sort_by_key(|warning| rank(&warning.code));
    documents
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_serious_come_first_and_none_comes_twice() {
        let all = ["landmark-far", "skin-overlaps", "skin-held", "units-suspect", "landmark-far"];
        let all = all.map(|code| Warning::new(code, code.to_owned()));
        let told: Vec<String> =
            warning_documents(all.iter()).into_iter().map(|warning| warning.code).collect();
        assert_eq!(told, ["units-suspect", "skin-overlaps", "landmark-far", "skin-held"]);
    }

    #[test]
    fn every_grave_code_is_one_of_the_page_of_errors() {
        let page = include_str!("../../../docs/errors.md");
        for code in GRAVE {
            assert!(page.contains(&format!("\n| `{code}` |")), "{code}");
        }
    }
}
