//! One way to ask two engines. The SQL text of the other files is shared; what differs between SQLite and
//! PostgreSQL stands in one file each, and only connections, the `clock` and error codes do.
//!
//! Text for both: `$1` placeholders, TEXT, BIGINT and DOUBLE PRECISION, RETURNING, ON CONFLICT, row values and
//! `string_agg`, which SQLite has since 3.44. A row that is read in order to be changed is read with
//! `FOR UPDATE`: PostgreSQL locks it, SQLite, whose transactions exclude each other, is handed the text without it.

mod errors;
mod postgres;
mod schema;
mod sqlite;

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use sqlx::postgres::{PgConnectOptions, PgPool, PgRow, Postgres};
use sqlx::sqlite::{Sqlite, SqlitePool, SqliteRow};
use sqlx::{Column, ColumnIndex, Decode, Row as _, Type, TypeInfo};

use super::StoreError;
pub use errors::{is_duplicate, is_full, is_reference, is_refused, is_unavailable};
pub use schema::{Migrated, newest as newest_step};

/// Where the rows are.
#[derive(Clone)]
pub(super) enum Address {
    /// A file of SQLite, which one process has to itself.
    File(PathBuf),
    /// A PostgreSQL that many processes share.
    Server { options: Box<PgConnectOptions>, connections: u32 },
}

impl Address {
    /// The server that an address names, `postgres://…`.
    pub fn server(address: &str, connections: u32) -> Result<Address, sqlx::Error> {
        let options: PgConnectOptions = address.parse()?;
        let options = Box::new(options.application_name("facies"));
        Ok(Address::Server { options, connections })
    }
}

/// Connections of one engine.
pub(super) enum Pool {
    Sqlite(SqlitePool),
    Postgres(PgPool),
}

/// Changes that happen together or not at all; dropped, they do not happen.
pub(super) enum Transaction {
    Sqlite(sqlx::Transaction<'static, Sqlite>),
    Postgres(sqlx::Transaction<'static, Postgres>),
}

impl Transaction {
    pub async fn commit(self) -> Result<(), sqlx::Error> {
        match self {
            Transaction::Sqlite(transaction) => transaction.commit().await,
            Transaction::Postgres(transaction) => postgres::in_time(transaction.commit()).await,
        }
    }

    pub async fn rollback(self) -> Result<(), sqlx::Error> {
        match self {
            Transaction::Sqlite(transaction) => transaction.rollback().await,
            Transaction::Postgres(transaction) => postgres::in_time(transaction.rollback()).await,
        }
    }
}

/// Where a statement runs: on any free connection, or as a part of a transaction.
pub(super) enum Place<'a> {
    Pool(&'a Pool),
    Transaction(&'a mut Transaction),
}

impl<'a> From<&'a Pool> for Place<'a> {
    fn from(pool: &'a Pool) -> Self {
        Place::Pool(pool)
    }
}

impl<'a> From<&'a mut Transaction> for Place<'a> {
    fn from(transaction: &'a mut Transaction) -> Self {
        Place::Transaction(transaction)
    }
}

/// What stands for a placeholder. NULL has a type, as PostgreSQL wants.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Text(Option<String>),
    Integer(Option<i64>),
    Real(Option<f64>),
}

macro_rules! value_from {
    ($($from:ty => $variant:ident($value:ident) $made:expr;)*) => {
        $(impl From<$from> for Value {
            fn from($value: $from) -> Self {
                Value::$variant($made)
            }
        })*
    };
}

value_from! {
    &str => Text(text) Some(text.to_owned());
    &&str => Text(text) Some((*text).to_owned());
    &String => Text(text) Some(text.clone());
    String => Text(text) Some(text);
    &Option<String> => Text(text) text.clone();
    Option<String> => Text(text) text;
    Option<&str> => Text(text) text.map(str::to_owned);
    i64 => Integer(number) Some(number);
    Option<i64> => Integer(number) number;
    Option<f64> => Real(number) number;
}

/// SQL with the values for its placeholders.
#[must_use]
pub(super) struct Statement {
    sql: Cow<'static, str>,
    values: Vec<Value>,
    patient: bool,
}

/// A statement of the program's own text; what clients send only ever comes in by `bind`.
pub(super) fn query(sql: &'static str) -> Statement {
    Statement { sql: sql.into(), values: Vec::new(), patient: false }
}

