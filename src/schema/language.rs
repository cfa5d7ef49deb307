//! The languages in which reports are written.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// `en` or `de`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Language {
    #[default]
    En,
    De,
}

impl Language {
    /// Its code in HTML and PDF.
    pub fn tag(self) -> &'static str {
        match self {
            Language::En => "en",
            Language::De => "de",
        }
    }

    /// The language preferred by a header `Accept-Language` (RFC 9110, section 12.5.4); English if it names neither.
    pub fn accepted(header: &str) -> Self {
        let mut best = (Language::En, 0.0);
        for range in header.split(',') {
            let mut parts = range.split(';').map(str::trim);
            let tag = parts.next().unwrap_or_default().to_ascii_lowercase();
            let quality = parts.find_map(|part| part.strip_prefix("q=")?.parse().ok());
            let quality: f32 = quality.unwrap_or(1.0);
            let language = match tag.split('-').next() {
                Some("de") => Language::De,
                Some("en") => Language::En,
                _ => continue,
            };
            if quality > best.1 {
                best = (language, quality);
            }
        }
        best.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_language_is_the_one_that_is_liked_best_of_those_there_are() {
        let cases = [
            ("", Language::En),
            ("fr", Language::En),
            ("de", Language::De),
            ("de-AT,en;q=0.5", Language::De),
            ("en-GB, de;q=0.9", Language::En),
            ("fr, de;q=0.3, en;q=0.2", Language::De),
            ("de;q=0", Language::En),
        ];
        for (header, language) in cases {
            assert_eq!(Language::accepted(header), language, "{header}");
        }
    }
}
