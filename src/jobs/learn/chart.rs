//! The picture of learning: errors by the number of cases, beside what is not learned.

use crate::jobs::study::words::variant_in_words;
use crate::schema::learn::result::LearningDocument;
use mechanics::chart::{LearningPicture, LearningSeries};
use mechanics::prediction::MethodKind;

/// An SVG of the learning curves.
pub fn learning_chart(found: &LearningDocument, cases: usize) -> String {
    let level = |name: &str| {
        let column = found.table.iter().find(|column| column.name == name)?;
        Some((in_words(&column.name), column.mean))
    };
    let nonlinear = MethodKind::FemNonlinear.name();
    let mut levels = vec!["what happened", "no movement", found.mechanical.as_str()];
    if found.mechanical != nonlinear {
        levels.push(nonlinear);
    }
    let levels: Vec<(String, f64)> = levels.into_iter().filter_map(level).collect();
    // Of other classes the kept method alone: eight lines more would hide each other.
    let other = found.curve_of_other_classes.iter().filter(|own| own.method == found.method);
    let other =
        other.map(|own| (format!("{} of other classes", in_words(&own.method)), &own.points));
    let own = found.curve.iter().map(|own| (in_words(&own.method), &own.points));
    let series: Vec<LearningSeries> = own
        .chain(other)
        .map(|(name, points)| LearningSeries {
            name,
            points: points.iter().map(|own| (own.cases as f64, own.error_mm)).collect(),
        })
        .collect();
    let title = format!("Mean error of {cases} cases by the number of cases learned from");
    LearningPicture { title: &title, levels: &levels, series: &series }.to_svg()
}

/// A method by the name of its column, that of mechanics in words.
fn in_words(name: &str) -> String {
    match name.split_once(" + ") {
        Some((mechanics, rule)) => format!("{} + {rule}", variant_in_words(mechanics)),
        None => variant_in_words(name),
    }
}
