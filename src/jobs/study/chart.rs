//! Charts of a report: one for each scene, and one over all.

use crate::schema::study::report::{ReportDocument, RowDocument, RowStatus};
use mechanics::chart::drawing::Document;
use mechanics::chart::svg::svg;
use mechanics::chart::{LadderFailure, LadderMark, LadderPicture};
use mechanics::study::pareto;

/// The longest reason that a chart tells; the report has it in full.
const REASON: usize = 110;

/// The chart of one scene, or of all where none is named, as SVG.
pub fn chart(report: &ReportDocument, scene: Option<&str>) -> String {
    svg(&chart_drawing(report, scene), &title(report, scene))
}

/// The same as a drawing.
pub fn chart_drawing(report: &ReportDocument, scene: Option<&str>) -> Document {
    let rows: Vec<&RowDocument> =
        report.rows.iter().filter(|row| scene.is_none_or(|scene| row.scene == scene)).collect();
    let mut series: Vec<String> = Vec::new();
    for row in &rows {
        if !series.contains(&row.label) {
            series.push(row.label.clone());
        }
    }
    let (mut marks, mut failures) = (Vec::new(), Vec::new());
    for (place, label) in series.iter().enumerate() {
        for level in levels(&rows, label) {
            let of = |row: &&RowDocument| row.label == *label && row.level == level;
            let own: Vec<&RowDocument> = rows.iter().copied().filter(of).collect();
            marks.extend(mark(&own, place, level));
            failures.extend(failed(&own, place, level));
        }
    }
    let points: Vec<[f64; 2]> = marks.iter().map(|mark| [mark.wall_s, mark.error_mm]).collect();
    for place in pareto::front(&points) {
        marks[place].on_front = true;
    }
    let picture = LadderPicture {
        title: &title(report, scene),
        subtitle: &subtitle(report, &rows, scene),
        series: &series,
        marks: &marks,
        failures: &failures,
        notes: &notes(report, scene),
    };
    picture.to_drawing()
}

fn levels(rows: &[&RowDocument], label: &str) -> Vec<u32> {
    let mut levels: Vec<u32> =
        rows.iter().filter(|row| row.label == label).map(|row| row.level).collect();
    levels.sort_unstable();
    levels.dedup();
    levels
}

/// The medians over the rows that have numbers.
fn mark(rows: &[&RowDocument], series: usize, level: u32) -> Option<LadderMark> {
    let numbers = rows.iter().filter_map(|row| row.numbers.as_ref());
    let runs: Vec<[f64; 2]> = numbers.map(|numbers| [numbers.wall_s, numbers.p95_mm]).collect();
    let median = |side: usize| {
        let mut values: Vec<f64> = runs.iter().map(|run| run[side]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len().saturating_sub(1) / 2).copied()
    };
    let (wall_s, error_mm) = (median(0)?, median(1)?);
    Some(LadderMark { series, level, wall_s, error_mm, on_front: false, runs })
}

/// The reasons of rows without numbers, each once.
fn failed(rows: &[&RowDocument], series: usize, level: u32) -> Vec<LadderFailure> {
    let mut found: Vec<(&str, &str, usize)> = Vec::new();
    for row in rows.iter().filter(|row| row.status != RowStatus::Solved) {
        let Some(error) = &row.error else { continue };
        match found.iter_mut().find(|(kind, ..)| *kind == error.kind) {
            Some((.., count)) => *count += 1,
            None => found.push((&error.kind, &error.detail, 1)),
        }
    }
    let failure = |(kind, detail, count): (&str, &str, usize)| {
        let of = if rows.len() > 1 {
            format!(" ({count} of {} rows)", rows.len())
        } else {
            String::new()
        };
        let words: String = detail.chars().take(REASON).collect();
        LadderFailure { series, level, reason: format!("{kind}{of}: {words}") }
    };
    found.into_iter().map(failure).collect()
}

fn title(report: &ReportDocument, scene: Option<&str>) -> String {
    match (scene, report.scenes.as_slice()) {
        (Some(name), _) => format!("Speed and accuracy: {name}"),
        (None, [only]) => format!("Speed and accuracy: {}", only.name),
        (None, scenes) => format!("Speed and accuracy over {} scenes", scenes.len()),
    }
}

fn subtitle(report: &ReportDocument, rows: &[&RowDocument], scene: Option<&str>) -> String {
    let distinct = |of: fn(&RowDocument) -> &str| {
        let mut names: Vec<&str> = rows.iter().map(|row| of(row)).collect();
        names.sort_unstable();
        names.dedup();
        names
    };
    let plans = counted(&distinct(|row| &row.plan), "plan");
    let materials = counted(&distinct(|row| &row.material), "material");
    let wanted = scene.or(match report.scenes.as_slice() {
        [only] => Some(only.name.as_str()),
        _ => None,
    });
    let about = report.scenes.iter().find(|about| Some(about.name.as_str()) == wanted);
    match about {
        Some(about) => format!(
            "{plans}, {materials}; {} nodes and {} cells at level 0, skin of {} nodes",
            about.nodes, about.cells, about.skin_nodes
        ),
        None => {
            let names: Vec<&str> = report.scenes.iter().map(|scene| scene.name.as_str()).collect();
            format!("{}; {plans}, {materials}", names.join(", "))
        }
    }
}

/// The only name, or how many there are.
fn counted(names: &[&str], what: &str) -> String {
    match names {
        [only] => format!("{what} {only}"),
        names => format!("{} {what}s", names.len()),
    }
}

fn notes(report: &ReportDocument, scene: Option<&str>) -> Vec<String> {
    let mut notes = vec![
        "Error: how far a skin node is from where the truth has it; 95 % of the skin's area lie below the value drawn. \
         Time: median of the repeats of a row, mesh in memory to displacement in memory, one thread. A mark is the \
         median over plans, materials and scenes; small dots are the single rows."
            .to_owned(),
    ];
    let wanted = report.scenes.iter().filter(|about| scene.is_none_or(|scene| about.name == scene));
    for about in wanted {
        let error = about.truth_error_mm.map_or_else(String::new, |error| {
            format!("; itself off by {:.4} mm (mean) and {:.4} mm (p95)", error.mean, error.p95)
        });
        notes.push(format!("Truth of {}: {}{error}.", about.name, about.truth));
    }
    let left_out = report.skipped.iter();
    for skipped in left_out.filter(|skipped| scene.is_none_or(|scene| skipped.scene == scene)) {
        notes.push(format!(
            "{} does not apply to {}: {}.",
            skipped.label, skipped.scene, skipped.reason
        ));
    }
    let engine = &report.engine;
    notes.push(format!(
        "{} {} ({}, {}), {}. Not a medical device.",
        engine.name, engine.version, engine.profile, engine.target, report.created
    ));
    notes
}
