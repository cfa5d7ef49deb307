//! Data elements: a tag, a length and a value, one after the other.

use super::bad;
use crate::format::cursor::Cursor;
use crate::format::error::FormatError;
use crate::format::scalar::ByteOrder;

/// Group and element, as one number.
pub(super) type Tag = u32;

const ITEM: Tag = 0xFFFE_E000;
const ITEM_END: Tag = 0xFFFE_E00D;
const SEQUENCE_END: Tag = 0xFFFE_E0DD;
/// A length that is not known before the end is met.
const UNDEFINED: u32 = u32::MAX;
/// Sequences within sequences.
const DEEPEST: usize = 64;

/// Types whose length has four bytes behind two that are empty (PS3.5, 7.1.2).
const LONG_TYPES: [&[u8; 2]; 13] =
    [b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV"];

/// How elements are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Coding {
    pub explicit: bool,
    pub order: ByteOrder,
}

/// What an element begins with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Head {
    pub tag: Tag,
    length: u32,
    is_unknown: bool,
}

/// The value of an element.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value<'a> {
    Bytes(&'a [u8]),
    /// Of a length that is found by its end; the cursor stands at its beginning.
    Open,
}

impl Coding {
    pub fn u16(self, bytes: [u8; 2]) -> u16 {
        match self.order {
            ByteOrder::Little => u16::from_le_bytes(bytes),
            ByteOrder::Big => u16::from_be_bytes(bytes),
        }
    }

    pub fn u32(self, bytes: [u8; 4]) -> u32 {
        match self.order {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        }
    }

    fn tag(self, cursor: &mut Cursor<'_>) -> Result<Tag, FormatError> {
        let [group, element] = [cursor.take_array()?, cursor.take_array()?];
        Ok(Tag::from(self.u16(group)) << 16 | Tag::from(self.u16(element)))
    }

    fn length(self, cursor: &mut Cursor<'_>) -> Result<u32, FormatError> {
        Ok(self.u32(cursor.take_array()?))
    }

    pub fn head(self, cursor: &mut Cursor<'_>) -> Result<Head, FormatError> {
        let tag = self.tag(cursor)?;
        // Items and ends of sequences have no type.
        if !self.explicit || tag >> 16 == 0xFFFE {
            return Ok(Head { tag, length: self.length(cursor)?, is_unknown: false });
        }
        let kind: [u8; 2] = cursor.take_array()?;
        let length = if LONG_TYPES.contains(&&kind) {
            cursor.take(2)?;
            self.length(cursor)?
        } else {
            u32::from(self.u16(cursor.take_array()?))
        };
        Ok(Head { tag, length, is_unknown: kind == *b"UN" })
    }

    pub fn value<'a>(self, head: Head, cursor: &mut Cursor<'a>) -> Result<Value<'a>, FormatError> {
        if head.length == UNDEFINED {
            return Ok(Value::Open);
        }
        cursor.take(u64::from(head.length)).map(Value::Bytes)
    }

    /// Moves behind a sequence of undefined length, however deep. Within an element of unknown type everything is
    /// implicit (PS3.5, 6.2.2).
    pub fn skip_open(self, head: Head, cursor: &mut Cursor<'_>) -> Result<(), FormatError> {
        let within = |coding: Coding, head: Head| match head.is_unknown {
            true => Coding { explicit: false, ..coding },
            false => coding,
        };
        let mut open = vec![within(self, head)];
        while let Some(&coding) = open.last() {
            if open.len() > DEEPEST {
                return Err(cursor.bad_bytes(format!("sequences stand more than {DEEPEST} deep")));
            }
            let head = coding.head(cursor)?;
            match (head.tag, head.length) {
                (ITEM_END | SEQUENCE_END, _) => {
                    open.pop();
                }
                (_, UNDEFINED) => open.push(within(coding, head)),
                (_, length) => {
                    cursor.take(u64::from(length))?;
                }
            }
        }
        Ok(())
    }

    /// The pieces of encapsulated pixels; the first holds offsets of frames or nothing (PS3.5, A.4).
    pub fn fragments<'a>(self, cursor: &mut Cursor<'a>) -> Result<Vec<&'a [u8]>, FormatError> {
        let mut fragments = Vec::new();
        loop {
            let [tag, length] = [self.tag(cursor)?, self.length(cursor)?];
            match tag {
                SEQUENCE_END => return Ok(fragments),
                ITEM if length != UNDEFINED => fragments.push(cursor.take(u64::from(length))?),
                _ => {
                    return Err(bad(
                        0,
                        "a piece of compressed pixels has no beginning or no length",
                    ));
                }
            }
        }
    }
}
