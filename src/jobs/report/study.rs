//! The report of a study: its outcome, its chart and its rows.

use mechanics::chart::drawing::Document;

use super::content::{Block, Figure, Report, Section, Table};
use super::tables::{mm, provenance, report, texts};
use super::warnings::warnings;
use super::words::{Words, filled, words};
use crate::schema::Language;
use crate::schema::predict::result::ResultDocument;
use crate::schema::study::report::{OutcomeName, ReportDocument, RowDocument, RowStatus};

/// A study, the chart over all its scenes, and the manifest of its job.
pub struct StudyFacts<'a> {
    pub report: &'a ReportDocument,
    pub chart: Document,
    pub result: &'a ResultDocument,
}

pub fn study_report(facts: StudyFacts, language: Language) -> Report {
    let own = words(language);
    let StudyFacts { report: study, chart, result } = facts;
    let figure = Figure::new(chart, own.chart, String::new());
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
    let [pass, worse, incomplete, no_baseline] = words.outcomes;
    let told = match verdict.outcome {
        OutcomeName::Pass => pass,
        OutcomeName::Worse => worse,
        OutcomeName::Incomplete => incomplete,
        OutcomeName::NoBaseline => no_baseline,
    };
    let numbers = [verdict.solved, verdict.rows, verdict.failed, verdict.worse, verdict.not_run];
    let counts = filled(words.counts, &numbers.map(|number| number.to_string()));
    let mut blocks = vec![Block::Paragraph(format!("{told}: {counts}"))];
    if !verdict.reasons.is_empty() {
        blocks.push(Block::List(verdict.reasons.clone()));
    }
    if !verdict.failing.is_empty() {
        blocks.push(Block::List(verdict.failing.iter().map(|row| row.sentence()).collect()));
    }
    Section::new(words.outcome, blocks)
}

fn rows(study: &ReportDocument, words: &Words) -> Section {
    let rows = study.rows.iter().map(|own| row(own, words)).collect();
    Section::new(words.rows, vec![Block::Table(Table::new(texts(words.row_columns), rows))])
}

fn row(row: &RowDocument, words: &Words) -> Vec<String> {
    let [solved, failed, not_run] = words.states;
    let state = match row.status {
        RowStatus::Solved => solved,
        RowStatus::Failed => failed,
        RowStatus::NotRun => not_run,
    };
    let numbers = row.numbers.as_ref().map_or_else(
        || ["–".to_owned(), state.to_owned(), "–".to_owned()],
        |own| [format!("{:.3}", own.wall_s), mm(own.mean_mm), mm(own.p95_mm)],
    );
    let names = [&row.label, &row.scene, &row.plan].map(String::clone);
    [names.to_vec(), vec![row.level.to_string()], numbers.to_vec()].concat()
}
