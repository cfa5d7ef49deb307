//! Reasons why a study has no report at all.

/// Why there is no report at all; whatever goes wrong in a row is reported there.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    #[error("stopped on request")]
    Cancelled,
    #[error("the study has no {what}")]
    Empty { what: &'static str },
    #[error("two {what}s are called {name:?}")]
    Repeated { what: &'static str, name: String },
    #[error("no thread to compute on: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}
