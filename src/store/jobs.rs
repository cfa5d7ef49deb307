//! Jobs for clients: read, listed, dismissed, removed.

use super::cases::AFTER_ALL;
use super::database::{Row, Transaction, query};
use super::events::record;
use super::made::{column, meshes_of_job};
use super::membership::{Leaving, forget_model, hold_cohorts, leave};
use super::waiting::{fail_waiting, hold_case};
use super::{Store, StoreError, tenants};
use crate::schema::job::JobStatus;

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
    /// Of a study, JSON.
    pub truths: Option<String>,
    pub created: i64,
    pub started: Option<i64>,
    pub finished: Option<i64>,
    pub updated: i64,
    pub tags: Vec<String>,
    /// The meshing of its case that it waits for.
    pub waits_for: Option<String>,
    /// How many accepted jobs stand before this one, where it could be claimed itself.
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

/// Outcome of a dismissal or removal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dismissal {
    Dismissed,
    /// It had ended and is gone.
    Removed,
    NotFound,
}

/// The jobs that a condition finds, newest first. Those that wait have their place in the queue of their tenant: the jobs
/// between them and the one before them on the page, added up, so that each that waits is counted once for the page and
/// not once for each of its rows. Tags hold no control characters, so that lines keep them apart.
macro_rules! found {
    ($condition:literal) => {
        concat!(
            "WITH page AS MATERIALIZED (SELECT id, tenant, priority, kind, case_id, spec_hash, engine, status, phase, \
               progress, iteration, residual, attempt, error, result, truths, created, started, finished, updated, \
               waits_for FROM jobs WHERE ",
            $condition,
            "), \
             places AS MATERIALIZED (SELECT page.*, \
               LAG(id) OVER (PARTITION BY status, waits_for, priority ORDER BY id) AS last FROM page), \
             steps AS MATERIALIZED (SELECT places.*, CASE WHEN status = 'accepted' AND waits_for = '' THEN \
                 (SELECT COUNT(*) FROM jobs WHERE jobs.tenant = places.tenant \
                   AND jobs.status = 'accepted' AND jobs.waits_for = '' AND jobs.priority = places.priority \
                   AND jobs.id >= COALESCE(places.last, '') AND jobs.id < places.id || '') \
                 + CASE WHEN last IS NULL THEN (SELECT COUNT(*) FROM jobs WHERE jobs.tenant = places.tenant \
                   AND jobs.status = 'accepted' AND jobs.waits_for = '' \
                   AND jobs.priority < places.priority) ELSE 0 END \
               END AS step FROM places) \
             SELECT id, kind, case_id, spec_hash, engine, status, phase, progress, iteration, residual, \
               attempt, error, result, truths, created, started, finished, updated, waits_for, \
               CAST(SUM(step) OVER (PARTITION BY status, waits_for, priority ORDER BY id) AS BIGINT) AS queue_position, \
               (SELECT string_agg(tag, '\n' ORDER BY tag) FROM job_tags WHERE job_tags.job_id = steps.id) AS tags \
             FROM steps ORDER BY id DESC"
        )
    };
}

const BY_ID: &str = found!("id = $1 AND tenant = $2");
const LIST: &str = found!(
    "tenant = $7 AND id < $1 AND ($2 = '' OR status = $2) AND ($3 = '' OR kind = $3) \
     AND ($4 = '' OR EXISTS (SELECT 1 FROM job_tags WHERE job_tags.job_id = jobs.id AND job_tags.tag = $4)) \
     AND ($5 = '' OR case_id = $5 \
       OR EXISTS (SELECT 1 FROM job_cases WHERE job_cases.job_id = jobs.id AND job_cases.case_id = $5)) \
     ORDER BY id DESC LIMIT $6"
);
const DOCUMENT: &str = "SELECT document FROM jobs WHERE id = $1 AND tenant = $2";
const STATUS: &str = "SELECT status FROM jobs WHERE id = $1 AND tenant = $2";
const CASES: &str = "SELECT case_id FROM jobs WHERE id = $1 AND tenant = $2 AND case_id IS NOT NULL \
     UNION SELECT job_cases.case_id FROM job_cases JOIN jobs ON jobs.id = job_cases.job_id \
       WHERE jobs.id = $1 AND jobs.tenant = $2";
