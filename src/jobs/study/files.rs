//! A report as a table and as the test results that CI systems read.

use std::fmt::Write;

use crate::schema::study::report::{
    OutcomeName, ReportDocument, RowDocument, RowVerdict, SkippedDocument,
};
use mechanics::format::csv::cell;

pub const REPORT_JSON: &str = "report.json";
pub const REPORT_CSV: &str = "report.csv";
pub const REPORT_JUNIT: &str = "report.junit.xml";
pub const CHART_SVG: &str = "chart.svg";
pub const ESTIMATES_SVG: &str = "estimates.svg";

pub const JSON_MEDIA_TYPE: &str = "application/json";
pub const CSV_MEDIA_TYPE: &str = "text/csv; charset=utf-8";
pub const JUNIT_MEDIA_TYPE: &str = "application/xml";
pub const SVG_MEDIA_TYPE: &str = "image/svg+xml";

/// The columns of `report.csv`; further ones are added at the end. Estimated errors are means over the skin.
pub const COLUMNS: [&str; 28] = [
    "scene",
    "plan",
    "method",
    "label",
    "element",
    "material",
    "level",
    "unknowns",
    "wall_s",
    "peak_mb",
    "mean_mm",
    "p95_mm",
    "max_mm",
    "status",
    "error",
    "iterations",
    "repeats",
    "closest_point_p95_mm",
    "skin_mean_mm",
    "smallest_det_f",
    "warnings",
    "on_front",
    "verdict",
    "reasons",
    "numerical_error_mm",
    "linearity_error_mm",
    "effectivity",
    "chosen",
];

/// The rows as comma-separated values (RFC 4180), numbers in full.
pub fn csv(report: &ReportDocument) -> String {
    let mut text = COLUMNS.join(",");
    text.push_str("\r\n");
    for row in &report.rows {
        text.push_str(&csv_cells(row).join(","));
        text.push_str("\r\n");
    }
    text
}

fn csv_cells(row: &RowDocument) -> [String; COLUMNS.len()] {
    let numbers = row.numbers.as_ref();
    let number = |of: fn(&crate::schema::study::report::NumbersDocument) -> Option<f64>| {
        numbers.and_then(of).map_or_else(String::new, |value| value.to_string())
    };
    let error = row.error.as_ref();
    [
        cell(&row.scene),
        cell(&row.plan),
        cell(&row.method),
        cell(&row.label),
        cell(&row.element),
        cell(&row.material),
        row.level.to_string(),
        number(|n| Some(n.unknowns as f64)),
        number(|n| Some(n.wall_s)),
        number(|n| n.peak_mb),
        number(|n| Some(n.mean_mm)),
        number(|n| Some(n.p95_mm)),
        number(|n| Some(n.max_mm)),
        row.status.name().to_owned(),
        error.map_or_else(String::new, |error| cell(&format!("{}: {}", error.kind, error.detail))),
        number(|n| Some(n.iterations as f64)),
        number(|n| Some(n.repeats as f64)),
        number(|n| Some(n.closest_point_mm.p95)),
        number(|n| Some(n.skin_mean_mm)),
        number(|n| n.smallest_det_f),
        cell(&row.warnings.join("; ")),
        row.on_front.to_string(),
        row.verdict.name().to_owned(),
        cell(&row.reasons.join("; ")),
        number(|n| Some(n.numerical_error_mm?.mean)),
        number(|n| Some(n.linearity_error_mm?.mean)),
        number(|n| n.effectivity),
        numbers.and_then(|n| n.chosen.as_deref()).map_or_else(String::new, cell),
    ]
}

/// The rows as test cases, a suite for each scene. There is a failure or an error exactly if the outcome is not
/// `pass`.
pub fn junit(report: &ReportDocument) -> String {
    let mut suites = Counts::default();
    let mut body = String::new();
    for scene in scenes(report) {
        let mut counts = Counts::default();
        let mut cases = String::new();
        for row in report.rows.iter().filter(|row| row.scene == scene) {
            counts.add(row);
            test_case(&mut cases, row);
        }
        for skipped in report.skipped.iter().filter(|skipped| skipped.scene == scene) {
            counts.tests += 1;
            counts.skipped += 1;
            skipped_case(&mut cases, skipped);
        }
        suite(&mut body, scene, &counts, &cases);
        suites.join(&counts);
    }
    let verdict = &report.verdict;
    let mut counts = Counts { tests: 1, ..Counts::default() };
    let mut case = String::from("    <testcase classname=\"study\" name=\"outcome\" time=\"0\">");
    if verdict.outcome != OutcomeName::Pass {
        let (name, reasons) = (verdict.outcome.name(), verdict.reasons.join("; "));
        let what = if verdict.outcome == OutcomeName::Worse { "failure" } else { "error" };
        counts.failures = u64::from(what == "failure");
        counts.errors = u64::from(what == "error");
        problem(&mut case, what, name, &reasons);
    }
    case.push_str("</testcase>\n");
    suite(&mut body, "outcome", &counts, &case);
    suites.join(&counts);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"facies study\" {suites}>\n{body}</testsuites>\n"
    )
}

