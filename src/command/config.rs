//! `facies config`: the settings in force, as a file of settings, with secrets hidden.

use super::settings::{Arguments, Source};
use crate::config::{Config, ConfigError, SETTINGS};
use crate::store;

/// Prints every setting with its source, or says what is wrong with one.
pub fn run(arguments: &Arguments) -> Result<(), ConfigError> {
    let given = arguments.given()?;
    let config = Config::without_listener(|name| given.get(name))?;
    config.check_listeners()?;
    let places = config.places;
    places.check_folders()?;
    places.check_address(store::address_fault)?;
    for setting in SETTINGS {
        let (value, source) = match given.find(setting) {
            Some(found) => found,
            None => (setting.default.to_owned(), Source::Default),
        };
        let source = match source {
            Source::Flag => format!("--{}", setting.name),
            Source::Variable => setting.variable(),
            Source::File => "file".to_owned(),
            Source::Default => "default".to_owned(),
        };
        println!("{} = {}  # {source}", setting.name, quoted(&setting.shown(&value)));
    }
    Ok(())
}

/// A text as TOML has it: a JSON string is one.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
