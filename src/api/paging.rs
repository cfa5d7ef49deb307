//! Lists in pages, each with the cursor of the next one.

use axum::http::header;
use axum::response::Response;
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;

use serde::Deserialize;
use utoipa::IntoParams;

use super::error::{ApiError, ApiResult};
use super::parameters::{LONGEST_PAGE, id};
use super::with_header;

const USUAL_PAGE: u32 = 50;

/// The parameters of a list without others.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct PageParameters {
    cursor: Option<String>,
    /// Default: 50.
    #[param(minimum = 1, maximum = 200)]
    limit: Option<u32>,
}

impl PageParameters {
    /// The page of a list whose rows have ids.
    pub fn page(&self) -> ApiResult<Page> {
        Page::new(self.cursor.as_deref(), self.limit)
    }

    /// The page of a list whose rows have other keys.
    pub fn page_by(&self, is_name: fn(&str) -> bool) -> ApiResult<Page> {
        let limit = checked_limit(self.limit)?;
        let name = |text: &str| is_name(text).then(|| text.to_owned());
        let after = self.cursor.as_deref().map(|cursor| read_cursor(cursor, name)).transpose()?;
        Ok(Page { after, limit: limit as usize })
    }
}

/// The page of a list.
pub struct Page {
    /// The last id of the previous page.
    pub after: Option<String>,
    pub limit: usize,
}

impl Page {
    pub fn new(cursor: Option<&str>, limit: Option<u32>) -> ApiResult<Page> {
        let limit = checked_limit(limit)?;
        let after = cursor.map(|cursor| read_cursor(cursor, id)).transpose()?;
        Ok(Page { after, limit: limit as usize })
    }

    /// One row more than the page, to see whether there is another page.
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

    /// The header with the next page, if there is one, for a body without cursor: `Link` of RFC 8288.
    pub fn linked(&self, answer: Response, path: &str, next: Option<String>) -> Response {
        let Some(next) = next else { return answer };
        let link = format!("<{path}?cursor={next}&limit={}>; rel=\"next\"", self.limit);
        with_header(answer, header::LINK, &link)
    }
}

/// The number of rows of a page.
pub fn checked_limit(limit: Option<u32>) -> ApiResult<u32> {
    let limit = limit.unwrap_or(USUAL_PAGE);
    if (1..=LONGEST_PAGE).contains(&limit) {
        return Ok(limit);
    }
    let detail = format!("limit is {limit}, and has to be 1 to {LONGEST_PAGE}");
    Err(ApiError::invalid_parameter("limit", detail))
}

/// The key in a cursor, if it is of the kind of this list.
fn read_cursor(cursor: &str, name: impl Fn(&str) -> Option<String>) -> ApiResult<String> {
    let text = URL_SAFE_NO_PAD.decode(cursor).ok();
    text.and_then(|text| String::from_utf8(text).ok())
        .and_then(|text| name(&text))
        .ok_or_else(|| ApiError::invalid_parameter("cursor", "the cursor is not of this list"))
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
