//! Keys of clients. A key is `fcs_<id>_<secret>`; only the hash of the whole is stored.

use super::database::{Row, Transaction, query};
use super::{Store, StoreError};
use crate::schema::key::{Key, KeyDocument, scope_words};
use crate::schema::wire::canonical::sha256_hex;

const HOUR_MS: i64 = 3600 * 1000;
const DAY_MS: i64 = 24 * HOUR_MS;

/// A key without its secret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyRow {
    pub id: String,
    pub tenant: String,
    pub label: String,
    /// SHA-256 of the whole key, in hexadecimal.
    pub hash: String,
    /// Words of [`crate::schema::key::Scope`], separated by spaces.
    pub scopes: String,
    pub created: i64,
    pub expires: Option<i64>,
    pub revoked: Option<i64>,
}

/// A key to be made.
struct NewKey {
    label: String,
    scopes: String,
    lasts_ms: Option<i64>,
    /// Whether another ends at once, so that there is none more.
    replaces_another: bool,
}

const INSERT: &str = "INSERT INTO keys (id, tenant, label, hash, scopes, created, expires) \
     VALUES ($1, $2, $3, $4, $5, (SELECT now_ms FROM clock), \
       (SELECT now_ms FROM clock) + CAST($6 AS BIGINT))";
macro_rules! columns {
    () => {
        "SELECT id, tenant, label, hash, scopes, created, expires, revoked FROM keys "
    };
}
const IN_FORCE: &str = concat!(
    columns!(),
    "WHERE id = $1 AND revoked IS NULL AND (expires IS NULL OR expires > (SELECT now_ms FROM clock))"
);
/// A key is never taken out of the table, so that the one which a cursor names is there.
const OF_TENANT: &str = concat!(
    columns!(),
    "WHERE tenant = $1 AND ($2 = '' OR (created, id) > \
       (SELECT last.created, last.id FROM keys AS last WHERE last.id = $2 AND last.tenant = $1)) \
     ORDER BY created, id LIMIT $3"
);
/// Of two that make a key at the same time one waits for the other.
const LOCK: &str = "SELECT name FROM tenants WHERE name = $1 FOR UPDATE";
const COUNT_IN_FORCE: &str = "SELECT COUNT(*) FROM keys WHERE tenant = $1 AND revoked IS NULL \
     AND (expires IS NULL OR expires > (SELECT now_ms FROM clock))";
const REVOKE: &str = "UPDATE keys SET revoked = (SELECT now_ms FROM clock) \
     WHERE id = $1 AND tenant = $2 AND revoked IS NULL";
const EXPIRE: &str = "UPDATE keys SET expires = (SELECT now_ms FROM clock) + $2 \
     WHERE id = $1 AND tenant = $3 AND revoked IS NULL \
     AND (expires IS NULL OR expires > (SELECT now_ms FROM clock) + $2)";

pub(super) fn key_row(row: &Row) -> Result<KeyRow, sqlx::Error> {
    Ok(KeyRow {
        id: row.try_get("id")?,
        tenant: row.try_get("tenant")?,
        label: row.try_get("label")?,
        hash: row.try_get("hash")?,
        scopes: row.try_get("scopes")?,
        created: row.try_get("created")?,
        expires: row.try_get("expires")?,
        revoked: row.try_get("revoked")?,
    })
}

impl Store {
    /// Makes a key of this tenant, unless it has as many as it may have. Only its hash is kept: whoever asked has to.
    pub async fn make_key(&self, wanted: &KeyDocument) -> Result<Key, StoreError> {
        let new = NewKey {
            label: wanted.label.clone(),
            scopes: scope_words(&wanted.scopes),
            lasts_ms: wanted.days.map(|days| days * DAY_MS),
            replaces_another: false,
        };
        self.add_key(new).await
    }

    async fn add_key(&self, new: NewKey) -> Result<Key, StoreError> {
        let mut random = [0; Key::RANDOM_BYTES];
        let source = rustls::crypto::ring::default_provider().secure_random;
        source.fill(&mut random).map_err(|_| StoreError::NoRandomness)?;
        let key = Key::from_random(&random);
        let mut transaction = self.database.begin().await?;
        self.enter(&mut transaction).await?;
        if !new.replaces_another {
            self.refuse_too_many(&mut transaction).await?;
        }
        query(INSERT)
            .bind(&key.id)
            .bind(self.tenant())
            .bind(new.label)
            .bind(sha256_hex(key.text.as_bytes()))
            .bind(new.scopes)
            .bind(new.lasts_ms)
            .execute(&mut transaction)
            .await?;
        transaction.commit().await?;
        Ok(key)
    }

    async fn refuse_too_many(&self, transaction: &mut Transaction) -> Result<(), StoreError> {
        query(LOCK).bind(self.tenant()).fetch_all(&mut *transaction).await?;
        let row = query(COUNT_IN_FORCE).bind(self.tenant()).fetch_one(&mut *transaction).await?;
        let (keys, most) = (row.try_get::<i64, _>(0)?, self.most_keys);
        if keys >= most {
            return Err(StoreError::TooManyKeys { keys, most });
        }
        Ok(())
    }

    /// Makes a key that allows what another of this tenant does, which ends some time from now; `None` where there is none
    /// in force. The new one lasts as long as the old one was made for. While both are in force both count.
    pub async fn rotate_key(&self, id: &str, overlap_h: i64) -> Result<Option<Key>, StoreError> {
        let old = self.key_in_force(id).await?.filter(|key| key.tenant == self.tenant());
        let Some(old) = old else { return Ok(None) };
        let new = NewKey {
            lasts_ms: old.expires.map(|expires| expires - old.created),
            label: old.label,
            scopes: old.scopes,
            replaces_another: overlap_h == 0,
        };
        let key = self.add_key(new).await?;
        self.expire_key(id, overlap_h * HOUR_MS).await?;
        Ok(Some(key))
    }

    /// The key of this id, of whichever tenant, if it may be used now: asked anew for every request, so that a revoked key
    /// ends at once.
    pub async fn key_in_force(&self, id: &str) -> Result<Option<KeyRow>, StoreError> {
        let row = query(IN_FORCE).bind(id).fetch_optional(self.database.reader()).await?;
        Ok(row.as_ref().map(key_row).transpose()?)
    }

    /// The keys of this tenant, oldest first, also those that are over; those after `cursor`, the id of one of them, where
    /// one is given.
    pub async fn keys(&self, cursor: Option<&str>, limit: i64) -> Result<Vec<KeyRow>, StoreError> {
        let rows = query(OF_TENANT)
            .bind(self.tenant())
            .bind(cursor.unwrap_or_default())
            .bind(limit)
            .fetch_all(self.database.reader())
            .await?;
        Ok(rows.iter().map(key_row).collect::<Result<_, _>>()?)
    }

    /// Ends a key of this tenant now; false when there is none that was not revoked.
    pub async fn revoke_key(&self, id: &str) -> Result<bool, StoreError> {
        let revoked = query(REVOKE)
            .bind(id)
            .bind(self.tenant())
            .execute(&self.database.writer().await?)
            .await?;
        Ok(revoked == 1)
    }

    /// Lets a key of this tenant end some time from now, if it would not end sooner.
    async fn expire_key(&self, id: &str, after_ms: i64) -> Result<bool, StoreError> {
        let changed = query(EXPIRE)
            .bind(id)
            .bind(after_ms)
            .bind(self.tenant())
            .execute(&self.database.writer().await?)
            .await?;
        Ok(changed == 1)
    }
}
