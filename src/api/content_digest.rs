//! `Content-Digest` of a request body (RFC 9530), checked as the body arrives.

use axum::http::HeaderMap;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256, Sha512};

use super::error::{ApiError, ApiResult};
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

const HEADER: &str = "content-digest";

/// The digests that a client stated, beside those of the bytes so far.
#[derive(Default)]
pub struct ContentDigest {
    sha256: Option<(Vec<u8>, Sha256)>,
    sha512: Option<(Vec<u8>, Sha512)>,
    bytes: u64,
}

impl ContentDigest {
    /// That of a request which states one. Other algorithms beside SHA-256 and SHA-512 are ignored; alone they are refused, as nothing
    /// would be checked.
    pub fn of(headers: &HeaderMap) -> ApiResult<Option<ContentDigest>> {
        let mut found = ContentDigest::default();
        for value in headers.get_all(HEADER) {
            let value = value.to_str().map_err(|_| wrong("it is no text"))?;
            for entry in value.split(',') {
                found.read(entry.trim_matches([' ', '\t']))?;
            }
        }
        match (&found.sha256, &found.sha512, headers.contains_key(HEADER)) {
            (None, None, false) => Ok(None),
            (None, None, true) => Err(wrong("it states neither")),
            (_, _, _) => Ok(Some(found)),
        }
    }

    /// An entry of the dictionary (RFC 9651, section 3.2): a key in lower case, bytes as base64 between colons, parameters that mean nothing
    /// here.
    fn read(&mut self, entry: &str) -> ApiResult<()> {
        let unreadable = || wrong(&format!("`{entry}` cannot be read"));
        let (key, value) = entry.split_once('=').ok_or_else(unreadable)?;
        let is_of_key = |byte: u8| {
            byte.is_ascii_lowercase()
                || byte.is_ascii_digit()
                || matches!(byte, b'-' | b'_' | b'.' | b'*')
        };
        if key.is_empty() || !key.bytes().all(is_of_key) {
            return Err(unreadable());
        }
        let inner = value.strip_prefix(':').and_then(|value| value.split_once(':'));
        let (inner, parameters) = inner.ok_or_else(unreadable)?;
        let stated = STANDARD.decode(inner).map_err(|_| unreadable())?;
        let length = match key {
            "sha-256" => 32,
            "sha-512" => 64,
            _ => stated.len(),
        };
        if stated.len() != length || !(parameters.is_empty() || parameters.starts_with(';')) {
            return Err(unreadable());
        }
        match key {
            "sha-256" => self.sha256 = Some((stated, Sha256::new())),
            "sha-512" => self.sha512 = Some((stated, Sha512::new())),
            _ => {}
        }
        Ok(())
    }

    /// The next bytes of the body.
    pub fn push(&mut self, frame: &[u8]) {
        self.bytes += frame.len() as u64;
        if let Some((_, hasher)) = &mut self.sha256 {
            hasher.update(frame);
        }
        if let Some((_, hasher)) = &mut self.sha512 {
            hasher.update(frame);
        }
    }

    /// Refuses a body that has come whole and is another.
    pub fn check(self) -> ApiResult<()> {
        let ContentDigest { sha256, sha512, bytes } = self;
        let sha256 = sha256.map(|(stated, hasher)| ("sha-256", stated, hasher.finalize().to_vec()));
        let sha512 = sha512.map(|(stated, hasher)| ("sha-512", stated, hasher.finalize().to_vec()));
        let mut differing =
            sha256.into_iter().chain(sha512).filter(|(_, stated, own)| stated != own);
        let Some((name, _, own)) = differing.next() else { return Ok(()) };
        let found = format!("{name}=:{}:", STANDARD.encode(own));
        let detail = format!("{bytes} bytes came, and their digest is {found}");
        Err(Problem::new(ErrorCode::DigestMismatch, detail).with("digest", found).into())
    }
}

fn wrong(why: &str) -> ApiError {
    let detail = format!(
        "the header Content-Digest has the form sha-256=:BASE64: or sha-512=:BASE64:, its names in lower case; {why}"
    );
    ApiError::invalid_parameter("Content-Digest", detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(values: &[&str], body: &[u8]) -> Option<&'static str> {
        let mut headers = HeaderMap::new();
        for value in values {
            headers.append(HEADER, value.parse().unwrap());
        }
        let checked = ContentDigest::of(&headers).and_then(|stated| {
            let Some(mut stated) = stated else { return Ok(()) };
            body.chunks(2).for_each(|frame| stated.push(frame));
            stated.check()
        });
        checked.err().map(|error| error.problem.code.name())
    }

    #[test]
    fn each_stated_digest_is_that_of_the_bytes_and_one_that_cannot_be_checked_is_refused() {
        let sha256 = |bytes: &[u8]| format!("sha-256=:{}:", STANDARD.encode(Sha256::digest(bytes)));
        let sha512 = |bytes: &[u8]| format!("sha-512=:{}:", STANDARD.encode(Sha512::digest(bytes)));
        let (right, wide) = (sha256(b"body"), sha512(b"body"));
        let both = format!("{wide};x=1 ,\t{right}, md5=:AAAA:");
        for values in [vec![], vec![&*right], vec![&*wide], vec![&*both], vec![&*right, &*wide]] {
            assert_eq!(code(&values, b"body"), None, "{values:?}");
        }
        let (other, other_wide) = (sha256(b"other"), sha512(b"other"));
        let half = format!("{wide}, {other}");
        for values in [vec![&*other], vec![&*other_wide], vec![&*half], vec![&*right, &*other_wide]]
        {
            assert_eq!(code(&values, b"body"), Some("digest-mismatch"), "{values:?}");
        }
        let upper = right.replace("sha", "SHA");
        let loose = right.replace(':', "");
        for value in [
            "",
            "md5=:AAAA:",
            "sha-256",
            "sha-256=:AAAA:",
            "sha-256=:!!!:",
            "garbage",
            &upper,
            &loose,
        ] {
            assert_eq!(code(&[value], b"body"), Some("invalid-parameter"), "{value}");
        }
    }
}
