//! Particulars of SQLite: its file, its one writer, its clock.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use futures::TryStreamExt;
use sqlx::pool::PoolConnection;
use sqlx::sqlite::{
    Sqlite, SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqlitePool,
    SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, Connection, Either, Executor, SqlSafeStr};

use super::file::{DatabaseFile, PlacedFile};
use super::sqlite_codes::damage;
use super::{Row, RowSink, Statement, Value};

/// Milliseconds since 1970 by the clock of the database, for `(SELECT now_ms FROM clock)`: leases are
/// compared with no other clock, so it does not matter how wrong the clocks of the workers are.
pub const CLOCK: &str = "CREATE VIEW IF NOT EXISTS clock AS \
     SELECT CAST(unixepoch('subsec') * 1000 AS INTEGER) AS now_ms";

/// The columns of a table, their types, and whether each has to hold something.
pub const COLUMNS: &str =
    "SELECT name, UPPER(type), \"notnull\" = 1 OR pk > 0 FROM pragma_table_info($1)";

/// How long a statement waits for another process that writes.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);
/// How long a request waits for a connection before it is told to come back.
pub const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(10);
const READERS: u32 = 4;

/// Connections to the file of a database, which is compared with the one that was opened before each is handed out.
#[derive(Clone)]
pub struct Connections {
    pub pool: SqlitePool,
    pub file: Arc<DatabaseFile>,
}

impl Connections {
    pub async fn acquire(&self) -> Result<PoolConnection<Sqlite>, sqlx::Error> {
        // Before a connection is opened: SQLite would take the log beside another file for that of this one.
        self.file.check()?;
        self.file.watched(self.pool.acquire().await)
    }

    /// A transaction that takes the write lock at once: one that reads first and writes later fails
    /// with BUSY, without waiting, when another has written in between.
    pub async fn begin(&self) -> Result<sqlx::Transaction<'static, Sqlite>, sqlx::Error> {
        self.begin_with("BEGIN IMMEDIATE").await
    }

    /// A transaction that sees everything as it is when it reads first.
    pub async fn snapshot(&self) -> Result<sqlx::Transaction<'static, Sqlite>, sqlx::Error> {
        self.begin_with("BEGIN").await
    }

    async fn begin_with(
        &self,
        statement: &'static str,
    ) -> Result<sqlx::Transaction<'static, Sqlite>, sqlx::Error> {
        self.file.check()?;
        self.file.watched(self.pool.begin_with(statement).await)
    }
}

/// One connection that writes, so that writers queue here instead of failing with BUSY, and several that read. The file is made only
/// where it is not `known`. `lock` is that of its folder.
pub async fn connect(
    path: &Path,
    lock: &PlacedFile,
    known: Option<Arc<DatabaseFile>>,
) -> Result<(Connections, Connections), sqlx::Error> {
    known.iter().try_for_each(|file| file.check())?;
    let options = options(path);
    let pool = SqlitePoolOptions::new()
        .acquire_timeout(ACQUIRE_TIMEOUT)
        // It is asked when it comes back, and nobody can take it away meanwhile.
        .test_before_acquire(false)
        .after_release(|connection, _| Box::pin(is_free(connection)));
    let first = options.clone().create_if_missing(known.is_none());
    let writer = pool.clone().max_connections(1).connect_with(first).await?;
    writer.set_connect_options(options.clone());
    let file = match known {
        Some(file) => file,
        None => Arc::new(DatabaseFile::opened(path, lock.clone())?),
    };
    let reader = pool.max_connections(READERS).connect_lazy_with(options);
    Ok((Connections { pool: writer, file: file.clone() }, Connections { pool: reader, file }))
}

fn options(file: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(file)
        .journal_mode(SqliteJournalMode::Wal)
        // A job that was accepted and a result that was announced outlast a power cut: each commit
        // is flushed, which NORMAL leaves to the next checkpoint.
        .synchronous(SqliteSynchronous::Full)
        .busy_timeout(BUSY_TIMEOUT)
        // What is deleted is overwritten with zeros.
        .pragma("secure_delete", "ON")
        .foreign_keys(true)
}

