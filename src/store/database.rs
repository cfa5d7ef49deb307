//! The database engine: everything that is SQLite's own stands in this file.
//!
//! The SQL text of the other files is portable ($1 placeholders, plain types, RETURNING), so another
//! engine needs its own connections, its own `clock` and, in `claim`, `FOR UPDATE SKIP LOCKED`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use sqlx::migrate::{MigrateError, Migrator};
use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};

use super::StoreError;

pub(super) type Pool = SqlitePool;
pub(super) type Row = sqlx::sqlite::SqliteRow;
pub(super) type Query<'q> = sqlx::query::Query<'q, sqlx::Sqlite, sqlx::sqlite::SqliteArguments>;
pub(super) type Transaction = sqlx::Transaction<'static, sqlx::Sqlite>;

static MIGRATIONS: Migrator = sqlx::migrate!("./migrations");

/// Milliseconds since 1970 by the clock of the database, for `(SELECT now_ms FROM clock)`: leases are
/// compared with no other clock, so it does not matter how wrong the clocks of the workers are.
const CLOCK: &str = "CREATE VIEW IF NOT EXISTS clock AS \
     SELECT CAST(unixepoch('subsec') * 1000 AS INTEGER) AS now_ms";

/// How long a statement waits for another process that writes.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);
/// How long a request waits for a connection before it is told to come back.
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(10);
const READERS: u32 = 4;

/// One connection that writes, so that writers queue here instead of failing with BUSY, and several that read.
#[derive(Clone)]
pub(super) struct Database {
    file: PathBuf,
    writer: Pool,
    reader: Pool,
}

impl Database {
    /// Opens the database, creates it if it is not there, and brings its schema up to date.
    pub async fn open(file: &Path) -> Result<Database, StoreError> {
        let database = Database::connect(file.to_owned()).await?;
        MIGRATIONS.run(&database.writer).await.map_err(schema_error)?;
        sqlx::query(CLOCK).execute(&database.writer).await?;
        Ok(database)
    }

    /// Connections of their own to the same database.
    pub async fn again(&self) -> Result<Database, StoreError> {
        Database::connect(self.file.clone()).await
    }

    async fn connect(file: PathBuf) -> Result<Database, StoreError> {
        let options = SqliteConnectOptions::new()
            .filename(&file)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            // A job that was accepted and a result that was announced outlast a power cut: each commit
            // is flushed, which NORMAL leaves to the next checkpoint.
            .synchronous(SqliteSynchronous::Full)
            .busy_timeout(BUSY_TIMEOUT)
            .foreign_keys(true);
        let pool = SqlitePoolOptions::new().acquire_timeout(ACQUIRE_TIMEOUT);
        let writer = pool.clone().max_connections(1);
        let reader = pool.max_connections(READERS);
        Ok(Database {
            writer: writer.connect_with(options.clone()).await?,
            reader: reader.connect_lazy_with(options),
            file,
        })
    }

    pub fn reader(&self) -> &Pool {
        &self.reader
    }

    /// For single statements.
    pub fn writer(&self) -> &Pool {
        &self.writer
    }

    /// A transaction that takes the write lock at once: one that reads first and writes later fails
    /// with BUSY, without waiting, when another has written in between.
    pub async fn begin(&self) -> Result<Transaction, StoreError> {
        Ok(self.writer.begin_with("BEGIN IMMEDIATE").await?)
    }

    pub async fn close(&self) {
        self.reader.close().await;
        self.writer.close().await;
    }
}

fn schema_error(error: MigrateError) -> StoreError {
    match error {
        MigrateError::VersionMissing(found) => StoreError::SchemaTooNew {
            found,
            known: MIGRATIONS.iter().map(|step| step.version).max().unwrap_or(0),
        },
        MigrateError::Execute(error) => StoreError::Database(error),
        other => StoreError::Schema(other.to_string()),
    }
}

/// True when the error says that the disk or the quota is full.
pub(super) fn is_full(error: &sqlx::Error) -> bool {
    const SQLITE_FULL: &str = "13";
    match error {
        sqlx::Error::Database(inner) => inner.code().is_some_and(|code| code == SQLITE_FULL),
        sqlx::Error::Io(inner) => inner.kind() == std::io::ErrorKind::StorageFull,
        _ => false,
    }
}

/// True when the error says that a unique key exists already.
pub(super) fn is_duplicate(error: &sqlx::Error) -> bool {
    matches!(error, sqlx::Error::Database(inner) if inner.is_unique_violation())
}

/// True when the error says that a row is referred to by another or refers to one that is not there.
pub(super) fn is_reference(error: &sqlx::Error) -> bool {
    matches!(error, sqlx::Error::Database(inner) if inner.is_foreign_key_violation())
}
