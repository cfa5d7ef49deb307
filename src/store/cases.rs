//! Cases: a document that refers to meshes, with its tags.

use super::accepted::NewJob;
use super::database::{Row, Transaction, is_duplicate, is_reference, query};
use super::events::record;
use super::made::column;
use super::membership::{Leaving, hold_cohorts, leave};
use super::references::{Content, hashes};
use super::referred::ReferredRows;
use super::{NewMesh, Store, StoreError};
use crate::schema::job::JobStatus;

/// A case to be stored, with the meshes that came in the same request.
#[derive(Clone, Debug)]
pub struct NewCase {
    pub id: String,
    pub document: String,
    pub report: String,
    pub tags: Vec<String>,
    /// All meshes that the document refers to.
    pub mesh_ids: Vec<String>,
    pub meshes: Vec<NewMesh>,
    /// The job that makes its mesh, where it has none yet.
    pub meshing: Option<NewJob>,
}

/// Outcome of storing a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddedCase {
    Stored,
    /// A mesh it counts on came or went meanwhile.
    Contended,
    /// Its meshing is one job too many.
    QueueFull,
}

#[derive(Clone, Debug)]
pub struct CaseRow {
    pub id: String,
    pub document: String,
    pub report: String,
    pub version: i64,
    pub created: i64,
    pub updated: i64,
    /// Of a case whose mesh a job makes, or has made.
    pub meshing: Option<CaseMeshing>,
}

/// The job that a case has its mesh from, as it is now.
#[derive(Clone, Debug)]
pub struct CaseMeshing {
    pub job: String,
    /// `None` where the job was removed.
    pub status: Option<JobStatus>,
    /// JSON with `type` and `detail`, where it failed.
    pub error: Option<String>,
}

/// Outcome of a conditional change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    Done,
    /// The row has the version told here.
    OtherVersion(i64),
    NotFound,
}

const BY_ID: &str = "SELECT cases.id, cases.document, report, version, cases.created, cases.updated, \
     meshing, jobs.status, jobs.error FROM cases LEFT JOIN jobs ON jobs.id = cases.meshing \
     WHERE cases.id = $1 AND cases.tenant = $2";
const LIST: &str = "SELECT cases.id, cases.document, report, version, cases.created, cases.updated, \
     meshing, jobs.status, jobs.error FROM cases LEFT JOIN jobs ON jobs.id = cases.meshing \
     WHERE cases.tenant = $4 AND cases.id < $1 AND ($2 = '' OR EXISTS \
       (SELECT 1 FROM case_tags WHERE case_tags.case_id = cases.id AND case_tags.tag = $2)) \
     ORDER BY cases.id DESC LIMIT $3";
const INSERT: &str = "INSERT INTO cases (id, document, report, tenant, meshing, version, created, updated) \
     VALUES ($1, $2, $3, $4, $5, 1, (SELECT now_ms FROM clock), (SELECT now_ms FROM age_clock))";
const REFER: &str =
    "INSERT INTO case_meshes (case_id, mesh_id) VALUES ($1, $2) ON CONFLICT DO NOTHING";
/// What a case leaves when it goes: the files of its jobs.
const FILES_OF_CASE: &str = "SELECT job_files.blob FROM job_files \
     JOIN jobs ON jobs.id = job_files.job_id WHERE jobs.case_id = $1 \
     OR jobs.id IN (SELECT job_id FROM job_cases WHERE case_id = $1)";
/// Jobs of several cases; those of one go with it.
const DELETE_SHARED_JOBS: &str =
    "DELETE FROM jobs WHERE id IN (SELECT job_id FROM job_cases WHERE case_id = $1)";
/// Locked before their tombstones are made, as by their own erasure.
const PLANS_OF_CASE: &str = "SELECT id FROM plans WHERE case_id = $1 ORDER BY id FOR UPDATE";
/// Locked first, so that a job of the case is either published by now or finds itself gone.
const JOBS_OF_CASE: &str = "SELECT id FROM jobs WHERE case_id = $1 \
     OR id IN (SELECT job_id FROM job_cases WHERE case_id = $1) ORDER BY id FOR UPDATE";
