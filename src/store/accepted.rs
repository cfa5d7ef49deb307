//! Acceptance of jobs: each once, with all that it refers to.

use std::collections::BTreeSet;

use super::database::{Transaction, is_reference, query};
use super::events::record;
use super::job_tags::insert_tags;
use super::membership::learn;
use super::referred::ReferredRows;
use super::{Store, StoreError};
use crate::schema::engine::EngineDocument;
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
    /// Of a study: the key of its rows.
    pub rows_key: Option<String>,
    /// Of a study: what its truths are expected to take, JSON.
    pub truths: Option<String>,
    pub engine: String,
    pub tags: Vec<String>,
    /// The meshes that have to stay while the job is there.
    pub mesh_ids: Vec<String>,
    /// The stored cohort that it learns from, and which version of it.
    pub learns_from: Option<(String, i64)>,
    /// Where in a trace it is accepted, where there is one.
    pub traceparent: Option<String>,
    /// The meshing of its case, which has no mesh yet. The document lacks the case, which the claim puts in.
    pub waits_for: Option<String>,
}

#[cfg(test)]
impl NewJob {
    /// A job of this id, with the inputs of every other such job.
    pub fn example(id: &str) -> NewJob {
        NewJob {
            id: id.to_owned(),
            kind: "study",
            priority: 0,
            case_id: None,
            shared_cases: Vec::new(),
            document: "{}".to_owned(),
            spec_hash: "same".to_owned(),
            rows_key: None,
            truths: None,
            engine: "{}".to_owned(),
            tags: Vec::new(),
            mesh_ids: Vec::new(),
            learns_from: None,
            traceparent: None,
            waits_for: None,
        }
    }
}

/// Outcome of the acceptance of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Enqueued {
    Accepted,
    /// The same inputs of the same cases are the job of this id already.
    Known(String),
    QueueFull,
    /// The case or a mesh went meanwhile.
    InputGone,
    /// The meshing of the case has ended without a mesh.
    NotMeshed,
}

/// A dismissed, lost or over-budget job may be accepted again.
const KNOWN: &str = "SELECT id, status = 'dismissed' OR \
     status = 'failed' AND COALESCE(error_class, '') IN ('budget', 'infrastructure') \
     FROM jobs WHERE spec_hash = $1 AND tenant = $2";
/// The row stays, without its key.
const RELEASED: &str =
    "UPDATE jobs SET spec_hash = status || ' ' || id || ' ' || spec_hash WHERE id = $1";
const WAITING: &str = "SELECT COUNT(*) FROM jobs WHERE tenant = $1 AND status = 'accepted'";
/// Locked before its jobs, as by an erasure.
const CASE: &str = "SELECT 1 FROM cases WHERE id = $1 FOR UPDATE";
/// Locked, so that the meshing has either ended or finds the job among those that wait for it.
const MESHING: &str = "SELECT status FROM jobs WHERE id = $1 AND tenant = $2 FOR UPDATE";
const INSERT: &str = "INSERT INTO jobs (id, kind, case_id, document, spec_hash, engine, tenant, priority, \
     traceparent, numerics, rows_key, truths, waits_for, status, progress, attempt, losses, claimable_from, \
       created, updated) \
     VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, 'accepted', 0, 0, 0, 0, \
       (SELECT now_ms FROM clock), (SELECT now_ms FROM age_clock)) \
     ON CONFLICT (spec_hash) DO NOTHING";

impl Store {
    /// Accepts a job, unless one with the same inputs is known.
    pub async fn enqueue(&self, job: &NewJob, longest_queue: i64) -> Result<Enqueued, StoreError> {
        let mut transaction = self.database.begin().await?;
        let found = query(KNOWN)
            .bind(self.key(job))
            .bind(self.tenant())
            .fetch_optional(&mut transaction)
            .await?;
        let mut known = None;
        if let Some(row) = found {
            let id: String = row.try_get(0)?;
            if !row.try_get::<bool, _>(1)? {
                return Ok(Enqueued::Known(id));
            }
            known = Some(id);
        }
        self.enter(&mut transaction).await?;
        hold_cases(&mut transaction, job).await?;
        if let Some(id) = known {
            query(RELEASED).bind(id).execute(&mut transaction).await?;
        }
        if self.is_queue_full(&mut transaction, longest_queue).await? {
            return Ok(Enqueued::QueueFull);
        }
        let Some(waits_for) = self.pending_meshing(&mut transaction, job).await? else {
            return Ok(Enqueued::NotMeshed);
        };
        match self.insert_job(&mut transaction, job, &waits_for).await {
            Ok(true) => {
                record(&mut transaction, &job.id).await?;
                transaction.commit().await?;
                self.job_changed(&job.id);
                Ok(Enqueued::Accepted)
            }
            // Another request with the same inputs came between the question and the answer.
            Ok(false) => {
                transaction.rollback().await;
                self.known(job).await
            }
            Err(error) if is_reference(&error) => Ok(Enqueued::InputGone),
            Err(error) => Err(error.into()),
        }
    }