/// A statement made of the program's own words. Never of a client's.
pub(super) fn query_of(sql: String) -> Statement {
    Statement { sql: sql.into(), values: Vec::new(), patient: false }
}

/// Who is handed the rows, one after the other.
pub(super) type Taker<'a> = &'a mut (dyn FnMut(Row) -> Result<(), sqlx::Error> + Send);

impl Statement {
    pub fn bind(mut self, value: impl Into<Value>) -> Self {
        self.values.push(value.into());
        self
    }

    /// Waits for the answer however long it takes.
    pub fn patiently(mut self) -> Self {
        self.patient = true;
        self
    }

    /// Hands over the rows as they come; returns how many rows were changed.
    pub async fn run(self, place: Place<'_>, take: Taker<'_>) -> Result<u64, sqlx::Error> {
        match place {
            Place::Pool(Pool::Sqlite(pool)) => {
                sqlite::run(&mut *pool.acquire().await?, self, take).await
            }
            Place::Pool(Pool::Postgres(pool)) => {
                let mut connection = pool.acquire().await?;
                let answer = postgres::run(&mut connection, self, take).await;
                if matches!(answer, Err(sqlx::Error::Io(_))) {
                    // Nobody is to wait for the answer that did not come.
                    connection.close_on_drop();
                }
                answer
            }
            Place::Transaction(Transaction::Sqlite(open)) => {
                sqlite::run(&mut *open, self, take).await
            }
            Place::Transaction(Transaction::Postgres(open)) => {
                postgres::run(&mut *open, self, take).await
            }
        }
    }

    /// The number of rows that it changed.
    pub async fn execute(self, place: impl Into<Place<'_>>) -> Result<u64, sqlx::Error> {
        self.run(place.into(), &mut |_| Ok(())).await
    }

    pub async fn fetch_all(self, place: impl Into<Place<'_>>) -> Result<Vec<Row>, sqlx::Error> {
        let mut rows = Vec::new();
        self.run(place.into(), &mut |row| {
            rows.push(row);
            Ok(())
        })
        .await?;
        Ok(rows)
    }

    /// The first row, if there is one.
    pub async fn fetch_optional(
        self,
        place: impl Into<Place<'_>>,
    ) -> Result<Option<Row>, sqlx::Error> {
        Ok(self.fetch_all(place).await?.into_iter().next())
    }

    pub async fn fetch_one(self, place: impl Into<Place<'_>>) -> Result<Row, sqlx::Error> {
        self.fetch_optional(place).await?.ok_or(sqlx::Error::RowNotFound)
    }
}

/// A row of either engine.
pub(super) enum Row {
    Sqlite(SqliteRow),
    Postgres(PgRow),
}

impl Row {
    /// A column by its name or number.
    pub fn try_get<'r, T, I>(&'r self, column: I) -> Result<T, sqlx::Error>
    where
        T: Decode<'r, Sqlite> + Type<Sqlite> + Decode<'r, Postgres> + Type<Postgres>,
        I: ColumnIndex<SqliteRow> + ColumnIndex<PgRow>,
    {
        match self {
            Row::Sqlite(row) => row.try_get(column),
            Row::Postgres(row) => row.try_get(column),
        }
    }

    /// The names of the columns, each with a value of its type.
    pub fn columns(&self) -> Result<Vec<(String, Value)>, sqlx::Error> {
        match self {
            Row::Sqlite(row) => row.columns().iter().map(typed).collect(),
            Row::Postgres(row) => row.columns().iter().map(typed).collect(),
        }
    }

    /// All values in the order of the columns.
    pub fn values(&self) -> Result<Vec<Value>, sqlx::Error> {
        let columns = self.columns()?.into_iter().enumerate();
        let value = |(number, (_, kind))| {
            Ok(match kind {
                Value::Text(_) => Value::Text(self.try_get(number)?),
                Value::Integer(_) => Value::Integer(self.try_get(number)?),
                Value::Real(_) => Value::Real(self.try_get(number)?),
            })
        };
        columns.map(value).collect()
    }
}

