//! Retention: what is older than its tenant's retention since its last change is erased.

use super::database::{Transaction, query};
use super::tenants::tenant_row;
use super::{Change, Dismissal, MeshDeletion, Store, StoreError, TenantRow};

const FORGETFUL: &str =
    "SELECT name, retention_days FROM tenants WHERE retention_days IS NOT NULL ORDER BY name";
/// A case is as old as the youngest thing that belongs to it.
macro_rules! old_cases {
    ($rest:literal) => {
        concat!(
            "SELECT id FROM cases WHERE tenant = $1 \
               AND updated < (SELECT now_ms FROM clock) - $2 \
               AND NOT EXISTS (SELECT 1 FROM plans WHERE plans.case_id = cases.id \
                 AND plans.updated >= (SELECT now_ms FROM clock) - $2) \
               AND NOT EXISTS (SELECT 1 FROM jobs WHERE (jobs.case_id = cases.id \
                   OR jobs.id IN (SELECT job_id FROM job_cases WHERE case_id = cases.id)) \
                 AND jobs.updated >= (SELECT now_ms FROM clock) - $2)",
            $rest
        )
    };
}
const OLD_CASES: &str = old_cases!("");
const OLD_CASE: &str = old_cases!(" AND id = $3");
const OLD_JOBS: &str = "SELECT id FROM jobs WHERE tenant = $1 \
     AND status IN ('successful', 'failed', 'dismissed') \
     AND updated < (SELECT now_ms FROM clock) - $2";
const OLD_MESHES: &str = "SELECT id FROM meshes WHERE tenant = $1 \
     AND created < (SELECT now_ms FROM clock) - $2 \
     AND NOT EXISTS (SELECT 1 FROM case_meshes WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM job_meshes WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM cohort_members WHERE mesh_id = meshes.id) \
     AND NOT EXISTS (SELECT 1 FROM made_meshes WHERE mesh_id = meshes.id)";

/// Who erases what is too old.
const RETENTION: &str = "retention";
const DAY_MS: i64 = 24 * 3600 * 1000;
/// After so many in a row that could not be erased now the others are left to the next pass.
const MOST_UNAVAILABLE: usize = 3;

/// What retention erases.
#[derive(Clone, Copy)]
enum Kind {
    Case,
    Job,
    Mesh,
}

impl Kind {
    /// In this order: jobs and meshes of an old case go with it.
    const ALL: [Kind; 3] = [Kind::Case, Kind::Job, Kind::Mesh];

    /// The query for the old ones, and the action in the audit log.
    fn old(self) -> (&'static str, &'static str) {
        match self {
            Kind::Case => (OLD_CASES, "erase case"),
            Kind::Job => (OLD_JOBS, "erase job"),
            Kind::Mesh => (OLD_MESHES, "erase mesh"),
        }
    }
}

impl Store {
    /// Erases what is older than its tenant's retention since its last change: cases with all that belongs to them,
    /// other ended jobs, unreferenced meshes. Returns how many. What cannot be erased now is left to the next time, and everything
    /// while the clock is in doubt.
    pub async fn erase_old(&self) -> Result<usize, StoreError> {
        self.release_reserve().await;
        let erased = match self.note_clock().await {
            Ok(None) => self.erase_old_of_all().await,
            Ok(Some(_)) => Ok(0),
            Err(error) => Err(error),
        };
        self.refill_reserve().await;
        erased
    }

    async fn erase_old_of_all(&self) -> Result<usize, StoreError> {
        let (mut erased, mut unavailable) = (0, 0);
        for row in query(FORGETFUL).fetch_all(self.database.reader()).await? {
            let TenantRow { name, retention_days } = tenant_row(&row)?;
            let Some(days) = retention_days else { continue };
            let age = days.saturating_mul(DAY_MS);
            let store = self.of_tenant(&name);
            for kind in Kind::ALL {
                for id in store.old(kind.old().0, age).await? {
                    match store.erase_noted(kind, &id, age).await {
                        Ok(is_erased) => {
                            (erased, unavailable) = (erased + usize::from(is_erased), 0);
                        }
                        Err(error) if error.is_unavailable() => {
                            tracing::warn!(%error, %id, "what is too old could not be erased now");
                            unavailable += 1;
                        }
                        Err(error) => return Err(error),
                    }
                    if unavailable == MOST_UNAVAILABLE {
                        return Ok(erased);
                    }
                }
            }
        }
        Ok(erased)
    }

    /// False where it went, was changed or is referred to meanwhile.
    async fn erase_noted(&self, kind: Kind, id: &str, age: i64) -> Result<bool, StoreError> {
        let begun = self.begin_action(&self.audited_action(RETENTION, kind.old().1, id)).await?;
        let erased = match kind {
            Kind::Case => {
                let change = self.delete_case_of_age(id, None, age).await;
                change.map(|change| change == Change::Done)
            }
            Kind::Job => {
                let dismissal = self.remove_old_job(id, age).await;
                dismissal.map(|dismissal| dismissal == Dismissal::Removed)
            }
            Kind::Mesh => {
                let deletion = self.delete_mesh_of_age(id, age).await;
                deletion.map(|deletion| deletion == MeshDeletion::Deleted)
            }
        };
        let outcome = if matches!(erased, Ok(true)) { "done" } else { "failed" };
        if let Err(error) = self.end_action(begun, id, outcome).await {
            tracing::error!(%error, "the audit log is told later what retention erased");
        }
        erased
    }

    /// Whether nothing of a case has changed for `age`, in ms.
    pub(super) async fn is_old_case(
        &self,
        transaction: &mut Transaction,
        id: &str,
        age: i64,
    ) -> Result<bool, sqlx::Error> {
        let row = query(OLD_CASE).bind(self.tenant()).bind(age).bind(id);
        Ok(row.fetch_optional(transaction).await?.is_some())
    }

    async fn old(&self, sql: &'static str, age: i64) -> Result<Vec<String>, StoreError> {
        let rows =
            query(sql).bind(self.tenant()).bind(age).fetch_all(self.database.reader()).await?;
        Ok(rows.iter().map(|row| row.try_get(0)).collect::<Result<_, _>>()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::NewMesh;

    #[tokio::test]
    async fn what_is_no_longer_old_when_its_turn_comes_is_kept_and_the_audit_log_says_so() {
        let folder = tempfile::TempDir::new().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let mesh = NewMesh::example("0a1b");
        assert!(store.add_mesh(&mesh).await.unwrap());
        assert!(!store.erase_noted(Kind::Mesh, &mesh.id, DAY_MS).await.unwrap());
        assert!(store.mesh(&mesh.id).await.unwrap().is_some());
        assert!(store.erase_noted(Kind::Mesh, &mesh.id, 0).await.unwrap());
        assert!(!store.erase_noted(Kind::Mesh, &mesh.id, 0).await.unwrap(), "it is gone");
        let rows = store.audit(0, "", 9).await.unwrap();
        let told: Vec<&str> = rows.iter().map(|row| row.outcome.as_str()).collect();
        assert_eq!(told, ["failed", "done", "failed"]);
    }
}
