//! All errors in a case and a plan, each with its place.

use super::error_code::SceneErrorCode;
use crate::boundary::SelectionError;

/// Most problems that are listed.
const MOST_PROBLEMS: usize = 50;

/// Everything wrong with a case and a plan, at most 50 entries.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", in_words(.0))]
pub struct SceneErrors(pub Vec<SceneError>);

/// Why there is no scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoScene {
    #[error(transparent)]
    Refused(#[from] SceneErrors),
    #[error("stopped on request")]
    Stopped,
}

/// The only one, or how many there are and the first.
fn in_words(problems: &[SceneError]) -> String {
    match problems {
        [] => "no problem".to_owned(),
        [only] => only.to_string(),
        [first, ..] => format!("{} problems, the first: {first}", problems.len()),
    }
}

/// One thing wrong, and where: a JSON pointer that starts with `/case`, `/plan` or `/spec`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{pointer}: {detail}")]
pub struct SceneError {
    pub pointer: String,
    pub code: SceneErrorCode,
    pub detail: String,
}

/// Problems found so far.
#[derive(Default)]
pub(super) struct Problems(Vec<SceneError>);

impl Problems {
    pub(super) fn add(&mut self, pointer: impl Into<String>, code: SceneErrorCode, detail: String) {
        if self.0.len() < MOST_PROBLEMS {
            self.0.push(SceneError { pointer: pointer.into(), code, detail });
        }
    }

    pub(super) fn selection(&mut self, pointer: &str, error: &SelectionError) {
        let code = match error {
            SelectionError::UnknownSet(_) => SceneErrorCode::UnknownSet,
            SelectionError::UnknownArray(_) => SceneErrorCode::UnknownArray,
            SelectionError::UnknownSurface(_) => SceneErrorCode::UnknownSurface,
            SelectionError::FlatSurface(_) => SceneErrorCode::MeshDegenerate,
            SelectionError::Empty(_) => SceneErrorCode::EmptySelection,
        };
        self.add(pointer, code, error.to_string());
    }

    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    pub(super) fn fail_on_problems(&mut self) -> Result<(), SceneErrors> {
        match self.0.is_empty() {
            true => Ok(()),
            false => Err(SceneErrors(std::mem::take(&mut self.0))),
        }
    }
}