/// Those that it refers to, and those that its jobs made or read: what came with another case that was erased before may
/// have been kept for them. Locked, so that a request which is about to refer to one of them has either done so or finds it
/// gone.
const MESHES_OF_CASE: &str = "WITH gone AS (SELECT id FROM jobs WHERE case_id = $1 \
       UNION SELECT job_id FROM job_cases WHERE case_id = $1) \
     SELECT id FROM meshes WHERE id IN (SELECT mesh_id FROM case_meshes WHERE case_id = $1 \
       UNION SELECT mesh_id FROM made_meshes WHERE job_id IN (SELECT id FROM gone) \
       UNION SELECT mesh_id FROM job_meshes WHERE job_id IN (SELECT id FROM gone) \
       UNION SELECT mesh_id FROM cohort_members WHERE case_id = $1 OR job_id IN (SELECT id FROM gone)) \
     ORDER BY id FOR UPDATE";

/// Sorts after every id.
pub(super) const AFTER_ALL: &str = "~";

fn meshing_of(row: &Row) -> Result<Option<CaseMeshing>, sqlx::Error> {
    let Some(job) = row.try_get("meshing")? else { return Ok(None) };
    let status: Option<String> = row.try_get("status")?;
    let status = status.as_deref().and_then(JobStatus::from_name);
    Ok(Some(CaseMeshing { job, status, error: row.try_get("error")? }))
}

fn case_row(row: &Row) -> Result<CaseRow, sqlx::Error> {
    Ok(CaseRow {
        id: row.try_get("id")?,
        document: row.try_get("document")?,
        report: row.try_get("report")?,
        version: row.try_get("version")?,
        created: row.try_get("created")?,
        updated: row.try_get("updated")?,
        meshing: meshing_of(row)?,
    })
}

/// Puts meshes among those that stay as long as a case does.
pub(super) async fn refer(
    transaction: &mut Transaction,
    case: &str,
    meshes: &[String],
) -> Result<(), sqlx::Error> {
    for mesh in meshes {
        query(REFER).bind(case).bind(mesh).execute(&mut *transaction).await?;
    }
    Ok(())
}

