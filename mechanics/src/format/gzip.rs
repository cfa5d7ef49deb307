//! Data compressed with gzip: members one behind the other, and the zeros with which archives and tapes fill their last block.
//!
//! Source: RFC 1952. Other bytes behind the last member are an error.

use std::io::{Error, ErrorKind, Read, Result};

use flate2::bufread::GzDecoder;

/// The first bytes of every member.
pub(super) const MAGIC: &[u8] = b"\x1f\x8b";

/// What the members hold, one behind the other.
pub(super) struct GzipReader<'a> {
    member: GzDecoder<&'a [u8]>,
}

impl<'a> GzipReader<'a> {
    pub fn new(bytes: &'a [u8]) -> GzipReader<'a> {
        GzipReader { member: GzDecoder::new(bytes) }
    }
}

impl Read for GzipReader<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        loop {
            let read = self.member.read(buffer)?;
            if read > 0 || buffer.is_empty() {
                return Ok(read);
            }
            let rest: &[u8] = self.member.get_ref();
            if rest.iter().all(|byte| *byte == 0) {
                return Ok(0);
            }
            if !rest.starts_with(MAGIC) {
                let detail = format!(
                    "{} bytes follow the compressed ones, which are neither compressed nor all zero",
                    rest.len()
                );
                return Err(Error::new(ErrorKind::InvalidData, detail));
            }
            self.member = GzDecoder::new(rest);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn member(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::new(1));
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    fn inflated(bytes: &[u8]) -> Result<Vec<u8>> {
        let mut inflated = Vec::new();
        GzipReader::new(bytes).read_to_end(&mut inflated).map(|_| inflated)
    }

    #[test]
    fn members_follow_each_other_and_zeros_follow_the_last() {
        let two = [member(b"one"), member(b""), member(b" two")].concat();
        for zeros in [0, 1, 511, 100_000] {
            let filled = [two.clone(), vec![0; zeros]].concat();
            assert_eq!(inflated(&filled).unwrap(), b"one two", "{zeros}");
        }
    }

    #[test]
    fn other_bytes_behind_the_last_member_and_a_member_that_is_cut_are_refused() {
        let one = member(b"one");
        for behind in [&b"x"[..], b"\0\0x", b"\x1f\x8c", b"\0\0\x1f\x8b"] {
            let error = inflated(&[&one, behind].concat()).unwrap_err().to_string();
            let wanted = format!("{} bytes follow the compressed ones", behind.len());
            assert!(error.starts_with(&wanted), "{behind:?}: {error}");
        }
        // Zeros stand for no part of a member: the size and the check sum at its end are compared.
        for left in 1..one.len() {
            assert!(inflated(&one[..left]).is_err(), "{left}");
            let error = inflated(&[&one[..left], &[0; 64]].concat());
            assert!(error.is_err() || left + 3 >= one.len(), "{left}");
        }
        assert!(inflated(&[&one[..], b"\x1f\x8b"].concat()).is_err());
    }
}
