//! Conditional requests and ranges (RFC 9110, sections 13 and 14).

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::download::ServedFile;
use super::error::{ApiError, ApiResult};
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

/// The strong entity tag of a version or a hash.
pub fn entity_tag(content: &str) -> HeaderValue {
    HeaderValue::from_str(&format!("\"{content}\""))
        .unwrap_or_else(|_| HeaderValue::from_static("\"\""))
}

/// The tags listed in a header; `None` if it is not sent.
fn tags(headers: &HeaderMap, name: header::HeaderName) -> Option<Vec<String>> {
    let values = headers.get_all(name);
    let mut tags = None;
    for value in values {
        let text = value.to_str().unwrap_or_default();
        let list: &mut Vec<String> = tags.get_or_insert_default();
        list.extend(text.split(',').map(|tag| tag.trim().to_owned()));
    }
    tags
}

/// Permits a change that names the present version, or any with `*`.
/// Only strong tags are compared, as If-Match requires.
pub fn require_match(headers: &HeaderMap, current: &str) -> ApiResult<()> {
    let Some(tags) = tags(headers, header::IF_MATCH) else {
        let detail = "send If-Match with the ETag of the version to change, or with *";
        return Err(Problem::new(ErrorCode::PreconditionRequired, detail)
            .with("etag", format!("\"{current}\""))
            .into());
    };
    let quoted = format!("\"{current}\"");
    if tags.iter().any(|tag| tag == "*" || *tag == quoted) {
        return Ok(());
    }
    Err(other_version(current))
}

/// Permits a change that names no version, or the present one.
pub fn allow_match(headers: &HeaderMap, current: &str) -> ApiResult<()> {
    match headers.contains_key(header::IF_MATCH) {
        true => require_match(headers, current),
        false => Ok(()),
    }
}

/// The refusal of a change to another version than the present one.
pub fn other_version(current: &str) -> ApiError {
    let quoted = format!("\"{current}\"");
    let detail = format!("the current version is {quoted}");
    Problem::new(ErrorCode::PreconditionFailed, detail).with("etag", quoted).into()
}

/// True if the client has this version already.
pub fn is_known(headers: &HeaderMap, current: &str) -> bool {
    let quoted = format!("\"{current}\"");
    tags(headers, header::IF_NONE_MATCH).is_some_and(|tags| {
        tags.iter().any(|tag| tag == "*" || tag.strip_prefix("W/").unwrap_or(tag) == quoted)
    })
}

/// 304 with the tag.
pub fn not_modified(current: &str) -> Response {
    let headers = [(header::ETAG, entity_tag(current))];
    (StatusCode::NOT_MODIFIED, headers).into_response()
}

/// A document with the hash of its text as its tag, or 304 if the client has it already.
pub async fn document(headers: &HeaderMap, response: Response) -> ApiResult {
    let (mut head, body) = response.into_parts();
    let bytes = axum::body::to_bytes(body, usize::MAX).await.map_err(ApiError::internal)?;
    let tag = crate::schema::wire::canonical::sha256_hex(&bytes);
    if is_known(headers, &tag) {
        return Ok(not_modified(&tag));
    }
    head.headers.insert(header::ETAG, entity_tag(&tag));
    Ok(Response::from_parts(head, bytes.into()))
}

/// An immutable file with conditional responses: tag, 304, one range.
pub fn file(
    headers: &HeaderMap,
    file: ServedFile,
    (media_type, name): (&str, &str),
    tag: &str,
) -> ApiResult {
    if is_known(headers, tag) {
        return Ok(not_modified(tag));
    }
    let total = file.bytes;
    let range = match requested_range(headers, tag) {
        Some(text) => single_range(&text, total)?,
        None => None,
    };
    let (first, count) = range.map_or((0, total), |(first, last)| (first, last - first + 1));
    let mut response = file.into_body(first, count)?.into_response();
    if let Some((first, last)) = range {
        *response.status_mut() = StatusCode::PARTIAL_CONTENT;
        set(&mut response, header::CONTENT_RANGE, &format!("bytes {first}-{last}/{total}"));
    }
    set(&mut response, header::CONTENT_LENGTH, &count.to_string());
    set(&mut response, header::CONTENT_TYPE, media_type);
    let disposition = format!("attachment; filename=\"{name}\"");
    set(&mut response, header::CONTENT_DISPOSITION, &disposition);
    set(&mut response, header::ACCEPT_RANGES, "bytes");
    set(&mut response, header::CACHE_CONTROL, "private, no-cache");
    response.headers_mut().insert(header::ETAG, entity_tag(tag));
    Ok(response)
}

fn set(response: &mut Response, name: header::HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        response.headers_mut().insert(name, value);
    }
}

