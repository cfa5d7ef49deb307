//! The report of a study: its outcome, its chart and its rows.

use mechanics::chart::drawing::Document;

use super::content::{Block, Figure, Report, Section, Table};
use super::tables::{mm, provenance, report, shortened, texts, warnings};
use super::words::{Words, filled, words};
use crate::schema::Language;
use crate::schema::predict::result::ResultDocument;
use crate::schema::study::report::{ReportDocument, RowDocument};

/// What there is room for beside chart, outcome and provenance.
const MOST_ROWS: usize = 36;
const MOST_REASONS: usize = 6;

/// A study, the chart over all of its scenes, and the manifest of its job.
pub struct StudyFacts<'a> {
    pub report: &'a ReportDocument,
    pub chart: Document,
    pub result: &'a ResultDocument,
}

pub fn study_report(facts: StudyFacts, language: Language) -> Report {
    let own = words(language);
    let StudyFacts { report: study, chart, result } = facts;
    let figure = Figure { drawing: chart, title: own.chart.to_owned(), caption: String::new() };
    let mut rows = rows(study, own);
    rows.on_new_page = true;
    let sections = vec![
        outcome(study, own),
        Section::new(own.chart, vec![Block::Figure(figure)]),
        rows,
        warnings(&result.warnings, own),
        provenance(result, own),
    ];
    let scenes: Vec<&str> = study.scenes.iter().map(|scene| scene.name.as_str()).collect();
    let subtitle = format!("{} · {}", scenes.join(", "), study.created);
    report(language, own.study, subtitle, sections)
}

fn outcome(study: &ReportDocument, words: &Words) -> Section {
    let verdict = &study.verdict;
    let counts = format!(
        "{}: {} / {} solved, {} failed, {} worse, {} not run",
        verdict.outcome.name(),
        verdict.solved,
        verdict.rows,
        verdict.failed,
        verdict.worse,
        verdict.not_run
    );
    let mut blocks = vec![Block::Paragraph(counts)];
    if !verdict.reasons.is_empty() {
        let mut reasons: Vec<String> = verdict.reasons.iter().take(MOST_REASONS).cloned().collect();
        if verdict.reasons.len() > MOST_REASONS {
            let left = verdict.reasons.len() - MOST_REASONS;
            reasons.push(filled(words.more, &[left.to_string()]));
        }
        blocks.push(Block::List(reasons));
    }
    Section::new(words.outcome, blocks)
}

fn rows(study: &ReportDocument, words: &Words) -> Section {
    let rows = study.rows.iter().map(row).collect();
    let table =
        Table { columns: texts(words.row_columns), rows: shortened(rows, MOST_ROWS, words) };
    Section::new(words.rows, vec![Block::Table(table)])
}

fn row(row: &RowDocument) -> Vec<String> {
    let numbers = row.numbers.as_ref().map_or_else(
        || ["–".to_owned(), row.status.name().to_owned(), "–".to_owned()],
        |own| [format!("{:.3}", own.wall_s), mm(own.mean_mm), mm(own.p95_mm)],
    );
    let names = [&row.label, &row.scene, &row.plan].map(String::clone);
    [names.to_vec(), vec![row.level.to_string()], numbers.to_vec()].concat()
}
