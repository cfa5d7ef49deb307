//! Common tables of all reports: provenance, and numbers as words.

use mechanics::mesh::Frame;

use super::content::{Block, Report, Section, Table};
use super::room::fitted;
use super::words::{Words, words};
use crate::schema::Language;
use crate::schema::predict::result::{ProvenanceDocument, ResultDocument};

/// Lengths in mm: two decimals, three below 0.1.
pub fn mm(value: f64) -> String {
    // No minus before nothing.
    let value = if value.abs() < 5e-4 { 0.0 } else { value };
    if value.abs() < 0.095 && value != 0.0 { format!("{value:.3}") } else { format!("{value:.2}") }
}

pub fn number_or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), mm)
}

/// With its sign.
pub fn signed(value: f64) -> String {
    let text = mm(value);
    if value >= 5e-4 { format!("+{text}") } else { text }
}

/// Versions, hashes, the plan and its date.
pub fn provenance(result: &ResultDocument, words: &Words) -> Section {
    let ProvenanceDocument { spec_hash, inputs, plan, plan_id, created, .. } = &result.provenance;
    let mut facts = vec![[words.program.to_owned(), engine_words(result)]];
    facts.extend(result.job.iter().map(|job| [words.job.to_owned(), job.clone()]));
    if plan.is_some() {
        let id = plan_id.clone().unwrap_or_else(|| words.not_stored.to_owned());
        facts.push([words.plan_id.to_owned(), id]);
    }
    let frame = Frame::from(result.provenance.frame);
    facts.push([words.frame.to_owned(), frame.name().to_owned()]);
    facts.push([words.made.to_owned(), created.clone()]);
    facts.push([words.hash.to_owned(), spec_hash.clone()]);
    let least = facts.len();
    for input in inputs {
        facts.push([format!("{} {}", words.input, input.role), input.sha256.clone()]);
    }
    let rows = facts.into_iter().map(Vec::from).collect();
    Section::new(words.provenance, vec![Block::Table(Table { columns: Vec::new(), rows, least })])
}

fn engine_words(result: &ResultDocument) -> String {
    let engine = &result.provenance.engine;
    format!(
        "{} {}, numerics {}, {}, {}",
        engine.name, engine.version, engine.numerics, engine.target, engine.profile
    )
}

/// A report of a result, with the disclaimer and lines for the reader's signature.
pub fn report(
    language: Language,
    title: &str,
    subtitle: String,
    mut sections: Vec<Section>,
) -> Report {
    let words = words(language);
    let (title, notice) = (title.to_owned(), words.notice.to_owned());
    sections.push(Section::new(words.read, vec![Block::Signature(texts(words.signature))]));
    Report { language, title, subtitle, notice, sections: fitted(sections, words) }
}

pub fn texts<const N: usize>(words: [&str; N]) -> Vec<String> {
    words.map(str::to_owned).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_has_no_sign_and_little_has_its_digits() {
        assert_eq!([0.0, -1e-9, 0.0123, -2.5].map(signed), ["0.00", "0.00", "+0.012", "-2.50"]);
    }
}