/// Whether a connection that comes back may be used again. Where a commit or a statement failed, SQLite may have rolled
/// back by itself; the driver's own ROLLBACK then finds nothing, and the driver takes the connection for one that is
/// within a transaction, in which no other can begin. Such a connection is closed, and the next one opened.
async fn is_free(connection: &mut SqliteConnection) -> Result<bool, sqlx::Error> {
    // What is queued behind the last statement, such as a ROLLBACK, is done by then.
    connection.ping().await?;
    Ok(!connection.is_in_transaction())
}

/// Checkpoints and truncates the write-ahead log; false while a reader or a writer prevents it.
pub async fn empty_log(file: &Path) -> Result<bool, sqlx::Error> {
    // Waiting here would make those wait who write.
    let options = options(file).busy_timeout(Duration::ZERO);
    let mut connection = SqliteConnection::connect_with(&options).await?;
    let asked = sqlx::query_scalar("PRAGMA wal_checkpoint(TRUNCATE)");
    let is_busy: Result<i64, _> = asked.fetch_one(&mut connection).await;
    connection.close().await?;
    Ok(is_busy? == 0)
}

/// What is wrong with the pages of the file and with its indexes, at most so much of it.
const CHECK: &str = "PRAGMA integrity_check(20)";
/// The same of one table without its indexes' content, where the whole check is broken off.
const CHECK_TABLE: &str = "SELECT quick_check FROM pragma_quick_check($1)";
const TABLES: &str = "SELECT name FROM sqlite_schema WHERE type = 'table'";

/// Reads every page of the file; returns what is wrong, with its pages, or its table where a check is broken off.
pub async fn faults(pool: &SqlitePool) -> Result<Vec<String>, sqlx::Error> {
    let broken_off = match told(sqlx::query_scalar(CHECK).fetch_all(pool).await)? {
        Ok(faults) => return Ok(faults),
        Err(message) => message,
    };
    let mut found = Vec::new();
    let tables: Vec<String> = match told(sqlx::query_scalar(TABLES).fetch_all(pool).await)? {
        Ok(tables) => tables,
        Err(message) => return Ok(vec![message]),
    };
    for table in tables {
        match told(sqlx::query_scalar(CHECK_TABLE).bind(&table).fetch_all(pool).await)? {
            Ok(faults) => found.extend(faults),
            Err(message) => found.push(format!("table {table}: {message}")),
        }
    }
    if found.is_empty() {
        found.push(broken_off);
    }
    Ok(found)
}

/// The lines that a check tells, or its message where the damage breaks it off.
fn told(
    lines: Result<Vec<String>, sqlx::Error>,
) -> Result<Result<Vec<String>, String>, sqlx::Error> {
    match lines {
        Ok(texts) => {
            let lines = texts.iter().flat_map(|text| text.lines()).map(str::trim);
            let faults = lines.filter(|line| *line != "ok" && !line.starts_with("***"));
            Ok(Ok(faults.map(str::to_owned).collect()))
        }
        Err(error) => match damage(&error) {
            Some(told) => Ok(Err(told)),
            None => Err(error),
        },
    }
}

/// Runs a statement to its end.
pub async fn run(
    connection: &mut SqliteConnection,
    statement: Statement,
    take: RowSink<'_>,
) -> Result<u64, sqlx::Error> {
    let sql = match without_row_locks(statement.sql) {
        Cow::Borrowed(text) => text.into_sql_str(),
        Cow::Owned(text) => AssertSqlSafe(text).into_sql_str(),
    };
    let mut query = sqlx::query(sql);
    for value in statement.values {
        query = match value {
            Value::Text(text) => query.bind(text),
            Value::Integer(number) => query.bind(number),
            Value::Real(number) => query.bind(number),
        };
    }
    let mut changed = 0;
    let mut pieces = connection.fetch_many(query);
    while let Some(piece) = pieces.try_next().await? {
        match piece {
            Either::Left(done) => changed += done.rows_affected(),
            Either::Right(row) => take(Row::Sqlite(row))?,
        }
    }
    Ok(changed)
}

/// SQLite has no row locks and needs none: a writer has the whole database.
fn without_row_locks(sql: Cow<'static, str>) -> Cow<'static, str> {
    const LOCKS: [&str; 3] = [" FOR UPDATE SKIP LOCKED", " FOR UPDATE", " FOR KEY SHARE"];
    LOCKS.iter().fold(sql, |sql, lock| match sql.contains(lock) {
        true => Cow::Owned(sql.replace(lock, "")),
        false => sql,
    })
}
