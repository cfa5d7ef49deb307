//! Jobs as clients see them: accepted, looked at, listed, dismissed, removed.

use super::cases::AFTER_ALL;
use super::database::{Row, Transaction, is_reference, query};
use super::events::record;
use super::made::made_by;
use super::{Store, StoreError, tenants};
use crate::schema::job::JobStatus;

/// A job to be accepted.
#[derive(Clone, Debug)]
pub struct NewJob {
    pub id: String,
    pub kind: &'static str,
    /// Of the accepted jobs of a tenant those with the smallest are claimed first.
    pub priority: i64,
    pub case_id: Option<String>,
    /// All cases of a job that reads several; it goes when one of them is erased.
    pub shared_cases: Vec<String>,
    /// Everything the job needs, resolved.
    pub document: String,
    pub spec_hash: String,
    pub engine: String,
    pub tags: Vec<String>,
    /// The meshes that have to stay while the job is there.
    pub mesh_ids: Vec<String>,
    /// Where in a trace it is accepted, where there is one.
    pub traceparent: Option<String>,
}

/// What became of a job that was to be accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Enqueued {
    Accepted,
    /// The same inputs are the job of this id already.
    Known(String),
    QueueFull,
    /// The case or a mesh went meanwhile.
    InputGone,
}

#[derive(Clone, Debug)]
pub struct JobRow {
    pub id: String,
    pub kind: String,
    pub case_id: Option<String>,
    pub spec_hash: String,
    pub engine: String,
    pub status: JobStatus,
    pub phase: Option<String>,
    pub progress: i64,
    pub iteration: Option<i64>,
    pub residual: Option<f64>,
    pub attempt: i64,
    /// JSON with `type` and `detail`.
    pub error: Option<String>,
    /// The manifest, JSON.
    pub result: Option<String>,
    pub created: i64,
    pub started: Option<i64>,
    pub finished: Option<i64>,
    pub updated: i64,
    pub tags: Vec<String>,
    /// How many accepted jobs stand before this one, where it is accepted itself.
    pub queue_position: Option<i64>,
}

/// Which jobs to list; an empty text asks for all.
#[derive(Clone, Debug, Default)]
pub struct JobFilter {
    pub status: String,
    pub kind: String,
    pub tag: String,
    pub case_id: String,
    pub cursor: Option<String>,
    pub limit: i64,
}

/// What became of a request to dismiss or remove.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dismissal {
    Dismissed,
    /// It had ended and is gone.
    Removed,
    NotFound,
}

/// Tags hold no control characters, so that lines keep them apart.
macro_rules! columns {
    () => {
        "SELECT id, kind, case_id, spec_hash, engine, status, phase, progress, iteration, residual, \
         attempt, error, result, created, started, finished, updated, \
         CASE WHEN status = 'accepted' THEN (SELECT COUNT(*) FROM jobs AS before \
           WHERE before.status = 'accepted' AND before.tenant = jobs.tenant AND before.priority <= jobs.priority \
           AND (before.priority < jobs.priority OR before.id < jobs.id)) END AS queue_position, \
         (SELECT string_agg(tag, '\n' ORDER BY tag) FROM job_tags WHERE job_tags.job_id = jobs.id) AS tags \
         FROM jobs WHERE "
    };
}

const BY_ID: &str = concat!(columns!(), "id = $1 AND tenant = $2");
const LIST: &str = concat!(
    columns!(),
    "tenant = $7 AND id < $1 AND ($2 = '' OR status = $2) AND ($3 = '' OR kind = $3) \
     AND ($4 = '' OR EXISTS (SELECT 1 FROM job_tags WHERE job_tags.job_id = jobs.id AND job_tags.tag = $4)) \
     AND ($5 = '' OR case_id = $5) ORDER BY id DESC LIMIT $6"
);
const KNOWN: &str = "SELECT id FROM jobs WHERE spec_hash = $1 AND tenant = $2";
const INSERT: &str = "INSERT INTO jobs (id, kind, case_id, document, spec_hash, engine, tenant, priority, \
     traceparent, status, progress, attempt, losses, claimable_from, created, updated) \
     VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, 'accepted', 0, 0, 0, 0, \
       (SELECT now_ms FROM clock), (SELECT now_ms FROM clock)) \
     ON CONFLICT (spec_hash) DO NOTHING";
const DISMISS: &str = "UPDATE jobs SET status = 'dismissed', lease_token = NULL, lease_expires = NULL, \
     finished = (SELECT now_ms FROM clock), updated = (SELECT now_ms FROM clock) \
     WHERE id = $1 AND tenant = $2 AND status IN ('accepted', 'running')";
const FILES: &str = "SELECT job_files.blob FROM job_files JOIN jobs ON jobs.id = job_files.job_id \
     WHERE jobs.id = $1 AND jobs.tenant = $2";
const REMOVE: &str = "DELETE FROM jobs WHERE id = $1 AND tenant = $2 AND status IN ('successful', 'failed', 'dismissed')";

fn job_row(row: &Row) -> Result<JobRow, sqlx::Error> {
    let status: String = row.try_get("status")?;
    let tags: String = row.try_get::<Option<_>, _>("tags")?.unwrap_or_default();
    Ok(JobRow {
        id: row.try_get("id")?,
        kind: row.try_get("kind")?,
        case_id: row.try_get("case_id")?,
        spec_hash: tenants::plain(row.try_get("spec_hash")?),
        engine: row.try_get("engine")?,
        status: JobStatus::from_name(&status)
            .ok_or_else(|| sqlx::Error::Decode(format!("job status `{status}`").into()))?,
        phase: row.try_get("phase")?,
        progress: row.try_get("progress")?,
        iteration: row.try_get("iteration")?,
        residual: row.try_get("residual")?,
        attempt: row.try_get("attempt")?,
        error: row.try_get("error")?,
        result: row.try_get("result")?,
        created: row.try_get("created")?,
        started: row.try_get("started")?,
        finished: row.try_get("finished")?,
        updated: row.try_get("updated")?,
        tags: tags.lines().map(str::to_owned).collect(),
        queue_position: row.try_get("queue_position")?,
    })
}

