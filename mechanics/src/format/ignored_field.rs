//! Field that lists the arrays a reader ignored, written beside a mesh: the stored file lacks these arrays, and a
//! request for one of them still gets the reason.
//!
//! One line for each array, `point` or `cell`, its name and the reason with tabs between them, and a
//! last line `more` with the number of those that are not named.

use crate::mesh::{IgnoredArray, IgnoredArrays, ValuesOf};

/// The name of the field.
pub(super) const FIELD: &str = "ignored_arrays";

/// Characters of a reason that are read.
const LONGEST_REASON: usize = 300;

pub(super) fn encode(ignored: &IgnoredArrays) -> String {
    let line = |array: &IgnoredArray| {
        format!("{}\t{}\t{}\n", array.of.name(), on_one_line(&array.name), on_one_line(&array.why))
    };
    let lines: String = ignored.listed.iter().map(line).collect();
    match ignored.more {
        0 => lines,
        more => format!("{lines}more\t{more}\n"),
    }
}

/// Adds what a field says; lines that say nothing are passed over.
pub(super) fn decode(text: &str, ignored: &mut IgnoredArrays) {
    for line in text.lines() {
        let mut parts = line.splitn(3, '\t');
        let (word, name, why) = (parts.next(), parts.next(), parts.next());
        let of = [ValuesOf::Points, ValuesOf::Cells].into_iter().find(|of| word == Some(of.name()));
        if let (Some(of), Some(name), Some(why)) = (of, name, why) {
            ignored.add(of, name, why.chars().take(LONGEST_REASON).collect());
        } else if word == Some("more") {
            let more: u64 = name.and_then(|number| number.parse().ok()).unwrap_or_default();
            ignored.more = ignored.more.saturating_add(more);
        }
    }
}

fn on_one_line(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_ignored_is_read_as_it_was_written() {
        let mut ignored = IgnoredArrays { listed: Vec::new(), more: 7 };
        ignored.add(ValuesOf::Cells, "ids of cells", "holds 9 distinct values".to_owned());
        ignored.add(ValuesOf::Points, "", "has no name".to_owned());
        let mut again = IgnoredArrays::default();
        decode(&encode(&ignored), &mut again);
        assert_eq!(again, ignored);
    }

    #[test]
    fn lines_that_say_nothing_are_passed_over_and_reasons_are_cut() {
        let mut ignored = IgnoredArrays::default();
        decode("edge\ta\tb\ncell\ta\nmore\tx\n\nmore\n", &mut ignored);
        assert_eq!(ignored, IgnoredArrays::default());
        decode(&format!("cell\ta\t{}", "x".repeat(1000)), &mut ignored);
        assert_eq!(ignored.listed[0].why.len(), LONGEST_REASON);
    }
}
