//! Cohorts: operated cases that a tenant learns from, members that left, and models with the version they were learned
//! from.

use super::cases::{AFTER_ALL, Change};
use super::database::{Row, Transaction, is_duplicate, is_reference, query};
use super::made::column;
use super::referred::ReferredRows;
use super::{Store, StoreError};
use crate::schema::job::JobStatus;

/// A cohort to be stored.
#[derive(Clone, Debug)]
pub struct NewCohort {
    pub id: String,
    pub name: String,
    /// JSON.
    pub consent: Option<String>,
    pub members: Vec<MemberRow>,
}

/// A member with what it refers to.
#[derive(Clone, Debug)]
pub struct MemberRow {
    /// From 1 on, as it was posted.
    pub number: i64,
    pub case_id: String,
    /// The prediction.
    pub job_id: String,
    /// After the operation.
    pub mesh_id: String,
    /// JSON.
    pub document: String,
}

#[derive(Clone, Debug)]
pub struct CohortRow {
    pub id: String,
    pub name: String,
    /// JSON.
    pub consent: Option<String>,
    /// One more whenever a member leaves.
    pub version: i64,
    pub members: i64,
    pub created: i64,
    pub updated: i64,
}

/// A case that was a member, and the version from which on it is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftRow {
    pub case_id: String,
    pub version: i64,
}

/// A job that learned from a version of a cohort.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CohortModelRow {
    pub job_id: String,
    pub version: i64,
    /// `None` where it was erased with a case.
    pub status: Option<JobStatus>,
}

/// A cohort with the version that a model learned from and the one that it has now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outdated {
    pub cohort: String,
    pub learned: i64,
    pub version: i64,
}

const BY_ID: &str = "SELECT id, name, consent, version, created, updated, \
     (SELECT COUNT(*) FROM cohort_members WHERE cohort_id = cohorts.id) AS members \
     FROM cohorts WHERE id = $1 AND tenant = $2";
const LIST: &str = "SELECT id, name, consent, version, created, updated, \
     (SELECT COUNT(*) FROM cohort_members WHERE cohort_id = cohorts.id) AS members \
     FROM cohorts WHERE tenant = $1 AND id < $2 ORDER BY id DESC LIMIT $3";
const MEMBERS: &str = "SELECT number, case_id, job_id, mesh_id, document FROM cohort_members \
     WHERE cohort_id = $1 AND EXISTS (SELECT 1 FROM cohorts WHERE id = $1 AND tenant = $2) \
     ORDER BY number";
const LEFT: &str = "SELECT case_id, version FROM cohort_left \
     WHERE cohort_id = $1 AND EXISTS (SELECT 1 FROM cohorts WHERE id = $1 AND tenant = $2) \
     ORDER BY version, case_id";
const MODELS: &str = "SELECT cohort_models.job_id, cohort_models.version, jobs.status \
     FROM cohort_models LEFT JOIN jobs ON jobs.id = cohort_models.job_id \
     WHERE cohort_id = $1 AND EXISTS (SELECT 1 FROM cohorts WHERE id = $1 AND tenant = $2) \
     ORDER BY cohort_models.job_id DESC";
const OUTDATED: &str = "SELECT cohorts.id, cohort_models.version AS learned, cohorts.version FROM cohort_models \
     JOIN cohorts ON cohorts.id = cohort_models.cohort_id \
     WHERE job_id = $1 AND tenant = $2 AND cohorts.version > cohort_models.version";
const INSERT: &str = "INSERT INTO cohorts (id, tenant, name, consent, version, created, updated) \
     VALUES ($1, $2, $3, $4, 1, (SELECT now_ms FROM clock), (SELECT now_ms FROM clock))";
const INSERT_MEMBER: &str = "INSERT INTO cohort_members \
     (cohort_id, number, case_id, job_id, mesh_id, document) VALUES ($1, $2, $3, $4, $5, $6)";
const VERSION: &str = "SELECT version FROM cohorts WHERE id = $1 AND tenant = $2 FOR UPDATE";
/// Locked, so that a request which is about to refer to one of them has either done so or finds it gone.
const MESHES: &str = "SELECT id FROM meshes \
     WHERE id IN (SELECT mesh_id FROM cohort_members WHERE cohort_id = $1) ORDER BY id FOR UPDATE";
const DELETE: &str = "DELETE FROM cohorts WHERE id = $1";

fn cohort_row(row: &Row) -> Result<CohortRow, sqlx::Error> {
    Ok(CohortRow {
        id: row.try_get("id")?,
        name: row.try_get("name")?,
        consent: row.try_get("consent")?,
        version: row.try_get("version")?,
        members: row.try_get("members")?,
        created: row.try_get("created")?,
        updated: row.try_get("updated")?,
    })
}

fn member_row(row: &Row) -> Result<MemberRow, sqlx::Error> {
    Ok(MemberRow {
        number: row.try_get("number")?,
        case_id: row.try_get("case_id")?,
        job_id: row.try_get("job_id")?,
        mesh_id: row.try_get("mesh_id")?,
        document: row.try_get("document")?,
    })
}

