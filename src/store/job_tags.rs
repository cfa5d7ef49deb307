//! Tags of jobs, for searches by clients: set with a job, added and removed at any time.

use std::collections::BTreeSet;

use super::database::{Transaction, query};
use super::{Store, StoreError};

/// Changes of one job are serialised, so that concurrent ones respect the limit on tags.
const LOCK: &str = "SELECT 1 FROM jobs WHERE id = $1 AND tenant = $2 FOR UPDATE";
/// Those that were put on last at the end.
const TAGS: &str = "SELECT tag FROM job_tags WHERE job_id = $1 ORDER BY number, tag";
const PUT_ON: &str = "INSERT INTO job_tags (job_id, tag, number) \
     SELECT $1, $2, COALESCE(MAX(number), 0) + 1 FROM job_tags WHERE job_id = $1 \
     ON CONFLICT (job_id, tag) DO UPDATE SET number = excluded.number";
/// A request for a job, equal to that of another client or for its tags, is a change from which its age counts anew.
const RENEW: &str = "UPDATE jobs SET updated = (SELECT now_ms FROM age_clock) WHERE id = $1";
const TAKE_OFF: &str = "DELETE FROM job_tags WHERE job_id = $1 AND tag = $2";

pub(super) async fn insert_tags(
    transaction: &mut Transaction,
    job: &str,
    tags: &[String],
) -> Result<(), sqlx::Error> {
    for tag in tags {
        query(PUT_ON).bind(job).bind(tag).execute(&mut *transaction).await?;
    }
    Ok(())
}

impl Store {
    /// Takes tags off a job and puts others on it. Where it would have more than `most`, those that were put on longest ago go,
    /// and none of the request. What is to be there or to be away already is no mistake, so that changes may be sent again and come
    /// in any order. The retention of the job begins anew. False where there is no such job.
    pub async fn change_tags(
        &self,
        job: &str,
        add: &[String],
        remove: &[String],
        most: usize,
    ) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        let found = query(LOCK).bind(job).bind(self.tenant());
        if found.fetch_optional(&mut transaction).await?.is_none() {
            return Ok(false);
        }
        let rows = query(TAGS).bind(job).fetch_all(&mut transaction).await?;
        let mut others: Vec<String> =
            rows.iter().map(|row| row.try_get(0)).collect::<Result<_, _>>()?;
        others.retain(|tag| !add.contains(tag) && !remove.contains(tag));
        let added = add.iter().collect::<BTreeSet<_>>().len();
        let excess = match added {
            0 => 0,
            added => (others.len() + added).saturating_sub(most),
        };
        for tag in remove.iter().chain(others.iter().take(excess)) {
            query(TAKE_OFF).bind(job).bind(tag).execute(&mut transaction).await?;
        }
        insert_tags(&mut transaction, job, add).await?;
        query(RENEW).bind(job).execute(&mut transaction).await?;
        transaction.commit().await?;
        Ok(true)
    }
}
