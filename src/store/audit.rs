//! Audit log of requests that change something. Rows are added, never changed; each carries a hash of itself and of the
//! hash before it, so that a row that was changed, removed or inserted shows.

use super::audited_action::AuditedAction;
use super::database::{Row, is_duplicate, query};
use super::{Store, StoreError};
use crate::schema::wire::canonical::sha256_hex;

/// A row of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AuditRow {
    pub number: i64,
    /// When it began, ms since 1970 by the clock of the database.
    pub at: i64,
    pub audited: AuditedAction,
    /// HTTP status, `done`, `failed`, or `unknown` where nobody lived to tell.
    pub outcome: String,
    pub hash: String,
}

/// Result of the check of the whole log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Chain {
    /// So many rows, and the hash of the last one: kept elsewhere, it shows whether the log was written anew.
    Whole { rows: i64, hash: String },
    /// The first row that does not follow from those before it, the end that is not where it was noted, or a row before
    /// the first or behind the end.
    Broken { at: i64 },
}

const LOOK: &str = "SELECT number, hash FROM audit_end WHERE one = 1";
/// One statement, which sees a row that is added together with the end that was moved to it.
const OUTSIDE: &str = "SELECT MIN(number) FROM audit \
     WHERE number < 1 OR number > COALESCE((SELECT number FROM audit_end WHERE one = 1), 0)";
const AFTER: &str = "SELECT number, at, tenant, actor, action, object, outcome, request, hash \
     FROM audit WHERE number > $1 AND ($2 = '' OR tenant = $2) ORDER BY number LIMIT $3";

/// Rows that are looked at together.
const AT_ONCE: i64 = 1000;

impl AuditRow {
    /// Fields are distinguished by a byte that none of them has.
    pub(super) fn hash_after(&self, previous: &str) -> String {
        let AuditedAction { tenant, actor, action, object, request } = &self.audited;
        let (number, at) = (self.number.to_string(), self.at.to_string());
        let fields: [&str; 9] =
            [previous, &number, &at, tenant, actor, action, object, &self.outcome, request];
        sha256_hex(fields.join("\0").as_bytes())
    }

    fn of_row(row: &Row) -> Result<AuditRow, sqlx::Error> {
        Ok(AuditRow {
            number: row.try_get("number")?,
            at: row.try_get("at")?,
            audited: AuditedAction::of_row(row)?,
            outcome: row.try_get("outcome")?,
            hash: row.try_get("hash")?,
        })
    }
}

impl Store {
    /// Rows after a number, of a tenant or, where it is empty, of all: everything that has ended by now in this process is
    /// there.
    pub async fn audit(
        &self,
        after: i64,
        tenant: &str,
        limit: i64,
    ) -> Result<Vec<AuditRow>, StoreError> {
        self.chain_ended().await?;
        self.rows(after, tenant, limit).await
    }

    /// Takes what has ended into the chain, as far as no row that somebody inserted behind its end stands in the way.
    async fn chain_ended(&self) -> Result<(), StoreError> {
        self.write_outcomes().await?;
        match self.chain_actions().await {
            Err(StoreError::Database(error)) if is_duplicate(&error) => {
                tracing::error!(%error, "the audit log has a row behind its end, and cannot grow");
                Ok(())
            }
            chained => chained.map(drop),
        }
    }

    async fn rows(
        &self,
        after: i64,
        tenant: &str,
        limit: i64,
    ) -> Result<Vec<AuditRow>, StoreError> {
        let rows = query(AFTER)
            .bind(after)
            .bind(tenant)
            .bind(limit)
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(AuditRow::of_row).collect::<Result<_, _>>()?)
    }

    /// Looks at every row whether it follows from the one before.
    pub async fn check_audit(&self) -> Result<Chain, StoreError> {
        self.chain_ended().await?;
        let end = query(LOOK).fetch_optional(self.database.reader()).await?;
        let (number, hash): (i64, String) = match end {
            Some(end) => (end.try_get("number")?, end.try_get("hash")?),
            None => (0, String::new()),
        };
        let (mut last, mut before) = (0, String::new());
        while last < number {
            let rows = self.rows(last, "", AT_ONCE.min(number - last)).await?;
            if rows.is_empty() {
                return Ok(Chain::Broken { at: last + 1 });
            }
            for row in rows {
                if row.number != last + 1 || row.hash != row.hash_after(&before) {
                    return Ok(Chain::Broken { at: last + 1 });
                }
                (last, before) = (row.number, row.hash);
            }
        }
        if before != hash {
            return Ok(Chain::Broken { at: number });
        }
        let outside = query(OUTSIDE).fetch_one(self.database.reader()).await?;
        Ok(match outside.try_get::<Option<i64>, _>(0)? {
            Some(at) => Chain::Broken { at },
            None => Chain::Whole { rows: number, hash },
        })
    }
}
