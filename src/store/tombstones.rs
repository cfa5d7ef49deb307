//! Tombstones of erased resources: id and time, so that a client gets 410 and not 404.

use super::database::{Transaction, query};
use super::{Store, StoreError};

const BURY: &str = "INSERT INTO tombstones (id, tenant, erased) VALUES ($1, $2, (SELECT now_ms FROM clock)) \
     ON CONFLICT (id) DO NOTHING";
/// A case with all that goes with it; its meshes follow one by one.
const BURY_CASE: &str = "INSERT INTO tombstones (id, tenant, erased) \
     SELECT id, $2, (SELECT now_ms FROM clock) FROM (SELECT id FROM cases WHERE id = $1 \
       UNION SELECT id FROM plans WHERE case_id = $1 UNION SELECT id FROM jobs WHERE case_id = $1 \
       UNION SELECT job_id FROM job_cases WHERE case_id = $1) AS erased WHERE TRUE \
     ON CONFLICT (id) DO NOTHING";

impl Store {
    /// Remembers one id.
    pub(super) async fn insert_tombstone(
        &self,
        transaction: &mut Transaction,
        id: &str,
    ) -> Result<(), sqlx::Error> {
        query(BURY).bind(id).bind(self.tenant()).execute(&mut *transaction).await?;
        Ok(())
    }

    /// Remembers the ids of a case, its plans and its jobs, which are about to go.
    pub(super) async fn insert_tombstones_of_case(
        &self,
        transaction: &mut Transaction,
        id: &str,
    ) -> Result<(), sqlx::Error> {
        query(BURY_CASE).bind(id).bind(self.tenant()).execute(&mut *transaction).await?;
        Ok(())
    }

    /// When something was erased, in ms since 1970; `None` where it was not.
    pub async fn erased(&self, id: &str) -> Result<Option<i64>, StoreError> {
        let row = query("SELECT erased FROM tombstones WHERE id = $1 AND tenant = $2")
            .bind(id)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        Ok(row.map(|row| row.try_get(0)).transpose()?)
    }
}