const WITH_ROWS: &str = "SELECT id FROM jobs WHERE rows_key = $1 AND tenant = $2 AND status = 'successful' \
     ORDER BY id DESC LIMIT 8";
const DISMISS: &str = "UPDATE jobs SET status = 'dismissed', lease_token = NULL, lease_expires = NULL, \
     finished = (SELECT now_ms FROM clock), updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND tenant = $2 AND status IN ('accepted', 'running')";
const FILES: &str = "SELECT blob FROM job_files WHERE job_id = $1";
/// Locked before the cohorts that it leaves.
const ENDED: &str = "SELECT 1 FROM jobs WHERE id = $1 AND tenant = $2 \
     AND status IN ('successful', 'failed', 'dismissed') \
     AND ($3 = 0 OR updated < (SELECT now_ms FROM clock) - $3) FOR UPDATE";
const REMOVE: &str = "DELETE FROM jobs WHERE id = $1";

/// The status in the row of a job, which an error names.
fn status_of(row: &Row, job: &str) -> Result<JobStatus, sqlx::Error> {
    let status: String = row.try_get("status")?;
    JobStatus::from_name(&status)
        .ok_or_else(|| sqlx::Error::Decode(format!("status `{status}` of job {job}").into()))
}

fn job_row(row: &Row) -> Result<JobRow, sqlx::Error> {
    let tags: String = row.try_get::<Option<_>, _>("tags")?.unwrap_or_default();
    let id: String = row.try_get("id")?;
    Ok(JobRow {
        status: status_of(row, &id)?,
        id,
        kind: row.try_get("kind")?,
        case_id: row.try_get("case_id")?,
        spec_hash: tenants::plain(row.try_get("spec_hash")?),
        engine: row.try_get("engine")?,
        phase: row.try_get("phase")?,
        progress: row.try_get("progress")?,
        iteration: row.try_get("iteration")?,
        residual: row.try_get("residual")?,
        attempt: row.try_get("attempt")?,
        error: row.try_get("error")?,
        result: row.try_get("result")?,
        truths: row.try_get("truths")?,
        created: row.try_get("created")?,
        started: row.try_get("started")?,
        finished: row.try_get("finished")?,
        updated: row.try_get("updated")?,
        tags: tags.lines().map(str::to_owned).collect(),
        waits_for: Some(row.try_get("waits_for")?).filter(|meshing: &String| !meshing.is_empty()),
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

    /// What a job was accepted with, resolved.
    pub async fn job_document(&self, id: &str) -> Result<Option<String>, StoreError> {
        let row = query(DOCUMENT).bind(id).bind(self.tenant());
        let row = row.fetch_optional(self.database.reader()).await?;
        Ok(row.map(|row| row.try_get(0)).transpose()?)
    }

    /// The cases that a job goes with.
    pub async fn cases_of_job(&self, id: &str) -> Result<Vec<String>, StoreError> {
        let rows =
            query(CASES).bind(id).bind(self.tenant()).fetch_all(self.database.reader()).await?;
        Ok(rows.iter().map(|row| row.try_get(0)).collect::<Result<_, _>>()?)
    }

    /// The newest studies that have ended well with rows of this key.
    pub async fn studies_with_rows(&self, rows_key: &str) -> Result<Vec<String>, StoreError> {
        let rows = query(WITH_ROWS)
            .bind(rows_key)
            .bind(self.tenant())
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(|row| row.try_get(0)).collect::<Result<_, _>>()?)
    }

    /// How a job is, and nothing else of it.
    pub async fn job_status(&self, id: &str) -> Result<Option<JobStatus>, StoreError> {
        let row = query(STATUS)
            .bind(id)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.as_ref().map(|row| status_of(row, id)).transpose()?)
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

    /// Ends a job that is accepted or running, removes one that has ended, with the meshes that it made or read and that
    /// nothing else refers to, unless somebody uploaded them for their own sake. A prediction leaves every cohort.
    pub async fn dismiss(&self, id: &str) -> Result<Dismissal, StoreError> {
        match self.end_unended(id).await? {
            None => Ok(Dismissal::Dismissed),
            Some(transaction) => self.remove_job(transaction, id, 0).await,
        }
    }

    /// Ends a job that is accepted or running; false where there is none.
    pub async fn dismiss_unended(&self, id: &str) -> Result<bool, StoreError> {
        Ok(self.end_unended(id).await?.is_none())
    }

    /// Ends a job that is accepted or running; where there is none, the transaction that found none.
    async fn end_unended(&self, id: &str) -> Result<Option<Transaction>, StoreError> {
        let mut transaction = self.database.begin().await?;
        hold_case(&mut transaction, id).await?;
        let dismissed =
            query(DISMISS).bind(id).bind(self.tenant()).execute(&mut transaction).await?;
        if dismissed != 1 {
            return Ok(Some(transaction));
        }
        record(&mut transaction, id).await?;
        let waited = fail_waiting(&mut transaction, id).await?;
        transaction.commit().await?;
        self.job_changed(id);
        waited.iter().for_each(|job| self.job_changed(job));
        Ok(None)
    }

    /// Removes a job that has ended and that nobody has changed for `age`, in ms.
    pub(super) async fn remove_old_job(&self, id: &str, age: i64) -> Result<Dismissal, StoreError> {
        self.remove_job(self.database.begin().await?, id, age).await
    }

    async fn remove_job(
        &self,
        mut transaction: Transaction,
        id: &str,
        age: i64,
    ) -> Result<Dismissal, StoreError> {
        let ended = query(ENDED).bind(id).bind(self.tenant()).bind(age);
        if ended.fetch_optional(&mut transaction).await?.is_none() {
            return Ok(Dismissal::NotFound);
        }
        let mut blobs = column(&mut transaction, FILES, id).await?;
        let leaving = Leaving::Prediction(id);
        let is_member = hold_cohorts(&mut transaction, leaving).await?;
        let meshes = meshes_of_job(&mut transaction, id).await?;
        if is_member {
            leave(&mut transaction, leaving).await?;
        }
        forget_model(&mut transaction, id).await?;
        query(REMOVE).bind(id).execute(&mut transaction).await?;
        self.insert_tombstone(&mut transaction, id).await?;
        blobs.extend(self.remove_unused(&mut transaction, meshes).await?);
        transaction.commit().await?;
        self.mark_erased();
        self.job_changed(id);
        self.discard(blobs).await;
        Ok(Dismissal::Removed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::database::query_of;

    /// How SQLite finds the rows of a page, line by line.
    async fn plan(store: &Store) -> Vec<String> {
        let mut asked = query_of(format!("EXPLAIN QUERY PLAN {LIST}"));
        for text in [AFTER_ALL, "", "", "", ""] {
            asked = asked.bind(text);
        }
        let asked = asked.bind(9).bind(store.tenant());
        let rows = asked.fetch_all(store.database.reader()).await.unwrap();
        rows.iter().map(|row| row.try_get("detail").unwrap()).collect()
    }

    #[tokio::test]
    async fn a_page_and_the_places_of_its_jobs_are_read_from_indexes_in_their_order() {
        let folder = tempfile::TempDir::new().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let plan = plan(&store).await;
        let mut of_jobs: Vec<&str> =
            plan.iter().map(String::as_str).filter(|line| line.contains(" jobs ")).collect();
        of_jobs.sort_unstable();
        let by_tenant = "SEARCH jobs USING COVERING INDEX jobs_by_tenant";
        let wanted = [
            format!("{by_tenant} (tenant=? AND status=? AND waits_for=? AND priority<?)"),
            format!(
                "{by_tenant} (tenant=? AND status=? AND waits_for=? AND priority=? AND id>? AND id<?)"
            ),
            "SEARCH jobs USING INDEX jobs_by_age (tenant=? AND id<?)".to_owned(),
        ];
        assert_eq!(of_jobs, wanted, "{plan:#?}");
    }
}
