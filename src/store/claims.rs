//! Claims: the choice of the next job for a worker.

use std::time::Duration;

use super::database::{Row, query};
use super::events::record;
use super::leases::{Lease, milliseconds};
use super::waiting::filled;
use super::{Store, StoreError};
use crate::schema::engine::EngineDocument;

/// A job to be worked on.
#[derive(Clone, Debug)]
pub struct Claim {
    pub lease: Lease,
    pub tenant: String,
    pub kind: String,
    pub document: String,
    pub created: i64,
    pub started: i64,
    /// Where in a trace it was accepted.
    pub traceparent: Option<String>,
}

/// Tenants with a job that can be claimed: first those with the fewest running jobs, so that a tenant whose jobs are short is not
/// left with no slot by one whose jobs are long, and of equals the one that has waited longest for its turn.
const IN_TURN: &str = "SELECT name FROM tenants WHERE EXISTS (SELECT 1 FROM jobs \
       WHERE jobs.tenant = tenants.name AND jobs.status = 'accepted' AND jobs.waits_for = '' AND jobs.numerics <= $1 \
       AND jobs.claimable_from <= (SELECT now_ms FROM clock)) \
       ORDER BY (SELECT COUNT(*) FROM jobs WHERE jobs.tenant = tenants.name AND jobs.status = 'running'), served, name";
/// The oldest of the most urgent jobs of a tenant, without rows that another transaction has locked.
const CLAIM: &str = "UPDATE jobs SET status = 'running', attempt = attempt + 1, lease_token = $1, \
     lease_expires = (SELECT now_ms FROM clock) + $2, heartbeat = (SELECT now_ms FROM clock), \
     phase = NULL, iteration = NULL, residual = NULL, \
     started = COALESCE(started, (SELECT now_ms FROM clock)), updated = (SELECT now_ms FROM age_clock) \
     WHERE id = (SELECT id FROM jobs WHERE status = 'accepted' AND tenant = $3 AND waits_for = '' AND numerics <= $4 \
       AND claimable_from <= (SELECT now_ms FROM clock) ORDER BY priority, id LIMIT 1 \
       FOR UPDATE SKIP LOCKED) \
     AND status = 'accepted' RETURNING id, attempt, tenant, kind, case_id, document, created, started, traceparent";
/// Skipped while another worker, which has the row of the tenant locked, serves it.
const SERVED: &str = "UPDATE tenants SET served = (SELECT MAX(served) FROM tenants) + 1 \
     WHERE name = (SELECT name FROM tenants WHERE name = $1 FOR UPDATE SKIP LOCKED)";

impl Store {
    /// Takes an accepted job, if there is one, of the tenant with the fewest running jobs, of equals of the one that has waited
    /// longest for its turn: the oldest of its most urgent ones that this program may run (see [`super::engines`]). Two workers never take the same. Where all
    /// jobs of a tenant are locked by other workers, the next tenant is served.
    pub async fn claim(&self, lease: Duration) -> Result<Option<Claim>, StoreError> {
        self.claim_if(lease, std::future::ready(true)).await
    }

    /// The same if a condition holds, which is asked for only where there is a job, before anything is written.
    pub async fn claim_if(
        &self,
        lease: Duration,
        condition: impl Future<Output = bool>,
    ) -> Result<Option<Claim>, StoreError> {
        let numerics = this_numerics();
        let tenants = query(IN_TURN).bind(numerics).fetch_all(self.database.reader()).await?;
        if tenants.is_empty() || !condition.await {
            return Ok(None);
        }
        for tenant in &tenants {
            let claimed = self.claim_of(tenant.try_get(0)?, lease, numerics).await?;
            if claimed.is_some() {
                return Ok(claimed);
            }
        }
        Ok(None)
    }

    async fn claim_of(
        &self,
        tenant: &str,
        lease: Duration,
        numerics: i64,
    ) -> Result<Option<Claim>, StoreError> {
        let token = uuid::Uuid::now_v7().to_string();
        let mut transaction = self.database.begin().await?;
        let row = query(CLAIM)
            .bind(&token)
            .bind(milliseconds(lease))
            .bind(tenant)
            .bind(numerics)
            .fetch_optional(&mut transaction)
            .await?;
        let Some(row) = row else { return Ok(None) };
        let mut claim = claim_row(&row, token)?;
        let case: Option<String> = row.try_get("case_id")?;
        let job = &claim.lease.job;
        claim.document = filled(&mut transaction, job, case.as_deref(), claim.document).await?;
        record(&mut transaction, &claim.lease.job).await?;
        query(SERVED).bind(tenant).execute(&mut transaction).await?;
        transaction.commit().await?;
        self.job_changed(&claim.lease.job);
        Ok(Some(claim))
    }
}

/// The revision of the numerics of this program.
fn this_numerics() -> i64 {
    i64::from(EngineDocument::this().numerics)
}

fn claim_row(row: &Row, token: String) -> Result<Claim, sqlx::Error> {
    Ok(Claim {
        lease: Lease { job: row.try_get("id")?, token, attempt: row.try_get("attempt")? },
        tenant: row.try_get("tenant")?,
        kind: row.try_get("kind")?,
        document: row.try_get("document")?,
        created: row.try_get("created")?,
        started: row.try_get("started")?,
        traceparent: row.try_get("traceparent")?,
    })
}
