//! Charts of distance over swept constants.

use super::words::{in_words, scene_in_words, variant_in_words};
use crate::jobs::failure::JobError;
use crate::schema::study::constants::{
    ConstantCellDocument, ConstantMapDocument, SweptAxisDocument,
};
use crate::schema::study::report::ReportDocument;
use mechanics::chart::{ContourAxis, ContourPicture};

/// The chart of one map as SVG: a curve over one constant, contours over two; of more those with the best values of all
/// but the first two that vary.
pub fn constants_chart(
    report: &ReportDocument,
    map: &ConstantMapDocument,
) -> Result<String, JobError> {
    let mut axes: Vec<usize> =
        (0..map.axes.len()).filter(|&at| map.axes[at].values.len() > 1).collect();
    if axes.is_empty() {
        axes.push(0);
    }
    let shown = &axes[..axes.len().min(2)];
    let drawn: Vec<ContourAxis> = shown.iter().map(|&at| drawn(&map.axes[at])).collect();
    let rest = (0..map.axes.len()).filter(|at| !shown.contains(at));
    let held: Vec<usize> = rest.collect();
    let is_shown = |cell: &&ConstantCellDocument| {
        held.iter().all(|&at| cell.values[at] == map.best.values[at])
    };
    let cells: Vec<&ConstantCellDocument> = map.cells.iter().filter(is_shown).collect();
    let across = &drawn[0];
    let above = drawn.get(1).map_or(&[0.0][..], |axis| &axis.values);
    let value =
        |cell: &ConstantCellDocument, k: usize| shown.get(k).map_or(0.0, |&at| cell.values[at]);
    let mut places = Vec::new();
    for &x in &across.values {
        places.extend(above.iter().map(|&y| [x, y]));
    }
    let is_at =
        |cell: &ConstantCellDocument, place: &[f64; 2]| [value(cell, 0), value(cell, 1)] == *place;
    let distances: Vec<Option<f64>> = places
        .iter()
        .map(|place| cells.iter().find(|cell| is_at(cell, place)).map(|cell| cell.mean_mm))
        .collect();
    let best = places.iter().position(|place| is_at(&map.best, place)).unwrap_or_default();
    let picture = ContourPicture {
        title: &format!("Distance from the scan: {}", scene_in_words(&map.scene)),
        subtitle: &format!(
            "{}, {}, level {}",
            in_words(&map.plan),
            variant_in_words(&map.label),
            map.level
        ),
        across,
        upwards: drawn.get(1),
        distances: &distances,
        best,
        noise: map.noise_mm,
        notes: &notes(report, map, &held),
    };
    Ok(picture.to_svg()?)
}

/// Values ascending, in any order of the sweep.
fn drawn(axis: &SweptAxisDocument) -> ContourAxis {
    let mut values = axis.values.clone();
    values.sort_by(f64::total_cmp);
    ContourAxis { name: in_words(&axis.words()), values }
}

fn notes(report: &ReportDocument, map: &ConstantMapDocument, held: &[usize]) -> Vec<String> {
    let best: Vec<String> = map
        .axes
        .iter()
        .zip(&map.best.values)
        .map(|(axis, value)| format!("{} {value}", axis.words()))
        .collect();
    let mut notes =
        vec![in_words(&format!("Least: {:.4} mm at {}.", map.best.mean_mm, best.join("; ")))];
    if !held.is_empty() {
        let names: Vec<String> = held.iter().map(|&at| map.axes[at].words()).collect();
        notes.push(in_words(&format!("Held at the best value: {}.", names.join("; "))));
    }
    let scene = report.scenes.iter().find(|scene| scene.name == map.scene);
    if let Some(unmoved) = scene.and_then(|scene| scene.unmoved_mm) {
        notes.push(format!("The skin at rest is {unmoved:.4} mm from the scan, measured alike."));
    }
    notes.push(match map.noise_mm {
        Some(noise) => format!(
            "Registration error {noise:.4} mm (root mean square): values within that of the least are equally good."
        ),
        None => "The registration error is not known.".to_owned(),
    });
    notes.extend(
        map.warnings
            .iter()
            .map(|warning| in_words(&format!("{}: {}.", warning.code, warning.detail))),
    );
    notes.push(
        "Mean distance between scan and predicted skin, both ways, where the skin moves."
            .to_owned(),
    );
    notes
}
