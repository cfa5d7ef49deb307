//! Events of a job: each visible state, written in the transaction that changed it, so that a later reader misses none.

use super::database::{Transaction, query};
use super::{Store, StoreError};
use crate::schema::job::JobStatus;

/// A state that a job was in.
#[derive(Clone, Debug, PartialEq)]
pub struct EventRow {
    /// From 1, without gaps.
    pub number: i64,
    pub at: i64,
    pub status: JobStatus,
    pub phase: Option<String>,
    pub progress: i64,
    pub iteration: Option<i64>,
    pub residual: Option<f64>,
    pub attempt: i64,
}

/// No row where the last event says the same. Every change locks the row of its job, so that numbers are unique.
const RECORD: &str = "INSERT INTO job_events \
     (job_id, number, at, status, phase, progress, iteration, residual, attempt) \
     SELECT jobs.id, COALESCE(last.number, 0) + 1, jobs.updated, jobs.status, jobs.phase, \
       jobs.progress, jobs.iteration, jobs.residual, jobs.attempt \
     FROM jobs LEFT JOIN job_events AS last ON last.job_id = jobs.id \
       AND last.number = (SELECT MAX(number) FROM job_events WHERE job_id = $1) \
     WHERE jobs.id = $1 AND (last.number IS NULL OR last.status <> jobs.status \
       OR COALESCE(last.phase, '') <> COALESCE(jobs.phase, '') \
       OR last.progress <> jobs.progress OR last.attempt <> jobs.attempt \
       OR COALESCE(last.iteration, 0) <> COALESCE(jobs.iteration, 0))";
/// A study of many rows changes its phase thousands of times; the last thousand are enough to come back to.
const FORGET: &str = "DELETE FROM job_events WHERE job_id = $1 AND number <= \
     (SELECT MAX(number) FROM job_events WHERE job_id = $1) - 1000";
const AFTER: &str = "SELECT number, at, status, phase, progress, iteration, residual, attempt \
     FROM job_events WHERE job_id = $1 AND number > $2 \
     AND EXISTS (SELECT 1 FROM jobs WHERE id = $1 AND tenant = $3) ORDER BY number";

/// Writes down the state of a job, if it is another than the last one.
pub(super) async fn record(transaction: &mut Transaction, job: &str) -> Result<(), sqlx::Error> {
    let recorded = query(RECORD).bind(job).execute(&mut *transaction).await?;
    if recorded > 0 {
        query(FORGET).bind(job).execute(&mut *transaction).await?;
    }
    Ok(())
}

impl Store {
    /// The events of a job after a number; `None` where there is no such job.
    pub async fn job_events(
        &self,
        job: &str,
        after: i64,
    ) -> Result<Option<Vec<EventRow>>, StoreError> {
        let rows = query(AFTER)
            .bind(job)
            .bind(after)
            .bind(self.tenant())
            .fetch_all(self.database.reader())
            .await?;
        if rows.is_empty() {
            let found = query("SELECT 1 FROM jobs WHERE id = $1 AND tenant = $2")
                .bind(job)
                .bind(self.tenant())
                .fetch_optional(self.database.reader())
                .await?;
            return Ok(found.map(|_| Vec::new()));
        }
        let mut events = Vec::with_capacity(rows.len());
        for row in &rows {
            let status: String = row.try_get("status")?;
            events.push(EventRow {
                number: row.try_get("number")?,
                at: row.try_get("at")?,
                status: JobStatus::from_name(&status).ok_or_else(|| {
                    sqlx::Error::Decode(
                        format!("status `{status}` of an event of job {job}").into(),
                    )
                })?,
                phase: row.try_get("phase")?,
                progress: row.try_get("progress")?,
                iteration: row.try_get("iteration")?,
                residual: row.try_get("residual")?,
                attempt: row.try_get("attempt")?,
            });
        }
        Ok(Some(events))
    }

    /// Writes down the state of a job that was accepted before events were.
    pub async fn record_job(&self, job: &str) -> Result<(), StoreError> {
        let mut transaction = self.database.begin().await?;
        // Every change of a job, and every event, locks its row.
        let lock = query("SELECT 1 FROM jobs WHERE id = $1 FOR UPDATE").bind(job);
        lock.fetch_optional(&mut transaction).await?;
        record(&mut transaction, job).await?;
        transaction.commit().await?;
        Ok(())
    }
}
