//! Plan responses of a case: which there are, and what they were built for.

use super::database::query;
use super::{Store, StoreError, tenants};

/// A case with the jobs that have built a response of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseResponses {
    /// The version of the case.
    pub version: i64,
    /// Successful jobs, newest first.
    pub jobs: Vec<String>,
}

/// What a response was built for.
#[derive(Clone, Debug)]
pub struct ResponseRow {
    /// The document of its job.
    pub document: String,
    /// The key that it had then.
    pub key: String,
}

const RESPONSES: &str = "SELECT cases.version, jobs.id FROM cases LEFT JOIN jobs \
     ON jobs.case_id = cases.id AND jobs.kind = 'response' AND jobs.status = 'successful' \
     WHERE cases.id = $1 AND cases.tenant = $2 ORDER BY jobs.id DESC";

impl Store {
    /// The responses of a case; `None` where there is no such case.
    pub async fn responses(&self, case: &str) -> Result<Option<CaseResponses>, StoreError> {
        let rows = query(RESPONSES)
            .bind(case)
            .bind(self.tenant())
            .fetch_all(self.database.reader())
            .await?;
        let Some(first) = rows.first() else { return Ok(None) };
        let version = first.try_get(0)?;
        let jobs = rows.iter().map(|row| row.try_get::<Option<String>, _>(1));
        let jobs = jobs.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        Ok(Some(CaseResponses { version, jobs }))
    }

    /// What a job was built for; `None` where it went meanwhile.
    pub async fn response(&self, job: &str) -> Result<Option<ResponseRow>, StoreError> {
        let row = query("SELECT document, spec_hash FROM jobs WHERE id = $1 AND tenant = $2")
            .bind(job)
            .bind(self.tenant())
            .fetch_optional(self.database.reader())
            .await?;
        let Some(row) = row else { return Ok(None) };
        Ok(Some(ResponseRow { document: row.try_get(0)?, key: tenants::plain(row.try_get(1)?) }))
    }
}