/// The name of a column, and NULL of its type.
fn typed<C: Column>(column: &C) -> Result<(String, Value), sqlx::Error> {
    let null = match column.type_info().name() {
        "TEXT" => Value::Text(None),
        "INTEGER" | "BIGINT" | "INT8" => Value::Integer(None),
        "REAL" | "FLOAT8" => Value::Real(None),
        other => return Err(sqlx::Error::Decode(format!("a column of type {other}").into())),
    };
    Ok((column.name().to_owned(), null))
}

/// The connections of this process: those that read, and those that may write.
#[derive(Clone)]
pub(super) struct Database {
    address: Address,
    writer: Arc<Pool>,
    reader: Arc<Pool>,
}

impl Database {
    /// Opens the database. The embedded one is created where it is not there and brought up to date. One
    /// that many share is refused unless its schema fits: none of them changes it under the others.
    pub async fn open(address: Address) -> Result<Database, StoreError> {
        let database = Database::connect(address).await?;
        match &database.address {
            Address::File(_) => drop(schema::migrate(&database.writer).await?),
            Address::Server { .. } => schema::check(&database.writer).await?,
        }
        Ok(database)
    }

    /// Brings the schema up to date, each step in a transaction of its own.
    pub async fn migrate(address: Address) -> Result<Migrated, StoreError> {
        let database = match address {
            Address::File(_) => Database::connect(address).await?,
            // A step may take longer than any request is allowed to.
            Address::Server { options, .. } => {
                let pool = Arc::new(Pool::Postgres(postgres::unlimited(&options).await?));
                let address = Address::Server { options, connections: 1 };
                Database { address, writer: pool.clone(), reader: pool }
            }
        };
        let migrated = schema::migrate(&database.writer).await;
        database.close().await;
        migrated
    }

    /// A few connections of their own to the same database.
    pub async fn again(&self) -> Result<Database, StoreError> {
        Database::connect(match &self.address {
            Address::Server { options, .. } => {
                Address::Server { options: options.clone(), connections: 2 }
            }
            file => file.clone(),
        })
        .await
    }

    async fn connect(address: Address) -> Result<Database, StoreError> {
        let (writer, reader) = match &address {
            Address::File(file) => {
                let (writer, reader) = sqlite::connect(file).await?;
                (Arc::new(Pool::Sqlite(writer)), Arc::new(Pool::Sqlite(reader)))
            }
            Address::Server { options, connections } => {
                let pool = postgres::connect(options, *connections).await?;
                let pool = Arc::new(Pool::Postgres(pool));
                (pool.clone(), pool)
            }
        };
        Ok(Database { address, writer, reader })
    }

    pub fn reader(&self) -> &Pool {
        &self.reader
    }

    /// For single statements.
    pub fn writer(&self) -> &Pool {
        &self.writer
    }

    pub async fn begin(&self) -> Result<Transaction, StoreError> {
        Ok(match &*self.writer {
            Pool::Sqlite(pool) => Transaction::Sqlite(sqlite::begin(pool).await?),
            Pool::Postgres(pool) => Transaction::Postgres(postgres::begin(pool).await?),
        })
    }

    /// A transaction whose commit does not wait for the disk. It is there before whatever is committed after it, since
    /// a log is written in its order; a crash of the server within a second may take it alone.
    pub async fn begin_unflushed(&self) -> Result<Transaction, StoreError> {
        match &*self.writer {
            Pool::Sqlite(_) => self.begin().await,
            Pool::Postgres(pool) => {
                Ok(Transaction::Postgres(postgres::begin_unflushed(pool).await?))
            }
        }
    }

    /// A transaction that sees everything as it is when it begins, and changes nothing. It may last.
    pub async fn snapshot(&self) -> Result<Transaction, StoreError> {
        Ok(match (&self.address, &*self.reader) {
            (Address::Server { options, .. }, _) => {
                let pool = postgres::unlimited(options).await?;
                Transaction::Postgres(postgres::snapshot(&pool).await?)
            }
            (_, Pool::Sqlite(pool)) => Transaction::Sqlite(pool.begin().await?),
            (_, Pool::Postgres(pool)) => Transaction::Postgres(postgres::snapshot(pool).await?),
        })
    }

    pub async fn close(&self) {
        for pool in [&self.reader, &self.writer] {
            match &**pool {
                Pool::Sqlite(pool) => pool.close().await,
                Pool::Postgres(pool) => pool.close().await,
            }
        }
    }
}
