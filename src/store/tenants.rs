//! Tenants: isolated users of one deployment.

use super::database::{Row, Transaction, query};
use super::{DEFAULT_TENANT, Store, StoreError};

/// A tenant and how long what it does not change is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TenantRow {
    pub name: String,
    pub retention_days: Option<i64>,
}

/// A new tenant, like one without a job for long, is served next; after one turn it comes behind all others.
const ENTER: &str =
    "INSERT INTO tenants (name, served) VALUES ($1, 0) ON CONFLICT (name) DO NOTHING";
const LIST: &str =
    "SELECT name, retention_days FROM tenants WHERE name > $1 ORDER BY name LIMIT $2";
const RETAIN: &str = "UPDATE tenants SET retention_days = $2 WHERE name = $1";

pub(super) fn tenant_row(row: &Row) -> Result<TenantRow, sqlx::Error> {
    let retention_days = row.try_get("retention_days")?;
    Ok(TenantRow { name: row.try_get("name")?, retention_days })
}

impl Store {
    /// A text that is unique in its table and has to be so within a tenant only.
    pub(super) fn own(&self, text: &str) -> String {
        own(self.tenant(), text)
    }

    /// Sees to it that the tenant has a row.
    pub(super) async fn enter(&self, transaction: &mut Transaction) -> Result<(), sqlx::Error> {
        query(ENTER).bind(self.tenant()).execute(&mut *transaction).await?;
        Ok(())
    }

    /// Tenants by name, those after `cursor` where one is given.
    pub async fn tenants(
        &self,
        cursor: Option<&str>,
        limit: i64,
    ) -> Result<Vec<TenantRow>, StoreError> {
        let rows = query(LIST)
            .bind(cursor.unwrap_or_default())
            .bind(limit)
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(tenant_row).collect::<Result<_, _>>()?)
    }

    /// Sets the retention of unchanged resources; for ever where no number is given.
    pub async fn retain(&self, days: Option<i64>) -> Result<(), StoreError> {
        let mut transaction = self.database.begin().await?;
        self.enter(&mut transaction).await?;
        query(RETAIN).bind(self.tenant()).bind(days).execute(&mut transaction).await?;
        transaction.commit().await?;
        Ok(())
    }
}

/// The same for a tenant of this name.
pub(super) fn own(tenant: &str, text: &str) -> String {
    match tenant {
        DEFAULT_TENANT => text.to_owned(),
        tenant => format!("{tenant} {text}"),
    }
}

/// A text without spaces as it was before [`own`], and before what else stands in front of it.
pub(super) fn plain(text: String) -> String {
    match text.rsplit_once(' ') {
        Some((_, plain)) => plain.to_owned(),
        None => text,
    }
}

/// Another text with all that stands in front of the one of [`plain`].
pub(super) fn with_plain(text: &str, plain: &str) -> String {
    match text.rsplit_once(' ') {
        Some((before, _)) => format!("{before} {plain}"),
        None => plain.to_owned(),
    }
}
