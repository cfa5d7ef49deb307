//! Tags of jobs, for searches by clients: set with a job, added and removed at any time.

use std::collections::BTreeSet;

use serde_json::Value;

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
const DOCUMENT: &str = "SELECT document FROM jobs WHERE id = $1";
const REPLACE: &str = "UPDATE jobs SET document = $2 WHERE id = $1";

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

/// Takes tags out of what the job was accepted with. Nothing that it computes depends on them.
async fn forget_tags(
    transaction: &mut Transaction,
    job: &str,
    tags: &[&String],
) -> Result<(), sqlx::Error> {
    let row = query(DOCUMENT).bind(job).fetch_one(&mut *transaction).await?;
    let unreadable = |error: serde_json::Error| {
        sqlx::Error::Decode(format!("the document of job {job}: {error}").into())
    };
    if let Some(document) = untagged(&row.try_get::<String, _>(0)?, tags).map_err(unreadable)? {
        query(REPLACE).bind(job).bind(document).execute(&mut *transaction).await?;
    }
    Ok(())
}

/// The document `{KIND: {"spec": {"tags": [...]}}}` of a job without these tags; `None` where it has none of them.
fn untagged(document: &str, tags: &[&String]) -> serde_json::Result<Option<String>> {
    let mut parsed: Value = serde_json::from_str(document)?;
    let inputs = parsed.as_object_mut().into_iter().flat_map(serde_json::Map::values_mut);
    let mut is_changed = false;
    for own in inputs.filter_map(|input| input.pointer_mut("/spec/tags")?.as_array_mut()) {
        let before = own.len();
        own.retain(|tag| !tags.iter().any(|taken| tag.as_str() == Some(taken)));
        is_changed |= own.len() < before;
    }
    Ok(is_changed.then(|| parsed.to_string()))
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
        let taken: Vec<&String> = remove.iter().chain(others.iter().take(excess)).collect();
        for tag in &taken {
            query(TAKE_OFF).bind(job).bind(*tag).execute(&mut transaction).await?;
        }
        if !taken.is_empty() {
            forget_tags(&mut transaction, job, &taken).await?;
        }
        insert_tags(&mut transaction, job, add).await?;
        query(RENEW).bind(job).execute(&mut transaction).await?;
        transaction.commit().await?;
        if !taken.is_empty() {
            self.mark_erased();
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_loses_the_tags_of_its_job_and_nothing_else() {
        let document = r#"{"predict":{"case":{"tags":["a"]},"plan":{"name":"a"},"spec":{"poisson":0.1,"tags":["a","b"]}}}"#;
        let without = untagged(document, &[&"a".to_owned(), &"c".to_owned()]).unwrap();
        let wanted = document.replace(r#"["a","b"]"#, r#"["b"]"#);
        assert_eq!(without.as_deref(), Some(wanted.as_str()));
        for untouched in [wanted.as_str(), r#"{"cohort":{"spec":{}}}"#, "{}"] {
            assert_eq!(untagged(untouched, &[&"a".to_owned()]).unwrap(), None, "{untouched}");
        }
    }
}
