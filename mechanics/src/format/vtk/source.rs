//! Sources of the bytes of a VTK XML array: the file itself, or base64 text in it.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::STANDARD_NO_PAD;

use crate::format::error::FormatError;
use crate::format::limits::room_for;

/// Where the bytes of an array come from.
pub(super) enum Source<'a> {
    Raw(&'a [u8]),
    Base64 {
        text: &'a [u8],
        /// Bytes that were decoded with the ones before them and not yet taken.
        pending: Vec<u8>,
    },
}

impl<'a> Source<'a> {
    pub fn base64(text: &'a [u8]) -> Self {
        Source::Base64 { text, pending: Vec::new() }
    }

    pub fn is_empty(&self) -> bool {
        self.at_most() == 0
    }

    /// No more bytes than this can follow.
    pub fn at_most(&self) -> u64 {
        match self {
            Source::Raw(bytes) => bytes.len() as u64,
            Source::Base64 { text, pending } => {
                (text.len() as u64).div_ceil(4) * 3 + pending.len() as u64
            }
        }
    }

    /// The next bytes; `None` where there are fewer.
    pub fn take(&mut self, count: usize) -> Result<Option<Cow<'a, [u8]>>, FormatError> {
        match self {
            Source::Raw(bytes) => {
                let Some((taken, rest)) = bytes.split_at_checked(count) else {
                    return Ok(None);
                };
                *bytes = rest;
                Ok(Some(Cow::Borrowed(taken)))
            }
            Source::Base64 { text, pending } => {
                let mut taken = room_for(count + 3)?;
                taken.append(pending);
                decode_plain(text, &mut taken, count);
                while taken.len() < count {
                    if !decode_four(text, &mut taken) {
                        return Ok(None);
                    }
                }
                *pending = taken.split_off(count);
                Ok(Some(Cow::Owned(taken)))
            }
        }
    }
}

/// Decodes as many fours of characters as hold no more than `count` bytes and are followed by others, where they are
/// digits throughout; leaves the text as it is where they are not.
fn decode_plain(text: &mut &[u8], bytes: &mut Vec<u8>, count: usize) {
    let fours = (count.saturating_sub(bytes.len()) / 3).min(text.len() / 4).saturating_sub(1);
    let Some((plain, rest)) = text.split_at_checked(4 * fours) else { return };
    let before = bytes.len();
    bytes.resize(before + 3 * fours, 0);
    match STANDARD_NO_PAD.decode_slice(plain, &mut bytes[before..]) {
        Ok(_) => *text = rest,
        Err(_) => bytes.truncate(before),
    }
}

/// Decodes four characters to at most three bytes. Padding ends one encoding; another may follow.
fn decode_four(text: &mut &[u8], bytes: &mut Vec<u8>) -> bool {
    let mut bits = 0_u32;
    let (mut digits, mut padding) = (0, 0);
    while digits + padding < 4 {
        let Some((&character, rest)) = text.split_first() else {
            return false;
        };
        *text = rest;
        match BASE64_DIGITS[character as usize] {
            SPACE => continue,
            PADDING => padding += 1,
            NO_DIGIT => return false,
            _ if padding > 0 => return false,
            digit => {
                bits = bits << 6 | u32::from(digit);
                digits += 1;
            }
        }
    }
    let [_, first, second, third] = (bits << (6 * padding)).to_be_bytes();
    match padding {
        0 => bytes.extend_from_slice(&[first, second, third]),
        1 => bytes.extend_from_slice(&[first, second]),
        2 => bytes.push(first),
        _ => return false,
    }
    true
}

const NO_DIGIT: u8 = 64;
const SPACE: u8 = 65;
const PADDING: u8 = 66;

const BASE64_DIGITS: [u8; 256] = {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut digits = [NO_DIGIT; 256];
    let mut digit = 0;
    while digit < 64 {
        digits[alphabet[digit] as usize] = digit as u8;
        digit += 1;
    }
    digits[b' ' as usize] = SPACE;
    digits[b'\n' as usize] = SPACE;
    digits[b'\r' as usize] = SPACE;
    digits[b'\t' as usize] = SPACE;
    digits[b'=' as usize] = PADDING;
    digits
};

#[cfg(test)]
mod tests {
    use base64::engine::general_purpose::STANDARD;

    use super::*;

    fn taken(text: &str, counts: &[usize]) -> Vec<Option<Vec<u8>>> {
        let mut source = Source::base64(text.as_bytes());
        let take = |&count: &usize| source.take(count).unwrap().map(Cow::into_owned);
        counts.iter().map(take).collect()
    }

    #[test]
    fn base64_that_was_encoded_in_two_parts_reads_as_one() {
        let joined = taken("aGVhZGRhdGE=", &[4, 4]);
        let apart = taken("aGVhZA==ZGF0YQ==", &[4, 4]);
        assert_eq!(joined, [Some(b"head".to_vec()), Some(b"data".to_vec())]);
        assert_eq!(joined, apart);
    }

    #[test]
    fn long_base64_reads_as_the_same_bytes_however_it_is_broken_into_lines_and_parts() {
        let bytes: Vec<u8> = (0..10_000_u32).map(|number| (number * 7 % 251) as u8).collect();
        let (head, data) = bytes.split_at(4097);
        let [head, data] = [head, data].map(|part| STANDARD.encode(part));
        let lines: Vec<&str> =
            data.as_bytes().chunks(76).map(|line| std::str::from_utf8(line).unwrap()).collect();
        for text in [format!("{head}{data}"), format!("{head}\n{}", lines.join("\r\n"))] {
            let parts = taken(&text, &[1, 4096, 5000, 903, 1]);
            let [.., last] = &parts[..] else { panic!("five parts") };
            assert_eq!(*last, None, "there is no byte more");
            let whole: Vec<u8> = parts.into_iter().flatten().flatten().collect();
            assert_eq!(whole, bytes);
        }
        let wrong = format!("{}?{}", &head[..3000], &head[3001..]);
        assert_eq!(taken(&wrong, &[4097]), [None]);
    }

    #[test]
    fn base64_that_ends_early_or_holds_other_characters_gives_nothing() {
        assert_eq!(taken("aGVh", &[4]), [None]);
        assert_eq!(taken("aG?h", &[3]), [None]);
        assert_eq!(taken("a===", &[1]), [None]);
        assert_eq!(taken("aG Vh\n", &[3]), [Some(b"hea".to_vec())]);
    }
}
