//! Tenants: isolated users of one deployment.

use super::database::{Row, Transaction, query};
use super::{DEFAULT_TENANT, Store, StoreError};

/// A tenant and how long what it does not change is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TenantRow {
    pub name: String,
    pub retention_days: Option<i64>,
}

/// A new tenant, like one without a job for long, is served next; after one turn it comes behind all others.
const ENTER: &str =
    "INSERT INTO tenants (name, served) VALUES ($1, 0) ON CONFLICT (name) DO NOTHING";
const LIST: &str =
    "SELECT name, retention_days FROM tenants WHERE name > $1 ORDER BY name LIMIT $2";
const FORGETFUL: &str =
    "SELECT name, retention_days FROM tenants WHERE retention_days IS NOT NULL ORDER BY name";
const RETAIN: &str = "UPDATE tenants SET retention_days = $2 WHERE name = $1";
/// A case is as old as the youngest thing that belongs to it.
const OLD_CASES: &str = "SELECT id FROM cases WHERE tenant = $1 \
     AND updated < (SELECT now_ms FROM clock) - $2 \
     AND NOT EXISTS (SELECT 1 FROM plans WHERE plans.case_id = cases.id \
       AND plans.updated >= (SELECT now_ms FROM clock) - $2) \
     AND NOT EXISTS (SELECT 1 FROM jobs WHERE (jobs.case_id = cases.id \
         OR jobs.id IN (SELECT job_id FROM job_cases WHERE case_id = cases.id)) \
       AND jobs.updated >= (SELECT now_ms FROM clock) - $2)";
const OLD_JOBS: &str = "SELECT id FROM jobs WHERE tenant = $1 \
     AND status IN ('successful', 'failed', 'dismissed') \
     AND finished < (SELECT now_ms FROM clock) - $2";
const OLD_MESHES: &str = "SELECT id FROM meshes WHERE tenant = $1 \
     AND created < (SELECT now_ms FROM clock) - $2 \
     AND NOT EXISTS (SELECT 1 FROM case_meshes WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM job_meshes WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM cohort_members WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM made_meshes WHERE mesh_id = meshes.id)";

/// Who erases what is too old.
const RETENTION: &str = "retention";
const DAY_MS: i64 = 24 * 3600 * 1000;

fn tenant_row(row: &Row) -> Result<TenantRow, sqlx::Error> {
    let retention_days = row.try_get("retention_days")?;
    Ok(TenantRow { name: row.try_get("name")?, retention_days })
}

impl Store {
    /// A text that is unique in its table and has to be so within a tenant only.
    pub(super) fn own(&self, text: &str) -> String {
        own(self.tenant(), text)
    }

    /// Sees to it that the tenant has a row.
    pub(super) async fn enter(&self, transaction: &mut Transaction) -> Result<(), sqlx::Error> {
        query(ENTER).bind(self.tenant()).execute(&mut *transaction).await?;
        Ok(())
    }

    /// Tenants by name, those after `cursor` where one is given.
    pub async fn tenants(
        &self,
        cursor: Option<&str>,
        limit: i64,
    ) -> Result<Vec<TenantRow>, StoreError> {
        let rows = query(LIST)
            .bind(cursor.unwrap_or_default())
            .bind(limit)
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(tenant_row).collect::<Result<_, _>>()?)
    }

    /// Sets the retention of unchanged resources; for ever where no number is given.
    pub async fn retain(&self, days: Option<i64>) -> Result<(), StoreError> {
        let mut transaction = self.database.begin().await?;
        self.enter(&mut transaction).await?;
        query(RETAIN).bind(self.tenant()).bind(days).execute(&mut transaction).await?;
        transaction.commit().await?;
        Ok(())
    }

    /// Erases what is older than its tenant's retention since its last change: cases with all that belongs to them,
    /// other ended jobs, unreferenced meshes. Returns how many.
    pub async fn erase_old(&self) -> Result<usize, StoreError> {
        let mut erased = 0;
        self.release_reserve().await;
        for row in query(FORGETFUL).fetch_all(self.database.reader()).await? {
            let TenantRow { name, retention_days } = tenant_row(&row)?;
            let Some(days) = retention_days else { continue };
            let age = days.saturating_mul(DAY_MS);
            let store = self.of_tenant(&name);
            for case in store.old(OLD_CASES, age).await? {
                let work = async { store.delete_case(&case, None).await.map(drop) };
                store
                    .noted(store.audited_action(RETENTION, "erase case", &case), work, |()| None)
                    .await?;
                erased += 1;
            }
            for job in store.old(OLD_JOBS, age).await? {
                let work = async { store.dismiss(&job).await.map(drop) };
                store
                    .noted(store.audited_action(RETENTION, "erase job", &job), work, |()| None)
                    .await?;
                erased += 1;
            }
            for mesh in store.old(OLD_MESHES, age).await? {
                let work = async { store.delete_mesh(&mesh).await.map(drop) };
                store
                    .noted(store.audited_action(RETENTION, "erase mesh", &mesh), work, |()| None)
                    .await?;
                erased += 1;
            }
        }
        self.refill_reserve().await;
        Ok(erased)
    }

    async fn old(&self, sql: &'static str, age: i64) -> Result<Vec<String>, StoreError> {
        let rows =
            query(sql).bind(self.tenant()).bind(age).fetch_all(self.database.reader()).await?;
        Ok(rows.iter().map(|row| row.try_get(0)).collect::<Result<_, _>>()?)
    }
}

/// The same for a tenant of this name.
pub(super) fn own(tenant: &str, text: &str) -> String {
    match tenant {
        DEFAULT_TENANT => text.to_owned(),
        tenant => format!("{tenant} {text}"),
    }
}

/// A text without spaces as it was before [`own`], and before what else stands in front of it.
pub(super) fn plain(text: String) -> String {
    match text.rsplit_once(' ') {
        Some((_, plain)) => plain.to_owned(),
        None => text,
    }
}

/// Another text with all that stands in front of the one of [`plain`].
pub(super) fn with_plain(text: &str, plain: &str) -> String {
    match text.rsplit_once(' ') {
        Some((before, _)) => format!("{before} {plain}"),
        None => plain.to_owned(),
    }
}
