//! Tags of jobs, for searches by clients: set with a job, added and removed at any time.

use std::collections::BTreeSet;

use super::database::{Transaction, query};
use super::{Store, StoreError};

/// Outcome of a change of tags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tagged {
    Done,
    /// It would have so many, which is more than it may have; nothing is changed.
    TooMany(usize),
    NotFound,
}

/// Changes of one job are serialised, so that concurrent ones respect the limit on tags.
const LOCK: &str = "SELECT 1 FROM jobs WHERE id = $1 AND tenant = $2 FOR UPDATE";
const TAGS: &str = "SELECT tag FROM job_tags WHERE job_id = $1";
const PUT_ON: &str = "INSERT INTO job_tags (job_id, tag) VALUES ($1, $2) ON CONFLICT DO NOTHING";
/// A request for a job, equal to that of another client or for its tags, is a change from which its age counts anew.
const RENEW: &str = "UPDATE jobs SET updated = (SELECT now_ms FROM clock) WHERE id = $1";
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
    /// Takes tags off a job and puts others on it, at most `most` in all. What is to be there or to be away already is no
    /// mistake, so that changes may be sent again and come in any order. The retention of the job begins anew.
    pub async fn change_tags(
        &self,
        job: &str,
        add: &[String],
        remove: &[String],
        most: usize,
    ) -> Result<Tagged, StoreError> {
        let mut transaction = self.database.begin().await?;
        let found = query(LOCK).bind(job).bind(self.tenant());
        if found.fetch_optional(&mut transaction).await?.is_none() {
            return Ok(Tagged::NotFound);
        }
        let rows = query(TAGS).bind(job).fetch_all(&mut transaction).await?;
        let before: BTreeSet<String> =
            rows.iter().map(|row| row.try_get(0)).collect::<Result<_, _>>()?;
        let kept = before.iter().filter(|tag| !remove.contains(tag));
        let after: BTreeSet<&String> = kept.chain(add).collect();
        if after.len() > most.max(before.len()) {
            return Ok(Tagged::TooMany(after.len()));
        }
        for tag in remove {
            query(TAKE_OFF).bind(job).bind(tag).execute(&mut transaction).await?;
        }
        insert_tags(&mut transaction, job, add).await?;
        query(RENEW).bind(job).execute(&mut transaction).await?;
        transaction.commit().await?;
        Ok(Tagged::Done)
    }
}
