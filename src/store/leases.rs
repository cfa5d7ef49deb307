//! Leases: the worker's side of jobs. A claim makes a lease with a token of its own; every later write names the token,
//! so that a worker which was thought dead and comes back changes nothing.

use std::time::Duration;

use bytes::Bytes;
use serde::Deserialize;

use super::cases::refer;
use super::database::{Statement, Transaction, query};
use super::engines::note_engine;
use super::events::record;
use super::made::MadeMesh;
use super::references::{Content, hashes};
use super::waiting::{MeshedCase, complete, fail_waiting, hold_case, hold_cases};
use super::{Store, StoreError};
use crate::schema::job::JobStatus;

/// The right of one attempt to write to its job.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Lease {
    pub job: String,
    pub token: String,
    pub attempt: i64,
}

/// Where a running job stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    pub phase: Option<&'static str>,
    pub progress: i64,
    pub iteration: Option<i64>,
    pub residual: Option<f64>,
}

/// A result file to be published.
#[derive(Clone, Debug)]
pub struct PublishedFile {
    pub name: String,
    pub media_type: String,
    pub sha256: String,
    pub bytes: Bytes,
}

/// The result of an attempt.
#[derive(Clone, Copy, Debug)]
pub struct Published<'a> {
    /// The manifest, JSON.
    pub result: &'a str,
    pub files: &'a [PublishedFile],
    pub meshes: &'a [MadeMesh],
    /// Of a meshing: the case that its mesh is made for, where one waits for it.
    pub case: Option<&'a MeshedCase>,
}

/// A result file.
#[derive(Clone, Debug)]
pub struct FileRow {
    pub name: String,
    pub media_type: String,
    pub blob: String,
    pub bytes: i64,
}

/// A job whose worker was lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostJob {
    pub job: String,
    pub attempt: i64,
    /// False: it has lost its worker too often and has failed.
    pub accepted_again: bool,
}

const RENEW: &str = "UPDATE jobs SET lease_expires = (SELECT now_ms FROM clock) + $3, \
     heartbeat = (SELECT now_ms FROM clock), updated = (SELECT now_ms FROM age_clock), phase = $4, \
     progress = CASE WHEN $5 > progress THEN $5 ELSE progress END, iteration = $6, residual = $7 \
     WHERE id = $1 AND status = 'running' AND lease_token = $2";
const HELD: &str = "SELECT 1 FROM jobs WHERE id = $1 AND status = 'running' AND lease_token = $2";
const STATUS: &str = "SELECT status FROM jobs WHERE id = $1";
const SUCCEED: &str = "UPDATE jobs SET status = 'successful', result = $3, progress = 100, \
     lease_token = NULL, lease_expires = NULL, phase = NULL, \
     finished = (SELECT now_ms FROM clock), updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND status = 'running' AND lease_token = $2";
const FAIL: &str = "UPDATE jobs SET status = 'failed', error = $3, error_class = $4, \
     lease_token = NULL, lease_expires = NULL, \
     finished = (SELECT now_ms FROM clock), updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND status = 'running' AND lease_token = $2";
const RELEASE: &str = "UPDATE jobs SET status = 'accepted', lease_token = NULL, lease_expires = NULL, \
     updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND status = 'running' AND lease_token = $2";
/// An attempt that failed through no fault of the job: accepted again after a pause, or failed for good.
const LOSE: &str = "UPDATE jobs SET losses = losses + 1, lease_token = NULL, lease_expires = NULL, \
     status = CASE WHEN losses + 1 >= $3 THEN 'failed' ELSE 'accepted' END, \
     error = CASE WHEN losses + 1 >= $3 THEN $4 END, \
     error_class = CASE WHEN losses + 1 >= $3 THEN $6 END, \
     finished = CASE WHEN losses + 1 >= $3 THEN (SELECT now_ms FROM clock) END, \
     claimable_from = (SELECT now_ms FROM clock) + $5 * (losses + 1), \
     updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND status = 'running' AND lease_token = $2";
const REAP: &str = "UPDATE jobs SET losses = losses + 1, lease_token = NULL, lease_expires = NULL, \
     status = CASE WHEN losses + 1 >= $1 THEN 'failed' ELSE 'accepted' END, \
     error = CASE WHEN losses + 1 >= $1 THEN $2 END, \
     error_class = CASE WHEN losses + 1 >= $1 THEN $3 END, \
     finished = CASE WHEN losses + 1 >= $1 THEN (SELECT now_ms FROM clock) END, \
     updated = (SELECT now_ms FROM age_clock) \
     WHERE id IN (SELECT id FROM jobs WHERE status = 'running' \
       AND lease_expires < $4 FOR UPDATE SKIP LOCKED) \
     RETURNING id, attempt, status";