    /// Unique key of a job: hash of the inputs and ids of the cases, with which the job is erased.
    fn key(&self, job: &NewJob) -> String {
        let cases: BTreeSet<&String> = job.case_id.iter().chain(&job.shared_cases).collect();
        let mut key: String = cases.into_iter().map(|case| format!("{case} ")).collect();
        key += &job.spec_hash;
        self.own(&key)
    }

    /// The job that was accepted in place of this one.
    async fn known(&self, job: &NewJob) -> Result<Enqueued, StoreError> {
        let known = query(KNOWN)
            .bind(self.key(job))
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        let id = known.ok_or(StoreError::Contended)?.try_get(0)?;
        Ok(Enqueued::Known(id))
    }

    /// Whether so many jobs wait that no other may.
    pub(super) async fn is_queue_full(
        &self,
        transaction: &mut Transaction,
        longest_queue: i64,
    ) -> Result<bool, sqlx::Error> {
        let waiting = query(WAITING).bind(self.tenant()).fetch_one(&mut *transaction).await?;
        Ok(waiting.try_get::<i64, _>(0)? >= longest_queue)
    }

    /// The meshing that a job has to wait for, empty where there is none or it is done; `None` where that made no mesh.
    async fn pending_meshing(
        &self,
        transaction: &mut Transaction,
        job: &NewJob,
    ) -> Result<Option<String>, sqlx::Error> {
        let Some(meshing) = &job.waits_for else { return Ok(Some(String::new())) };
        let row = query(MESHING).bind(meshing).bind(self.tenant());
        let Some(row) = row.fetch_optional(&mut *transaction).await? else { return Ok(None) };
        let status: String = row.try_get(0)?;
        Ok(match JobStatus::from_name(&status) {
            Some(JobStatus::Accepted | JobStatus::Running) => Some(meshing.clone()),
            Some(JobStatus::Successful) => Some(String::new()),
            Some(JobStatus::Failed | JobStatus::Dismissed) | None => None,
        })
    }

    /// False when a job with the same inputs was there before.
    pub(super) async fn insert_job(
        &self,
        transaction: &mut Transaction,
        job: &NewJob,
        waits_for: &str,
    ) -> Result<bool, sqlx::Error> {
        let inserted = query(INSERT)
            .bind(&job.id)
            .bind(job.kind)
            .bind(&job.case_id)
            .bind(&job.document)
            .bind(self.key(job))
            .bind(&job.engine)
            .bind(self.tenant())
            .bind(job.priority)
            .bind(&job.traceparent)
            .bind(i64::from(EngineDocument::this().numerics))
            .bind(&job.rows_key)
            .bind(&job.truths)
            .bind(waits_for)
            .execute(&mut *transaction)
            .await?;
        if inserted == 0 {
            return Ok(false);
        }
        insert_tags(transaction, &job.id, &job.tags).await?;
        for case in &job.shared_cases {
            query("INSERT INTO job_cases (job_id, case_id) VALUES ($1, $2) ON CONFLICT DO NOTHING")
                .bind(&job.id)
                .bind(case)
                .execute(&mut *transaction)
                .await?;
        }
        if let Some((cohort, version)) = &job.learns_from {
            learn(transaction, &job.id, (cohort, *version)).await?;
        }
        for mesh in job.mesh_ids.iter().collect::<BTreeSet<_>>() {
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

/// Holds the cases of a job before any job is held: the one that a meshing is to complete as the end of that does.
async fn hold_cases(transaction: &mut Transaction, job: &NewJob) -> Result<(), sqlx::Error> {
    if job.waits_for.is_some() {
        query(CASE).bind(&job.case_id).fetch_optional(&mut *transaction).await?;
    }
    let cases = job.case_id.iter().chain(&job.shared_cases).map(String::as_str).collect();
    ReferredRows { cases, ..ReferredRows::default() }.hold(transaction).await
}