/// Scenes in the order of their rows, then those with all variants skipped.
fn scenes(report: &ReportDocument) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    let skipped = report.skipped.iter().map(|skipped| skipped.scene.as_str());
    for name in report.rows.iter().map(|row| row.scene.as_str()).chain(skipped) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

#[derive(Default)]
struct Counts {
    tests: u64,
    failures: u64,
    errors: u64,
    skipped: u64,
    time_s: f64,
}

impl Counts {
    fn add(&mut self, row: &RowDocument) {
        self.tests += 1;
        match row.verdict {
            RowVerdict::Pass => {}
            RowVerdict::Worse => self.failures += 1,
            RowVerdict::Failed | RowVerdict::NotRun => self.errors += 1,
            RowVerdict::KnownFailure => self.skipped += 1,
        }
        self.time_s += row.numbers.as_ref().map_or(0.0, |numbers| numbers.wall_s);
    }

    fn join(&mut self, other: &Counts) {
        self.tests += other.tests;
        self.failures += other.failures;
        self.errors += other.errors;
        self.skipped += other.skipped;
        self.time_s += other.time_s;
    }
}

impl std::fmt::Display for Counts {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Counts { tests, failures, errors, skipped, time_s } = self;
        write!(
            formatter,
            "tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\" skipped=\"{skipped}\" time=\"{time_s:.6}\""
        )
    }
}

fn suite(body: &mut String, name: &str, counts: &Counts, cases: &str) {
    let name = escaped(name);
    *body += &format!("  <testsuite name=\"{name}\" {counts}>\n{cases}  </testsuite>\n");
}

fn test_case(cases: &mut String, row: &RowDocument) {
    let class = escaped(&format!("study.{}.{}", row.scene, row.plan));
    let name = escaped(&format!("{}, {}, level {}", row.label, row.material, row.level));
    let time = row.numbers.as_ref().map_or(0.0, |numbers| numbers.wall_s);
    *cases += &format!("    <testcase classname=\"{class}\" name=\"{name}\" time=\"{time:.6}\">");
    let reasons = row.reasons.join("; ");
    let kind = row.error.as_ref().map_or(row.verdict.name(), |error| error.kind.as_str());
    match row.verdict {
        RowVerdict::Pass => {}
        RowVerdict::Worse => problem(cases, "failure", "worse", &reasons),
        RowVerdict::Failed | RowVerdict::NotRun => problem(cases, "error", kind, &reasons),
        RowVerdict::KnownFailure => {
            *cases += &format!("<skipped message=\"{}\"/>", escaped(&reasons));
        }
    }
    if let Some(numbers) = &row.numbers {
        let _ = write!(
            cases,
            "<system-out>mean {:.4} mm, p95 {:.4} mm, max {:.4} mm, {:.4} s, {} unknowns</system-out>",
            numbers.mean_mm, numbers.p95_mm, numbers.max_mm, numbers.wall_s, numbers.unknowns
        );
    }
    cases.push_str("</testcase>\n");
}

/// A variant that does not support a scene.
fn skipped_case(cases: &mut String, skipped: &SkippedDocument) {
    let class = escaped(&format!("study.{}", skipped.scene));
    let (name, reason) = (escaped(&skipped.label), escaped(&skipped.reason));
    *cases += &format!(
        "    <testcase classname=\"{class}\" name=\"{name}\" time=\"0\"><skipped message=\"{reason}\"/></testcase>\n"
    );
}

fn problem(cases: &mut String, what: &str, kind: &str, words: &str) {
    let (kind, words) = (escaped(kind), escaped(words));
    *cases += &format!("<{what} type=\"{kind}\" message=\"{words}\">{words}</{what}>");
}

/// Text for XML: markup escaped, and characters that XML 1.0 does not allow replaced.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            letter if letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}') => {
                out.push('\u{fffd}');
            }
            letter => out.push(letter),
        }
    }
    out
}
