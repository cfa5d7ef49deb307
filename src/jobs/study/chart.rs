//! Charts of a report: speed and accuracy of each scene and over all, and estimated against true errors.

use super::words::{in_words, scene_in_words, variant_in_words};
use crate::schema::study::report::{ReportDocument, RowDocument, RowStatus};
use mechanics::chart::drawing::Document;
use mechanics::chart::svg::svg;
use mechanics::chart::{
    EstimateMark, EstimatesPicture, LadderFailure, LadderMark, LadderPicture, MethodSeries,
};
use mechanics::study::{LINEAR_TRUTH, TRUTH_WITHOUT_CONTACT, WITHIN_TRUTH_ERROR, pareto};

/// Warnings on rows whose true error differs from the drawn one.
pub const MARKED: [(&str, &str); 3] = [
    (
        LINEAR_TRUTH,
        "results of finite strain are compared with a linear truth: its linearisation error counts as their error.",
    ),
    (
        TRUTH_WITHOUT_CONTACT,
        "results with contact are compared with a truth without: the effect of contact counts as their error, not comparable \
         with that of the other rows.",
    ),
    (WITHIN_TRUTH_ERROR, "errors below that of the truth: these are small, but not known exactly."),
];

/// The chart of one scene, or of all if none is named, as SVG.
pub fn chart(report: &ReportDocument, scene: Option<&str>) -> String {
    svg(&chart_drawing(report, scene), &title(report, scene))
}

/// The same as a drawing.
pub fn chart_drawing(report: &ReportDocument, scene: Option<&str>) -> Document {
    let rows: Vec<&RowDocument> =
        report.rows.iter().filter(|row| scene.is_none_or(|scene| row.scene == scene)).collect();
    let series = series(report);
    let (mut marks, mut failures) = (Vec::new(), Vec::new());
    for (place, MethodSeries { label, .. }) in series.iter().enumerate() {
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
        notes: &notes(report, &rows, scene),
    };
    picture.to_drawing()
}

/// Estimated against true errors of all rows with both, as SVG; none without such rows.
pub fn estimates_chart(report: &ReportDocument) -> Option<String> {
    let known = |row: &&RowDocument| row.numbers.as_ref().is_some_and(|n| n.effectivity.is_some());
    let rows: Vec<&RowDocument> = report.rows.iter().filter(known).collect();
    let methods = series(report);
    let mark = |row: &&RowDocument| {
        let numbers = row.numbers.as_ref()?;
        let series = methods.iter().position(|own| own.label == row.label)?;
        let (level, true_mm) = (row.level, numbers.mean_mm);
        let estimated_mm = numbers.effectivity? * true_mm;
        Some(EstimateMark { series, level, true_mm, estimated_mm })
    };
    let marks: Vec<EstimateMark> = rows.iter().filter_map(mark).collect();
    let within =
        marks.iter().filter(|mark| (0.5..=2.0).contains(&(mark.estimated_mm / mark.true_mm)));
    let title = "Estimated against true error";
    let picture = EstimatesPicture {
        title,
        subtitle: &format!(
            "{} of {} results are within a factor of two of the truth",
            within.count(),
            marks.len()
        ),
        series: &methods,
        marks: &marks,
        notes: &[
            "Estimated without the truth: the discretisation error, and that of linearity if the truth is one of finite \
             strain. A mark is a row: a plan, a material and a mesh. Methods chosen by error estimate it over the skin that \
             moves, and are drawn by the ratio to the true error there."
                .to_owned(),
            engine_words(report),
        ],
    };
    (!marks.is_empty()).then(|| svg(&picture.to_drawing(), title))
}

/// The models of a report in the order of its rows, each once: each has the same symbol in all charts of it, whichever
/// of them these show.
fn series(report: &ReportDocument) -> Vec<MethodSeries> {
    let mut series: Vec<MethodSeries> = Vec::new();
    for row in &report.rows {
        if !series.iter().any(|known| known.label == row.label) {
            let (label, method) = (row.label.clone(), row.method.clone());
            let is_apart = |other: &RowDocument| {
                other.label == label
                    && other.warnings.iter().any(|own| own == TRUTH_WITHOUT_CONTACT)
            };
            let apart = if report.rows.iter().any(is_apart) { " (not comparable)" } else { "" };
            let name = variant_in_words(&label) + apart;
            series.push(MethodSeries { name, label, method });
        }
    }
    series
}

fn levels(rows: &[&RowDocument], label: &str) -> Vec<u32> {
    let mut levels: Vec<u32> =
        rows.iter().filter(|row| row.label == label).map(|row| row.level).collect();
    levels.sort_unstable();
    levels.dedup();
    levels
}

/// The medians over the rows with numbers.
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
        LadderFailure { series, level, reason: format!("{kind}{of}: {}", in_words(detail)) }
    };
    found.into_iter().map(failure).collect()
}

fn title(report: &ReportDocument, scene: Option<&str>) -> String {
    match (scene, report.scenes.as_slice()) {
        (Some(name), _) => format!("Speed and accuracy: {}", scene_in_words(name)),
        (None, [only]) => format!("Speed and accuracy: {}", scene_in_words(&only.name)),
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
            let names: Vec<String> =
                report.scenes.iter().map(|scene| scene_in_words(&scene.name)).collect();
            format!("{}; {plans}, {materials}", names.join(", "))
        }
    }
}

/// The only name, or how many there are. Plans without a name are called `plan 1` and so on.
fn counted(names: &[&str], what: &str) -> String {
    match names {
        [only] if only.starts_with(&format!("{what} ")) => (*only).to_owned(),
        [only] => format!("{what} {}", in_words(only)),
        names => format!("{} {what}s", names.len()),
    }
}

fn notes(report: &ReportDocument, rows: &[&RowDocument], scene: Option<&str>) -> Vec<String> {
    let mut notes = vec![
        "Error: distance of a skin node from its true position; 95 % of the skin's area are below the value drawn. \
         Time: median of the repeats of a row, mesh in memory to displacement in memory, one thread. A mark is the \
         median over plans, materials and scenes; small dots are the single rows."
            .to_owned(),
    ];
    let wanted = report.scenes.iter().filter(|about| scene.is_none_or(|scene| about.name == scene));
    for about in wanted {
        let error = about.truth_error_mm.map_or_else(String::new, |error| {
            format!("; itself off by {:.4} mm (mean) and {:.4} mm (p95)", error.mean, error.p95)
        });
        let (name, truth) = (scene_in_words(&about.name), in_words(&about.truth));
        notes.push(format!("Truth of the {name}: {truth}{error}."));
    }
    let marked = MARKED.iter().filter_map(|(code, words)| {
        let is_told = |row: &&&RowDocument| row.warnings.iter().any(|own| own == code);
        let count = rows.iter().filter(is_told).count();
        (count > 0).then(|| format!("{count} of {} rows ({code}): {words}", rows.len()))
    });
    notes.extend(marked);
    let left_out = report.skipped.iter();
    for skipped in left_out.filter(|skipped| scene.is_none_or(|scene| skipped.scene == scene)) {
        notes.push(format!(
            "{} has no row on {}: {}.",
            variant_in_words(&skipped.label),
            scene_in_words(&skipped.scene),
            in_words(&skipped.reason)
        ));
    }
    notes.push(engine_words(report));
    notes
}

fn engine_words(report: &ReportDocument) -> String {
    let engine = &report.engine;
    format!(
        "{} {} ({}), {}. Not a medical device.",
        engine.name, engine.version, engine.profile, report.created
    )
}
