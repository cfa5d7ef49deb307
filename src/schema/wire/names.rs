//! Lists of unique names: tags, and entries identified by their names.

use std::collections::{BTreeMap, BTreeSet};

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

/// Names that are the keys of a map, unique without the spaces around them.
pub fn check_keys<T>(
    named: &BTreeMap<String, T>,
    at: &Pointer,
    limits: &Limits,
    faults: &mut Faults,
) {
    faults.check_length(at, named.len(), limits.map_entries as usize);
    let mut seen = BTreeMap::new();
    for name in named.keys() {
        faults.check_name(&at.key(name), name, limits.name_characters as usize);
        if let Some(before) = seen.insert(name.trim(), name) {
            let detail = format!("{name:?} and {before:?} differ by spaces around them alone");
            faults.add(&at.key(name), ErrorCode::DuplicateName, detail);
        }
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
