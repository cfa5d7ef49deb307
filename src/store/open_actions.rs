//! Audited actions of this process without a stored outcome: those that go on, and those whose outcome the database has
//! not committed.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::StoreError;
use super::audited_action::AuditedAction;

/// Outcomes that may wait to be stored, some megabytes. Beyond that, requests that would need a record are refused.
const MOST_ENDS: usize = 10_000;

/// How an audited action ended, and what it was done to.
#[derive(Clone, Debug)]
pub(super) struct End {
    pub object: String,
    pub outcome: String,
}

/// All of them, by the ids of their rows.
#[derive(Clone, Default)]
pub(super) struct OpenActions(Arc<Mutex<HashMap<String, Open>>>);

#[derive(Clone, Debug)]
pub(super) struct Open {
    pub audited: AuditedAction,
    /// When it began, ms since 1970 by the clock of the database; `None` where no row was made before it.
    pub at: Option<i64>,
    /// Where it has ended.
    pub end: Option<End>,
    /// Whether its outcome may be in the database already.
    pub was_told: bool,
}

/// An audited action without an outcome yet.
pub struct OpenAction {
    pub(super) id: String,
    open_actions: OpenActions,
    ended: bool,
}

impl OpenActions {
    pub fn begin(&self, id: &str, audited: &AuditedAction) -> OpenAction {
        let open = Open { audited: audited.clone(), at: None, end: None, was_told: false };
        self.lock().insert(id.to_owned(), open);
        OpenAction { id: id.to_owned(), open_actions: self.clone(), ended: false }
    }

    /// Remembers when the row of an audited action was made.
    pub fn began(&self, id: &str, at: i64) {
        if let Some(open) = self.lock().get_mut(id) {
            open.at = Some(at);
        }
    }

    /// Remembers how an audited action ended until its row tells it.
    pub fn end(&self, mut begun: OpenAction, end: End) -> String {
        begun.ended = true;
        if let Some(open) = self.lock().get_mut(&begun.id) {
            open.end = Some(end);
        }
        begun.id.clone()
    }

    /// Remembers an audited action that was over before anything of it was noted.
    pub fn over(&self, audited: AuditedAction, end: End) -> Result<(), StoreError> {
        let mut open_actions = self.lock();
        if open_actions.values().filter(|open| open.end.is_some()).count() >= MOST_ENDS {
            return Err(StoreError::Busy { most: MOST_ENDS });
        }
        let open = Open { audited, at: None, end: Some(end), was_told: false };
        open_actions.insert(uuid::Uuid::now_v7().to_string(), open);
        Ok(())
    }

    /// Marks an outcome as sent to the database; returns the earlier state.
    pub fn tell(&self, id: &str) -> Option<Open> {
        let mut open_actions = self.lock();
        let open = open_actions.get_mut(id)?;
        let before = open.clone();
        open.was_told = true;
        Some(before)
    }

    pub fn forget(&self, id: &str) {
        self.lock().remove(id);
    }

    /// The ids of those that have ended, or of those that go on.
    pub fn ids(&self, ended: bool) -> Vec<String> {
        let open_actions = self.lock();
        let wanted = open_actions.iter().filter(|(_, open)| open.end.is_some() == ended);
        wanted.map(|(id, _)| id.clone()).collect()
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<String, Open>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for OpenAction {
    /// An action dropped without an outcome becomes `unknown` after an hour.
    fn drop(&mut self) {
        if !self.ended {
            self.open_actions.forget(&self.id);
        }
    }
}
