//! A file of settings: TOML with the names of the flags.
//!
//! ```toml
//! bind = "0.0.0.0:8080"
//! workers = 4
//! lease-s = 30.0
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use super::{ConfigError, SETTINGS};

/// The settings of a file as they would be written behind a flag. An unknown name is refused: it would be a
/// setting that silently has no effect.
pub fn read(path: &Path) -> Result<BTreeMap<&'static str, String>, ConfigError> {
    let refused = |reason: String| ConfigError::File { path: path.to_owned(), reason };
    let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
    parse(&text).map_err(refused)
}

fn parse(text: &str) -> Result<BTreeMap<&'static str, String>, String> {
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
        let before = error.span().map_or("", |span| text.get(..span.start).unwrap_or_default());
        let line = before.lines().count().max(1);
        format!("line {line}: {}", error.message().replace('\n', ", "))
    })?;
    let mut found = BTreeMap::new();
    for (name, value) in table {
        let setting = SETTINGS.iter().find(|setting| setting.name == name);
        let setting = setting.ok_or_else(|| format!("there is no setting `{name}`"))?;
        let value = match value {
            toml::Value::String(text) => text,
            toml::Value::Integer(number) => number.to_string(),
            toml::Value::Float(number) => number.to_string(),
            _ => return Err(format!("{name} has to be a text or a number")),
        };
        found.insert(setting.name, value);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_the_names_of_the_flags() {
        let found = parse("bind = \"0.0.0.0:80\"\nworkers = 4\nlease-s = 2.5\n").unwrap();
        assert_eq!(found["bind"], "0.0.0.0:80");
        assert_eq!(found["workers"], "4");
        assert_eq!(found["lease-s"], "2.5");
    }

    #[test]
    fn a_mistake_is_one_line_that_says_where() {
        for (text, said) in [
            ("workers = 4\nworker = 2", "there is no setting `worker`"),
            ("workers = true", "workers has to be"),
            ("workers = 4\nbind = ", "line 2"),
            ("[serve]\nworkers = 4", "there is no setting `serve`"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(said) && !error.contains('\n'), "{error}");
        }
    }
}
