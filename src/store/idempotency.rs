//! Idempotency keys: the id of what the first request made, or would have made. No answer is stored, only the id, so
//! that a repeated request gets the resource as it is now.

use super::database::{Row, query};
use super::{Store, StoreError};

/// How long a key is remembered.
const KEPT_MS: i64 = 24 * 3600 * 1000;

/// Meaning of a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reserved {
    /// The key is new, and now refers to the given id.
    Fresh,
    /// The same request was sent before, and this is the id of what it makes, or of what it `found` to be there already.
    Again { id: String, found: bool },
    /// Another request was sent with this key.
    Other,
}

const FORGET: &str = "DELETE FROM idempotency_keys WHERE created < (SELECT now_ms FROM clock) - $1";
const RESERVE: &str = "INSERT INTO idempotency_keys (key, fingerprint, resource, created) \
     VALUES ($1, $2, $3, (SELECT now_ms FROM clock)) ON CONFLICT (key) DO NOTHING";
const FIND: &str = "SELECT fingerprint, resource, found FROM idempotency_keys WHERE key = $1";
const FOUND: &str = "UPDATE idempotency_keys SET resource = $2, found = 1 WHERE key = $1";

impl Store {
    /// What a key stands for already.
    pub async fn reserved(
        &self,
        key: &str,
        fingerprint: &str,
    ) -> Result<Option<Reserved>, StoreError> {
        let row = query(FIND).bind(key).fetch_optional(self.database.reader()).await?;
        Ok(row.map(|row| reserved(&row, fingerprint)).transpose()?)
    }

    /// Gives a key the id that what its request makes is to have, unless it has one.
    pub async fn reserve(
        &self,
        key: &str,
        fingerprint: &str,
        resource: &str,
    ) -> Result<Reserved, StoreError> {
        // By itself: of two that forget the same keys while they hold one of their own, each could wait for the other.
        query(FORGET).bind(KEPT_MS).execute(&self.database.writer().await?).await?;
        let mut transaction = self.database.begin().await?;
        let is_fresh = query(RESERVE)
            .bind(key)
            .bind(fingerprint)
            .bind(resource)
            .execute(&mut transaction)
            .await?
            == 1;
        let row = query(FIND).bind(key).fetch_one(&mut transaction).await?;
        transaction.commit().await?;
        if is_fresh { Ok(Reserved::Fresh) } else { Ok(reserved(&row, fingerprint)?) }
    }

    /// Remembers that the request with a key made nothing: what it asks for was there already.
    pub async fn remember_found(&self, key: &str, resource: &str) -> Result<(), StoreError> {
        query(FOUND).bind(key).bind(resource).execute(&self.database.writer().await?).await?;
        Ok(())
    }
}

/// What a row says to a request with its key.
fn reserved(row: &Row, fingerprint: &str) -> Result<Reserved, sqlx::Error> {
    let known: String = row.try_get("fingerprint")?;
    if known != fingerprint {
        return Ok(Reserved::Other);
    }
    let found = row.try_get::<i64, _>("found")? == 1;
    Ok(Reserved::Again { id: row.try_get("resource")?, found })
}
