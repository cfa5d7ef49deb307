//! Particulars of PostgreSQL: its limits of time, its clock, its codes.

use std::borrow::Cow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use futures::TryStreamExt;
use sqlx::pool::PoolConnectionMetadata;
use sqlx::postgres::{PgConnectOptions, PgConnection, PgPool, PgPoolOptions, Postgres};
use sqlx::{AssertSqlSafe, Connection, Either, Executor, SqlSafeStr};

use super::{Row, RowSink, Statement, Value};

/// Milliseconds since 1970 by the clock of the database, whatever the clocks of its clients show.
pub const CLOCK: &str = "CREATE OR REPLACE VIEW clock AS \
     SELECT CAST(EXTRACT(EPOCH FROM clock_timestamp()) * 1000 AS BIGINT) AS now_ms";

/// The columns of a table, their types, and whether each has to hold something.
pub const COLUMNS: &str = "SELECT CAST(column_name AS TEXT), UPPER(data_type), is_nullable = 'NO' \
     FROM information_schema.columns WHERE table_schema = current_schema() AND table_name = $1";

/// The disk is full.
pub const FULL: &str = "53100";
/// A replica takes no row.
const READ_ONLY: &str = "25006";

/// How long a request waits for a connection before it is told to come back.
pub const ACQUIRE_TIMEOUT: Duration = Duration::from_millis(2500);
/// How long an answer may take. A server behind a broken network says nothing at all, and a heartbeat that
/// waits for it would miss that its lease has run out.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);
/// A connection that was used within this time is used again without being asked whether it is there: under load the question
/// would cost as much as what is asked of it. No server is back sooner after a crash.
const FRESH: Duration = Duration::from_millis(100);
/// A connection keeps the default of its first moment, to write or only to read (`default_transaction_read_only`). One that only reads
/// is used for so long, so that what is stored can be read meanwhile, and the next one may write.
const READS_FOR: Duration = Duration::from_secs(2);
/// How long after a refused row every connection is asked.
const DOUBT: Duration = Duration::from_secs(10);
/// What the server keeps to by itself. A client that was cut off holds its locks no longer than this. Statements take
/// milliseconds, whatever the planner expects of them: compiling that of a page of 200 jobs took the server 100 to 240 ms,
/// running it 7 to 19.
const LIMITS: &str = "SET jit = off; SET statement_timeout = '10s'; SET lock_timeout = '5s'; \
     SET idle_in_transaction_session_timeout = '10s'; \
     SET tcp_keepalives_idle = 10; SET tcp_keepalives_interval = 5; SET tcp_keepalives_count = 3";

/// Server, port and database, without what is secret.
pub fn name(options: &PgConnectOptions) -> String {
    let database = options.get_database().unwrap_or_default();
    format!("{}:{}/{database}", options.get_host(), options.get_port())
}

/// Connections that give up in time. The first is made at once, so that a wrong address is found at the start.
pub async fn connect(options: &PgConnectOptions, connections: u32) -> Result<PgPool, sqlx::Error> {
    PgPoolOptions::new()
        .max_connections(connections)
        .acquire_timeout(ACQUIRE_TIMEOUT)
        .test_before_acquire(false)
        .before_acquire(|connection, used| Box::pin(is_there(connection, used)))
        .after_connect(|connection, _| {
            Box::pin(async move { connection.execute(LIMITS).await.map(|_| ()) })
        })
        .after_release(|connection, _| Box::pin(is_free(connection)))
        .connect_with(options.clone())
        .await
}

/// Whether a connection may be used again: the server answers on it, and it is not one of a time when nothing could be written.
async fn is_there(
    connection: &mut PgConnection,
    used: PoolConnectionMetadata,
) -> Result<bool, sqlx::Error> {
    const MODE: &str = "SELECT current_setting('transaction_read_only')";
    if used.idle_for < FRESH && !was_refused_lately() {
        return Ok(true);
    }
    let mode: String = in_time(sqlx::query_scalar(MODE).fetch_one(connection)).await?;
    Ok(mode == "off" || used.age < READS_FOR)
}

/// When a row was last refused because the server, or the connection, only reads.
static REFUSED: Mutex<Option<Instant>> = Mutex::new(None);

fn was_refused_lately() -> bool {
    let refused = REFUSED.lock().unwrap_or_else(PoisonError::into_inner);
    refused.is_some_and(|at| at.elapsed() < DOUBT)
}

