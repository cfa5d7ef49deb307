//! Audited actions: recorded before they begin, and taken into the chain of the audit log once they have ended.

use super::audit::AuditRow;
use super::audited_action::AuditedAction;
use super::database::{Database, Row, query};
use super::notes::{Acknowledgement, Note, StartCondition};
use super::open_actions::{End, OpenAction};
use super::{Store, StoreError};

/// Outcome of an audited action without a reported one: its process died, or lost the database for an hour.
const UNKNOWN: &str = "unknown";

/// Open actions whose last sign of life is older than a minute.
const LIVED: &str =
    "SELECT id FROM deeds WHERE outcome IS NULL AND alive < (SELECT now_ms FROM clock) - 60000";
const LIVE: &str = "UPDATE deeds SET alive = (SELECT now_ms FROM clock) WHERE id = $1";
const ENDED: &str = "SELECT id, at, tenant, actor, action, object, request, outcome FROM deeds \
     WHERE outcome IS NOT NULL OR COALESCE(alive, at) < (SELECT now_ms FROM clock) - 3600000 \
     ORDER BY at, id LIMIT $1";
const FORGET: &str = "DELETE FROM deeds WHERE id = $1";
const FIRST_END: &str =
    "INSERT INTO audit_end (one, number, hash) VALUES (1, 0, '') ON CONFLICT (one) DO NOTHING";
/// One process at a time adds to the chain.
const HOLD_END: &str = "SELECT number, hash FROM audit_end WHERE one = 1 FOR UPDATE";
const APPEND: &str = "INSERT INTO audit \
     (number, at, tenant, actor, action, object, outcome, request, hash) \
     VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)";
const MOVE_END: &str = "UPDATE audit_end SET number = $1, hash = $2 WHERE one = 1";

/// Audited actions that are taken into the chain in one transaction, for whose end others wait.
const AT_ONCE: i64 = 100;

/// The line of writers in which the audit log stands. No tenant has such a name.
const LINE: &str = "the audit log";

impl Store {
    /// Records an action before it begins; without the record it must not begin. The record reaches the disk no later
    /// than the change.
    pub async fn begin_action(&self, audited: &AuditedAction) -> Result<OpenAction, StoreError> {
        self.begin_wanted(audited, Box::new(|| true)).await
    }

    /// The same where it is still wanted when its turn has come.
    pub(super) async fn begin_wanted(
        &self,
        audited: &AuditedAction,
        is_wanted: StartCondition,
    ) -> Result<OpenAction, StoreError> {
        let id = uuid::Uuid::now_v7().to_string();
        let begun = self.open_actions.begin(&id, audited);
        let note = Note::Begin { id, audited: audited.clone() };
        heard(self.notes.note(&self.of_audit(), note, is_wanted)).await?;
        Ok(begun)
    }

    /// Notes how it ended, and the id of what it was done to, which may not have been there before. What the database does
    /// not take is kept for `write_outcomes`; what it has taken is on its disk.
    pub async fn end_action(
        &self,
        begun: OpenAction,
        object: &str,
        outcome: &str,
    ) -> Result<(), StoreError> {
        let end = End { object: object.to_owned(), outcome: outcome.to_owned() };
        let id = self.open_actions.end(begun, end);
        heard(self.note_end(id)).await
    }

    /// Keeps for `write_outcomes` what was asked for and changed nothing. Nobody waits for its row, and nobody else does who
    /// writes.
    pub fn note_rejected(&self, audited: AuditedAction, outcome: &str) -> Result<(), StoreError> {
        let end = End { object: audited.object.clone(), outcome: outcome.to_owned() };
        self.open_actions.over(audited, end)
    }

    /// Says of the audited actions of this process that go on that it lives, and of those that have ended how, where the database did
    /// not take it before.
    pub async fn write_outcomes(&self) -> Result<(), StoreError> {
        let audit = self.of_audit();
        let ended = self.open_actions.ids(true).into_iter();
        for told in ended.map(|id| self.note_end(id)).collect::<Vec<_>>() {
            heard(told).await?;
        }
        let own = self.open_actions.ids(false);
        let silent = query(LIVED).fetch_all(audit.reader()).await?;
        let silent = silent.iter().map(|row| row.try_get(0)).collect::<Result<Vec<String>, _>>()?;
        for id in silent.iter().filter(|id| own.contains(id)) {
            query(LIVE).bind(id).execute(&audit.writer().await?).await?;
        }
        Ok(())
    }

