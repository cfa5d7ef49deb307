//! Audit intent of a request: recorded before its first change. Until then its client may disconnect and end it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use futures::future::BoxFuture;
use tokio::sync::watch;

use super::audited_action::AuditedAction;
use super::database::BeforeWriting;
use super::open_actions::OpenAction;
use super::{Store, StoreError};

/// The audit intent of one request, and its stage.
#[derive(Clone)]
pub struct AuditIntent(Arc<Inner>);

struct Inner {
    store: Store,
    audited: AuditedAction,
    stage: Mutex<Stage>,
    /// Serialises first writes, so that the intent is recorded once.
    alone: tokio::sync::Mutex<()>,
    has_left: watch::Sender<bool>,
}

enum Stage {
    NothingDone,
    /// Its note is written at this moment.
    Noted,
    Begun(OpenAction),
    Ended,
    /// Its client left before anything was done.
    Left,
}

impl Store {
    /// A request that may change something.
    pub fn audit_intent(&self, audited: AuditedAction) -> AuditIntent {
        AuditIntent(Arc::new(Inner {
            store: self.clone(),
            audited,
            stage: Mutex::new(Stage::NothingDone),
            alone: tokio::sync::Mutex::default(),
            has_left: watch::Sender::new(false),
        }))
    }

    /// The same store scoped to the tenant of a request: it takes turns with other tenants when it writes, after the
    /// intent was recorded, if there is one.
    pub fn asked_by(&self, tenant: &str, intent: Option<&AuditIntent>) -> Store {
        let database = self.database.in_line(tenant);
        let database = match intent {
            Some(intent) => database.after(Arc::new(intent.clone())),
            None => database,
        };
        Store { database, ..self.of_tenant(tenant) }
    }
}

impl BeforeWriting for AuditIntent {
    fn prepare(&self) -> BoxFuture<'_, Result<(), StoreError>> {
        Box::pin(self.begin())
    }
}

impl AuditIntent {
    /// Records the intent, once.
    pub async fn begin(&self) -> Result<(), StoreError> {
        let _alone = self.0.alone.lock().await;
        if !matches!(*self.0.lock(), Stage::NothingDone) {
            return Ok(());
        }
        self.0.refuse_too_many()?;
        let own = self.0.clone();
        let is_wanted = Box::new(move || own.claim_intent());
        let begun = self.0.store.begin_wanted(&self.0.audited, is_wanted).await;
        let mut stage = self.0.lock();
        match begun {
            Ok(begun) => {
                *stage = Stage::Begun(begun);
                Ok(())
            }
            Err(error) => {
                *stage = Stage::NothingDone;
                Err(error)
            }
        }
    }

    /// Marks that the client disconnected. False where a change was begun, which goes on.
    pub fn leave(&self) -> bool {
        self.0.has_left.send_replace(true);
        let mut stage = self.0.lock();
        let may_leave = matches!(*stage, Stage::NothingDone | Stage::Left);
        if may_leave {
            *stage = Stage::Left;
        }
        may_leave
    }

    /// Waits until the client disconnects.
    pub async fn left(&self) {
        // The sender lives as long as `self`.
        let _ = self.0.has_left.subscribe().wait_for(|left| *left).await;
    }

    /// Notes how it ended. What changed nothing is noted soon, where it `is_told` at all; an error means that it cannot be.
    pub async fn end(&self, object: &str, outcome: &str, is_told: bool) -> Result<(), StoreError> {
        let stage = std::mem::replace(&mut *self.0.lock(), Stage::Ended);
        match stage {
            Stage::Begun(begun) => {
                if let Err(error) = self.0.store.end_action(begun, object, outcome).await {
                    tracing::error!(%error, "the audit log is told later how a request ended");
                }
                Ok(())
            }
            Stage::NothingDone if is_told => {
                let audited = AuditedAction { object: object.to_owned(), ..self.0.audited.clone() };
                self.0.store.note_rejected(audited, outcome)
            }
            Stage::NothingDone | Stage::Noted | Stage::Ended | Stage::Left => Ok(()),
        }
    }

    /// What it is done to, as far as its address says so.
    pub fn object(&self) -> &str {
        &self.0.audited.object
    }
}

impl Inner {
    fn refuse_too_many(&self) -> Result<(), StoreError> {
        let (most, tenant) = (self.store.most_waiting, &self.audited.tenant);
        let writing = self.store.database.in_line(tenant).waiting();
        match self.store.notes.waiting(tenant) + writing >= most {
            true => Err(StoreError::Busy { most }),
            false => Ok(()),
        }
    }

    /// Claims the right to record the intent; false where the client has disconnected or it was recorded.
    fn claim_intent(&self) -> bool {
        let mut stage = self.lock();
        let is_wanted = matches!(*stage, Stage::NothingDone);
        if is_wanted {
            *stage = Stage::Noted;
        }
        is_wanted
    }

    fn lock(&self) -> MutexGuard<'_, Stage> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