/// The Range header, unless If-Range names another version.
fn requested_range(headers: &HeaderMap, tag: &str) -> Option<String> {
    let range = headers.get(header::RANGE)?.to_str().ok()?;
    let meant = headers.get(header::IF_RANGE);
    let applies = meant.is_none_or(|meant| *meant == entity_tag(tag));
    applies.then(|| range.to_owned())
}

/// First and last byte of a single range. A server may ignore other units, and several
/// ranges are ignored here: a thousand of one byte each would cost more than the file.
fn single_range(text: &str, total: u64) -> ApiResult<Option<(u64, u64)>> {
    let Some((first, last)) = text
        .strip_prefix("bytes=")
        .filter(|ranges| !ranges.contains(','))
        .and_then(|range| range.trim().split_once('-'))
    else {
        return Ok(None);
    };
    let range = match (position(first), position(last)) {
        (Some(first), Some(last)) if first <= last => (first, last.min(total.saturating_sub(1))),
        (Some(first), None) if last.is_empty() => (first, total.saturating_sub(1)),
        (None, Some(count)) if first.is_empty() => {
            if count == 0 {
                return Err(outside(total));
            }
            (total.saturating_sub(count), total.saturating_sub(1))
        }
        _ => return Ok(None),
    };
    if range.0 >= total {
        return Err(outside(total));
    }
    Ok(Some(range))
}

/// A number of any length; one that is too large for a number lies beyond the end of any file.
fn position(text: &str) -> Option<u64> {
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().unwrap_or(u64::MAX))
}

fn outside(total: u64) -> ApiError {
    let detail = format!("the file has {total} bytes");
    let error: ApiError =
        Problem::new(ErrorCode::RangeNotSatisfiable, detail).with("bytes", total).into();
    match HeaderValue::from_str(&format!("bytes */{total}")) {
        Ok(value) => error.header(header::CONTENT_RANGE, value),
        Err(_) => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(name: header::HeaderName, value: &str) -> HeaderMap {
        let mut headers = HeaderMap::new();
        headers.insert(name, value.parse().unwrap());
        headers
    }

    #[test]
    fn only_a_strong_tag_of_the_current_version_lets_a_change_pass() {
        let passes = |value: &str| require_match(&with(header::IF_MATCH, value), "3").is_ok();
        assert!(passes("\"3\""));
        assert!(passes("*"));
        assert!(passes("\"2\", \"3\""));
        assert!(!passes("W/\"3\""));
        assert!(!passes("\"2\""));
        assert!(!passes("3"));
        let missing = require_match(&HeaderMap::new(), "3").unwrap_err();
        assert_eq!(missing.problem.code, ErrorCode::PreconditionRequired);
    }

    #[test]
    fn a_change_that_needs_no_version_is_held_to_the_one_that_it_names() {
        assert!(allow_match(&HeaderMap::new(), "3").is_ok());
        assert!(allow_match(&with(header::IF_MATCH, "\"3\""), "3").is_ok());
        let refused = allow_match(&with(header::IF_MATCH, "\"2\""), "3").unwrap_err();
        assert_eq!(refused.problem.code, ErrorCode::PreconditionFailed);
    }

    #[test]
    fn a_weak_tag_is_enough_to_save_a_download() {
        assert!(is_known(&with(header::IF_NONE_MATCH, "W/\"3\""), "3"));
        assert!(!is_known(&with(header::IF_NONE_MATCH, "\"4\""), "3"));
        assert!(!is_known(&HeaderMap::new(), "3"));
    }

    #[test]
    fn one_range_is_served_and_none_beyond_the_end() {
        let range = |text: &str| single_range(text, 10);
        assert_eq!(range("bytes=2-4").unwrap(), Some((2, 4)));
        assert_eq!(range("bytes=8-99").unwrap(), Some((8, 9)));
        assert_eq!(range("bytes=8-99999999999999999999").unwrap(), Some((8, 9)));
        assert_eq!(range("bytes=-99999999999999999999").unwrap(), Some((0, 9)));
        assert_eq!(range("bytes=7-").unwrap(), Some((7, 9)));
        assert_eq!(range("bytes=-3").unwrap(), Some((7, 9)));
        assert_eq!(range("bytes=-99").unwrap(), Some((0, 9)));
        for ignored in ["bytes=0-0,1-1", "lines=1-2", "bytes=4-2", "bytes=a-b", "bytes=+1-2"] {
            assert_eq!(range(ignored).unwrap(), None, "{ignored}");
        }
        for outside in ["bytes=10-", "bytes=99-100", "bytes=99999999999999999999-", "bytes=-0"] {
            assert!(range(outside).is_err(), "{outside}");
        }
        assert!(single_range("bytes=-1", 0).is_err());
    }
}
