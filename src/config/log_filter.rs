//! The filter of log lines: a level, or levels by target.

use tracing_subscriber::filter::Targets;

/// Words that a level may be, in either case.
const LEVELS: [&str; 6] = ["off", "error", "warn", "info", "debug", "trace"];

/// Whether each part between commas is a level, or a target with one. `Targets` alone takes any other word for a target of which everything
/// is logged, so that of a misspelt level nothing is.
pub(super) fn is_log_filter(text: &str) -> bool {
    text.split(',').all(|part| match part.split_once('=') {
        None => is_level(part),
        Some((target, level)) => is_target(target) && is_level(level),
    }) && text.parse::<Targets>().is_ok()
}

fn is_level(word: &str) -> bool {
    LEVELS.iter().any(|level| word.eq_ignore_ascii_case(level))
}

/// The path of a module, or the beginning of one.
fn is_target(word: &str) -> bool {
    !word.is_empty()
        && word.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_:".contains(&byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_or_levels_by_target_are_a_filter_and_other_words_are_not() {
        for filter in ["info", "WARN", "off", "facies=debug,sqlx=warn", "info,facies::store=trace"]
        {
            assert!(is_log_filter(filter), "{filter}");
        }
        for other in [
            "",
            "warning",
            "inof",
            "loud",
            "facies",
            "facies=",
            "=debug",
            "facies=loud",
            "==",
            "info,",
            "info;debug",
            "fac ies=info",
            "facies[span]=info",
            "5",
            "facies=5",
        ] {
            assert!(!is_log_filter(other), "{other}");
        }
    }
}
