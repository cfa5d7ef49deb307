//! Settings from flags, variables and a file: a flag goes before a variable, a variable before the file.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};

use crate::config::{ConfigError, SETTINGS, Setting, file};

/// The flag and the variable that name the file of settings.
const FILE_FLAG: &str = "config";
const FILE_VARIABLE: &str = "FACIES_CONFIG";

/// Letters that are wrong, missing, too many or exchanged in a name that is taken for another.
const MISSPELT: usize = 2;

/// The settings as flags; each may as well be an environment variable or a line of a file.
#[derive(Clone, Debug, Default)]
pub struct Arguments {
    flags: BTreeMap<&'static str, String>,
    file: Option<PathBuf>,
}

/// Where a value comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    Flag,
    Variable,
    File,
    Default,
}

/// Every setting that was given, and where.
pub struct SettingSources {
    flags: BTreeMap<&'static str, String>,
    file: BTreeMap<&'static str, String>,
}

impl Arguments {
    /// Reads the file of settings, if there is one.
    pub fn given(&self) -> Result<SettingSources, ConfigError> {
        let variable = || std::env::var_os(FILE_VARIABLE).map(PathBuf::from);
        let names = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok());
        misspelt(names).iter().for_each(|told| eprintln!("not used   {told}"));
        let file = match self.file.clone().or_else(variable) {
            Some(path) => file::read(&path)?,
            None => BTreeMap::new(),
        };
        Ok(SettingSources { flags: self.flags.clone(), file })
    }
}

impl SettingSources {
    /// What was given for a setting.
    pub fn get(&self, name: &str) -> Option<String> {
        let setting = SETTINGS.iter().find(|setting| setting.name == name)?;
        Some(self.find(setting)?.0)
    }

    /// What was given for a setting, and where.
    pub fn find(&self, setting: &Setting) -> Option<(String, Source)> {
        if let Some(value) = self.flags.get(setting.name) {
            return Some((value.clone(), Source::Flag));
        }
        if let Some(value) = std::env::var_os(setting.variable()) {
            return Some((value.to_string_lossy().into_owned(), Source::Variable));
        }
        let value = self.file.get(setting.name)?;
        Some((value.clone(), Source::File))
    }
}

/// Variables that are no setting and are named almost like one.
fn misspelt(names: impl Iterator<Item = String>) -> Vec<String> {
    let known: Vec<String> = SETTINGS.iter().map(Setting::variable).collect();
    let almost = |name: &String| {
        let near = known.iter().find(|known| strsim::osa_distance(name, known) <= MISSPELT)?;
        Some(format!("the variable {name} is no setting; {near} is"))
    };
    let is_other = |name: &String| name.starts_with("FACIES_") && !known.contains(name);
    names.filter(is_other).filter_map(|name| almost(&name)).collect()
}

/// The group of a setting in the help: the sections of `docs/configuration.md`.
fn heading(name: &str) -> &'static str {
    match name {
        "data" | "database" | "database-connections" | "blobs" => "Where things are kept",
        "workers" | "threads-per-job" | "slot-memory-mib" | "lease-s" | "heartbeat-s"
        | "attempts" | "grace-s" => "Jobs",
        "log-format" | "log-level" | "traces" => "Logs and traces",
        _ => "Requests",
    }
}

impl Args for Arguments {
    fn augment_args(command: Command) -> Command {
        // Given twice, the last one counts, as it does in shells and container files.
        let file = Arg::new(FILE_FLAG).long(FILE_FLAG).value_name("FILE").help(format!(
            "file of settings: TOML with the names of these flags [env: {FILE_VARIABLE}]"
        ));
        let command = command.args_override_self(true).arg(file);
        SETTINGS.iter().fold(command, |command, setting| {
            let default = match setting.default {
                "" => String::new(),
                default => format!(" [default: {default}]"),
            };
            let argument = Arg::new(setting.name)
                .long(setting.name)
                .help_heading(heading(setting.name))
                .value_name("VALUE")
                .help(format!("{} [env: {}]{default}", setting.about, setting.variable()));
            // `--ask-for-keys` alone is `--ask-for-keys true`.
            command.arg(match setting.default {
                "true" | "false" => argument.num_args(0..=1).default_missing_value("true"),
                _ => argument.allow_hyphen_values(true),
            })
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Arguments {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let value = |name: &'static str| {
            let value = matches.get_one::<String>(name)?;
            Some((name, value.clone()))
        };
        let flags = SETTINGS.iter().filter_map(|setting| value(setting.name)).collect();
        let file = matches.get_one::<String>(FILE_FLAG).map(PathBuf::from);
        Ok(Arguments { flags, file })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_variable_is_told_and_others_are_not() {
        let names =
            ["FACIES_WROKERS", "FACIES_WORKERS", "FACIES_CONFIG", "FACIES_FAULT", "WORKERS"];
        let told = misspelt(names.map(str::to_owned).into_iter());
        assert_eq!(told, ["the variable FACIES_WROKERS is no setting; FACIES_WORKERS is"]);
    }

    #[test]
    fn a_switch_without_a_value_is_on_and_takes_no_flag_for_one() {
        let read = |words: &[&str]| {
            let command = Arguments::augment_args(Command::new("serve").no_binary_name(true));
            let matches = command.try_get_matches_from(words).expect("read");
            Arguments::from_arg_matches(&matches).expect("read").flags
        };
        let given = read(&["--ask-for-keys", "--admin-bind", "127.0.0.1:9"]);
        assert_eq!(given["ask-for-keys"], "true");
        assert_eq!(given["admin-bind"], "127.0.0.1:9");
        assert_eq!(read(&["--ask-for-keys", "false"])["ask-for-keys"], "false");
    }
}