impl Store {
    pub async fn job(&self, id: &str) -> Result<Option<JobRow>, StoreError> {
        let row = query(BY_ID)
            .bind(id)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.as_ref().map(job_row).transpose()?)
    }

    /// Jobs newest first.
    pub async fn jobs(&self, filter: &JobFilter) -> Result<Vec<JobRow>, StoreError> {
        let rows = query(LIST)
            .bind(filter.cursor.as_deref().unwrap_or(AFTER_ALL))
            .bind(&filter.status)
            .bind(&filter.kind)
            .bind(&filter.tag)
            .bind(&filter.case_id)
            .bind(filter.limit)
            .bind(self.tenant())
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(job_row).collect::<Result<_, _>>()?)
    }

    /// Accepts a job, unless one with the same inputs is known.
    pub async fn enqueue(&self, job: &NewJob, longest_queue: i64) -> Result<Enqueued, StoreError> {
        let mut transaction = self.database.begin().await?;
        let known = query(KNOWN)
            .bind(self.own(&job.spec_hash))
            .bind(self.tenant())
            .fetch_optional(&mut transaction)
            .await?;
        if let Some(row) = known {
            return Ok(Enqueued::Known(row.try_get(0)?));
        }
        let waiting = query("SELECT COUNT(*) FROM jobs WHERE tenant = $1 AND status = 'accepted'")
            .bind(self.tenant())
            .fetch_one(&mut transaction)
            .await?;
        if waiting.try_get::<i64, _>(0)? >= longest_queue {
            return Ok(Enqueued::QueueFull);
        }
        self.enter(&mut transaction).await?;
        match self.insert_job(&mut transaction, job).await {
            Ok(true) => {
                record(&mut transaction, &job.id).await?;
                transaction.commit().await?;
                self.jobs_changed();
                Ok(Enqueued::Accepted)
            }
            // Another request with the same inputs came between the question and the answer.
            Ok(false) => {
                transaction.rollback().await?;
                self.known(job).await
            }
            Err(error) if is_reference(&error) => Ok(Enqueued::InputGone),
            Err(error) => Err(error.into()),
        }
    }

    /// The job that was accepted in place of this one.
    async fn known(&self, job: &NewJob) -> Result<Enqueued, StoreError> {
        let known = query(KNOWN)
            .bind(self.own(&job.spec_hash))
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        let id = known.ok_or(StoreError::Contended)?.try_get(0)?;
        Ok(Enqueued::Known(id))
    }

    /// Ends a job that is accepted or running, removes one that has ended, with the meshes that it made and that nothing
    /// else refers to.
    pub async fn dismiss(&self, id: &str) -> Result<Dismissal, StoreError> {
        let mut transaction = self.database.begin().await?;
        let dismissed =
            query(DISMISS).bind(id).bind(self.tenant()).execute(&mut transaction).await?;
        if dismissed == 1 {
            record(&mut transaction, id).await?;
            transaction.commit().await?;
            self.jobs_changed();
            return Ok(Dismissal::Dismissed);
        }
        let rows = query(FILES).bind(id).bind(self.tenant()).fetch_all(&mut transaction).await?;
        let mut blobs =
            rows.iter().map(|row| row.try_get(0)).collect::<Result<Vec<String>, _>>()?;
        let made = made_by(&mut transaction, id).await?;
        let removed = query(REMOVE).bind(id).bind(self.tenant()).execute(&mut transaction).await?;
        if removed == 1 {
            self.bury(&mut transaction, id).await?;
            blobs.extend(self.remove_unused(&mut transaction, made).await?);
        }
        transaction.commit().await?;
        self.jobs_changed();
        self.discard(blobs).await;
        Ok(match removed {
            0 => Dismissal::NotFound,
            _ => Dismissal::Removed,
        })
    }

    /// False when a job with the same inputs was there before.
    async fn insert_job(
        &self,
        transaction: &mut Transaction,
        job: &NewJob,
    ) -> Result<bool, sqlx::Error> {
        let inserted = query(INSERT)
            .bind(&job.id)
            .bind(job.kind)
            .bind(&job.case_id)
            .bind(&job.document)
            .bind(self.own(&job.spec_hash))
            .bind(&job.engine)
            .bind(self.tenant())
            .bind(job.priority)
            .bind(&job.traceparent)
            .execute(&mut *transaction)
            .await?;
        if inserted == 0 {
            return Ok(false);
        }
        for tag in &job.tags {
            query("INSERT INTO job_tags (job_id, tag) VALUES ($1, $2) ON CONFLICT DO NOTHING")
                .bind(&job.id)
                .bind(tag)
                .execute(&mut *transaction)
                .await?;
        }
        for case in &job.shared_cases {
            query("INSERT INTO job_cases (job_id, case_id) VALUES ($1, $2) ON CONFLICT DO NOTHING")
                .bind(&job.id)
                .bind(case)
                .execute(&mut *transaction)
                .await?;
        }
        for mesh in &job.mesh_ids {
            query(
                "INSERT INTO job_meshes (job_id, mesh_id) VALUES ($1, $2) ON CONFLICT DO NOTHING",
            )
            .bind(&job.id)
            .bind(mesh)
            .execute(&mut *transaction)
            .await?;
        }
        Ok(true)
    }
}
