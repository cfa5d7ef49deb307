//! Format and scopes of keys.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::letters::is_unseen;
use crate::schema::wire::problem::Problem;

/// A permission of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Scope {
    /// To read.
    Read,
    /// To store and erase meshes, cases and plans, and to erase jobs that have ended.
    Write,
    /// To start and dismiss jobs.
    Run,
    /// To create and revoke keys and read the audit log of its tenant.
    Admin,
}

impl Scope {
    pub const ALL: [Scope; 4] = [Scope::Read, Scope::Write, Scope::Run, Scope::Admin];

    pub fn name(self) -> &'static str {
        match self {
            Scope::Read => "read",
            Scope::Write => "write",
            Scope::Run => "run",
            Scope::Admin => "admin",
        }
    }
}

/// Scopes from words separated by spaces or commas; else the first word that is none.
pub fn scopes_of(words: &str) -> Result<BTreeSet<Scope>, String> {
    let words = words.split([' ', ',']).filter(|word| !word.is_empty());
    words
        .map(|word| {
            Scope::ALL.into_iter().find(|scope| scope.name() == word).ok_or_else(|| word.to_owned())
        })
        .collect()
}

/// The same as words separated by spaces.
pub fn scope_words(scopes: &BTreeSet<Scope>) -> String {
    scopes.iter().map(|scope| scope.name()).collect::<Vec<_>>().join(" ")
}

/// A key in full: `fcs_<id>_<secret>`, 12 and 64 hexadecimal digits.
pub struct Key {
    pub id: String,
    pub text: String,
}

const PREFIX: &str = "fcs";
const ID_BYTES: usize = 6;
const SECRET_BYTES: usize = 32;

impl Key {
    pub const RANDOM_BYTES: usize = ID_BYTES + SECRET_BYTES;

    /// A new one from random bytes.
    pub fn from_random(random: &[u8; Self::RANDOM_BYTES]) -> Key {
        let hexadecimal: String = random.iter().map(|byte| format!("{byte:02x}")).collect();
        let (id, secret) = hexadecimal.split_at(2 * ID_BYTES);
        Key { id: id.to_owned(), text: format!("{PREFIX}_{id}_{secret}") }
    }

    /// None if the text is not in the form of a key.
    pub fn parse(text: &str) -> Option<Key> {
        let mut parts = text.split('_');
        let (prefix, id, secret) = (parts.next()?, parts.next()?, parts.next()?);
        let is_key = prefix == PREFIX
            && parts.next().is_none()
            && is_hexadecimal(id, ID_BYTES)
            && is_hexadecimal(secret, SECRET_BYTES);
        is_key.then(|| Key { id: id.to_owned(), text: text.to_owned() })
    }
}

/// A key to be created.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct KeyDocument {
    /// Its purpose: 1 to 100 characters, no name of a person.
    #[schema(min_length = 1, max_length = 100)]
    pub label: String,
    /// Duplicates count once.
    #[schema(min_items = 1, value_type = Vec<Scope>)]
    pub scopes: BTreeSet<Scope>,
    /// Days to expiry; absent: it does not expire.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1, maximum = 3650)]
    pub days: Option<i64>,
}

/// The rotation of a key.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationDocument {
    /// Hours for which the old key remains valid.
    #[serde(default = "default_overlap_h")]
    #[schema(default = 24, minimum = 0, maximum = 8760)]
    pub overlap_h: i64,
}

fn default_overlap_h() -> i64 {
    24
}

const MOST_DAYS: i64 = 3650;
const MOST_OVERLAP_H: i64 = 8760;
const LONGEST_LABEL: usize = 100;

impl KeyDocument {
    /// Its faults.
    pub fn check(&self) -> Result<(), Problem> {
        let mut faults = Faults::default();
        let at = Pointer::from_text("/label");
        faults.check_name(&at, &self.label, LONGEST_LABEL);
        // A list in which a label looks like another one, or changes the order of a line, has the wrong key revoked.
        if let Some(letter) = self.label.chars().find(|letter| is_unseen(*letter)) {
            let letter = letter.escape_unicode();
            let detail =
                format!("a label has no letters that nobody sees, and this one has {letter}");
            faults.add(&at, ErrorCode::BadName, detail);
        }
        let mut add = |at: &str, detail: &str| {
            faults.add(&Pointer::from_text(at), ErrorCode::OutOfRange, detail);
        };
        if self.scopes.is_empty() {
            add("/scopes", "a key allows something");
        }
        if self.days.is_some_and(|days| !(1..=MOST_DAYS).contains(&days)) {
            add("/days", "a key lasts 1 to 3650 days");
        }
        faults.into_result()
    }
}

