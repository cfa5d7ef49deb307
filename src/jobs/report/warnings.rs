//! Warnings in a report: the most serious first, and each kind once, so that many of one hide no other.

use super::content::{Block, Section};
use super::words::{Words, filled};
use crate::jobs::result::warnings::rank;
use crate::schema::WarningDocument;

/// Warnings of one code.
struct Kind<'a> {
    code: &'a str,
    all: Vec<&'a WarningDocument>,
}

impl Kind<'_> {
    /// The worst of them, and their number.
    fn told(&self, words: &Words) -> Option<String> {
        // Of several as bad the first.
        let worst = self
            .all
            .iter()
            .rev()
            .max_by(|one, other| severity_mm(one).total_cmp(&severity_mm(other)))?;
        let code = match self.all.len() {
            1 => self.code.to_owned(),
            count => filled(words.times, &[self.code.to_owned(), count.to_string()]),
        };
        Some(format!("{} ({code})", worst.detail))
    }
}

/// The first length among the numbers of a warning, in mm: distances, depths and errors, the larger the worse.
fn severity_mm(warning: &WarningDocument) -> f64 {
    let lengths = warning.numbers.iter().filter(|(name, _)| name.ends_with("_mm"));
    lengths.filter_map(|(_, value)| value.as_f64()).next().map_or(0.0, f64::abs)
}

/// A line for each kind of warning.
pub fn warnings(list: &[WarningDocument], words: &Words) -> Section {
    if list.is_empty() {
        let none = Block::Paragraph(words.no_warnings.to_owned());
        return Section::new(words.warnings, vec![none]);
    }
    let mut kinds: Vec<Kind> = Vec::new();
    for warning in list {
        match kinds.iter_mut().find(|kind| kind.code == warning.code) {
            Some(kind) => kind.all.push(warning),
            None => kinds.push(Kind { code: &warning.code, all: vec![warning] }),
        }
    }
    kinds.sort_by_key(|kind| rank(kind.code));
    let told = kinds.iter().filter_map(|kind| kind.told(words)).collect();
    Section::new(words.warnings, vec![Block::List(told)])
}

#[cfg(test)]
mod tests {
    use super::super::words::words;
    use super::*;
    use crate::schema::Language;
    use serde_json::json;

    fn warning(code: &str, length_mm: f64) -> WarningDocument {
        let detail = format!("{code} by {length_mm} mm");
        let numbers = json!({"distance_mm": length_mm}).as_object().unwrap().clone();
        WarningDocument { code: code.to_owned(), detail, numbers }
    }

    #[test]
    fn many_warnings_of_one_kind_hide_no_graver_one() {
        let mut list: Vec<WarningDocument> =
            (0..56).map(|n| warning("landmark-far", f64::from(n % 40))).collect();
        list.push(warning("skin-held", 1.0));
        list.push(warning("numerical-error-large", 0.3));
        let told = |language| {
            let section = warnings(&list, words(language));
            let [Block::List(entries)] = &section.blocks[..] else { panic!("one list") };
            entries.clone()
        };
        assert_eq!(
            told(Language::En),
            [
                "numerical-error-large by 0.3 mm (numerical-error-large)",
                "landmark-far by 39 mm (landmark-far, 56 times, the worst here)",
                "skin-held by 1 mm (skin-held)",
            ]
        );
        assert!(told(Language::De)[1].ends_with("(landmark-far, 56-mal, hier das schlimmste)"));
    }
}