fn model_row(row: &Row) -> Result<CohortModelRow, sqlx::Error> {
    let status: Option<String> = row.try_get("status")?;
    let status = status.as_deref().and_then(JobStatus::from_name);
    Ok(CohortModelRow { job_id: row.try_get("job_id")?, version: row.try_get("version")?, status })
}

impl Store {
    /// Stores a cohort; false where something that it refers to went meanwhile.
    pub async fn add_cohort(&self, cohort: &NewCohort) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        match self.insert_cohort(&mut transaction, cohort).await {
            Ok(()) => {
                transaction.commit().await?;
                Ok(true)
            }
            // The same request came twice at the same time.
            Err(error) if is_duplicate(&error) => Ok(true),
            Err(error) if is_reference(&error) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    async fn insert_cohort(
        &self,
        transaction: &mut Transaction,
        cohort: &NewCohort,
    ) -> Result<(), sqlx::Error> {
        let mut referred = ReferredRows::default();
        for member in &cohort.members {
            referred.cases.insert(&member.case_id);
            referred.jobs.insert(&member.job_id);
            referred.meshes.insert(&member.mesh_id);
        }
        referred.hold(transaction).await?;
        query(INSERT)
            .bind(&cohort.id)
            .bind(self.tenant())
            .bind(&cohort.name)
            .bind(&cohort.consent)
            .execute(&mut *transaction)
            .await?;
        for member in &cohort.members {
            query(INSERT_MEMBER)
                .bind(&cohort.id)
                .bind(member.number)
                .bind(&member.case_id)
                .bind(&member.job_id)
                .bind(&member.mesh_id)
                .bind(&member.document)
                .execute(&mut *transaction)
                .await?;
        }
        Ok(())
    }

    pub async fn cohort(&self, id: &str) -> Result<Option<CohortRow>, StoreError> {
        let row = query(BY_ID).bind(id).bind(self.tenant());
        let row = row.fetch_optional(self.database.reader()).await?;
        Ok(row.as_ref().map(cohort_row).transpose()?)
    }

    /// Cohorts, newest first.
    pub async fn cohorts(
        &self,
        cursor: Option<&str>,
        limit: i64,
    ) -> Result<Vec<CohortRow>, StoreError> {
        let rows = query(LIST)
            .bind(self.tenant())
            .bind(cursor.unwrap_or(AFTER_ALL))
            .bind(limit)
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(cohort_row).collect::<Result<_, _>>()?)
    }

    /// Those that are in a cohort, in the order in which they were posted.
    pub async fn cohort_members(&self, id: &str) -> Result<Vec<MemberRow>, StoreError> {
        let rows = query(MEMBERS).bind(id).bind(self.tenant());
        let rows = rows.fetch_all(self.database.reader()).await?;
        Ok(rows.iter().map(member_row).collect::<Result<_, _>>()?)
    }

    /// The cases that left a cohort, in that order.
    pub async fn left_cohort(&self, id: &str) -> Result<Vec<LeftRow>, StoreError> {
        let rows = query(LEFT).bind(id).bind(self.tenant());
        let rows = rows.fetch_all(self.database.reader()).await?;
        let row = |row: &Row| {
            Ok(LeftRow { case_id: row.try_get("case_id")?, version: row.try_get("version")? })
        };
        rows.iter().map(row).collect()
    }

    /// Models learned from a cohort, newest first.
    pub async fn cohort_models(&self, id: &str) -> Result<Vec<CohortModelRow>, StoreError> {
        let rows = query(MODELS).bind(id).bind(self.tenant());
        let rows = rows.fetch_all(self.database.reader()).await?;
        Ok(rows.iter().map(model_row).collect::<Result<_, _>>()?)
    }

    /// The cohort that a model was learned from and that members have left since.
    pub async fn outdated(&self, model: &str) -> Result<Option<Outdated>, StoreError> {
        let row = query(OUTDATED).bind(model).bind(self.tenant());
        let row = row.fetch_optional(self.database.reader()).await?;
        let found = |row: Row| {
            let (learned, version) = (row.try_get("learned")?, row.try_get("version")?);
            Ok(Outdated { cohort: row.try_get("id")?, learned, version })
        };
        row.map(found).transpose()
    }

    /// Deletes a cohort; what was learned from it stays.
    pub async fn delete_cohort(&self, id: &str, version: i64) -> Result<Change, StoreError> {
        let mut transaction = self.database.begin().await?;
        let found = query(VERSION).bind(id).bind(self.tenant());
        let Some(found) = found.fetch_optional(&mut transaction).await? else {
            return Ok(Change::NotFound);
        };
        let found: i64 = found.try_get("version")?;
        if found != version {
            return Ok(Change::OtherVersion(found));
        }
        let meshes = column(&mut transaction, MESHES, id).await?;
        self.insert_tombstone(&mut transaction, id).await?;
        query(DELETE).bind(id).execute(&mut transaction).await?;
        let blobs = self.remove_unused(&mut transaction, meshes).await?;
        transaction.commit().await?;
        self.mark_erased();
        self.discard(blobs).await;
        Ok(Change::Done)
    }
}
