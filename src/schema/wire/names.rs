//! Lists of unique names: tags, and entries identified by their names.

use std::collections::BTreeSet;

use super::fault::{Faults, Pointer};
use super::limits::Limits;
use crate::schema::code::ErrorCode;

/// Tags are names, at most 32 of them.
pub fn check_tags(tags: &[String], at: &Pointer, limits: &Limits, faults: &mut Faults) {
    faults.check_length(at, tags.len(), limits.tags as usize);
    for (index, tag) in tags.iter().enumerate() {
        faults.check_name(&at.index(index), tag, limits.name_characters as usize);
    }
}

/// Refuses a name that an earlier entry has.
pub fn check_distinct<'a>(names: impl Iterator<Item = &'a str>, at: &Pointer, faults: &mut Faults) {
    let mut seen = BTreeSet::new();
    for (index, name) in names.enumerate() {
        if !seen.insert(name.trim()) {
            let detail = format!("the name `{}` is given more than once", name.trim());
            faults.add(&at.index(index).key("name"), ErrorCode::DuplicateName, detail);
        }
    }
}
