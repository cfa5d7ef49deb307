//! A place in the bytes of a file, read as binary fields or as words of text, never past the end.

use std::borrow::Cow;

use super::error::{FilePosition, FormatError};

#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    format: &'static str,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub fn new(format: &'static str, bytes: &'a [u8]) -> Self {
        Cursor { format, bytes, at: 0 }
    }

    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    pub fn remaining(&self) -> u64 {
        (self.bytes.len() - self.at) as u64
    }

    pub fn is_at_end(&self) -> bool {
        self.at == self.bytes.len()
    }

    /// An error here, placed by byte.
    pub fn bad_bytes(&self, detail: impl Into<String>) -> FormatError {
        FormatError::Parse {
            format: self.format,
            place: FilePosition::Offset(self.at as u64),
            detail: detail.into(),
        }
    }

    /// An error here, placed by line. Lines are counted only when one is asked for.
    pub fn bad_line(&self, detail: impl Into<String>) -> FormatError {
        let before = &self.bytes[..self.at];
        let lines = before.iter().filter(|&&byte| byte == b'\n').count() as u64;
        FormatError::Parse {
            format: self.format,
            place: FilePosition::Line(lines + 1),
            detail: detail.into(),
        }
    }

    // Binary fields.

    pub fn take(&mut self, count: u64) -> Result<&'a [u8], FormatError> {
        if count > self.remaining() {
            let have = self.remaining();
            return Err(self.bad_bytes(format!("{count} bytes declared, {have} left")));
        }
        let taken = &self.bytes[self.at..self.at + count as usize];
        self.at += count as usize;
        Ok(taken)
    }

    /// The bytes of `count` records of `each` bytes; the product may overflow what fits in memory.
    pub fn take_records(&mut self, count: u64, each: u64) -> Result<&'a [u8], FormatError> {
        self.take(count.saturating_mul(each))
    }

    pub fn take_array<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N as u64)?);
        Ok(array)
    }

    // Words and lines.

    pub fn skip_space(&mut self) {
        let space = self.rest().iter().take_while(|byte| byte.is_ascii_whitespace());
        self.at += space.count();
    }

    /// The next word, or `None` at the end.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        (length > 0).then(|| &rest[..length])
    }

    /// The next word, which has to be there.
    pub fn expect_word(&mut self, what: &str) -> Result<&'a str, FormatError> {
        match self.word() {
            Some(word) => std::str::from_utf8(word).map_err(|_| {
                self.bad_line(format!("expected {what}, found bytes that are no text"))
            }),
            None => Err(self.bad_line(format!("the file ends where {what} is expected"))),
        }
    }

    pub fn real(&mut self, what: &str) -> Result<f64, FormatError> {
        let word = self.expect_word(what)?;
        word.parse().map_err(|_| self.not_a_number(what, word))
    }

    pub fn integer(&mut self, what: &str) -> Result<i64, FormatError> {
        let word = self.expect_word(what)?;
        word.parse().map_err(|_| self.not_a_number(what, word))
    }

    pub fn unsigned(&mut self, what: &str) -> Result<u64, FormatError> {
        let word = self.expect_word(what)?;
        word.parse().map_err(|_| self.not_a_number(what, word))
    }

    /// The error for a word that should be a number; says so where a decimal comma is the cause.
    pub fn not_a_number(&self, what: &str, word: &str) -> FormatError {
        let shown: String = word.chars().take(40).collect();
        let hint =
            if word.contains(',') { "; numbers need a decimal point, not a comma" } else { "" };
        self.bad_line(format!("expected {what}, found {shown:?}{hint}"))
    }

    /// Refuses a count of text values for which the rest of the file is too short: each value
    /// takes a digit and a separator.
    pub fn expect_words(&self, count: u64) -> Result<(), FormatError> {
        let at_most = self.remaining().div_ceil(2);
        if count > at_most {
            let have = self.remaining();
            return Err(self.bad_line(format!("{count} values declared, {have} bytes left")));
        }
        Ok(())
    }

    /// The rest of the line, without its end; `None` at the end of the file.
    pub fn line(&mut self) -> Option<&'a [u8]> {
        if self.is_at_end() {
            return None;
        }
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |length| length + 1);
        let line = &rest[..length.unwrap_or(rest.len())];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// The rest of the line as text.
    pub fn text_line(&mut self) -> Option<Cow<'a, str>> {
        self.line().map(String::from_utf8_lossy)
    }

    /// Moves behind the next line that starts with `mark`; false where there is none.
    pub fn skip_past_line(&mut self, mark: &str) -> bool {
        let found = find(self.rest(), mark.as_bytes());
        match found {
            Some(distance) => {
                self.at += distance;
                self.line();
                true
            }
            None => false,
        }
    }
}

/// Where `needle` first stands in `hay`.
pub(super) fn find(hay: &[u8], needle: &[u8]) -> Option<usize> {
    let first = *needle.first()?;
    let mut from = 0;
    while let Some(step) = hay[from..].iter().position(|&byte| byte == first) {
        let at = from + step;
        if hay[at..].starts_with(needle) {
            return Some(at);
        }
        from = at + 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_beyond_the_rest_is_refused_before_it_is_used() {
        let mut cursor = Cursor::new("STL", b"abcd");
        assert!(cursor.take_records(u64::MAX, 50).is_err());
        assert!(cursor.expect_words(3).is_err());
        assert_eq!(cursor.take(4).unwrap(), b"abcd");
        assert!(cursor.is_at_end());
    }

    #[test]
    fn an_error_names_the_line_of_the_word() {
        let mut cursor = Cursor::new("OBJ", b"1 2\n3 0,5\n");
        for _ in 0..3 {
            cursor.real("a number").unwrap();
        }
        let error = cursor.real("a number").unwrap_err();
        assert_eq!(
            error.to_string(),
            "OBJ file, line 2: expected a number, found \"0,5\"; numbers need a decimal point, not a comma"
        );
    }
}
