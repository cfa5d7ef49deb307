//! Times of the database as text.

use crate::schema::wire::date::date_and_time;

/// Milliseconds since 1970 as RFC 3339 in UTC.
pub fn rfc3339(milliseconds: i64) -> String {
    let (seconds, fraction) = (milliseconds.div_euclid(1000), milliseconds.rem_euclid(1000));
    format!("{}.{fraction:03}Z", date_and_time(seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_milliseconds() {
        assert_eq!(rfc3339(1_795_176_912_345), "2026-11-20T12:15:12.345Z");
        assert_eq!(rfc3339(-1), "1969-12-31T23:59:59.999Z");
    }
}
