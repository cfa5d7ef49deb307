//! Group commit of audit rows: all that wait are committed together, so that requests wait for one commit and not for
//! one another.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

use super::StoreError;
use super::audited_action::AuditedAction;
use super::database::{Database, Transaction};
use super::note_rows;
use super::open_actions::OpenActions;

/// Most of them in one transaction, for whose end others wait.
const AT_ONCE: usize = 100;

/// Whether an audited action is still to be begun; asked once, and where the answer is yes it is.
pub(super) type StartCondition = Box<dyn FnOnce() -> bool + Send + Sync>;

/// Rows to be written.
pub(super) enum Note {
    Begin { id: String, audited: AuditedAction },
    End { id: String },
}

/// Acknowledgement of a row. An action whose start was cancelled meanwhile gets none.
pub(super) type Acknowledgement = oneshot::Receiver<Result<(), StoreError>>;

type Acknowledger = oneshot::Sender<Result<(), StoreError>>;

/// A waiting row, with its acknowledgement.
struct Waiter {
    note: Note,
    is_wanted: StartCondition,
    teller: Acknowledger,
}

/// Those that wait.
#[derive(Clone, Default)]
pub(super) struct Notes {
    open_actions: OpenActions,
    waiting: Arc<Mutex<Waiting>>,
}

#[derive(Default)]
struct Waiting {
    notes: VecDeque<Waiter>,
    is_written: bool,
}

impl Notes {
    pub fn of(open_actions: OpenActions) -> Notes {
        Notes { open_actions, waiting: Arc::default() }
    }

    /// Notes it with all that wait meanwhile.
    pub fn note(
        &self,
        database: &Database,
        note: Note,
        is_wanted: StartCondition,
    ) -> Acknowledgement {
        let (teller, told) = oneshot::channel();
        self.lock().notes.push_back(Waiter { note, is_wanted, teller });
        if let Some(writing) = self.writing() {
            // A task of its own: its caller may disconnect while rows of others are written.
            tokio::spawn(writing.write(database.clone()));
        }
        told
    }

    /// The writer of all waiting rows, unless there is one already.
    fn writing(&self) -> Option<Writing> {
        let is_written = std::mem::replace(&mut self.lock().is_written, true);
        (!is_written).then(|| Writing { notes: self.clone(), is_over: false })
    }

    /// How many wait for the same tenant to begin something.
    pub fn waiting(&self, tenant: &str) -> usize {
        let is_his = |waiter: &&Waiter| match &waiter.note {
            Note::Begin { audited, .. } => audited.tenant == tenant && !waiter.teller.is_closed(),
            Note::End { .. } => false,
        };
        self.lock().notes.iter().filter(is_his).count()
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The writer of waiting rows, until none is left.
struct Writing {
    notes: Notes,
    /// Whether it has given up its role. The next writer may have begun since.
    is_over: bool,
}

impl Writing {
    async fn write(mut self, database: Database) {
        while let Some(group) = self.next() {
            let (notes, tellers): (Vec<Note>, Vec<Acknowledger>) = group.into_iter().unzip();
            let written = self.write_some(&database, &notes).await.map_err(Arc::new);
            for teller in tellers {
                // An error: the caller has disconnected.
                let _ = teller.send(written.clone().map_err(StoreError::OfMany));
            }
        }
    }

    /// The next rows to write, without cancelled ones.
    fn next(&mut self) -> Option<Vec<(Note, Acknowledger)>> {
        let mut waiting = self.notes.lock();
        let count = waiting.notes.len().min(AT_ONCE);
        if count == 0 {
            waiting.is_written = false;
            self.is_over = true;
            return None;
        }
        let group = waiting.notes.drain(..count).collect::<Vec<_>>();
        drop(waiting);
        let wanted = group
            .into_iter()
            .filter_map(|Waiter { note, is_wanted, teller }| is_wanted().then_some((note, teller)));
        Some(wanted.collect())
    }

    async fn write_some(&self, database: &Database, notes: &[Note]) -> Result<(), StoreError> {
        if notes.is_empty() {
            return Ok(());
        }
        let ends = notes.iter().any(|note| matches!(note, Note::End { .. }));
        // That something begins is on the disk before what is done; how it ended has nothing behind it.
        let mut transaction =
            if ends { database.begin().await? } else { database.begin_unflushed().await? };
        let mut begun = Vec::new();
        for note in notes {
            begun.extend(self.write_one(&mut transaction, note).await?);
        }
        transaction.commit().await?;
        for (id, at) in begun {
            self.notes.open_actions.began(id, at);
        }
        for note in notes {
            if let Note::End { id } = note {
                self.notes.open_actions.forget(id);
            }
        }
        Ok(())
    }

    /// When an audited action begins, where it does.
    async fn write_one<'a>(
        &self,
        transaction: &mut Transaction,
        note: &'a Note,
    ) -> Result<Option<(&'a str, i64)>, StoreError> {
        match note {
            Note::Begin { id, audited } => {
                let at = note_rows::begin(transaction, id, audited).await?;
                Ok(Some((id, at)))
            }
            Note::End { id } => {
                if let Some(open) = self.notes.open_actions.tell(id)
                    && let Some(end) = &open.end
                {
                    note_rows::end(transaction, id, &open, end).await?;
                }
                Ok(None)
            }
        }
    }
}

impl Drop for Writing {
    /// Where its runtime ended, the next who notes something goes on.
    fn drop(&mut self) {
        if !self.is_over {
            self.notes.lock().is_written = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_who_has_written_all_does_not_end_the_next_who_writes() {
        let notes = Notes::default();
        let mut first = notes.writing().expect("nobody writes");
        assert!(notes.writing().is_none(), "one writes at a time");
        assert!(first.next().is_none(), "nothing waits");
        let next = notes.writing().expect("the first has ended");
        drop(first);
        assert!(notes.writing().is_none(), "the next goes on");
        drop(next);
        assert!(notes.writing().is_some(), "where its runtime ended, another goes on");
    }
}
