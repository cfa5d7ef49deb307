//! Classification of database errors.

use super::{postgres, sqlite_codes as sqlite};

/// True when the error says that the disk or the quota is full.
pub fn is_full(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::Database(inner) => {
            inner.code().is_some_and(|code| code == sqlite::FULL || code == postgres::FULL)
        }
        sqlx::Error::Io(inner) => inner.kind() == std::io::ErrorKind::StorageFull,
        _ => false,
    }
}

/// True when the database is busy or out of reach, so that the same may succeed later.
pub fn is_unavailable(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::PoolTimedOut | sqlx::Error::PoolClosed => true,
        sqlx::Error::Io(inner) => inner.kind() != std::io::ErrorKind::StorageFull,
        sqlx::Error::Database(inner) => inner
            .code()
            .is_some_and(|code| sqlite::is_transient(&code) || postgres::is_transient(&code)),
        _ => false,
    }
}

/// True when the database can be read and not written.
pub fn is_read_only(error: &sqlx::Error) -> bool {
    matches!(error, sqlx::Error::Database(inner) if inner
        .code()
        .is_some_and(|code| sqlite::is_read_only(&code) || postgres::is_read_only(&code)))
}

/// True when the file of an embedded database is damaged.
pub fn is_damaged(error: &sqlx::Error) -> bool {
    sqlite::damage(error).is_some()
}

/// True when the server does not let us in, whatever we ask: a wrong user, password or name.
pub fn is_refused(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::Configuration(_) | sqlx::Error::Tls(_) => true,
        sqlx::Error::Database(inner) => {
            inner.code().is_some_and(|code| postgres::is_access_denied(&code))
        }
        _ => false,
    }
}

/// True when the error says that a unique key exists already.
pub fn is_duplicate(error: &sqlx::Error) -> bool {
    matches!(error, sqlx::Error::Database(inner) if inner.is_unique_violation())
}

/// True when the error says that a row is referred to by another or refers to one that is not there.
pub fn is_reference(error: &sqlx::Error) -> bool {
    matches!(error, sqlx::Error::Database(inner) if inner.is_foreign_key_violation())
}
