//! What all slices of a series share: patient, study and frame of reference. Their values are compared, and stand in no message.

use std::collections::BTreeMap;

use super::attributes::{self as tag, Attributes, name};
use super::bad;
use super::element::Tag;
use crate::format::error::FormatError;

const SHARED: [Tag; 4] = [tag::PATIENT, tag::PATIENT_NAME, tag::STUDY, tag::FRAME_OF_REFERENCE];

/// So many values are counted in a message.
const MOST_SHOWN: usize = 4;

/// The values of [`SHARED`]; those that a file leaves out say nothing.
pub(super) struct Identity([Option<String>; 4]);

impl Identity {
    pub fn read(attributes: &Attributes<'_>) -> Identity {
        // Empty parts of a name may be left out.
        let plain = |word: String| word.trim_end_matches('^').trim().to_uppercase();
        Identity(SHARED.map(|tag| attributes.word(tag).map(plain)))
    }
}

/// Refuses slices, each with the number of its file, of several patients, studies or frames of reference.
pub(super) fn check_identity<'a>(
    slices: impl Iterator<Item = (usize, &'a Identity)> + Clone,
) -> Result<(), FormatError> {
    for (number, &tag) in SHARED.iter().enumerate() {
        // How many slices have a value, and the first file of them.
        let mut values: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for (file, identity) in slices.clone() {
            let Some(value) = &identity.0[number] else { continue };
            let (count, first) = values.entry(value).or_insert((0, file));
            *count += 1;
            *first = (*first).min(file);
        }
        if values.len() < 2 {
            continue;
        }
        let (name, differ) = (name(tag), values.len());
        let mut found: Vec<(usize, usize)> = values.into_values().collect();
        found.sort_by_key(|&(_, first)| first);
        let shown = found.iter().take(MOST_SHOWN);
        let shown: Vec<String> =
            shown.map(|(count, first)| format!("{count} (first file {first})")).collect();
        let detail = format!(
            "{name} has {differ} values in one series, in slices of the archive: {}; slices of several patients, studies or positions \
             are no one image: send those of one",
            shown.join(", ")
        );
        return Err(bad(0, detail));
    }
    Ok(())
}
