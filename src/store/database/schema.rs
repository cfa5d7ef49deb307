//! Schema migrations, step by step. Each step runs in a transaction: it is done or it is not.

use std::sync::LazyLock;

use sqlx::migrate::{MigrateError, Migration, MigrationType, Migrator};
use sqlx::{AssertSqlSafe, SqlSafeStr, SqlStr};

use super::sqlite::Connections;
use super::value::null_of;
use super::{Pool, Row, Value, postgres, query, sqlite};
use crate::store::error::StoreError;

/// The files of `migrations/`, in order. Their macro in sqlx would compile every engine a second time, for the
/// compiler itself.
const FILES: [(&str, &str); 19] = [
    ("first", include_str!("../../../migrations/0001_first.sql")),
    ("studies", include_str!("../../../migrations/0002_studies.sql")),
    ("blobs", include_str!("../../../migrations/0003_blobs.sql")),
    ("clients", include_str!("../../../migrations/0004_clients.sql")),
    ("keys", include_str!("../../../migrations/0005_keys.sql")),
    ("deeds", include_str!("../../../migrations/0006_deeds.sql")),
    ("traces", include_str!("../../../migrations/0007_traces.sql")),
    ("unfinished blobs", include_str!("../../../migrations/0008_unfinished_blobs.sql")),
    ("error classes", include_str!("../../../migrations/0009_error_classes.sql")),
    ("made meshes", include_str!("../../../migrations/0010_made_meshes.sql")),
    ("queues", include_str!("../../../migrations/0011_queues.sql")),
    ("living deeds", include_str!("../../../migrations/0012_living_deeds.sql")),
    ("study rows", include_str!("../../../migrations/0013_study_rows.sql")),
    ("meshed cases", include_str!("../../../migrations/0014_meshed_cases.sql")),
    ("cohorts", include_str!("../../../migrations/0015_cohorts.sql")),
    ("identity", include_str!("../../../migrations/0016_identity.sql")),
    ("seen clock", include_str!("../../../migrations/0017_seen_clock.sql")),
    ("age clock", include_str!("../../../migrations/0018_age_clock.sql")),
    ("order of tags", include_str!("../../../migrations/0019_order_of_tags.sql")),
];

/// The steps as they are written, for SQLite.
static STEPS: LazyLock<Migrator> = LazyLock::new(|| {
    let step = |(version, (description, sql)): (i64, (&'static str, &'static str))| {
        let sql = SqlStr::from_static(sql);
        Migration::new(version, description.into(), MigrationType::Simple, sql, false)
    };
    Migrator::with_migrations((1..).zip(FILES).map(step).collect())
});

/// The same steps for PostgreSQL, with its clock, and with texts that compare byte by byte as those of SQLite do: in the order of a
/// language `~` comes before letters, and an index would depend on the libraries of the server's system.
static POSTGRES_STEPS: LazyLock<Migrator> = LazyLock::new(|| {
    let translated = STEPS.iter().map(|step| {
        let sql = step.sql.as_str().replace(" TEXT", " TEXT COLLATE \"C\"");
        let sql = sql.replace(
            "CAST(unixepoch('subsec') * 1000 AS INTEGER)",
            "CAST(EXTRACT(EPOCH FROM clock_timestamp()) * 1000 AS BIGINT)",
        );
        let sql = AssertSqlSafe(sql).into_sql_str();
        Migration::new(step.version, step.description.clone(), step.migration_type, sql, false)
    });
    Migrator::with_migrations(translated.collect())
});

/// From which step to which a database was brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Migrated {
    pub from: i64,
    pub to: i64,
}

/// Brings the tables up to date. One process at a time does it; the others wait.
pub async fn migrate(pool: &Pool) -> Result<Migrated, StoreError> {
    let before = applied(pool).await?;
    let (clock, ran) = match pool {
        Pool::Sqlite(Connections { pool, .. }) => (sqlite::CLOCK, STEPS.run(pool).await),
        Pool::Postgres(pool) => (postgres::CLOCK, POSTGRES_STEPS.run(pool).await),
    };
    ran.map_err(schema_error)?;
    query(clock).execute(pool).await?;
    Ok(Migrated { from: before.last().map_or(0, |step| step.0), to: newest() })
}

/// Makes the tables of a new database. One of an earlier step is refused and stays as it is: the program that made it could not open
/// it afterwards.
pub async fn make(pool: &Pool) -> Result<(), StoreError> {
    let (found, known) = (applied(pool).await?.last().map_or(0, |step| step.0), newest());
    if (1..known).contains(&found) {
        return Err(StoreError::SchemaTooOld { found, known });
    }
    migrate(pool).await.map(|_| ())
}

/// Refuses a database whose tables are not exactly those that this program works with.
pub async fn check(pool: &Pool) -> Result<(), StoreError> {
    let applied = applied(pool).await?;
    let (found, known) = (applied.last().map_or(0, |step| step.0), newest());
    if found > known {
        return Err(StoreError::SchemaTooNew { found, known });
    }
    if found < known || applied.len() < STEPS.iter().count() {
        return Err(StoreError::SchemaTooOld { found, known });
    }
    for step in POSTGRES_STEPS.iter() {
        let same =
            |(version, sum): &(i64, Vec<u8>)| *version == step.version && *sum == *step.checksum;
        if !applied.iter().any(same) {
            return Err(schema_error(MigrateError::VersionMismatch(step.version)));
        }
    }
    Ok(())
}

/// A column of a table.
pub(in crate::store) struct Column {
    pub name: String,
    pub null: Value,
    /// Whether it takes no NULL.
    pub is_needed: bool,
}

pub(super) async fn columns(pool: &Pool, table: &str) -> Result<Vec<Column>, sqlx::Error> {
    let sql = match pool {
        Pool::Sqlite(_) => sqlite::COLUMNS,
        Pool::Postgres(_) => postgres::COLUMNS,
    };
    let rows = query(sql).bind(table).fetch_all(pool).await?;
    let column = |row: &Row| {
        let null = null_of(&row.try_get::<String, _>(1)?)?;
        Ok(Column { name: row.try_get(0)?, null, is_needed: row.try_get(2)? })
    };
    rows.iter().map(column).collect()
}

/// The steps that a database has taken, with their checksums, in order.
async fn applied(pool: &Pool) -> Result<Vec<(i64, Vec<u8>)>, StoreError> {
    const APPLIED: &str = "SELECT version, checksum FROM _sqlx_migrations ORDER BY version";
    let rows = match query(APPLIED).fetch_all(pool).await {
        Err(error) if is_no_such_table(&error) => return Ok(Vec::new()),
        rows => rows?,
    };
    rows.iter().map(|row| Ok((row.try_get(0)?, row.try_get(1)?))).collect()
}

/// A database in which nothing was made yet.
fn is_no_such_table(error: &sqlx::Error) -> bool {
    const POSTGRES_UNDEFINED_TABLE: &str = "42P01";
    matches!(error, sqlx::Error::Database(inner)
        if inner.code().is_some_and(|code| code == POSTGRES_UNDEFINED_TABLE)
            || inner.message().starts_with("no such table"))
}

/// The last step that this program knows.
pub fn newest() -> i64 {
    STEPS.iter().map(|step| step.version).max().unwrap_or(0)
}

fn schema_error(error: MigrateError) -> StoreError {
    match error {
        MigrateError::VersionMissing(found) => StoreError::SchemaTooNew { found, known: newest() },
        MigrateError::Execute(error) | MigrateError::ExecuteMigration(error, _) => {
            StoreError::from(error)
        }
        other => StoreError::Schema(other.to_string()),
    }
}
