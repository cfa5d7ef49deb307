//! Plan responses of a case, with the version that each was built for.

use super::database::{Row, query};
use super::keys::{KeyRow, key_row};
use super::{Store, StoreError, tenants};

/// A case with the jobs that have built a response of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseResponses {
    /// The version of the case.
    pub version: i64,
    /// Successful jobs, newest first.
    pub jobs: Vec<String>,
}

/// Case version that a response was built for.
#[derive(Clone, Debug)]
pub struct ResponseRow {
    /// The document of its job.
    pub document: String,
    /// The key that it had then.
    pub key: String,
}

const RESPONSES: &str = "SELECT cases.version, jobs.id AS job FROM cases LEFT JOIN jobs \
     ON jobs.case_id = cases.id AND jobs.kind = 'response' AND jobs.status = 'successful' \
     WHERE cases.id = $1 AND cases.tenant = $2 ORDER BY jobs.id DESC";

/// The same with a key of the tenant, where it is in force.
const WITH_KEY: &str = "SELECT keys.id, keys.tenant, label, hash, scopes, keys.created, expires, revoked, \
       cases.version, jobs.id AS job FROM keys \
     LEFT JOIN cases ON cases.id = $2 AND cases.tenant = keys.tenant \
     LEFT JOIN jobs ON jobs.case_id = cases.id AND jobs.kind = 'response' AND jobs.status = 'successful' \
     WHERE keys.id = $1 AND revoked IS NULL AND (expires IS NULL OR expires > (SELECT now_ms FROM clock)) \
     ORDER BY jobs.id DESC";

fn responses_of(rows: &[Row]) -> Result<Option<CaseResponses>, sqlx::Error> {
    let Some(first) = rows.first() else { return Ok(None) };
    let Some(version) = first.try_get("version")? else { return Ok(None) };
    let jobs = rows.iter().map(|row| row.try_get::<Option<String>, _>("job"));
    let jobs = jobs.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    Ok(Some(CaseResponses { version, jobs }))
}

impl Store {
    /// The key of this id, of whichever tenant, if it may be used now, and the responses of a case of that tenant.
    pub async fn key_and_responses(
        &self,
        key: &str,
        case: &str,
    ) -> Result<Option<(KeyRow, Option<CaseResponses>)>, StoreError> {
        let rows = query(WITH_KEY).bind(key).bind(case).fetch_all(self.database.reader()).await?;
        let Some(first) = rows.first() else { return Ok(None) };
        Ok(Some((key_row(first)?, responses_of(&rows)?)))
    }

    /// The responses of a case; `None` where there is no such case.
    pub async fn responses(&self, case: &str) -> Result<Option<CaseResponses>, StoreError> {
        let rows = query(RESPONSES)
            .bind(case)
            .bind(self.tenant())
            .fetch_all(self.database.reader())
            .await?;
        Ok(responses_of(&rows)?)
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
