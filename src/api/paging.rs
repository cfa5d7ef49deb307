//! Lists in pages: the newest first, each page with the cursor of the next.

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;

use super::error::{ApiError, ApiResult};
use super::parameters::id;

const LONGEST_PAGE: u32 = 200;
const USUAL_PAGE: u32 = 50;

/// Which page of a list.
pub struct Page {
    /// The last id of the page before.
    pub after: Option<String>,
    pub limit: usize,
}

impl Page {
    pub fn new(cursor: Option<&str>, limit: Option<u32>) -> ApiResult<Page> {
        let limit = checked_limit(limit)?;
        let after = cursor.map(read_cursor).transpose()?;
        Ok(Page { after, limit: limit as usize })
    }

    /// One row more than the page holds tells whether there is another page.
    pub fn rows(&self) -> i64 {
        self.limit as i64 + 1
    }

    /// Cuts the rows to the page; the cursor of the next one, if there is one.
    pub fn cut<T>(&self, rows: &mut Vec<T>, id_of: impl Fn(&T) -> &str) -> Option<String> {
        if rows.len() <= self.limit {
            return None;
        }
        rows.truncate(self.limit);
        rows.last().map(|row| URL_SAFE_NO_PAD.encode(id_of(row)))
    }
}

/// How many rows a page has.
pub fn checked_limit(limit: Option<u32>) -> ApiResult<u32> {
    let limit = limit.unwrap_or(USUAL_PAGE);
    if (1..=LONGEST_PAGE).contains(&limit) {
        return Ok(limit);
    }
    let detail = format!("limit is {limit}, and has to be 1 to {LONGEST_PAGE}");
    Err(ApiError::invalid_parameter("limit", detail))
}

fn read_cursor(cursor: &str) -> ApiResult<String> {
    let text = URL_SAFE_NO_PAD.decode(cursor).ok();
    text.and_then(|text| String::from_utf8(text).ok())
        .and_then(|text| id(&text))
        .ok_or_else(|| ApiError::invalid_parameter("cursor", "the cursor is none of ours"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_forged_cursor_is_refused() {
        let page = Page::new(None, Some(1)).unwrap();
        let mut rows = vec!["0197a5b0-0000-7000-8000-000000000001".to_owned(), "next".to_owned()];
        let cursor = page.cut(&mut rows, |row| row).unwrap();
        assert_eq!(rows.len(), 1);
        let after = Page::new(Some(&cursor), None).unwrap().after;
        assert_eq!(after.as_deref(), Some(rows[0].as_str()));
        for forged in ["x", "%", "JyBPUiAx", ""] {
            assert!(Page::new(Some(forged), None).is_err(), "{forged}");
        }
        assert!(Page::new(None, Some(201)).is_err());
        assert!(Page::new(None, Some(0)).is_err());
    }
}