/// Leases and pauses from before the clock went back keep their length from now on.
const CLOCK_WENT_BACK: [&str; 2] = [
    "UPDATE jobs SET lease_expires = lease_expires - heartbeat + (SELECT now_ms FROM clock), \
     heartbeat = (SELECT now_ms FROM clock) \
     WHERE id IN (SELECT id FROM jobs \
       WHERE status = 'running' AND heartbeat > (SELECT now_ms FROM clock) ORDER BY id FOR UPDATE)",
    "UPDATE jobs SET claimable_from = claimable_from - updated + (SELECT now_ms FROM clock), \
     updated = (SELECT now_ms FROM age_clock) \
     WHERE id IN (SELECT id FROM jobs WHERE status = 'accepted' AND claimable_from > updated \
       AND updated > (SELECT now_ms FROM clock) ORDER BY id FOR UPDATE)",
];
const INSERT_FILE: &str =
    "INSERT INTO job_files (job_id, name, media_type, blob, bytes) VALUES ($1, $2, $3, $4, $5)";
const FILE: &str = "SELECT name, media_type, blob, bytes FROM job_files WHERE job_id = $1 AND name = $2 \
     AND EXISTS (SELECT 1 FROM jobs WHERE jobs.id = $1 AND jobs.tenant = $3)";

