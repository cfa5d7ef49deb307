//! Whether the key of a request is in force, asked again after everything that takes time: a key that is revoked meanwhile
//! reads, stores and follows nothing more.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::http::{HeaderValue, header};

use super::error::{ApiError, ApiResult};
use crate::schema::ErrorCode;
use crate::store::Store;

/// How long a lookup stays valid.
const FRESH: Duration = Duration::from_millis(100);

/// The lookup of a key at the arrival of its request.
#[derive(Clone, Debug)]
pub struct KeyLookup {
    /// The id of the key; `None` of a caller without a key, or with that of the settings.
    key: Option<Arc<str>>,
    at: Instant,
}

impl KeyLookup {
    pub fn of(key: Arc<str>, at: Instant) -> KeyLookup {
        KeyLookup { key: Some(key), at }
    }

    /// The lookup of a caller whom no row can end.
    pub fn of_no_row() -> KeyLookup {
        KeyLookup { key: None, at: Instant::now() }
    }

    /// Refuses a key that was revoked or has expired meanwhile.
    pub async fn require(&self, store: &Store) -> ApiResult<()> {
        let Some(key) = &self.key else { return Ok(()) };
        store.key_in_force(key).await?.map(drop).ok_or_else(not_in_force)
    }

    /// The same, unless the lookup is so recent that it counts.
    pub async fn require_if_old(&self, store: &Store) -> ApiResult<()> {
        match self.at.elapsed() < FRESH {
            true => Ok(()),
            false => self.require(store).await,
        }
    }
}

pub fn not_in_force() -> ApiError {
    unauthorized("this key is not known, or it was revoked or has expired")
}

/// The refusal of an unknown caller.
pub fn unauthorized(detail: &str) -> ApiError {
    let error = ApiError::new(ErrorCode::Unauthorized, detail);
    error.header(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::key::{KeyDocument, Scope};

    #[tokio::test]
    async fn a_key_is_asked_for_again_once_its_lookup_is_old() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        let scopes = [Scope::Read].into();
        let wanted = KeyDocument { label: "test".to_owned(), scopes, days: None };
        let key = store.make_key(&wanted).await.unwrap();
        let at = |at| KeyLookup::of(key.id.as_str().into(), at);
        let now = Instant::now() + Duration::from_secs(3600);
        let (old, fresh) = (at(Instant::now() - FRESH), at(now));
        assert!(old.require_if_old(&store).await.is_ok());
        assert!(store.revoke_key(&key.id).await.unwrap());
        let refused = old.require_if_old(&store).await.unwrap_err();
        assert_eq!(refused.problem.code, ErrorCode::Unauthorized);
        assert!(fresh.require_if_old(&store).await.is_ok());
        assert!(fresh.require(&store).await.is_err());
        assert!(KeyLookup::of_no_row().require(&store).await.is_ok());
    }
}
