//! The picture of learning: errors by the number of cases, beside what is not learned.

use crate::schema::learn::result::LearningDocument;
use mechanics::chart::{LearningPicture, LearningSeries};

/// An SVG of the learning curves.
pub fn learning_chart(found: &LearningDocument, cases: usize) -> String {
    let level = |name: &str| {
        let column = found.table.iter().find(|column| column.name == name)?;
        Some((column.name.clone(), column.mean))
    };
    let levels: Vec<(String, f64)> = ["what happened", "no movement", "linear", "nonlinear"]
        .into_iter()
        .filter_map(level)
        .collect();
    let series: Vec<LearningSeries> = found
        .curve
        .iter()
        .map(|curve| LearningSeries {
            name: curve.method.clone(),
            points: curve.points.iter().map(|own| (own.cases as f64, own.error_mm)).collect(),
        })
        .collect();
    let title = format!("Mean error of {cases} cases by the number of cases learned from");
    LearningPicture { title: &title, levels: &levels, series: &series }.to_svg()
}
