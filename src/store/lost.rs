//! Lost jobs, which failed through no fault of their own: listed for operators, and accepted again.

use super::database::query;
use super::events::record;
use super::waiting::{hold_case, wait_again};
use super::{Store, StoreError};

/// A job that failed through no fault of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostRow {
    pub id: String,
    pub tenant: String,
    pub kind: String,
    pub attempt: i64,
    pub finished: i64,
    /// JSON.
    pub error: String,
}

const LOST: &str = "SELECT id, tenant, kind, attempt, finished, error FROM jobs \
     WHERE status = 'failed' AND error_class = 'infrastructure' AND waits_for = '' AND id > $1 ORDER BY id LIMIT $2";
const REQUEUE: &str = "UPDATE jobs SET status = 'accepted', error = NULL, error_class = NULL, losses = 0, \
     finished = NULL, claimable_from = 0, updated = (SELECT now_ms FROM age_clock) \
     WHERE id = $1 AND status = 'failed' AND error_class = 'infrastructure' AND waits_for = ''";

impl Store {
    /// The jobs of all tenants that failed through no fault of their own, oldest first, those after `cursor` where
    /// one is given. Those that failed with the meshing of their case go on with it.
    pub async fn lost_jobs(
        &self,
        cursor: Option<&str>,
        limit: i64,
    ) -> Result<Vec<LostRow>, StoreError> {
        let rows = query(LOST)
            .bind(cursor.unwrap_or_default())
            .bind(limit)
            .fetch_all(self.database.reader())
            .await?;
        let mut lost = Vec::with_capacity(rows.len());
        for row in &rows {
            lost.push(LostRow {
                id: row.try_get("id")?,
                tenant: row.try_get("tenant")?,
                kind: row.try_get("kind")?,
                attempt: row.try_get("attempt")?,
                finished: row.try_get("finished")?,
                error: row.try_get("error")?,
            });
        }
        Ok(lost)
    }

    /// Accepts such a job again, and those that failed with it; false where there is none of this id.
    pub async fn requeue(&self, id: &str) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        hold_case(&mut transaction, id).await?;
        let changed = query(REQUEUE).bind(id).execute(&mut transaction).await?;
        let mut waited = Vec::new();
        if changed == 1 {
            record(&mut transaction, id).await?;
            waited = wait_again(&mut transaction, id).await?;
        }
        transaction.commit().await?;
        self.job_changed(id);
        waited.iter().for_each(|job| self.job_changed(job));
        Ok(changed == 1)
    }
}