impl RotationDocument {
    /// Its faults.
    pub fn check(&self) -> Result<(), Problem> {
        let mut faults = Faults::default();
        if !(0..=MOST_OVERLAP_H).contains(&self.overlap_h) {
            let at = Pointer::from_text("/overlap_h");
            faults.add(&at, ErrorCode::OutOfRange, "keys overlap for 0 to 8760 hours");
        }
        faults.into_result()
    }
}

/// Whether a text has the form of the id of a key.
pub fn is_key_id(text: &str) -> bool {
    is_hexadecimal(text, ID_BYTES)
}

fn is_hexadecimal(text: &str, bytes: usize) -> bool {
    let is_digit = |byte: u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
    text.len() == 2 * bytes && text.bytes().all(is_digit)
}

/// The rule for names of tenants.
pub const TENANT_NAMES: &str =
    "a tenant has 1 to 64 of a to z, 0 to 9, - and ., and is neither . nor ..";

/// Bounds of the retention of unchanged resources.
pub const RETENTION_DAYS: std::ops::RangeInclusive<i64> = 1..=36_500;

/// Whether a name is one of [`TENANT_NAMES`].
pub fn is_tenant(name: &str) -> bool {
    let is_plain = |byte: u8| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.');
    let is_folder = matches!(name, "." | "..");
    (1..=64).contains(&name.len()) && name.bytes().all(is_plain) && !is_folder
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenant_has_a_name_that_an_address_keeps() {
        assert!(["ward-7", "a.b", "..."].into_iter().all(is_tenant));
        let long = "a".repeat(65);
        assert!(!["", ".", "..", "Ward", "a/b", &long].into_iter().any(is_tenant));
    }

    #[test]
    fn a_key_is_read_as_it_was_made_and_nothing_else_is_one() {
        let mut random = [7; 38];
        random[0] = 0xab;
        let key = Key::from_random(&random);
        assert_eq!(key.id, "ab0707070707");
        assert_eq!(key.text.len(), 3 + 1 + 12 + 1 + 64);
        assert_eq!(Key::parse(&key.text).map(|key| key.id), Some(key.id));
        let wrong = ["", "fcs__", "fcs_ab_cd", &key.text[1..], &key.text.to_uppercase()];
        assert!(wrong.iter().all(|text| Key::parse(text).is_none()));
        assert!(Key::parse(&format!("{}_", key.text)).is_none());
    }

    #[test]
    fn a_label_has_characters_that_a_list_can_show() {
        let code = |label: &str| {
            let scopes = BTreeSet::from([Scope::Read]);
            let wanted = KeyDocument { label: label.to_owned(), scopes, days: None };
            wanted.check().err().map(|problem| problem.errors[0].code)
        };
        assert_eq!(code(&"\u{e9}".repeat(100)), None);
        let wrong =
            ["", " ", "\u{200d}\u{200c}", &"a".repeat(101), "\u{1b}[2J", "a\nroot", "\u{9b}2J"];
        assert!(wrong.into_iter().all(|label| code(label) == Some(ErrorCode::BadName)));
        for unseen in
            "\u{ad}\u{115f}\u{1160}\u{200b}\u{2029}\u{202e}\u{2066}\u{2800}\u{3164}\u{feff}\u{ffa0}\u{e0041}".chars()
        {
            assert_eq!(code(&format!("ward{unseen} 7")), Some(ErrorCode::BadName), "{unseen:?}");
        }
        assert_eq!(code("\u{5d0}\u{301} \u{1f600}\u{fe0f} \u{2010}"), None);
    }

    #[test]
    fn scopes_are_words_of_which_every_one_is_known() {
        let scopes = scopes_of("run read, run").unwrap();
        assert_eq!(scope_words(&scopes), "read run");
        assert_eq!(scopes_of("read root"), Err("root".to_owned()));
    }
}
