//! Words for the names in documents, as shown in pictures.

/// Methods by their names.
const METHODS: [(&str, &str); 9] = [
    ("auto", "chosen by its error"),
    ("fem_linear", "linear FEM"),
    ("fem_nonlinear", "nonlinear FEM"),
    ("mtm", "mass-tensor"),
    ("mtm_ti", "mass-tensor with fibres"),
    ("mtm_nonlinear", "nonlinear mass-tensor"),
    ("msm", "springs"),
    ("dvs", "spline"),
    ("thickness_warp", "warp that keeps thickness"),
];

/// Words for variants of a method whose name is no word.
const VARIANTS: [(&str, &str); 7] = [
    ("gauss_seidel", "Gauss-Seidel"),
    ("damped_jacobi", "damped Jacobi"),
    ("jacobi", "Jacobi"),
    ("newton", "Newton"),
    ("direct", "node by node"),
    ("galerkin", "Galerkin"),
    ("lattice", "lattice of links"),
];

/// Scenes of the program by their names.
const SCENES: [(&str, &str); 6] = [
    ("sphere", "thick sphere"),
    ("slab", "slab"),
    ("slab_hex", "slab of hexahedra"),
    ("slab_far", "slab, moved far"),
    ("half_head", "half head"),
    ("half_head_far", "half head, moved far"),
];

/// A variant by the label of its rows; labels of clients are taken for words.
pub fn variant_in_words(label: &str) -> String {
    let (method, rest) = label.split_once(' ').unwrap_or((label, ""));
    let Some(method) = found(&METHODS, method) else { return in_words(label) };
    match (found(&VARIANTS, rest), rest) {
        (_, "") => method.to_owned(),
        (Some(variant), _) => format!("{method}, {variant}"),
        (None, rest) => format!("{method}, {}", in_words(rest)),
    }
}

/// A scene by its name; names of clients are taken for words.
pub fn scene_in_words(name: &str) -> String {
    found(&SCENES, name).map_or_else(|| in_words(name), str::to_owned)
}

/// The same text as words.
pub fn in_words(text: &str) -> String {
    text.replace('_', " ")
}

fn found(table: &[(&str, &'static str)], name: &str) -> Option<&'static str> {
    table.iter().find(|(known, _)| *known == name).map(|(_, words)| *words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mechanics::study::methods;
    use mechanics::study::scenes::SCENES as OF_THE_PROGRAM;

    #[test]
    fn every_variant_and_scene_of_the_program_has_words_of_its_own() {
        let mut labels: Vec<String> = methods::available().into_iter().map(|v| v.label).collect();
        labels.push(methods::auto().label);
        let mut all: Vec<String> = labels.iter().map(|label| variant_in_words(label)).collect();
        for (label, words) in labels.iter().zip(&all) {
            assert!(words != label && !words.contains('_'), "{label}: {words}");
        }
        assert!(OF_THE_PROGRAM.iter().all(|name| found(&SCENES, name).is_some()));
        all.extend(OF_THE_PROGRAM.map(scene_in_words));
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
        assert_eq!(variant_in_words("mtm damped_jacobi"), "mass-tensor, damped Jacobi");
        assert_eq!(variant_in_words("my_own label"), "my own label");
        assert_eq!(scene_in_words("subject_jaw_4mm"), "subject jaw 4mm");
    }
}