/// An answer, of which it is remembered that a row was refused.
fn watched<T>(answer: Result<T, sqlx::Error>) -> Result<T, sqlx::Error> {
    if let Err(sqlx::Error::Database(error)) = &answer
        && error.code().is_some_and(|code| is_read_only(&code))
    {
        *REFUSED.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
    }
    answer
}

/// Whether a connection that comes back may be used again: the server answers on it, and its transaction is over.
async fn is_free(connection: &mut PgConnection) -> Result<bool, sqlx::Error> {
    // One that was lost in the middle of a commit says nothing at all, and would be waited for.
    in_time(connection.ping()).await?;
    Ok(!connection.is_in_transaction())
}

/// A connection that takes its time.
pub async fn unlimited(options: &PgConnectOptions) -> Result<PgPool, sqlx::Error> {
    let pool = PgPoolOptions::new().max_connections(1).acquire_timeout(ACQUIRE_TIMEOUT);
    pool.connect_with(options.clone()).await
}

/// Each statement sees what was committed before it (READ COMMITTED), so what is read in order to be
/// changed is read with FOR UPDATE.
pub async fn begin(pool: &PgPool) -> Result<sqlx::Transaction<'static, Postgres>, sqlx::Error> {
    in_time(pool.begin()).await
}

/// Its commit is written by the next one that is flushed, or within a second.
pub async fn begin_unflushed(
    pool: &PgPool,
) -> Result<sqlx::Transaction<'static, Postgres>, sqlx::Error> {
    in_time(pool.begin_with("BEGIN; SET LOCAL synchronous_commit = off")).await
}

/// Sees everything as it is when it begins.
pub async fn snapshot(pool: &PgPool) -> Result<sqlx::Transaction<'static, Postgres>, sqlx::Error> {
    pool.begin_with("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY").await
}

/// Runs a statement to its end.
pub async fn run(
    connection: &mut PgConnection,
    statement: Statement,
    take: RowSink<'_>,
) -> Result<u64, sqlx::Error> {
    let sql = match statement.sql {
        Cow::Borrowed(text) => text.into_sql_str(),
        Cow::Owned(text) => AssertSqlSafe(text).into_sql_str(),
    };
    let mut query = sqlx::query(sql);
    for value in statement.values {
        query = match value {
            Value::Text(text) => query.bind(text.map(without_nul)),
            Value::Integer(number) => query.bind(number),
            Value::Real(number) => query.bind(number),
        };
    }
    let answer = async {
        let mut changed = 0;
        let mut pieces = connection.fetch_many(query);
        while let Some(piece) = pieces.try_next().await? {
            match piece {
                Either::Left(done) => changed += done.rows_affected(),
                Either::Right(row) => take(Row::Postgres(row))?,
            }
        }
        Ok(changed)
    };
    watched(if statement.patient { answer.await } else { in_time(answer).await })
}

/// An answer that does not come in time is an error of the connection.
pub async fn in_time<T>(
    answer: impl Future<Output = Result<T, sqlx::Error>>,
) -> Result<T, sqlx::Error> {
    let late = || sqlx::Error::Io(std::io::ErrorKind::TimedOut.into());
    tokio::time::timeout(ANSWER_TIMEOUT, answer).await.unwrap_or_else(|_| Err(late()))
}

/// PostgreSQL keeps no NUL in a text, and nothing that is kept has one: documents are JSON, names hold no
/// control characters. A filter with one is turned into another that matches nothing either.
fn without_nul(text: String) -> String {
    if text.contains('\0') { text.replace('\0', "\u{1}") } else { text }
}

/// Connections lost (08), too many of them (53), the server stopping or starting (57P), a deadlock or
/// another transaction in the way (40, 55P03), a limit of time (57014), a server that only reads.
pub fn is_transient(code: &str) -> bool {
    let classes = ["08", "40", "53", "55P03", "57", READ_ONLY];
    code != FULL && classes.iter().any(|class| code.starts_with(class))
}

pub fn is_read_only(code: &str) -> bool {
    code == READ_ONLY
}

/// A wrong user or password (28), no such database (3D).
pub fn is_access_denied(code: &str) -> bool {
    code.starts_with("28") || code.starts_with("3D")
}