impl Store {
    /// Keeps a job and tells where it stands; false when it is not ours any more.
    pub async fn renew(
        &self,
        lease: &Lease,
        length: Duration,
        point: &Point,
    ) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        let renewed = query(RENEW)
            .bind(&lease.job)
            .bind(&lease.token)
            .bind(milliseconds(length))
            .bind(point.phase)
            .bind(point.progress)
            .bind(point.iteration)
            .bind(point.residual)
            .execute(&mut transaction)
            .await?;
        if renewed == 1 {
            record(&mut transaction, &lease.job).await?;
        }
        transaction.commit().await?;
        self.job_changed(&lease.job);
        Ok(renewed == 1)
    }

    /// Whether a job is ours still.
    pub async fn holds(&self, lease: &Lease) -> Result<bool, StoreError> {
        let row = query(HELD)
            .bind(&lease.job)
            .bind(&lease.token)
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.is_some())
    }

    /// Whether a job was dismissed or erased.
    pub async fn is_dismissed(&self, job: &str) -> Result<bool, StoreError> {
        let row = query(STATUS).bind(job).fetch_optional(self.database.reader()).await?;
        let Some(row) = row else { return Ok(true) };
        Ok(row.try_get::<String, _>(0)? == JobStatus::Dismissed.name())
    }

    /// Publishes the result of an attempt, all of it or, when the job is not ours any more, nothing: bytes first, then one
    /// transaction. The store has to be scoped to the job's tenant.
    pub async fn publish(&self, lease: &Lease, made: Published<'_>) -> Result<bool, StoreError> {
        let mut contents: Vec<Content> = Vec::new();
        for file in made.files {
            contents.push((file.sha256.clone(), file.bytes.clone()));
        }
        for MadeMesh { mesh, .. } in made.meshes.iter().filter(|made| made.is_as_stored()) {
            contents.push((mesh.blob.clone(), mesh.bytes.clone()));
        }
        let blobs = hashes(&contents);
        let mut transaction = self.begin_with(contents).await?;
        match self.insert_result(&mut transaction, lease, made).await {
            Ok(true) => {
                transaction.commit().await?;
                self.job_changed(&lease.job);
                Ok(true)
            }
            given_up @ (Ok(false) | Err(StoreError::Contended)) => {
                transaction.rollback().await;
                self.discard(blobs).await;
                given_up
            }
            Err(error) => Err(error),
        }
    }

    async fn insert_result(
        &self,
        transaction: &mut Transaction,
        lease: &Lease,
        made: Published<'_>,
    ) -> Result<bool, StoreError> {
        if made.case.is_some() {
            hold_case(transaction, &lease.job).await?;
        }
        let published = query(SUCCEED)
            .bind(&lease.job)
            .bind(&lease.token)
            .bind(made.result)
            .execute(&mut *transaction)
            .await?;
        if published != 1 {
            return Ok(false);
        }
        for file in made.files {
            query(INSERT_FILE)
                .bind(&lease.job)
                .bind(&file.name)
                .bind(&file.media_type)
                .bind(&file.sha256)
                .bind(file.bytes.len() as i64)
                .execute(&mut *transaction)
                .await?;
        }
        let mut completed = None;
        if let Some(case) = made.case {
            completed = complete(transaction, &lease.job, case).await?;
        }
        let others = made.case.map_or(&[][..], |case| &case.mesh_ids);
        self.insert_made(transaction, &lease.job, made.meshes, others).await?;
        if let Some(case) = completed {
            refer(transaction, &case, others).await?;
        }
        note_engine(transaction, &lease.job, made.result).await?;
        record(transaction, &lease.job).await?;
        Ok(true)
    }

    /// Ends a job whose own fault it is; false when it is not ours any more.
    pub async fn fail(&self, lease: &Lease, error: &str) -> Result<bool, StoreError> {
        let query = query(FAIL).bind(&lease.job).bind(&lease.token).bind(error);
        self.end(lease, query.bind(class_of(error))).await
    }

    /// Gives a job back untouched, for a worker that is about to stop.
    pub async fn release(&self, lease: &Lease) -> Result<bool, StoreError> {
        self.end(lease, query(RELEASE).bind(&lease.job).bind(&lease.token)).await
    }

    /// Gives a job back that failed through no fault of its own, or fails it when that was the last attempt. The next one comes after
    /// `pause`, times the losses so far.
    pub async fn lose(
        &self,
        lease: &Lease,
        attempts: u32,
        pause: Duration,
        error: &str,
    ) -> Result<bool, StoreError> {
        let query = query(LOSE)
            .bind(&lease.job)
            .bind(&lease.token)
            .bind(i64::from(attempts))
            .bind(error)
            .bind(milliseconds(pause))
            .bind(class_of(error));
        self.end(lease, query).await
    }

    async fn end(&self, lease: &Lease, query: Statement) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        hold_case(&mut transaction, &lease.job).await?;
        let changed = query.execute(&mut transaction).await?;
        let mut waited = Vec::new();
        if changed == 1 {
            record(&mut transaction, &lease.job).await?;
            waited = fail_waiting(&mut transaction, &lease.job).await?;
        }
        transaction.commit().await?;
        self.job_changed(&lease.job);
        waited.iter().for_each(|job| self.job_changed(job));
        Ok(changed == 1)
    }

    /// Takes jobs from workers that gave no sign of life for a lease, however the clock was set meanwhile. `error` is for those
    /// that this happened to `attempts` times.
    pub async fn reap(&self, attempts: u32, error: &str) -> Result<Vec<LostJob>, StoreError> {
        for keep in CLOCK_WENT_BACK {
            query(keep).execute(&self.database.writer().await?).await?;
        }
        let mut transaction = self.database.begin().await?;
        let now = hold_cases(&mut transaction).await?;
        let rows = query(REAP)
            .bind(i64::from(attempts))
            .bind(error)
            .bind(class_of(error))
            .bind(now)
            .fetch_all(&mut transaction)
            .await?;
        let mut waited = Vec::new();
        for row in &rows {
            let id: String = row.try_get("id")?;
            record(&mut transaction, &id).await?;
            waited.extend(fail_waiting(&mut transaction, &id).await?);
        }
        transaction.commit().await?;
        let mut reaped = Vec::with_capacity(rows.len());
        for row in &rows {
            reaped.push(LostJob {
                job: row.try_get("id")?,
                attempt: row.try_get("attempt")?,
                accepted_again: row.try_get::<String, _>("status")? == "accepted",
            });
        }
        reaped
            .iter()
            .map(|reaped| &reaped.job)
            .chain(&waited)
            .for_each(|job| self.job_changed(job));
        Ok(reaped)
    }

    /// One file of a successful job.
    pub async fn job_file(&self, job: &str, name: &str) -> Result<Option<FileRow>, StoreError> {
        let row = query(FILE)
            .bind(job)
            .bind(name)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        let Some(row) = row else { return Ok(None) };
        Ok(Some(FileRow {
            name: row.try_get("name")?,
            media_type: row.try_get("media_type")?,
            blob: row.try_get("blob")?,
            bytes: row.try_get("bytes")?,
        }))
    }
}

/// Class of an error, as its document says.
fn class_of(error: &str) -> Option<String> {
    #[derive(Deserialize)]
    struct Classed {
        class: String,
    }
    serde_json::from_str(error).ok().map(|Classed { class }| class)
}

pub(super) fn milliseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_millis()).unwrap_or(i64::MAX)
}
