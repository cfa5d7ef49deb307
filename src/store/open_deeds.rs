//! Deeds of this process that are not told to the audit log to their end: those that go on, and those whose end the database
//! did not take.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::deed::Deed;

/// How a deed ended, and what it was done to.
#[derive(Clone, Debug)]
pub(super) struct End {
    pub object: String,
    pub outcome: String,
}

/// All of them, by the ids of their rows.
#[derive(Clone, Default)]
pub(super) struct OpenDeeds(Arc<Mutex<HashMap<String, Open>>>);

#[derive(Clone, Debug)]
pub(super) struct Open {
    pub deed: Deed,
    /// Where it has ended.
    pub end: Option<End>,
}

/// A deed that was begun, to be told how it ended.
pub struct Begun {
    pub(super) id: String,
    deeds: OpenDeeds,
    ended: bool,
}

impl OpenDeeds {
    pub fn begin(&self, id: &str, deed: &Deed) -> Begun {
        self.lock().insert(id.to_owned(), Open { deed: deed.clone(), end: None });
        Begun { id: id.to_owned(), deeds: self.clone(), ended: false }
    }

    /// Remembers how a deed ended until its row tells it.
    pub fn end(&self, mut begun: Begun, end: End) -> String {
        begun.ended = true;
        if let Some(open) = self.lock().get_mut(&begun.id) {
            open.end = Some(end);
        }
        begun.id.clone()
    }

    pub fn get(&self, id: &str) -> Option<Open> {
        self.lock().get(id).cloned()
    }

    pub fn forget(&self, id: &str) {
        self.lock().remove(id);
    }

    /// The ids of those that have ended, or of those that go on.
    pub fn ids(&self, ended: bool) -> Vec<String> {
        let deeds = self.lock();
        let wanted = deeds.iter().filter(|(_, open)| open.end.is_some() == ended);
        wanted.map(|(id, _)| id.clone()).collect()
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<String, Open>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Begun {
    /// Where nobody says how it ended, its row says so by itself after an hour.
    fn drop(&mut self) {
        if !self.ended {
            self.deeds.forget(&self.id);
        }
    }
}
