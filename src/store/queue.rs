//! Queue statistics for operators.

use super::database::query;
use super::{Store, StoreError};

/// How many jobs wait and run, and how long the one that waits longest has waited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueueRow {
    pub waiting: i64,
    pub running: i64,
    pub oldest_ms: i64,
}

const COUNT: &str = "SELECT (SELECT COUNT(*) FROM jobs WHERE status = 'accepted') AS waiting, \
     (SELECT COUNT(*) FROM jobs WHERE status = 'running') AS running, \
     COALESCE((SELECT (SELECT now_ms FROM clock) - MIN(created) FROM jobs WHERE status = 'accepted'), 0) \
       AS oldest_ms";

impl Store {
    /// Counts the jobs that have not ended, of a database that can be read.
    pub async fn queue(&self) -> Result<QueueRow, StoreError> {
        self.check_readable().await?;
        let row = query(COUNT).fetch_one(self.database.reader()).await?;
        Ok(QueueRow {
            waiting: row.try_get("waiting")?,
            running: row.try_get("running")?,
            oldest_ms: row.try_get("oldest_ms")?,
        })
    }
}
