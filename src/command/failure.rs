//! Failures of the command line, with their exit codes.

use std::io;
use std::path::PathBuf;

use super::admin::AdminError;
use super::demo::DemoError;
use super::health::HealthError;
use super::serve::ServeError;
use crate::config::ConfigError;
use crate::jobs::JobError;
use crate::schema::Problem;
use crate::schema::job::ErrorClass;
use crate::schema::study::report::OutcomeName;
use crate::schema::wire::numbers::with_short_numbers;
use crate::worker::process::SlotError;

/// The job ran and failed.
pub const FAILED: u8 = 1;
/// Wrong use, or documents and meshes that are refused.
const REFUSED: u8 = 2;
/// Disks, memory, other programs.
pub const INFRASTRUCTURE: u8 = 3;
/// A wrong setting (sysexits.h, EX_CONFIG).
const CONFIGURATION: u8 = 78;

#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    #[error("{0}")]
    Usage(String),
    #[error("{}: {}", path.display(), problem.detail)]
    Document { path: PathBuf, problem: Problem },
    #[error("{} could not be read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{} could not be written: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Job(#[from] JobError),
    /// A study that did not pass: `worse`, `incomplete` or `no-baseline`.
    #[error("the outcome is {}: {}", outcome.name(), reasons.join("; "))]
    Verdict { outcome: OutcomeName, reasons: Vec<String> },
    #[error("{probes} answers are wrong and carry no warning")]
    SilentlyWrong { probes: usize },
    #[error(transparent)]
    Demo(#[from] DemoError),
    #[error(transparent)]
    Serve(#[from] ServeError),
    #[error(transparent)]
    Slot(#[from] SlotError),
    #[error(transparent)]
    Admin(#[from] AdminError),
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Health(#[from] HealthError),
}

impl CommandError {
    pub fn exit_code(&self) -> u8 {
        match self {
            CommandError::Slot(SlotError::NoOrders)
            | CommandError::Usage(_)
            | CommandError::Document { .. }
            | CommandError::Read { .. } => REFUSED,
            CommandError::SilentlyWrong { .. } => FAILED,
            CommandError::Write { .. } => INFRASTRUCTURE,
            CommandError::Verdict { outcome, .. } => outcome.exit_code(),
            CommandError::Demo(error) if error.is_failed_job() => FAILED,
            CommandError::Demo(error) if error.is_setting() => CONFIGURATION,
            CommandError::Demo(error) if error.is_refused() => REFUSED,
            CommandError::Serve(ServeError::Store(error))
            | CommandError::Admin(AdminError::Store(error))
                if error.is_damaged() =>
            {
                FAILED
            }
            CommandError::Serve(error) if error.is_setting() => CONFIGURATION,
            CommandError::Health(error) if error.is_setting() => CONFIGURATION,
            CommandError::Admin(error) if error.is_setting() => CONFIGURATION,
            CommandError::Admin(error) if error.is_refused() => REFUSED,
            CommandError::Admin(
                AdminError::Findings { .. }
                | AdminError::Audit { .. }
                | AdminError::ClockDoubted(_),
            ) => FAILED,
            CommandError::Config(_) => CONFIGURATION,
            CommandError::Demo(_)
            | CommandError::Serve(_)
            | CommandError::Slot(_)
            | CommandError::Health(_)
            | CommandError::Admin(_) => INFRASTRUCTURE,
            CommandError::Job(error) => match error.class() {
                ErrorClass::Input => REFUSED,
                ErrorClass::Infrastructure => INFRASTRUCTURE,
                ErrorClass::Numerical | ErrorClass::Cancelled | ErrorClass::Budget => FAILED,
            },
        }
    }

    /// One line for each mistake, with its place and its code.
    pub fn lines(&self) -> Vec<String> {
        match self {
            CommandError::Document { path, problem } => {
                let file = path.display();
                problem_lines(problem).map(|line| format!("{file}: {line}")).collect()
            }
            CommandError::Job(JobError::Refused(problem)) => problem_lines(problem).collect(),
            CommandError::Job(error) => {
                vec![format!("{} ({})", with_short_numbers(&error.to_string()), error.kind())]
            }
            other => vec![other.to_string()],
        }
    }
}

fn problem_lines(problem: &Problem) -> impl Iterator<Item = String> {
    let whole = problem.errors.is_empty().then(|| format!("{} ({})", problem.detail, problem.code));
    let errors = problem.errors.iter();
    whole.into_iter().chain(errors.map(|error| match error.pointer.as_str() {
        "" => format!("{} ({})", error.detail, error.code),
        pointer => format!("{pointer}: {} ({})", error.detail, error.code),
    }))
}
