//! Reading of the direction in which sliding nodes are constrained: a word or three numbers.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, SeqAccess, Visitor};

use super::document::{NormalDocument, NormalWord};
use crate::schema::Triple;

/// Keeps the place of a component that is no number, which an untagged enum would lose.
impl<'de> Deserialize<'de> for NormalDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Normal)
    }
}

struct Normal;

const WORDS: &[&str] = &["surface"];

impl<'de> Visitor<'de> for Normal {
    type Value = NormalDocument;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("the string `surface` or an array of 3 numbers")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<NormalDocument, E> {
        match word == WORDS[0] {
            true => Ok(NormalDocument::Word(NormalWord::Surface)),
            false => Err(E::unknown_variant(word, WORDS)),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<NormalDocument, A::Error> {
        let mut direction = [0.0; 3];
        for (index, component) in direction.iter_mut().enumerate() {
            let next = entries.next_element()?;
            *component = next.ok_or_else(|| A::Error::invalid_length(index, &self))?;
        }
        let mut more = 0;
        while entries.next_element::<IgnoredAny>()?.is_some() {
            more += 1;
        }
        match more {
            0 => Ok(NormalDocument::Direction(Triple(direction))),
            more => Err(A::Error::invalid_length(3 + more, &self)),
        }
    }
}