    fn note_end(&self, id: String) -> Acknowledgement {
        self.notes.note(&self.of_audit(), Note::End { id }, Box::new(|| true))
    }

    /// The database for the audit log: a queue of its own, and no audit of its writes.
    fn of_audit(&self) -> Database {
        self.database.in_line(LINE)
    }

    /// Something that no request asks for.
    pub fn audited_action(&self, actor: &str, action: &str, object: &str) -> AuditedAction {
        AuditedAction {
            tenant: self.tenant().to_owned(),
            actor: actor.to_owned(),
            action: action.to_owned(),
            object: object.to_owned(),
            request: String::new(),
        }
    }

    /// Does it, noted before and after; the object is what it is done to, or what it makes.
    pub async fn noted<T>(
        &self,
        audited: AuditedAction,
        work: impl Future<Output = Result<T, StoreError>>,
        made: impl Fn(&T) -> Option<&String>,
    ) -> Result<T, StoreError> {
        let begun = self.begin_action(&audited).await?;
        let done = work.await;
        let outcome = if done.is_ok() { "done" } else { "failed" };
        let object = done.as_ref().ok().and_then(made).unwrap_or(&audited.object);
        self.end_action(begun, object, outcome).await?;
        done
    }

    /// Takes the audited actions that have ended into the chain; returns how many.
    pub async fn chain_actions(&self) -> Result<usize, StoreError> {
        let mut chained = 0;
        // Most often there is nothing, which a read shows without blocking writers.
        while !query(ENDED).bind(1).fetch_all(self.database.reader()).await?.is_empty() {
            chained += self.chain_some().await?;
        }
        Ok(chained)
    }

    async fn chain_some(&self) -> Result<usize, StoreError> {
        let mut transaction = self.of_audit().begin().await?;
        query(FIRST_END).execute(&mut transaction).await?;
        let end = query(HOLD_END).fetch_one(&mut transaction).await?;
        let (mut number, mut hash): (i64, String) = (end.try_get("number")?, end.try_get("hash")?);
        let ended = query(ENDED).bind(AT_ONCE).fetch_all(&mut transaction).await?;
        for row in &ended {
            number += 1;
            let row_of_log = next_row(row, number, &hash)?;
            query(APPEND)
                .bind(row_of_log.number)
                .bind(row_of_log.at)
                .bind(&row_of_log.audited.tenant)
                .bind(&row_of_log.audited.actor)
                .bind(&row_of_log.audited.action)
                .bind(&row_of_log.audited.object)
                .bind(&row_of_log.outcome)
                .bind(&row_of_log.audited.request)
                .bind(&row_of_log.hash)
                .execute(&mut transaction)
                .await?;
            query(FORGET).bind(row.try_get::<String, _>("id")?).execute(&mut transaction).await?;
            hash = row_of_log.hash;
        }
        query(MOVE_END).bind(number).bind(&hash).execute(&mut transaction).await?;
        transaction.commit().await?;
        Ok(ended.len())
    }
}

/// Waits for the acknowledgement of a row.
async fn heard(told: Acknowledgement) -> Result<(), StoreError> {
    told.await.unwrap_or(Err(StoreError::Interrupted))
}

/// The row of the log for an audited action that has ended.
fn next_row(audited: &Row, number: i64, hash_before: &str) -> Result<AuditRow, sqlx::Error> {
    let outcome: Option<String> = audited.try_get("outcome")?;
    let mut row = AuditRow {
        number,
        at: audited.try_get("at")?,
        audited: AuditedAction::of_row(audited)?,
        outcome: outcome.unwrap_or_else(|| UNKNOWN.to_owned()),
        hash: String::new(),
    };
    row.hash = row.hash_after(hash_before);
    Ok(row)
}