impl Store {
    pub async fn case(&self, id: &str) -> Result<Option<CaseRow>, StoreError> {
        let row = query(BY_ID)
            .bind(id)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.as_ref().map(case_row).transpose()?)
    }

    /// Cases newest first, those after `cursor` where one is given, with `tag` unless it is empty.
    pub async fn cases(
        &self,
        tag: &str,
        cursor: Option<&str>,
        limit: i64,
    ) -> Result<Vec<CaseRow>, StoreError> {
        let rows = query(LIST)
            .bind(cursor.unwrap_or(AFTER_ALL))
            .bind(tag)
            .bind(limit)
            .bind(self.tenant())
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(case_row).collect::<Result<_, _>>()?)
    }

    /// Stores a case, its meshes and the job that is to mesh it, or nothing.
    pub async fn add_case(
        &self,
        case: &NewCase,
        longest_queue: i64,
    ) -> Result<AddedCase, StoreError> {
        let mut contents: Vec<Content> = Vec::new();
        for mesh in &case.meshes {
            contents.push((mesh.blob.clone(), mesh.bytes.clone()));
        }
        let blobs = hashes(&contents);
        let mut transaction = self.begin_with(contents).await?;
        if case.meshing.is_some() && self.is_queue_full(&mut transaction, longest_queue).await? {
            transaction.rollback().await;
            self.discard(blobs).await;
            return Ok(AddedCase::QueueFull);
        }
        match self.insert_case(&mut transaction, case).await {
            Ok(()) => {
                transaction.commit().await?;
                case.meshing.iter().for_each(|job| self.job_changed(&job.id));
                Ok(AddedCase::Stored)
            }
            Err(error) => {
                transaction.rollback().await;
                self.discard(blobs).await;
                let meanwhile = is_duplicate(&error) || is_reference(&error);
                if meanwhile { Ok(AddedCase::Contended) } else { Err(error.into()) }
            }
        }
    }

    /// Erases a case: its plans, its jobs with their results, and the meshes that came with it or that its jobs made or
    /// read and that nothing else refers to; it leaves every cohort. A job of it that is running finds itself gone and stops.
    pub async fn delete_case(&self, id: &str, version: Option<i64>) -> Result<Change, StoreError> {
        self.delete_case_of_age(id, version, 0).await
    }

    /// The same where nothing of it has changed for `age`, in ms; with the version that it has otherwise.
    pub(super) async fn delete_case_of_age(
        &self,
        id: &str,
        version: Option<i64>,
        age: i64,
    ) -> Result<Change, StoreError> {
        let mut transaction = self.database.begin().await?;
        let found = query("SELECT version FROM cases WHERE id = $1 AND tenant = $2 FOR UPDATE")
            .bind(id)
            .bind(self.tenant())
            .fetch_optional(&mut transaction)
            .await?;
        let Some(found) = found else {
            return Ok(Change::NotFound);
        };
        let found: i64 = found.try_get("version")?;
        if version.is_some_and(|version| version != found) {
            return Ok(Change::OtherVersion(found));
        }
        column(&mut transaction, PLANS_OF_CASE, id).await?;
        let jobs = column(&mut transaction, JOBS_OF_CASE, id).await?;
        if age > 0 && !self.is_old_case(&mut transaction, id, age).await? {
            return Ok(Change::OtherVersion(found));
        }
        let mut blobs = column(&mut transaction, FILES_OF_CASE, id).await?;
        let leaving = Leaving::Case(id);
        let is_member = hold_cohorts(&mut transaction, leaving).await?;
        let meshes = column(&mut transaction, MESHES_OF_CASE, id).await?;
        self.insert_tombstones_of_case(&mut transaction, id).await?;
        if is_member {
            leave(&mut transaction, leaving).await?;
        }
        query(DELETE_SHARED_JOBS).bind(id).execute(&mut transaction).await?;
        query("DELETE FROM cases WHERE id = $1").bind(id).execute(&mut transaction).await?;
        blobs.extend(self.remove_unused(&mut transaction, meshes).await?);
        transaction.commit().await?;
        self.mark_erased();
        jobs.iter().for_each(|job| self.job_changed(job));
        self.discard(blobs).await;
        Ok(Change::Done)
    }

    async fn insert_case(
        &self,
        transaction: &mut Transaction,
        case: &NewCase,
    ) -> Result<(), sqlx::Error> {
        if case.meshing.is_some() {
            self.enter(transaction).await?;
        }
        for mesh in &case.meshes {
            self.insert_mesh(transaction, mesh).await?;
        }
        let read = case.meshing.iter().flat_map(|job| &job.mesh_ids);
        let meshes = case.mesh_ids.iter().chain(read).map(String::as_str).collect();
        ReferredRows { meshes, ..ReferredRows::default() }.hold(transaction).await?;
        query(INSERT)
            .bind(&case.id)
            .bind(&case.document)
            .bind(&case.report)
            .bind(self.tenant())
            .bind(case.meshing.as_ref().map(|job| job.id.as_str()))
            .execute(&mut *transaction)
            .await?;
        for tag in &case.tags {
            query("INSERT INTO case_tags (case_id, tag) VALUES ($1, $2) ON CONFLICT DO NOTHING")
                .bind(&case.id)
                .bind(tag)
                .execute(&mut *transaction)
                .await?;
        }
        refer(transaction, &case.id, &case.mesh_ids).await?;
        if let Some(job) = &case.meshing {
            self.insert_job(transaction, job, "").await?;
            record(transaction, &job.id).await?;
        }
        Ok(())
    }
}
