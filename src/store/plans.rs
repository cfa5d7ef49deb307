//! Plans that were stored with their case.

use super::cases::{AFTER_ALL, Change};
use super::database::{Row, is_duplicate, is_reference, query};
use super::{Store, StoreError};

#[derive(Clone, Debug)]
pub struct PlanRow {
    pub id: String,
    pub case_id: String,
    pub document: String,
    pub version: i64,
    pub created: i64,
    pub updated: i64,
}

const BY_ID: &str = "SELECT id, case_id, document, version, created, updated FROM plans \
     WHERE id = $1 AND case_id = $2 AND EXISTS \
       (SELECT 1 FROM cases WHERE cases.id = plans.case_id AND cases.tenant = $3)";
const LIST: &str = "SELECT id, case_id, document, version, created, updated FROM plans \
     WHERE case_id = $1 AND id < $2 AND EXISTS \
       (SELECT 1 FROM cases WHERE cases.id = plans.case_id AND cases.tenant = $4) \
     ORDER BY id DESC LIMIT $3";
const INSERT: &str = "INSERT INTO plans (id, case_id, document, version, created, updated) \
     SELECT $1, id, $3, 1, (SELECT now_ms FROM clock), (SELECT now_ms FROM age_clock) \
     FROM cases WHERE id = $2 AND tenant = $4";
const UPDATE: &str = "UPDATE plans SET document = $1, version = version + 1, \
     updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $2 AND case_id = $3 AND ($4 = 0 OR version = $4) AND EXISTS \
       (SELECT 1 FROM cases WHERE cases.id = plans.case_id AND cases.tenant = $5)";
const DELETE: &str = "DELETE FROM plans WHERE id = $1 AND case_id = $2 AND ($3 = 0 OR version = $3) \
     AND EXISTS (SELECT 1 FROM cases WHERE cases.id = plans.case_id AND cases.tenant = $4)";

fn plan_row(row: &Row) -> Result<PlanRow, sqlx::Error> {
    Ok(PlanRow {
        id: row.try_get("id")?,
        case_id: row.try_get("case_id")?,
        document: row.try_get("document")?,
        version: row.try_get("version")?,
        created: row.try_get("created")?,
        updated: row.try_get("updated")?,
    })
}

impl Store {
    pub async fn plan(&self, case_id: &str, id: &str) -> Result<Option<PlanRow>, StoreError> {
        let row = query(BY_ID)
            .bind(id)
            .bind(case_id)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.as_ref().map(plan_row).transpose()?)
    }

    /// The plans of a case, newest first.
    pub async fn plans(
        &self,
        case_id: &str,
        cursor: Option<&str>,
        limit: i64,
    ) -> Result<Vec<PlanRow>, StoreError> {
        let rows = query(LIST)
            .bind(case_id)
            .bind(cursor.unwrap_or(AFTER_ALL))
            .bind(limit)
            .bind(self.tenant())
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(plan_row).collect::<Result<_, _>>()?)
    }

    /// False when the case is not there.
    pub async fn add_plan(
        &self,
        case_id: &str,
        id: &str,
        document: &str,
    ) -> Result<bool, StoreError> {
        let inserted = query(INSERT)
            .bind(id)
            .bind(case_id)
            .bind(document)
            .bind(self.tenant())
            .execute(&self.database.writer().await?)
            .await;
        match inserted {
            Ok(inserted) => Ok(inserted == 1),
            // The same request came twice at the same time.
            Err(error) if is_duplicate(&error) => Ok(true),
            Err(error) if is_reference(&error) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Replaces the document of a plan, of any version where none is given.
    pub async fn replace_plan(
        &self,
        (case_id, id): (&str, &str),
        document: &str,
        version: Option<i64>,
    ) -> Result<Change, StoreError> {
        let changed = query(UPDATE)
            .bind(document)
            .bind(id)
            .bind(case_id)
            .bind(version.unwrap_or(0))
            .bind(self.tenant())
            .execute(&self.database.writer().await?)
            .await?;
        // What it was before is in the files of the database until they are wiped.
        self.mark_erased();
        self.plan_change(case_id, id, changed).await
    }

    pub async fn delete_plan(
        &self,
        (case_id, id): (&str, &str),
        version: Option<i64>,
    ) -> Result<Change, StoreError> {
        let mut transaction = self.database.begin().await?;
        let changed = query(DELETE)
            .bind(id)
            .bind(case_id)
            .bind(version.unwrap_or(0))
            .bind(self.tenant())
            .execute(&mut transaction)
            .await?;
        if changed == 1 {
            self.insert_tombstone(&mut transaction, id).await?;
        }
        transaction.commit().await?;
        self.mark_erased();
        self.plan_change(case_id, id, changed).await
    }

    async fn plan_change(&self, case_id: &str, id: &str, rows: u64) -> Result<Change, StoreError> {
        if rows == 1 {
            return Ok(Change::Done);
        }
        Ok(match self.plan(case_id, id).await? {
            Some(plan) => Change::OtherVersion(plan.version),
            None => Change::NotFound,
        })
    }
}
